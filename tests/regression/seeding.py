#!/usr/bin/env python3
"""Particles of bodies beside a second, plain implementation: every point of a lattice is asked for itself whether it is
inside.

The shapes' formulas are those of solid geometry, written down here once more: a cone frustum that widens, a tangent
ogive (an arc that leaves the base upright and ends in the tip), half-spaces, turned bodies, Gauss points of cells.

usage: seeding.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import itertools
import math
import os

from _runs import SCRATCH, Report, run

CELL = 1.0
FITTED = 4e-3 # how far the volume of particles that fit their shapes may be from that of these
DECK = """
dimension {dimension}
grid cell=1
method mpm
time dt=1e-12 steps=1
material m elastic density=2 young=1e-9 poisson=0
body b {card}
{more}
output csv fields=initial_position,volume,mass
"""


def unit(vector):
    """A vector of length 1."""
    length = math.sqrt(sum(v*v for v in vector))
    return [v/length for v in vector]


def along_and_beside(point, centre, axis):
    """Distance along an axis from its foot, and from the axis."""
    offset = [p - c for p, c in zip(point, centre)]
    along = sum(o*a for o, a in zip(offset, unit(axis)))
    return along, math.sqrt(max(0.0, sum(o*o for o in offset) - along**2))


def cone(centre, axis, radius, top, length):
    """Inside a frustum."""
    def inside(point):
        along, beside = along_and_beside(point, centre, axis)
        return 0 <= along < length and beside <= radius + (top - radius)*along/length
    return inside


def ogive(centre, axis, radius, length):
    """Inside a tangent ogive: a circle with its centre in the plane of the base, beyond the axis, through edge and
    tip."""
    beyond = (length**2 - radius**2)/(2*radius) # (radius + beyond)^2 = length^2 + beyond^2

    def inside(point):
        along, beside = along_and_beside(point, centre, axis)
        return 0 <= along < length and along**2 + (beside + beyond)**2 <= (radius + beyond)**2
    return inside


def ogive_volume(radius, length):
    """Of a tangent ogive."""
    arc = (radius**2 + length**2)/(2*radius)
    return math.pi*(length*arc**2 - length**3/3 - (arc - radius)*arc**2*math.asin(length/arc))


def shoelace(corners):
    """Area of a polygon."""
    return abs(sum(ax*by - bx*ay for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1])))/2


def below(side, normal, level):
    """Volume of a cube at the origin in which x.normal < level: with and without corners, by turns."""
    total = 0.0
    for corner in itertools.product((0, 1), repeat=3):
        over = level - side*sum(c*n for c, n in zip(corner, normal))
        total += (-1)**sum(corner)*max(0.0, over)**3
    return total/(6*math.prod(normal))


def halfspace(centre, axis):
    """Behind a plane."""
    return lambda point: sum((p - c)*a for p, c, a in zip(point, centre, axis)) < 0


def block(lower, upper):
    """In a box."""
    return lambda point: all(a <= p < b for p, a, b in zip(point, lower, upper))


def ring(centre, radius, inner):
    """Between two circles, in the plane."""
    return lambda point: inner <= math.hypot(point[0] - centre[0], point[1] - centre[1]) <= radius


def polygon(*corners):
    """Inside a polygon: its sides are seen under angles that add up to a whole turn."""
    def inside(point):
        turn = 0.0
        for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]):
            a, b = (ax - point[0], ay - point[1]), (bx - point[0], by - point[1])
            turn += math.atan2(a[0]*b[1] - a[1]*b[0], a[0]*b[0] + a[1]*b[1])
        return abs(turn) > math.pi
    return inside


def lattice(corner, spacing, low, high, dimension=3):
    """Centres of the cubes between two corners."""
    axes = []
    for axis in range(dimension):
        first = math.floor((low - corner[axis])/spacing) - 1
        last = math.ceil((high - corner[axis])/spacing) + 1
        axes.append([corner[axis] + (i + 0.5)*spacing for i in range(first, last + 1)])
    return itertools.product(*axes)


def turned(point, degrees, pivot):
    """A point turned about z."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    x, y = point[0] - pivot[0], point[1] - pivot[1]
    return (pivot[0] + c*x - s*y, pivot[1] + s*x + c*y, *point[2:])


