#!/usr/bin/env python3
"""Walls that nothing touches at the start, and floors (doc/loads.md, Bodies near walls): they let go what meets them,
those that move are put a cell farther out; what touches another, flows or is fast has its wall where the deck says.

usage: walls_apart.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math

from _runs import Report, run

# An elastic bar without Poisson's ratio: it rests for an instant when the wave has come back to its middle.
BAR = """
parameter n = 16
parameter v = 0.003
parameter gap = 0.4
parameter d = 1               ! -1: towards the wall on the other side
dimension {space}
grid cell=1/n {grid}
wall {walls} shift=$shift
method $method
time end=2+2*gap/v cfl=0.4
material m elastic density=1 young=1 poisson=0
body a block material=m {block} ppc=2
velocity a {along}=-d*v
history steps=1
"""
SHIFT = "parameter shift = auto\nparameter method = sgmp\n"
SPACES = {
    1: ("x=0:3", "x-=slip x+=fixed", "lower=d>0?gap:3-gap-1 upper=d>0?gap+1:3-gap", "x"),
    2: ("x=0:3 y=0:3/n", "x-=slip x+=fixed y-=slip y+=slip",
        "lower=(d>0?gap:3-gap-1,0) upper=(d>0?gap+1:3-gap,3/n)", "x"),
    3: ("x=0:1/n y=0:1/n z=0:3", "x-=slip x+=slip y-=slip y+=slip z-=slip z+=slip",
        "lower=(0,0,d>0?gap:3-gap-1) upper=(1/n,1/n,d>0?gap+1:3-gap)", "z"),
    "axisymmetric": ("r=0:3/n z=0:3", "r+=slip z-=slip z+=slip",
                     "lower=(0,d>0?gap:3-gap-1) upper=(3/n,d>0?gap+1:3-gap)", "z"),
}
FLOOR = """
dimension 2
grid cell=1 y=0:open
wall y-={kind}
method sgmp
time end=240 cfl=0.4
material m elastic density=1 young=1 poisson=0
{more}
body a block material={matter} lower=(2,6) upper=(10,10) ppc=2
velocity a y={speed}
history steps=20
"""
CORNER = """
dimension {space}
grid cell=1 x=0:open y=0:open
wall x-=slip y-=slip reactions=yes
method sgmp
time end=130 cfl=0.4
material m elastic density=1 young=1 poisson=0.3
body a block material=m lower={low} upper={high} rotation=10 ppc=2
body b block material=m lower=(9{up}9) upper=(12{top}12) ppc=2
contact all
velocity a x=-0.04 y=-0.03
velocity b x=-0.04 y=-0.03
history steps=20
"""
SWIRLS = """
dimension axisymmetric{swirl}
grid cell=1/8 r=0:open z=0:open
wall z-=fixed
method sgmp
time end=1 cfl=0.4
material m elastic density=1 young=1 poisson=0.3
body a cylinder material=m centre=(0,0.5) radius=1 length=1 ppc=2
velocity a z=-0.01
"""
GRAZES = """
dimension {space}
grid cell={cell} y=0:open
wall y-=slip reactions=yes
wallfriction y- friction=0.1
method sgmp
time end={end} cfl=0.4
material m elastic density=1 young=1 poisson=0.3
body a {shape} material=m ppc=2
velocity a {v}
history steps=5
"""
PRESSED = """
parameter cell = 0.1
dimension 2
grid cell=cell y=0:open
wall y-=slip
method sgmp
time end=150 cfl=0.4
damping rate=0.05
material m elastic density=1 young=1 poisson=0
body m block material=m lower=(0,0.05) upper=(1,2.05) ppc=2
motion m where="y>1.85" x=0 y="-0.25/100*(t<100)"
history steps=50
output csv at=end fields=stress
"""
DISK = """
parameter place = 0
dimension 2
grid cell=1/16 y=open:place
wall y+=slip
method sgmp
time end=14 cfl=0.5
material m elastic density=1 young=1 poisson=0
body m sphere centre=(0.02,place-0.55) radius=0.5 material=m ppc=3
velocity m y=0.03
history steps=20
"""
RESTS = """
parameter along = 0
dimension 2
grid cell=0.1 y=0:open
wall y-=slip
method sgmp
damping rate=0.3
time end=120 cfl=0.4
gravity (along,-0.001)
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=(0,0.2) upper=(1,1.2) ppc=2
history steps=50
output csv at=end fields=stress,initial_position
"""
# A block stands on a rough floor and is pushed over; one that vibrates on a smooth one; ground that begins with its
# weight. The floor may be on any side, and rows of particles may begin anywhere from it.
TIPS = """
parameter n = 10
dimension {space}
grid cell=1/n {grid}
wall {walls}
wallfriction {face} friction=1
method sgmp
time end=2.2 cfl=0.4
{acts}
material m elastic density=1 young={young} poisson=0.2
body m block material=m {block} ppc=2
history steps=50
output csv at=end fields=initial_position
"""
STANDS = """
parameter update = musl
parameter n = 8
parameter g = 1e-4
dimension 2
grid cell=1/n {grid}
wall {walls}
method sgmp update=$update
time end={end} cfl=0.4
gravity {gravity}
material m elastic density=1 young=1 poisson=0
body m block material=m lower=(0,0) upper=(4/n,1) ppc=2
history steps=20
output csv at=end fields=displacement,initial_position
"""
REST = """
dimension 2
grid cell=1/8 x=open:open y=0:open
wall y-=slip
wallfriction y- friction=0.5
method sgmp
time end=2 cfl=0.5
material m elastic density=1 young=500 poisson=0.3
body m block material=m lower=(0,0) upper=(1,1) ppc=2
gravity (0,-1)
initial_stress m surface=1 k0=0
history every=0.02
"""
WATER = "material w fluid density=1\neos w gruneisen c0=1 s=2 gamma0=0.1"
SOIL = "material s drucker_prager density=1 young=1 poisson=0.3 friction=30 cohesion=0\n"
report = Report()


def early(result, settings, along):
    """Cells by which a bar turns too early, and the velocity with which it comes back over the first."""
    rows = [row for row in result.table("bodies.csv") if row["name"] == "a"]
    up = settings.get("d", 1)
    turned = next(row["time"] for row in rows if up*row[f"velocity_{along}"] >= 0)
    return 16*0.003*(0.4/0.003 + 1 - turned), up*rows[-1][f"velocity_{along}"]/0.003


def bars():
    """Within a third of a cell by all methods, in all spaces, at both ends, and they come back; without the shift three
    quarters early."""
    for space, (grid, walls, block, along) in SPACES.items():
        deck = SHIFT + BAR.format(space=space, grid=grid, walls=walls, block=block, along=along)
        for settings in ({}, {"d": -1}, {"shift": "none"}) if space != 3 else ({"d": -1},):
            for method in ("sgmp", "gimp", "mpm", "bspline") if space == 1 else ("sgmp",):
                name = f"bar_{space}_{method}_" + "_".join(f"{key}{value}" for key, value in settings.items())
                result = run(name, deck, method=method, **settings)
                if report.finished(result, name):
                    cells, back = early(result, settings, along)
                    right = 0.6 < cells < 1.2 if "shift" in settings else abs(cells) < 0.33
                    report.check(right, f"{name}: turns {cells:.2f} cells early")
                    report.check(0.93 < back < 1.01, f"{name}: comes back with {back:.3f} of its velocity")
                    books = [row["total_energy"] - row["external_work"] for row in result.table("history.csv")]
                    drift = max(abs(energy/books[0] - 1) for energy in books)
                    report.check(drift < 0.03, f"{name}: energy drifts by {drift}")


def pressed():
    """A strip that its moved end presses on a wall: the wall gives by half a cell of the strip."""
    for cell in (0.2, 0.1):
        result = run(f"pressed_{cell}", PRESSED, cell=cell)
        if report.finished(result, f"pressed_{cell}"):
            rows = [row["stress_yy"] for row in result.table("particles_end.csv") if 0.3 < row["y"] < 1.2]
            stress, exact, gives = -sum(rows)/len(rows), -math.log(1 - 0.2/1.8), 0.5*cell/1.8
            report.check(abs(stress/exact - 1 + gives) < 0.02, f"pressed, {cell}: stress {stress}, exact {exact}")


def between():
    """A disk comes back as well from a wall that lies anywhere between lines of nodes (finite elements: 0.974)."""
    for place in (0, 0.02, 0.04):
        result = run(f"disk_{place}", DISK, place=place)
        if report.finished(result, f"disk_{place}"):
            back = -result.table("bodies.csv")[-1]["velocity_y"]/0.03
            report.check(abs(back - 0.974) < 0.03, f"disk, wall at {place}: comes back with {back:.3f}")


def rests():
    """A block that falls on a wall and comes to rest there: its stress is its weight, row by row, and it lies on it."""
    lowest_rows = []
    for name, along in (("rests", 0), ("goes_along", 0.15)):  # with half of the speed of sound at last
        result = run(name, RESTS, along=along)
        if not report.finished(result, name):
            continue
        rows = {}
        for row in result.table("particles_end.csv"):
            rows.setdefault(round(row["y0"], 3), []).append((row["y"], row["stress_yy"]/1e-3))
        for found in rows.values():
            y, mean = (sum(row[k] for row in found)/len(found) for k in (0, 1))
            report.check(abs(mean + 1 - y) < 0.09, f"{name}: stress {mean:.3f} at {y:.3f}, weight {1 - y:.3f}")
        lowest_rows.append(sum(stress for _, stress in rows[min(rows)])/len(rows[min(rows)]))
        lowest = min(rows[min(rows)])[0]
        report.check(abs(lowest - 0.025) < 0.002, f"{name}: lowest particles at {lowest}")
    report.check(abs(lowest_rows[0] - lowest_rows[-1]) < 0.003, f"a block that moves along a wall: {lowest_rows}")


def reactions():
    """The impulse of walls that let go is what the momentum of the bodies gains, to round-off: a bar at an angle to
    both, in the plane, in space, with two bodies of a field each."""
    for name, deck in (
        ("plane", CORNER.format(space=2, up=",", top=",", low="(2,3)", high="(6,6)")),
        ("space", CORNER.format(space=3, up=",9,", top=",12,", low="(2,3,2)", high="(6,6,6)")
                        .replace("y-=slip", "y-=slip z-=slip").replace("y=0:open", "y=0:open z=0:open")
                        .replace("y=-0.03", "y=-0.03 z=-0.02")),
    ):
        result = run(f"weighed_{name}", deck)
        if not report.finished(result, name):
            continue
        report.check(result["walls_let_go"] == (2 if name == "plane" else 3), f"{name}: {result['walls_let_go']}")
        rows = result.table("bodies.csv")
        for axis in "xy" if name == "plane" else "xyz":
            first, last = ([row for row in rows if row["time"] == time] for time in (0, rows[-1]["time"]))
            gained = sum(row["mass"]*row[f"velocity_{axis}"] for row in last) - \
                sum(row["mass"]*row[f"velocity_{axis}"] for row in first)
            pushed = result.table("history.csv")[-1][f"wall_{axis}-_impulse_{axis}"]
            report.check(gained > 0.2 and abs(pushed/gained - 1) < 1e-9, f"{name}, {axis}: {gained}, wall {pushed}")


def rubs():
    """Bodies that graze a rough wall lose mu times what they gain across it, to round-off, while all slides; a block
    slides as far as its velocity takes it; on a slope it stays; on a fixed wall nothing moves along it."""
    for name, shape, space, more in (
        ("disk", "sphere centre=(0.03,0.65) radius=0.5", 2, ""),
        ("block", "block lower=(0,0.15) upper=(1,1.15)", 2, ""),
        ("space", "block lower=(0,0.15,0) upper=(1,1.15,1)", 3, " z=0.02"),
    ):
        v, cell = f"x=0.05 y=-0.02{more}", 0.1 if space == 2 else 0.2
        result = run(f"grazes_{name}", GRAZES.format(space=space, shape=shape, v=v, cell=cell, end=20))
        if not report.finished(result, f"grazes_{name}"):
            continue
        first, last = result.table("bodies.csv")[0], result.table("bodies.csv")[-1]
        gained = last["velocity_y"] - first["velocity_y"]
        lost = math.hypot(first["velocity_x"], first["velocity_z"]) - math.hypot(last["velocity_x"], last["velocity_z"])
        report.check(gained > 0.036 and abs(lost/(0.1*gained) - 1) < (1e-9 if space == 2 else 3e-3),
                     f"grazes_{name}: loses {lost}, gains {gained}")
        report.check(abs(result["energy"]["drift"]) < 0.02, f"grazes_{name}: drift {result['energy']['drift']}")
        if name == "block":  # a cell aside other particles change bins
            aside = run("grazes_aside", GRAZES.format(space=2, shape="block lower=(0.1,0.15) upper=(1.1,1.15)", v=v,
                                                      cell=cell, end=20))
            there = aside.table("bodies.csv")[-1] if aside.summary else last
            for key in ("velocity_x", "velocity_y"):
                report.check(aside.summary and abs(there[key]/last[key] - 1) < 1e-10,
                             f"grazes_aside: {key} {there[key]}, not {last[key]}")
        pushed = result.table("history.csv")[-1]["wall_y-_impulse_x"]/first["mass"]
        report.check(abs(pushed/(last["velocity_x"] - first["velocity_x"]) - 1) < 1e-9, f"grazes_{name}: wall {pushed}")
    slides = GRAZES.format(space=2, shape="block lower=(0,0.0022) upper=(2,0.5022)", v="x=0.02", cell=0.1, end=120)
    for name, deck, way, allowed in (
        ("slides", slides.replace("friction=0.1", "friction=0.3") + "gravity (0,-1e-3)\n", 0.02**2/0.6e-3, 0.03),
        ("slope", slides.replace("friction=0.1", "friction=0.5").replace("velocity a x=0.02", "") +
         "gravity (2e-4,-1e-3)\ndamping rate=0.2\n", 0, 0.006),
        ("fixed", slides.replace("wallfriction y- friction=0.1", "").replace("y-=slip", "y-=fixed")
         .replace("velocity a x=0.02", "") + "gravity (5e-4,-1e-3)\ndamping rate=0.2\n", 0, 0.006),
    ):
        result = run(name, deck)
        if report.finished(result, name):
            gone = result.table("bodies.csv")[-1]["x"] - result.table("bodies.csv")[0]["x"]
            report.check(abs(gone - way) < allowed, f"{name}: goes {gone}, not {way}")
            report.check(result["walls_let_go"] == 1, f"{name}: {result['walls_let_go']} walls let go")


def loaded():
    """A block under a pressure that comes to rest on a rough wall bears that pressure: columns of loads and of the ways
    along walls do not get into each other's way."""
    deck = RESTS.replace("gravity (along,-0.001)", "pressure m face=y+ p=0.001").replace("parameter along = 0\n", "")
    result = run("loaded", deck.replace("wall y-=slip", "wall y-=slip\nwallfriction y- friction=0.3"))
    if report.finished(result, "loaded"):
        rows = [row["stress_yy"] for row in result.table("particles_end.csv")]
        borne = -sum(rows)/len(rows)
        report.check(abs(borne/1e-3 - 1) < 0.02, f"loaded: stress {borne}, pressure 0.001")


