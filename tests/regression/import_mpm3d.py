#!/usr/bin/env python3
"""Import of MPM3D decks: native decks and reports as they should be, errors at their places, runs against native decks.

usage: import_mpm3d.py SGMP SOURCE_DIR SCRATCH_DIR [--write]

tests/decks/mpm/X.mpm must become golden/X.inp with the report golden/X.import.txt (--write replaces both, to be read
before they are committed); broken/X.mpm says in its first line what must be printed.
"""
import csv
import math
import os
import re
import shutil
import subprocess
import sys

from _runs import tidy

EXECUTABLE, SOURCE, SCRATCH = map(os.path.abspath, sys.argv[1:4])
WRITE = "--write" in sys.argv
DECKS = os.path.join(SOURCE, "tests", "decks", "mpm")
FULL = os.environ.get("SGMP_TEST_FULL", "") not in ("", "0")
T_END = 0.08 if FULL else 0.02
FAILURES = []
# The mutation tool asks whether anything fails, not what.
FIRST_ENDS = os.environ.get("SGMP_TEST_FIRST_ENDS", "") not in ("", "0")


def sgmp(*words, folder=DECKS):
    done = subprocess.run(
        [EXECUTABLE, *words], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300, check=False
    )
    return done.returncode, done.stdout.decode("utf-8", "replace")


def expect(condition, what):
    if not condition:
        FAILURES.append(what)
        print("FAIL", what)
        if FIRST_ENDS:
            sys.exit(1)


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


def fresh(name):
    folder = os.path.join(SCRATCH, name)
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def goldens():
    """Every deck: what it becomes, and that it is a deck."""
    out = fresh("golden")
    names = sorted(name[:-4] for name in os.listdir(DECKS) if name.endswith(".mpm"))
    for name in names:
        code, printed = sgmp("import", name + ".mpm", "--output", out)
        expect(code == 0, f"{name}: {printed}")
        report = os.path.join(out, name + ".import.txt")
        text = read(report).replace(out + "/", "")
        with open(report, "w", encoding="utf-8") as file:
            file.write(text)
        code, printed = sgmp(os.path.join(out, name + ".inp"), "--check", "--output", os.path.join(out, "checked"))
        expect(code == 0, f"{name}: the native deck: {printed}")
    folder = os.path.join(DECKS, "golden")
    for name in sorted(os.listdir(out)):
        if WRITE:
            shutil.copy(os.path.join(out, name), os.path.join(folder, name))
        known = os.path.exists(os.path.join(folder, name))
        expect(known and read(folder, name) == read(out, name), f"golden/{name} is another")
    return len(names)


def broken():
    """Errors: exit code 3 and the words of the first line."""
    folder = os.path.join(DECKS, "broken")
    names = sorted(os.listdir(folder))
    for name in names:
        pattern = re.match("! expected: (.*)\n", read(folder, name)).group(1)
        code, printed = sgmp("import", name, "--output", fresh("broken"), folder=folder)
        expect(code == 3, f"{name}: exit code {code}")
        expect(re.search(pattern, printed, re.DOTALL), f"{name}: no '{pattern}' in {printed}")
        code, printed = sgmp(name, "--output", fresh("broken"), folder=folder)
        expect(code == 3, f"{name}: exit code {code} of a run")
    return len(names)


def files():
    """A deck that is there is not overwritten; a foreign deck of another name is one line; options of runs are
    refused."""
    out = fresh("files")
    sgmp("import", "points.mpm", "--output", out)
    code, printed = sgmp("import", "points.mpm", "--output", out)
    expect(code == 5 and "there is a file" in printed, f"overwritten: {printed}")
    code, printed = sgmp("import", "nowhere.mpm")
    expect(code == 5 and "nowhere.mpm" in printed, f"missing deck: {code} {printed}")
    code, printed = sgmp("import", "points.mpm", "--check")
    expect(code == 2 and "--keep-3d" in printed, f"option of a run: {printed}")
    code, printed = sgmp("import", "points.mpm", "--keep-3d", "--output", fresh("keep"))
    shutil.copy(os.path.join(DECKS, "points.mpm"), os.path.join(out, "renamed.inp"))
    code, printed = sgmp(os.path.join(out, "renamed.inp"), "--check")
    expect(code == 3 and "1 error(s)" in printed and "import" in printed, f"renamed: {printed}")


