#!/usr/bin/env python3
"""`sgmp-view solids`: volumes of STL solids and of elements of LS-DYNA against closed forms, particle files as sgmp
takes them, and what is said of surfaces and decks that are wrong.

usage: solids.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import contextlib
import importlib.util
import io
import itertools
import math
import os
import sys

from _runs import SCRATCH, SOURCE, Report, run

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
    print("skipped: numpy and matplotlib are not installed")
    sys.exit(77)
sys.path.insert(0, os.path.join(SOURCE, "python"))
import numpy as np  # noqa: E402
from sgmp_view import command  # noqa: E402
from sgmp_view.dyna import hexahedron  # noqa: E402

FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], dtype=float)
DECK = """
dimension 3
grid cell=0.5
time dt=1e-9 steps=1
material m elastic density=2 young=1 poisson=0
body part file material=m file={file} spacing=0.25
output csv at=end fields=mass
"""


def view(*words):
    """Runs the command in the scratch folder; its exit code and all that it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            command.main(["solids", *words])
        except SystemExit as end:
            return (1, printed.getvalue() + end.code) if isinstance(end.code, str) else (end.code, printed.getvalue())
    return 0, printed.getvalue()


def write(name, text):
    """A file in the scratch folder; its path."""
    path = os.path.join(SCRATCH, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def stl(name, *triangles):
    """An STL file of triangles (n, 3, 3)."""
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*p) for p in t)
        + "endloop\nendfacet\n"
        for t in np.concatenate(triangles)
    )
    return write(name, f"solid s\n{facets}endsolid s\n")


def box(lower, upper, outwards=True):
    """The 12 triangles of a box."""
    corners = np.array(lower) + CUBE * (np.array(upper) - lower)
    triangles = np.array([corners[list(t)] for a, b, c, d in FACES for t in ((a, b, c), (a, c, d))])
    return triangles if outwards else triangles[:, ::-1]


def sphere(radius, rings):
    """A sphere of triangles whose corners lie on it, and the volume of that polyhedron as a sum of pyramids to its
    centre."""
    def at(i, j):
        theta, phi = math.pi * i / rings, math.pi * j / rings
        return (
            radius * math.sin(theta) * math.cos(phi), radius * math.sin(theta) * math.sin(phi),
            radius * math.cos(theta),
        )
    triangles = []
    for i, j in itertools.product(range(rings), range(2 * rings)):
        k = (j + 1) % (2 * rings)
        if i > 0:
            triangles.append((at(i, j), at(i + 1, k), at(i, k)))
        if i < rings - 1:
            triangles.append((at(i, j), at(i + 1, j), at(i + 1, k)))
    triangles = np.array(triangles)
    triangles[np.abs(triangles) < 1e-12] = 0
    return triangles, sum(abs(np.linalg.det(t)) for t in triangles) / 6


def table(path):
    """Places and volumes of a particle file."""
    rows = np.loadtxt(path)
    return rows[:, :3], rows[:, 3]