def tipped(push, pulse, end):
    """Angle of a rigid block of 1 by 2 that is pushed at the middle of its side and turns about an edge."""
    angle = rate = time = 0.0
    while time < end:
        moment = 2*push*math.sin(math.pi*time/pulse)**2 if time < pulse else 0.0
        moment -= math.sqrt(5)*math.cos(math.atan(2) + angle)
        rate = max(rate + 1e-4*moment/(10/3), 0.0) if angle <= 0 else rate + 1e-4*moment/(10/3)
        angle += 1e-4*rate
        time += 1e-4
    return angle


def tips():
    """A block that stands on a rough floor topples as a rigid one; held by a plane of symmetry it would not. The
    particle at its edge bears it at its middle, a quarter of a cell inside: a block of n cells has 1/(2 n) less that
    rights it."""
    exact = tipped(6, 0.4, 2.2)
    push, lies = 'pressure m face={} p="6*sin(pi*t/0.4)^2*(t<0.4)"\n', "gravity {}"
    for name, space, grid, face, corners, gravity, pushed, more in (  # the last is softer: half the steps
        ("below", 2, "y=0:open", "y-", "lower=(0,0) upper=(1,2)", "(0,-1)", "x-", ""),
        ("above", 2, "y=open:0.03", "y+", "lower=(0,-1.97) upper=(1,0.03)", "(0,1)", "x+", ""),
        ("beside", 2, "x=0:open", "x-", "lower=(0,0) upper=(2,1)", "(-1,0)", "y+", ""),
        ("space", 3, "y=0:0.1 z=0:open", "z-", "lower=(0,0,0) upper=(1,0.1,2)", "(0,0,-1)", "x-", " y-=slip y+=slip"),
    ):
        young, most = ("5e3", 1.25) if space == 3 else ("2e4", 1.13)
        deck = TIPS.format(space=space, young=young, grid=grid, face=face, walls=f"{face}=slip{more}", block=corners,
                           acts=push.format(pushed) + lies.format(gravity))
        result = run(f"tips_{name}", deck)
        if not report.finished(result, f"tips_{name}"):
            continue
        rows, axes = result.table("particles_end.csv"), "xz" if space == 3 else "xy"
        mean = {key: sum(row[key] for row in rows)/len(rows) for key in (*axes, *(f"{axis}0" for axis in axes))}
        sine = cosine = 0.0
        for row in rows:
            a, b, a0, b0 = (row[key] - mean[key] for key in (*axes, *(f"{axis}0" for axis in axes)))
            sine, cosine = sine + a0*b - b0*a, cosine + a0*a + b0*b
        angle = abs(math.atan2(sine, cosine))
        report.check(0.95 < angle/exact < most, f"tips_{name}: by {angle}, a rigid block by {exact}")
        report.check(result["verdict"] == "coarse" and "turns over" in result.text, f"tips_{name}: {result.text}")
        report.check(abs(result["energy"]["drift"]) < 0.01, f"tips_{name}: drift {result['energy']['drift']}")
        report.check(result["walls_let_go"] == 1, f"tips_{name}: {result['walls_let_go']} walls let go")