def last_row(folder, name="history.csv"):
    rows = [row for row in csv.reader(read(folder, name).splitlines()) if row and not row[0].startswith("#")]
    return dict(zip(rows[0], rows[-1]))


def run(name, *options):
    """A deck of the folder, run on one thread: the folder of its results, and what was printed."""
    folder = fresh("_".join([name, *options]).replace("-", ""))
    code, printed = sgmp(name + ".mpm", "--output", folder, "--threads", "1", *options)
    expect(code == 0, f"{name} {options}: {printed}")
    return folder, printed


def thickness(folder, name):
    """What masses and energies are divided by, from the report; 1 where nothing is left out."""
    found = re.search(r"are those there over (\S+);", read(folder, name + ".import.txt"))
    return float(found.group(1)) if found else 1.0


def keep_3d():
    """One cell thick or not: the same run, for masses and energies times the thickness. A slope of points, whose rows
    are alike; two cells between planes of symmetry with gimp, where all nodes are held, bspline alike."""
    for name in ("edge_load", "slope_points", "two_cells"):
        (thin, _), (thick, _) = run(name), run(name, "--keep-3d")
        for file, dimension in ((thin, 2), (thick, 3)):
            expect(f"dimension {dimension}\n" in read(file, name + ".inp"), f"{name}: not in {dimension} dimensions")
        factor = thickness(thin, name)
        for column in ("kinetic_energy", "total_energy", "momentum_x"):
            a, b = float(last_row(thin)[column])*factor, float(last_row(thick)[column])
            expect(
                abs(a - b) <= 1e-6 * abs(b) + 1e-12, f"{name}, {column}: {a} in plane strain, {b} in three dimensions"
            )
    folder = fresh("two_cells_bimp")
    os.makedirs(folder)
    with open(os.path.join(folder, "x.mpm"), "w", encoding="utf-8") as file:
        file.write(read(DECKS, "two_cells.mpm").replace("\ngimp\n", "\nbimp\n"))
    code, printed = sgmp("import", "x.mpm", folder=folder)
    expect(
        code == 0 and "dimension 2\n" in read(folder, "x.inp") and "method bspline" in read(folder, "x.inp"),
        f"bimp: {printed}",
    )


def shared_field():
    """Without cont two components share a field: the second bar, which flies away, takes the first with it. Apart,
    their centres were 4.4 from each other at the end, and the first at rest; together both have half of the speed in
    the mean."""
    folder, _ = run("shared_field")
    rows = [dict(zip(("x", "v"), (float(row["x"]), float(row["velocity_x"])))) for row in table(folder)]
    first, second = rows[:8], rows[8:]
    apart = sum(row["x"] for row in second)/8 - sum(row["x"] for row in first)/8
    expect(abs(apart - 4) < 0.05, f"shared_field: the bars are {apart} apart")
    mean = sum(row["v"] for row in rows)/16
    expect(abs(mean - 0.05) < 1e-10, f"shared_field: mean velocity {mean}")
    expect(sum(row["v"] for row in first) > 0.1, f"shared_field: the first bar has {sum(row['v'] for row in first)}")


def total_lagrangian():
    """Total Lagrangian motion knows no box: nothing is lost, and a block without stress flies on at its speed, 10 to
    the right and 6 down."""
    folder, _ = run("total_lagrangian")
    rows = table(folder)
    expect(len(rows) == 128, f"total_lagrangian: {len(rows)} of 128 particles")
    for axis, place in (("x", 13), ("y", -4)):
        mean = sum(float(row[axis]) for row in rows)/len(rows)
        expect(abs(mean - place) < 1e-9, f"total_lagrangian: {axis} = {mean} at the end")