def surfaces(report):
    """A box that the lattice fits, a hollow one, a sphere, and surfaces that are none of a solid."""
    if not importlib.util.find_spec("vtk"):
        print("without VTK: STL files are not tested")
        code, text = view(stl("none.stl", box((0, 0, 0), (1, 1, 1))), "--spacing", "0.25")
        report.check(code == 1 and "need VTK: pip install vtk" in text, f"without VTK: {text}")
        return
    path = stl("box.stl", box((0, 0, 0), (2, 1, 0.5)))
    code, text = view(path, "--spacing", "0.25", "--density", "2")
    report.check(
        code == 0 and "64 particles, mass 2; of the solid 2 (+0.00 %)" in text and "file=box.txt spacing=0.25" in text,
        f"box: {text}",
    )
    points, volumes = table(path.replace(".stl", ".txt"))
    wanted = {(0.25*i + 0.125, 0.25*j + 0.125, 0.25*k + 0.125) for i in range(8) for j in range(4) for k in range(2)}
    report.check(
        {tuple(p) for p in points.round(9)} == wanted and np.all(volumes == 0.015625),
        f"box: other particles {points[:4]}",
    )
    result = run("box", DECK.format(file=path.replace(".stl", ".txt")))
    if report.finished(result, "box"):
        report.check(
            abs(sum(row["mass"] for row in result.table("particles_end.csv")) - 2) < 1e-12, "box: another mass in sgmp"
        )
    code, text = view(
        path, "--spacing", "2.5", "--scale", "10", "--move", "100,0,-3", "-o", os.path.join(SCRATCH, "moved.txt")
    )
    points, volumes = table(os.path.join(SCRATCH, "moved.txt"))
    report.check(
        code == 0
        and "volume 1000; of the solid 1000 (+0.00 %)" in text
        and len(points) == 64
        and np.allclose([points.min(axis=0), points.max(axis=0)], [(101.25, 1.25, -1.75), (118.75, 8.75, 0.75)]),
        f"moved: {text}",
    )
    code, text = view(
        stl("hollow.stl", box((0, 0, 0), (2, 2, 2)), box((0.5, 0.5, 0.5), (1.5, 1.5, 1), outwards=False)), "--spacing",
        "0.25",
    )
    report.check("480 particles, volume 7.5; of the solid 7.5 (+0.00 %)" in text, f"hollow: {text}")
    triangles, exact = sphere(3.0, 24)
    code, text = view(stl("ball.stl", triangles), "--spacing", "0.25", "--origin", "0,0,0")
    found = float(text.split("of the solid ")[1].split()[0]) if "of the solid" in text else 0
    points, volumes = table(os.path.join(SCRATCH, "ball.txt"))
    report.check(
        abs(found / exact - 1) < 1e-5 and abs(volumes.sum() / exact - 1) < 0.01, f"ball: {text}, exact {exact}"
    )
    report.check(
        np.all(np.linalg.norm(points, axis=1) < 3) and np.allclose(points.sum(axis=0), 0, atol=1e-6),
        "ball: particles outside, or to one side",
    )
    for name, triangles, said in (
        ("open.stl", box((0, 0, 0), (1, 1, 1))[1:], "the surface is open: 3 edges"),
        (
            "three.stl", np.concatenate([box((0, 0, 0), (1, 1, 1)), box((1, 1, 0), (2, 2, 1))]),
            "more than two triangles",
        ),
        ("coarse.stl", box((0, 0, 0), (1, 1, 1)), "its sides are 1 x 1 x 1: choose a smaller --spacing"),
    ):
        code, text = view(stl(name, triangles), "--spacing", "0.25" if name != "coarse.stl" else "5")
        report.check(code == 1 and said in text and name in text, f"{name}: {text}")
    for words, said in (
        ((write("text.stl", "hello\n"), "--spacing", "1"), "no triangles"), ((path,), "needs --spacing"),
        ((path, "--spacing", "-1"), "--spacing -1 is not positive"),
        (("nowhere.stl", "--spacing", "1"), "no such file"),
        ((write("a.obj", ""), "--spacing", "1"), "neither .stl nor"),
    ):
        code, text = view(*words)
        report.check(code == 1 and said in text, f"{words}: {text}")


def elements(report):
    """Volumes of elements: a cube; a frustum of a pyramid; a twisted hexahedron, whose volume is that of its 5
    tetrahedra averaged over both ways to cut it (the volume of a trilinear hexahedron)."""
    for split in (1, 2, 3):
        places, volumes = hexahedron(CUBE, split)
        report.check(
            np.allclose(volumes, split**-3) and np.allclose(places.mean(axis=0), 0.5) and len(places) == split**3,
            f"cube in {split}: {volumes}",
        )
    frustum = CUBE * (2, 2, 3)
    frustum[4:, :2] = 0.5 + CUBE[4:, :2]
    places, volumes = hexahedron(frustum, 1)  # Heron: h (A + sqrt(A a) + a)/3
    report.check(abs(volumes[0] - (4 + 2 + 1)) < 1e-12, f"frustum: {volumes}")
    report.check(abs(places[0, 2] - 3*(4 + 2*2 + 3*1)/(4*(4 + 2 + 1))) < 1e-12, f"frustum: centroid {places}")
    report.check(abs(hexahedron(frustum, 4)[1].sum() - 7) < 1e-12, "frustum in 64 parts: another volume")
    twisted = CUBE + np.array(
        [
            (0.1, -0.2, 0.05), (0.2, 0.1, -0.1), (-0.1, 0.15, 0.2), (0, 0.1, -0.2), (0.3, 0, 0.1), (-0.2, 0.1, 0),
            (0.1, 0.2, -0.1), (0, -0.3, 0.2),
        ]
    )
    cuts = (
        ((0, 1, 3, 4), (2, 3, 1, 6), (5, 4, 6, 1), (7, 6, 4, 3), (1, 3, 4, 6)),
        ((1, 2, 0, 5), (3, 0, 2, 7), (4, 7, 5, 0), (6, 5, 7, 2), (0, 5, 7, 2)),
    )
    volume = sum(abs(np.linalg.det(twisted[list(t)][1:] - twisted[t[0]])) / 6 for cut in cuts for t in cut) / 2
    report.check(
        abs(hexahedron(twisted, 1)[1][0] - volume) < 1e-12,
        f"twisted: {hexahedron(twisted, 1)[1]}, by tetrahedra {volume}",
    )