def compare(report, name, card, expected, volume, dimension=3, more="", exact=None):
    """The same points, each with the volume of its cube (a number or a function of the point) and mass; by default the
    particles of a body have the volume of its shapes (`exact`)."""
    whole = "" if "layout=gauss" in card else " fit=cubes"
    result = run(name, DECK.format(dimension=dimension, card=card + whole, more=more))
    if not report.finished(result, name):
        return
    if exact is not None:
        fitted = run(f"{name}_fitted", DECK.format(dimension=dimension, card=card, more=more))
        if report.finished(fitted, f"{name}_fitted"):
            shares = [row["volume"] for row in fitted.table("particles_end.csv")]
            report.check(abs(sum(shares)/exact - 1) < FITTED, f"{name}: the volume of {sum(shares)}, expected {exact}")
    rows = result.table("particles_end.csv")
    axes = "xz" if dimension == "axisymmetric" else "xyz"[:dimension]
    found = sorted(tuple(round(row[f"{a}0"], 6) + 0.0 for a in axes) for row in rows)
    wanted = sorted(tuple(round(p, 6) + 0.0 for p in point) for point in expected)
    report.check(len(wanted) > 0 and found == wanted,
                 f"{name}: {len(found)} particles, expected {len(wanted)}; {sorted(set(found) ^ set(wanted))[:4]}")
    for row in rows:
        share = volume(tuple(row[f"{a}0"] for a in axes)) if callable(volume) else volume
        if not report.check(abs(row["volume"] - share) < 1e-9 and abs(row["mass"] - 2*share) < 1e-9,
                            f"{name}: volume {row['volume']}, mass {row['mass']}, expected {share}"):
            break


def solids(report):
    """Solids of revolution, some on axes that are neither a coordinate nor of length 1."""
    spacing, corner = 0.4, (0.1, -0.05, 0.15)
    origin = "lattice_origin=(0.1,-0.05,0.15) spacing=0.4"
    points = list(lattice(corner, spacing, -8, 8))
    for name, card, inside, exact in (
        (
            "widening", "cone material=m centre=(0,0,-1) radius=1 top=2.6 length=3",
            cone((0, 0, -1), (0, 0, 1), 1, 2.6, 3), math.pi*(1 + 2.6 + 2.6**2),
        ),
        (
            "pointed", "cone material=m centre=(0,1,0) axis=(0,2,0) radius=2 length=3",
            cone((0, 1, 0), (0, 1, 0), 2, 0, 3), 4*math.pi,
        ),
        (
            "oblique", "cone material=m centre=(1,0,0) axis=(3,-4,12) radius=0.5 top=2 length=4",
            cone((1, 0, 0), (3, -4, 12), 0.5, 2, 4), 7*math.pi,
        ),
        (
            "slender", "ogive material=m centre=(0,0,0) radius=1.5 length=5",
            ogive((0, 0, 0), (0, 0, 1), 1.5, 5), ogive_volume(1.5, 5),
        ),
        (
            "down", "ogive material=m centre=(0,0.3,1) axis=(0,0,-2) radius=2 length=3",
            ogive((0, 0.3, 1), (0, 0, -1), 2, 3), ogive_volume(2, 3),
        ),
    ):
        compare(report, name, f"{card} {origin}", [point for point in points if inside(point)], spacing**3, exact=exact)


def cuts(report):
    """A block behind a plane, without a wedge; a plane's normal need not have length 1."""
    spacing, corner = 0.5, (0, 0, 0)
    body = block((0, 0, 0), (4, 4, 4))
    plane, wedge = halfspace((2.1, 2.1, 2.1), (1, 2, 3)), halfspace((1, 0, 0), (5, 0, -1))
    points = [point for point in lattice(corner, spacing, 0, 4) if body(point)]
    card = "block material=m lower=(0,0,0) upper=(4,4,4) spacing=0.5"
    compare(report, "behind", card, [p for p in points if plane(p)], spacing**3,
            more="intersect b halfspace centre=(2.1,2.1,2.1) axis=(1,2,3)", exact=below(4, (1, 2, 3), 12.6))
    compare(
        report,
        "beyond",
        card,
        [p for p in points if plane(p) and not wedge(p)],
        spacing**3,
        more="intersect b halfspace centre=(2.1,2.1,2.1) axis=(10,20,30)\nsubtract b halfspace centre=(1,0,0) "
        "axis=(5,0,-1)",
    )
    ball = [p for p in points if sum((c - 2.2)**2 for c in p) <= 1.1**2]
    compare(report, "ball", card, ball, spacing**3, more="intersect b sphere centre=(2.2,2.2,2.2) radius=1.1",
            exact=4/3*math.pi*1.1**3)