def stands():
    """A bar on which gravity begins to act at once, on a smooth floor: its top is twice as deep as at rest after half a
    period, wherever the rows of particles begin; it keeps its energy for thirty periods."""
    for name, grid, walls, gravity in (
        ("below", "x=0:4/n y=0:open", "x-=slip x+=slip y-=slip", "(0,-g)"),
        ("above", "x=0:4/n y=open:1", "x-=slip x+=slip y+=slip", "(0,g)"),
    ):
        for n in (8, 7.3, 7.7):
            result = run(f"stands_{name}_{n}", STANDS.format(grid=grid, walls=walls, gravity=gravity, end=2), n=n)
            if report.finished(result, f"stands_{name}_{n}"):
                rows = [(row["y0"] if name == "below" else 1 - row["y0"], abs(row["displacement_y"]))
                        for row in result.table("particles_end.csv")]
                top = max(rows)
                report.check(abs(top[1]/1e-4/(1 - (1 - top[0])**2) - 1) < 0.1, f"stands_{name}_{n}: {top}")
    for update in ("musl", "usavg"):
        deck = STANDS.format(grid="x=0:4/n y=0:open", walls="x-=slip x+=slip y-=slip", gravity="(0,-g)", end=120)
        result = run(f"stays_{update}", deck, g=0.01, update=update)
        if report.finished(result, update):
            report.check(result["walls_let_go"] == 1, f"stays_{update}: {result['walls_let_go']} walls let go")
            report.check(abs(result["energy"]["drift"]) < 0.02, f"stays_{update}: drift {result['energy']['drift']}")
    result = run("ground", REST)
    if report.finished(result, "ground"):
        fastest = max(row["kinetic_energy"] for row in result.table("history.csv"))
        report.check(result["walls_let_go"] == 1 and math.sqrt(2*fastest) < 5e-3, f"ground: moves {fastest}")