MESH = """*KEYWORD
*TITLE
a cube, a tetrahedron, a wedge and two SPH nodes
*NODE
$    id               x               y               z
       1             0.0             0.0             0.0       0       0
       2             2.0             0.0             0.0
       3             2.0             2.0             0.0
       4             0.0             2.0             0.0
5,0.,0.,2.+0
6,2,0,2
7,2,2,2d0
8,0,2,20.e-1
*ELEMENT_SOLID
       1       7       1       2       3       4       5       6       7       8
       2       8
       1       2       4       5       5       5       5       5
       3       8       1       2       3       4       5       5       8       8
*PART
the block
         7         1         1
$ a comment
*MAT_ELASTIC
         1      7.85     210.0       0.3
*PART
some pieces
         8         1         1
*ELEMENT_SPH
       1       9            -0.5
6,9,4.0
*CONTROL_TERMINATION
1.0
*END
what comes after the end is not read
"""


def meshes(report):
    """A small deck with all that is read, and decks that are wrong."""
    path = write("mesh.k", MESH)
    code, text = view(path, "--density", "8")
    report.check(code == 0 and "left out: *MAT_ELASTIC, *CONTROL_TERMINATION" in text, f"mesh: {text}")
    for part, volumes in ((7, [8]), (8, [8/6, 4]), (9, [0.5, 0.5])):
        rows = np.loadtxt(os.path.join(SCRATCH, f"mesh_part{part}.txt"), ndmin=2)
        report.check(np.allclose(rows[:, 3], volumes), f"part {part}: {rows}")
    rows = np.loadtxt(os.path.join(SCRATCH, "mesh_part8.txt"))
    report.check(np.allclose(rows[:, :3], [(0.5, 0.5, 0.5), (2/3, 1, 2/3)]), f"part 8: {rows}")
    with open(os.path.join(SCRATCH, "mesh_part7.txt"), encoding="utf-8") as file:
        report.check("part 7 the block of mesh.k" in file.readline(), "mesh_part7.txt: no title")
    code, text = view(path, "--part", "7", "--split", "4", "-o", os.path.join(SCRATCH, "block.txt"))
    result = run("block", DECK.format(file=os.path.join(SCRATCH, "block.txt")))
    if report.finished(result, "block"):
        rows = result.table("particles_end.csv")
        report.check(
            len(rows) == 64 and abs(sum(row["mass"] for row in rows) - 16) < 1e-9, f"block: {len(rows)} particles"
        )
    for old, new, said in (
        ("*NODE\n", "*NODE\n  1 0.0 0.0 0.0\n", ":5: '1 0.0' is not a whole number"),
        (
            "       4             0.0             2.0",
            "       4             0.0             2.O",
            ":9: '2.O' is not a number",
        ),
        ("       1       7       1       2", "       1       7       1      99", "mesh.k:15: there is no node 99"),
        (
            "       1       7       1       2       3       4       5       6       7       8",
            "       1       7       5       6       7       8       1       2       3       4",
            ":15: element 1 is inside out",
        ),
        ("       2       8\n", "       2       8       1       2       3\n", ":16: element 2 has 3 nodes"),
        (
            "       1       2       4       5       5       5       5       5\n",
            "       1       2       4       5       5       5       5       5       6       7\n",
            ":17: element 2 has nodes between",
        ),
        (
            "       1       2       4       5       5       5       5       5\n",
            "*END\n",
            ":17: element 2 has no line of nodes",
        ),
        ("8,0,2,20", "7,0,2,20", "there are two of node 7"),
        ("8,0,2,20", "0,0,2,20", ":13: node 0: numbers are positive"),
        ("-0.5", " 0.0", "SPH node 1 has neither"),
        ("*MAT_ELASTIC", "*INCLUDE", "*INCLUDE is not read"),
        ("*NODE\n", "*NODE %\n", "the long format"),
        ("*ELEMENT_SOLID\n", "*ELEMENT_SOLID_ORTHO\n", "*ELEMENT_SOLID_ORTHO is not read"),
        ("*KEYWORD", "*KEYWORD LONG=Y", ":1: the long format"),
    ):
        code, text = view(write("mesh.k", MESH.replace(old, new, 1)), "--density", "8")
        report.check(code == 1 and said in text, f"{new!r}: {text}")
    write("mesh.k", MESH)
    for words, said in (
        ((path,), "mesh.k:30: SPH node 6 has a mass: --density"),
        ((path, "--part", "3"), "no elements of part 3; there are: 7, 8, 9"),
        ((path, "--density", "8", "-o", "x.txt"), "-o is for one part, and there are 3"),
        ((write("empty.k", "*KEYWORD\n*END\n"),), "neither *ELEMENT_SOLID nor"),
        ((write("none.k", "hello\n"),), "no keyword"),
    ):
        code, text = view(*words)
        report.check(code == 1 and said in text, f"{words}: {text}")


def main():
    """All of it."""
    report = Report()
    for part in (elements, meshes, surfaces):
        part(report)
    report.end()


main()