def polygons(report):
    """A bent one in the plane, either way round; one with a notch cut out of it, of which rings are made."""
    spacing, corner = 0.25, (0.1, -0.05)
    hook = ((0.0, 0.0), (3.03, 0.4), (3.0, 3.0), (2.2, 1.1), (0.4, 3.5))
    points = [point for point in lattice(corner, spacing, -1, 5, 2) if polygon(*hook)(point)]
    for name, way in (("hook", hook), ("hook_back", hook[::-1])):
        compare(
            report,
            name,
            f"polygon material=m corners={','.join(f'({x},{y})' for x, y in way)} spacing=0.25 "
            f"lattice_origin=(0.1,-0.05)",
            points,
            spacing**2,
            2,
            exact=shoelace(hook),
        )
    # Points on the sides: those of the lower ones belong to it, whatever their last bits.
    compare(
        report, "tile",
        "polygon material=m corners=(0,0),(2.1,0),(2.1,0.7),(0,0.7) spacing=0.1 lattice_origin=(-0.05,-0.05)",
        [(0.1 * i, 0.1 * j) for i in range(21) for j in range(7)], 0.01, 2,
        exact=1.47,
    )
    outer, notch = ((0.0, -1.0), (2.0, 0.3), (1.4, 4.1), (0.0, 3.0)), ((0.9, 0.0), (3.0, 1.3), (3.0, 2.5))
    points = [
        p for p in lattice((0.0, -1.0), spacing, -1, 5, 2) if p[0] > 0 and polygon(*outer)(p) and not polygon(*notch)(p)
    ]
    compare(
        report, "spindle", "polygon material=m corners=(0,-1),(2,0.3),(1.4,4.1),(0,3) spacing=0.25", points,
        lambda p: 2 * math.pi * p[0] * spacing**2, "axisymmetric", "subtract b polygon corners=(0.9,0),(3,1.3),(3,2.5)",
    )


def turns(report):
    """A turned lattice; Gauss points of cells in a turned box, whose box is wider than the box."""
    degrees, pivot, spacing = 35.0, (1, 2), 0.3
    body = block((0, 0), (3, 1.2))
    corner = (0.1, 0.05)
    inside = [turned(p, degrees, pivot) for p in lattice(corner, spacing, -1, 4, 2) if body(p)]
    compare(
        report, "turned",
        "block material=m lower=(0,0) upper=(3,1.2) spacing=0.3 lattice_origin=(0.1,0.05) rotation=35 pivot=(1,2)",
        inside, spacing**2, 2, exact=3.6,
    )
    places, weights = (0.5 - math.sqrt(0.15), 0.5, 0.5 + math.sqrt(0.15)), (5/18, 8/18, 5/18)
    # Along its diagonal, the box is turned to stand almost upright; a box around that diagonal would be far too narrow.
    body = block((0, 0), (8, 6))
    points = {}
    for cell in itertools.product(range(-12, 13), repeat=2):
        for (x, wx), (y, wy) in itertools.product(zip(places, weights), repeat=2):
            points[cell[0] + x, cell[1] + y] = wx*wy
    inside = {p: w for p, w in points.items() if body(turned(p, -degrees, pivot))}
    rounded = {tuple(round(c, 6) for c in p): w for p, w in inside.items()}
    compare(
        report, "gauss", "block material=m lower=(0,0) upper=(8,6) layout=gauss ppc=3 rotation=35 pivot=(1,2)",
        list(inside), lambda p: rounded.get(tuple(round(c, 6) for c in p), -1), 2,
    )
    inside = [p for p in lattice((0.2, 0.3), 0.25, -5, 5, 2) if ring((0.3, -0.2), 3, 1.7)(p)]
    compare(
        report, "ring", "ring material=m centre=(0.3,-0.2) radius=3 inner=1.7 spacing=0.25 lattice_origin=(0.2,0.3)",
        inside, 0.0625, 2, exact=math.pi*(3**2 - 1.7**2),
    )