def left_alone():
    """Walls that something touches, liquids, what is fast, other words: as with shift=none. A wall that moves is put
    outwards in the place of letting go."""
    seat = "body b block material=m lower=(2,0) upper=(10,4) ppc=2"
    goes, moves = "wall y- lets go", "wall y- is a cell outside of 0"
    stands_on = "wall y- is a floor and lets go"
    moving = "wallmotion y- x=min(t/100,1)*0.01"
    for name, more, matter, speed, kind, words in (
        ("flies", "", "m", -0.03, "slip", goes), ("touched", seat, "m", -0.03, "slip", None),
        ("liquid", WATER, "w", -0.01, "slip", None), ("fast", "", "m", -0.12, "slip", None),
        ("beside", seat.replace("(2,0)", "(2,0.1)"), "m", -0.03, "slip", goes),
        ("close", seat.replace("(2,0)", "(2,0.01)"), "m", -0.03, "slip", None),
        ("round", "body b sphere material=m centre=(6,2) radius=2 ppc=3", "m", -0.03, "slip", goes),
        ("cut", "body b sphere material=m centre=(6,1.8) radius=2 ppc=3\nintersect b halfspace axis=(0,-1)", "m", -0.03,
         "slip", None),
        ("fixed", "", "m", -0.03, "fixed", goes), ("rubs", "wallfriction y- friction=0.2", "m", -0.03, "slip", goes),
        ("floor", seat + "\ngravity (0,-1e-4)", "m", -0.03, "slip", stands_on),
        ("ceiling", seat + "\ngravity (0,1e-4)", "m", -0.03, "slip", None),
        ("rough", seat + "\nwallfriction y- friction=0.2", "m", -0.03, "slip", stands_on),
        ("soil", SOIL + seat.replace("=m", "=s") + "\ngravity (0,-1e-4)", "m", -0.03, "slip", None),
        ("fixed_close", seat, "m", -0.03, "fixed", None), ("moves", moving, "m", -0.03, "fixed", moves),
        ("moves_close", moving + "\n" + seat.replace("(2,0)", "(2,0.2)"), "m", -0.03, "fixed", None),
    ):
        deck = FLOOR.format(more=more, matter=matter, speed=speed, kind=kind)
        text = run(f"check_{name}", deck, options=("--check",)).text
        for sentence in (goes, stands_on, moves):
            report.check((sentence in text) == (words == sentence), f"{name}: {text}")
        result = run(name, deck)
        plain = run(f"{name}_plain", deck.replace(f"y-={kind}", f"y-={kind} shift=none"))
        if report.finished(result, name) and report.finished(plain, name):
            same = plain["checksum"] == result["checksum"]
            report.check(same != bool(words), f"{name}: as a plane of symmetry or not")
            told = result["walls_let_go"], result["walls_shifted"], plain["walls_let_go"], plain["walls_shifted"]
            right = words in (goes, stands_on), words == moves, 0, 0
            report.check(told == right, f"{name}: summary.json says {told}")


def told():
    """What --check says: a floor on one side is no image of an open face; what turns about the axis is not rubbed by a
    wall that lets go."""
    floor = FLOOR.format(more="", matter="m", speed=-0.03, kind="slip")
    floor = floor.replace("y=0:open", "y=0:open x=0:open").replace("y-=slip", "y-=slip x-=slip")
    text = run("check_open", floor, options=("--check",)).text
    report.check("wall x- lets go" in text and "its own image" not in text, f"check_open: {text}")
    for swirl, words in (("", "wall z- lets go"), (" swirl=yes", "wall z- is a cell outside of 0")):
        text = run(f"check_swirl{len(swirl)}", SWIRLS.format(swirl=swirl), options=("--check",)).text
        report.check(words in text, f"check{swirl}: {text}")


bars()
pressed()
between()
rests()
told()
rubs()
loaded()
reactions()
tips()
stands()
left_alone()
report.end()