def hot_expansion():
    """In expansion the pressure is rho0 c0^2 mu = 200 (V0/V - 1), whatever the energy; in the law with the energy it is
    far from it."""
    folder, printed = run("hot_expansion")
    expect(
        "hot_expansion.mpm:16:1: warning: the rows of body 1 lie off the middle" in printed, f"no warning: {printed}"
    )
    native = read(folder, "hot_expansion.inp")
    shutil.copy(os.path.join(folder, "hot_expansion_body_1.txt"), os.path.join(SCRATCH, "hot_expansion_body_1.txt"))
    with open(os.path.join(SCRATCH, "thermal.inp"), "w", encoding="utf-8") as file:
        file.write(native.replace(" expansion=cold", ""))
    sgmp("thermal.inp", "--quiet", "--output", fresh("thermal"), folder=SCRATCH)
    for name, least, most in ((folder, 0, 1e-10), (os.path.join(SCRATCH, "thermal"), 1, 1e9)):
        rows = [(float(row["pressure"]), float(row["volume"])) for row in table(name) if float(row["volume"]) > 0.5]
        expect(len(rows) > 30, f"{name}: {len(rows)} particles have expanded")
        error = max(abs(p - 200*(0.5/v - 1)) for p, v in rows)
        expect(least <= error <= most, f"{name}: pressure off C1 mu by {error}")


def table(folder):
    """Rows of particles_end.csv, by name."""
    rows = [
        row for row in csv.reader(read(folder, "particles_end.csv").splitlines()) if row and not row[0].startswith("#")
    ]
    return [dict(zip(rows[0], row)) for row in rows[1:]]


def nothing_left():
    """A deck that was imported to one that cannot be is not left behind, so that the mended one needs no other
    folder."""
    for name in ("poisson", "far_away"):
        folder = fresh("left")
        sgmp("import", os.path.join("broken", name + ".mpm"), "--output", folder)
        expect(not os.path.exists(os.path.join(folder, name + ".inp")), f"{name}.inp is left behind")


def taylor_deck(discs):
    """A Taylor bar in MPM3D's language: 67 discs, or their particles one by one."""
    spacing, radius, layers = 0.38, 10, 67
    odd = [0.5 * i * spacing for i in range(1 - 2 * radius, 2 * radius, 2)]
    flat = [(x, y) for y in odd for x in odd if x * x + y * y < (radius * spacing) ** 2]
    head = f"""mpm3d *** copper bar
nbco 1 nbmp {layers * len(flat)} nbbo {layers if discs else 1} nmat 1
grid -9.12 9.12  -9.12 9.12  -0.76 27.36
dcell 0.76
dtscale 0.8
endtime {T_END}
sgmp musl on
fixed 0 0 0 0 2 0
material
 1 sjc 8.93e-3 117e3 0.35 157 425 1.0 0 1.0
seos 1 2 3940 1.49 1.96 0
"""
    if discs:
        bodies = "".join(
            f"particle cicle 1\n 1 8.93e-3 {spacing} 0 0 {spacing * k:.2f} {radius}\n" for k in range(layers)
        )
    else:
        places = [(x, y, (k + 0.5) * spacing) for k in range(layers) for x, y in flat]
        bodies = f"particle point 1 {len(places)}\n" + "".join(
            f"{n} 1 {8.93e-3 * spacing**3:.12e} {x:.4f} {y:.4f} {z:.4f}\n" for n, (x, y, z) in enumerate(places, 1))
    speeds = "".join(f"body {b} 0 0 -190\n" for b in range(1, (layers if discs else 1) + 1))
    return head + bodies + "velo\n" + speeds + "endv\nendi\n"