def spun(point, degrees, axis, pivot):
    """A point turned about any axis, by the quaternion of the rotation."""
    s = math.sin(math.radians(degrees/2))
    w, (x, y, z) = math.cos(math.radians(degrees/2)), [s*a for a in unit(axis)]
    a, b, c = (p - q for p, q in zip(point, pivot))
    i, j, k = w*a + y*c - z*b, w*b + z*a - x*c, w*c + x*b - y*a
    r = -x*a - y*b - z*c
    return (pivot[0] + w*i - r*x - j*z + k*y, pivot[1] + w*j - r*y - k*x + i*z, pivot[2] + w*k - r*z - i*y + j*x)


def revolutions(report):
    """A polygon turned about an oblique axis, with a hollow; a prism out of which a turned one is cut."""
    spacing, corner = 0.4, (0.1, -0.05, 0.15)
    origin = "lattice_origin=(0.1,-0.05,0.15) spacing=0.4"
    points = list(lattice(corner, spacing, -8, 8))
    section, centre, axis = ((0.5, -1.0), (2.5, -1.2), (3.0, 1.1), (1.2, 0.4), (1.0, 3.0)), (1, 0, 0.5), (2, -1, 2)

    def revolved(point):
        along, beside = along_and_beside(point, centre, axis)
        return polygon(*section)((beside, along))

    compare(
        report,
        "revolved",
        f"revolved material=m corners={','.join(f'({r},{z})' for r, z in section)} centre=(1,0,0.5) axis=(2,-1,2) "
        f"{origin}",
        [p for p in points if revolved(p)],
        spacing**3,
    )

    def prism(point):
        return polygon((-3, -3), (4, -2), (0, 4.1))(point[:2]) and -2 <= point[2] < 3

    def bar(point):
        return block((-1, -5, -1), (1, 5, 1))(spun(point, -40, (1, 2, 3), (1, 0, 1)))
    compare(report, "prism", f"polygon material=m corners=(-4,-4),(3,-3),(-1,3.1) centre=(1,1,-2) length=5 {origin}",
            [p for p in points if prism(p) and not bar(p)], spacing**3,
            more="subtract b block lower=(-1,-5,-1) upper=(1,5,1) rotation=40 rotation_axis=(1,2,3) pivot=(1,0,1)")
    body = [p for p in points if block((-2, -1, 0), (3, 1, 2))(p)]
    compare(
        report, "leaning",
        f"block material=m lower=(-2,-1,0) upper=(3,1,2) rotation=-25 rotation_axis=(0,1,1) pivot=(1,2,3) {origin}",
        [spun(p, -25, (0, 1, 1), (1, 2, 3)) for p in body], spacing**3, exact=20,
    )


def rows(report):
    """Spheres in a row, some of them united; holes in a row, each turned."""
    spacing, corner = 0.4, (0.1, -0.05, 0.15)
    origin = "lattice_origin=(0.1,-0.05,0.15) spacing=0.4"
    points = list(lattice(corner, spacing, -8, 8))
    places = [(-4 + 1.9*i, 0.3*i, -0.7*i) for i in range(5)]
    compare(report, "spheres", f"sphere material=m centre=(-4,0,0) radius=1.1 copies=5 offset=(1.9,0.3,-0.7) {origin}",
            [p for p in points if any(math.dist(p, c) <= 1.1 for c in places)], spacing**3)

    def hole(point):
        return any(
            block((-4.5 + 3 * i, -9, -1), (-3.5 + 3 * i, 9, 1))(spun(point, -30, (0, 0, 1), (-4 + 3 * i, 0, 0)))
            for i in range(3)
        )

    compare(
        report, "holes", f"block material=m lower=(-6,-2,-2) upper=(6,2,2) {origin}",
        [p for p in points if block((-6, -2, -2), (6, 2, 2))(p) and not hole(p)], spacing**3,
        more="subtract b block lower=(-4.5,-9,-1) upper=(-3.5,9,1) rotation=30 pivot=(-4,0,0) copies=3 offset=(3,0,0)",
        exact=192 - 3*4*2/math.cos(math.radians(30)),
    )