def bar_shape(folder):
    """L, D, W by the rule of scripts/taylor_bar_report.py."""
    spacing, cell, level = 0.38, 0.76, 0.2 * 25.4
    rows = [
        row for row in csv.reader(read(folder, "particles_end.csv").splitlines()) if row and not row[0].startswith("#")
    ]
    columns = [rows[0].index(name) for name in ("x", "y", "z")]
    points = []
    for row in rows[1:]:
        try:
            points.append([float(row[i]) for i in columns])
        except ValueError:  # units
            continue
    foot = min(z for _, _, z in points)
    width = [2 * (max(math.hypot(x, y) for x, y, z in points if low <= z <= high) + spacing / 2)
             for low, high in ((foot, foot + cell), (level - cell / 2, level + cell / 2))]
    return [max(z for _, _, z in points) + spacing / 2, *width]


def taylor():
    """Both forms of the Taylor bar against the native deck: L, D, W within 0.5 %."""
    shapes = {}
    for form in ("discs", "points"):
        folder = fresh("taylor_" + form)
        os.makedirs(folder)
        with open(os.path.join(folder, "bar.mpm"), "w", encoding="utf-8") as file:
            file.write(taylor_deck(form == "discs"))
        code, printed = sgmp("bar.mpm", "--quiet", "--output", "out", folder=folder)
        expect(code == 0 and "warning" not in printed, f"Taylor bar, {form}: {printed}")
        shapes[form] = bar_shape(os.path.join(folder, "out"))
    native = fresh("taylor_native")
    deck = os.path.join(SOURCE, "input", "taylor_bar.inp")
    sgmp(deck, "--quiet", "--output", native, "--set", "cfl=0.8", "--set", f"t_end={T_END}", "--set", "fit=cubes")
    reference = bar_shape(native)
    print("L, D, W:", reference, shapes)
    for form, shape in shapes.items():
        for name, value, known in zip("LDW", shape, reference):
            expect(abs(value / known - 1) < 0.005, f"Taylor bar, {form}: {name} = {value}, native {known}")


def against_native(name, options, native, native_options, tolerance):
    """Kinetic energy at the end of an imported deck and of a native one that says the same."""
    energies = []
    for deck, words in ((name + ".mpm", options), (os.path.join(SOURCE, "input", native), native_options)):
        folder = fresh(os.path.basename(deck) + "_run")
        settings = [word for setting in words for word in ("--set", setting)]
        code, printed = sgmp(deck, "--quiet", "--output", folder, *settings)
        expect(code == 0, f"{deck}: {printed}")
        energies.append(float(last_row(folder)["kinetic_energy"]))
    print(f"{name}: kinetic energy {energies[0]}, {native} {energies[1]}")
    expect(
        abs(energies[0] / energies[1] - 1) < tolerance, f"{name}: kinetic energy {energies[0]}, {native} {energies[1]}"
    )


def without_viscosity():
    """The slab of explosive as MPM3D has it, which gives explosives no bulk viscosity."""
    path = os.path.join(SCRATCH, "tnt_slab_inviscid.inp")
    lines = [
        line
        for line in read(SOURCE, "input", "tnt_slab.inp").splitlines()
        if not re.match("viscosity |parameter linear", line)
    ]
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join([*lines, "viscosity all quadratic=0 linear=0"]) + "\n")
    return path


def membrane_deck():
    """Cook's membrane, nearly incompressible: particles on a lattice of half a cell, loads that rise on the last
    column, damping to rest."""
    places = [((i + 0.5)/2, (j + 0.5)/2) for j in range(120) for i in range(96)]
    places = [(x, y) for x, y in places if 44/48*x <= y <= 44 + 16/48*x]
    edge = [n for n, (x, _) in enumerate(places, 1) if x > 47.5]
    share = 1/(len(edge) - 1)
    return f"""mpm3d Cook's membrane
nbco 1 nbbo 1 nmat 1 nbmp {len(places)}
grid -1 50 -1 62 -0.5 0.5
dcell 1
fixed 1 0 0 0 2 2
dtscale 0.9
endtime 30
musl on sgmp
QuLo 15
Damp 0.3
curv disy {len(places)}
material 1 neoh 1 70 0.499
particle point 1 {len(places)}
""" + "".join(f"{n} 1 {1440/len(places):.9g} {x} {y} 0\n" for n, (x, y) in enumerate(places, 1)) + "load\n" + "".join(
        f"part {n} 0 {share/2 if n in (edge[0], edge[-1]) else share:.9g} 0\n" for n in edge) + "endl\nendi\n"


DAM = """mpm3d a column of water, 1 m wide and 2 m high, breaks
nbco 1 nbbo 1 nbmp 3200 nmat 1
grid -0.125 4.25 -0.125 2.125 0 0.125
dcell 0.125
dtscale 0.8
endtime 0.68
musl on sgmp
bulk 1.5 1.0
curv disy 3161
curv disx 40
fixed 2 0 2 0 2 2
material 1 null 997.5 2.0e9 0.001
seos 1 4 1415
particle block 1
1 997.5 0.025 0 0 0.05 40 80 1
load
grav 1 0 -9.81 0
endl
endi
"""


def displacements(name, deck, expected):
    """How far particles have moved at the end, by number and axis, against MPM3D: within 2 %."""
    folder = fresh(name)
    os.makedirs(folder)
    with open(os.path.join(folder, name + ".mpm"), "w", encoding="utf-8") as file:
        file.write(deck)
    code, printed = sgmp(name + ".mpm", "--quiet", "--output", "out", folder=folder)
    expect(code == 0 and "warning" not in printed, f"{name}: {printed}")
    rows = [
        dict(zip(("step", "time", "gauge", "particle", "x", "y"), row))
        for row in csv.reader(read(folder, "out", "gauges.csv").splitlines()[1:])
    ]
    for gauge, axis, start, moved in expected:
        last = [float(row[axis]) for row in rows if row["gauge"] == str(gauge)][-1] - start
        print(f"{name}: {last}, MPM3D {moved}")
        expect(abs(last/moved - 1) < 0.02, f"{name}: {last}, MPM3D {moved}")


def ranks():
    """Two ranks: one writes and says so, both read; one rank alone, which may be quiet."""
    out = fresh("ranks")
    if shutil.which("mpirun"):
        done = subprocess.run(
            ["mpirun", "-np", "2", "--oversubscribe", EXECUTABLE, "explosive_row.mpm", "--check", "--output", out],
            cwd=DECKS, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120, check=False,
        )
        expect(
            done.returncode == 0 and done.stdout.decode().count("explosive_row.mpm is ") == 1,
            f"two ranks: {done.stdout.decode()}",
        )
    for words, times in (((), 1), (("--quiet",), 0)):
        code, printed = sgmp("explosive_row.mpm", "--check", "--output", out, *words)
        expect(code == 0 and printed.count("explosive_row.mpm is ") == times, f"one rank {words}: {printed}")


def main():
    counts = goldens(), broken()
    files()
    keep_3d()
    shared_field()
    total_lagrangian()
    hot_expansion()
    nothing_left()
    taylor()
    # A row of explosive in one dimension (its files cut steps short, others than in the native deck); the free beam in
    # two, m and s there, mm and ms in the native deck.
    against_native("explosive_row", [], without_viscosity(), ["ppc=1"], 0.005)
    against_native("free_beam", ["t_end=2e-6"], "beam.inp", ["t_end=2e-3"], 0.005)
    if FULL:
        displacements("membrane", membrane_deck(), [(1, "y", 59.75, 0.268)])
        displacements("dam", DAM, [(1, "y", 1.9875, -1.076), (2, "x", 0.9875, 3.13)])
    ranks()
    print(f"{counts[0]} decks, {counts[1]} broken decks, {len(FAILURES)} failures")
    if not FAILURES:
        tidy()
    return 1 if FAILURES else 0


sys.exit(main())