def fitted(report):
    """A body has the volume of its shapes however these lie on its lattice: in a line, rings about the axis, on unequal
    cells, joined of pieces that share a side or lie over each other, thinner than a cube; the place of its middle is
    right, too. On a lattice that fits nothing changes, to the last bit; fit=cubes leaves whole cubes."""
    ball, torus = 4/3*math.pi*1.3**3, 2*math.pi**2*3*1.1**2
    for name, dimension, cards, exact, middle in (
        ("line", 1, "body b block material=m lower=0.13 upper=3.44 spacing=0.4 lattice_origin=0", 3.31, 1.785),
        ("about", "axisymmetric", "body b sphere material=m centre=(0,0.1) radius=1.3 spacing=0.4", ball, 0.1),
        ("torus", "axisymmetric", "body b sphere material=m centre=(3,-1) radius=1.1 spacing=0.4", torus, -1),
        ("unequal", 2, "body b cylinder material=m centre=(5.1,4.2) radius=3.1", math.pi*3.1**2, 5.1),
        ("joined", 2, "body b block material=m lower=(0,0) upper=(1.13,2) spacing=0.4\n"
         "add b block lower=(1.13,0) upper=(3,2)", 6, 1.5),
        ("over", 2, "body b block material=m lower=(0,0) upper=(2.13,1.9) spacing=0.4\n"
         "add b block lower=(1,0) upper=(3,1.9)", 5.7, 1.5),
        ("thin", 2, "body b block material=m lower=(0,0) upper=(3,0.22) spacing=0.4", 0.66, 1.5),
        ("placed", 2, "body b block material=m lower=(0,0) upper=(3,2) spacing=0.25 copies=2 offset=(3.1,0)", 12, 3.05),
    ):
        deck = DECK.replace("body b {card}\n{more}", cards).format(dimension=dimension)
        if name == "unequal":
            deck = deck.replace("method mpm\n", "").replace(
                "cell=1", "cell=0.5 x=0:20 y=0:20 fine_x=(2,6) fine_y=(2,6)")
        result = run(f"fit_{name}", deck)
        if not report.finished(result, f"fit_{name}"):
            continue
        rows = result.table("particles_end.csv")
        volume = sum(row["volume"] for row in rows)
        along = "z0" if dimension == "axisymmetric" else "x0"
        place = sum(row["volume"]*row[along] for row in rows)/volume
        report.check(abs(volume/exact - 1) < 2e-3, f"fit_{name}: volume {volume}, expected {exact}")
        report.check(abs(place - middle) < 2e-3, f"fit_{name}: middle at {place}, expected {middle}")
        report.check(all(row["mass"] == 2*row["volume"] for row in rows), f"fit_{name}: masses")
        if name == "about":
            way = sum(row["volume"]*row["x0"] for row in rows)/volume
            report.check(abs(way/(3*math.pi/16*1.3) - 1) < 0.04, f"fit_about: {way} from the axis in the mean")
    # So small that no part of its cube is seen: a whole cube, and a warning.
    speck = "sphere material=m centre=(0.25,0.25,0.25) radius=0.03 spacing=0.5 lattice_origin=(0,0,0)"
    result = run("speck", DECK.format(dimension=3, card=speck, more=""))
    if report.finished(result, "speck"):
        rows = result.table("particles_end.csv")
        report.check([row["volume"] for row in rows] == [0.125] and "have a mass of" in result.text,
                     f"speck: {rows}\n{result.text}")
    whole = DECK.format(dimension=2, card="block material=m lower=(0,0) upper=(3,2) ppc=3", more="")
    ends = [run(f"whole_{words}", whole.replace("ppc=3", f"ppc=3 fit={words}")).table("particles_end.csv")
            for words in ("shape", "cubes")]
    report.check(ends[0] == ends[1], "a block that fits its lattice has other particles with fit=cubes")


def files(report):
    """A file's volume of zero is refused at its line."""
    path = os.path.join(SCRATCH, "volumes.txt")
    with open(path, "w", encoding="utf-8") as file:
        file.write("0.5 0.5 0.5 0.125\n1.5 0.5 0.5 0\n")
    result = run("volumes", DECK.format(dimension=3, card=f"file material=m file={path}", more=""))
    report.check(
        result.code == 3 and "volumes.txt:2" in result.text, f"zero volume: exit code {result.code}\n{result.text}"
    )


def main():
    """All of it."""
    report = Report()
    for part in (solids, cuts, polygons, turns, revolutions, rows, fitted, files):
        part(report)
    report.end()


main()
