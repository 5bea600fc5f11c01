#!/usr/bin/env python3
"""Decks of several bodies without a card `contact` (doc/contact.md, Without a card): bars exchange their velocities,
what falls rests and can be lifted, layers hold together under tension, a slug of water gives a plate its momentum and
leaves it, a card `group` bonds, and words at the start and of --check say what is done.

usage: default_contact.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os

from _runs import Report, run

BARS = """
parameter c = 32
dimension {space}
grid cell=1/c {grid}
{walls}
method sgmp
time end=3.2 cfl=0.4
material m elastic density=1 young=1 poisson=0
body one block material=m lower={at[0]} upper={at[1]} ppc=2
body two block material=m lower={at[2]} upper={at[3]} ppc=2
velocity one x=0.01
history steps=20
"""
# One bar, cut in two: the wave of a blow at its left end runs to the right one and comes back as tension.
LAYERS = """
parameter c = 32
dimension 1
grid cell=1/c x=open
method sgmp
time end=2.5 cfl=0.4
material m elastic density=1 young=1 poisson=0
body hammer block material=m lower=0 upper=0.25
body left block material=m lower=0.25 upper=1
body right block material=m lower=1 upper=1.5
velocity hammer x=0.01
history steps=20
"""
# Half of a block that is set on water, beside a plane of symmetry.
FLOATS = """
dimension 2
grid cell=0.25 x=0:2 y=0:open
wall x-=slip x+=slip y-=slip
method sgmp
time end=30 cfl=0.5
damping rate=1
gravity (0,-1)
material w fluid density=1
eos w tait c0=15
initial_stress w surface=2
material m elastic density=0.5 young=200 poisson=0.3
body w block material=w lower=(0,0) upper=(2,2) ppc=2
body m block material=m lower=(0,2) upper=(1,3) ppc=2
history steps=50
"""
# A heavy block that is set on water sinks; a wedge is driven into water at rest at a constant speed.
SINKS = FLOATS.replace("x=0:2", "x=0:4").replace("(2,2)", "(4,5)").replace("surface=2", "surface=5").replace(
    "(0,2) upper=(1,3)", "(0,5) upper=(1,6)").replace("cell=0.25", "cell=0.2").replace("end=30", "end=6").replace(
    "damping rate=1\n", "").replace("elastic density=0.5", "elastic density=1.5")
SLAMS = """
parameter angle = 30   ! of its faces with the water
parameter depth = 0.6
parameter slope = tan(angle*pi/180)
dimension 2
grid cell=0.05 x=0:6 y=-4:open
wall x-=slip x+=slip y-=slip
method sgmp
time end=depth cfl=0.5
material w fluid density=1
eos w tait c0=20
material s elastic density=3 young=1e4 poisson=0.3
body w block material=w lower=(0,-4) upper=(6,0) ppc=2
body s polygon material=s corners=(0,0),(2.5,2.5*slope),(2.5,2.5*slope+0.5),(0,2.5*slope+0.5) ppc=2
rigid s y=-1
history every=0.02
"""
# A free rigid cylinder in a shell of water is pulled; water in a rigid tank, aslant in the grid, is shaken.
CARRIES = """
dimension 2
grid cell=0.125
method sgmp
time end=2 cfl=0.5
material w fluid density=1
eos w tait c0=20
material s elastic density=2 young=1e4 poisson=0.3
body w ring material=w centre=(0,0) radius=3 inner=1 ppc=2
body s sphere material=s centre=(0,0) radius=1
body out ring material=s centre=(0,0) radius=3.5 inner=3 ppc=2
rigid s free=yes
rigid out
bodyforce s x=0.1
history every=0.1
"""
SHAKEN = """
dimension 2
grid cell=0.05
method sgmp
time end=10 cfl=0.5
gravity (0.5,-sqrt(0.75))
material w fluid density=1
eos w tait c0=15
material s elastic density=3 young=1e4 poisson=0.3
body w block material=w lower=(0,0) upper=(2,1) ppc=2 rotation=30 pivot=(0,0)
body s block material=s lower=(-0.5,-0.5) upper=(2.5,2) rotation=30 pivot=(0,0)
subtract s block lower=(0,0) upper=(2,2.1)
rigid s x="0.05*cos(2*t)"
"""
# A plate falls on another, and is lifted again.
LIFTED = """
dimension 2
grid cell=1 x=0:12 y=0:open
wall x-=slip x+=slip y-=slip
method sgmp
time end=300 cfl=0.4
material m elastic density=1 young=1 poisson=0
body low block material=m lower=(0,0) upper=(12,6)
body high block material=m lower=(2,7) upper=(10,13)
bodyforce high y="t<150 ? -0.0005 : 0.0005"
damping rate=0.05
history steps=20
"""
SLUG = """
units mm g ms
dimension 1
grid cell=0.25 x=open
method sgmp
time end=0.02 cfl=0.4
material water fluid density=1e-3
eos water gruneisen c0=1480 s=1.92 gamma0=0.1
material copper elastic density=0.00893 young=120000 poisson=0.34
body slug block material=water lower=0 upper=8
body plate block material=copper lower=8.3 upper=9.3
velocity slug x=100
history steps=20
"""
# A rod without strength goes into a block without any.
JET = """
parameter split = auto
parameter t_end = 80
dimension 2
grid cell=0.25 x=0:open y=open
wall x-=slip
method sgmp split=$split
time end=t_end cfl=0.4
material a j2 density=1 young=1 poisson=0.3 yield=1e-4
body rod block material=a lower=(0,0) upper=(1,12) ppc=2
body target block material=a lower=(0,-12) upper=(8,0) ppc=2
velocity rod y=-0.2
history steps=50
output csv at=end
"""
report = Report()


def end_of(result, name, key):
    """The last value of a body."""
    return [row[key] for row in result.table("bodies.csv") if row["name"] == name][-1]


def bars():
    """Two equal bars exchange their velocities (waves in bars), on a line, in plane and space."""
    for space, grid, walls, at in (
        (1, "", "", ("0", "1", "1.005", "2.005")),
        (2, "y=0:4/c", "wall y-=slip y+=slip", ("(0,0)", "(1,4/c)", "(1.005,0)", "(2.005,4/c)")),
        (3, "y=0:4/c z=0:4/c", "wall y-=slip y+=slip z-=slip z+=slip",
         ("(0,0,0)", "(1,4/c,4/c)", "(1.005,0,0)", "(2.005,4/c,4/c)")),
    ):
        deck = BARS.format(space=space, grid=grid, walls=walls, at=at)
        result = run(f"bars_{space}", deck)
        if not report.finished(result, f"bars {space}D"):
            continue
        left, right = (end_of(result, name, "velocity_x")/0.01 for name in ("one", "two"))
        report.check(abs(left) < 0.04 and abs(right - 1) < 0.04, f"bars {space}D: {left:.3f}, {right:.3f}, not 0, 1")
        asked = run(f"asked_{space}", deck + "contact all\n")
        report.check(asked["checksum"] == result["checksum"], f"bars {space}D: not as with contact all")
        bonded = run(f"bonded_{space}", deck + "group both one,two\n")
        if report.finished(bonded, f"group {space}D"):
            left, right = (end_of(bonded, name, "x") for name in ("one", "two"))
            report.check(abs(right - left - 1.0) < 0.03, f"group {space}D: {left}, {right} have parted")


def layers():
    """What shares a surface is one piece. The hammer and the bar have 1.5 in length; in t = 2.5 the pulse has run to
    the end, has come back and lies in the left part again: tension has passed where the bar is cut."""
    result = run("layers", LAYERS)
    if not report.finished(result, "layers"):
        return
    grouped = run("layers_grouped", LAYERS + "group bar left,right\n")
    report.check(grouped["checksum"] == result["checksum"], "layers: not as with a group")
    momentum = {name: end_of(result, name, "velocity_x")*length
                for name, length in (("hammer", 0.25), ("left", 0.75), ("right", 0.5))}
    # the hammer stops; the pulse of 0.5 at velocity 0.005 runs: at 2.5 - 0.25 = 2.25 its head is 0.5 left of the end
    report.check(abs(momentum["hammer"]) < 1e-4, f"layers: {momentum}")
    report.check(abs(momentum["right"]) < 2.5e-4 and abs(momentum["left"] - 2.5e-3) < 2.5e-4, f"layers: {momentum}")
    report.check("'left' and 'right' share a surface at the start and are bonded" in result.text, result.text)
    report.check("bonded" not in grouped.text, grouped.text)
    parted = run("layers_parted", LAYERS + "contact all\n")
    if report.finished(parted, "parted layers"):  # the pulse stays in the right part, which flies away with it
        left, right = (end_of(parted, name, "velocity_x") for name in ("left", "right"))
        report.check(abs(left) < 4e-4 and abs(right - 0.005) < 4e-4, f"parted layers: {left}, {right}")


def lifted():
    """A plate that has come to rest on another can be lifted."""
    result = run("lifted", LIFTED)
    if report.finished(result, "lifted"):
        rows = result.table("bodies.csv")
        heights = [row["y"] for row in rows if row["name"] == "high"]
        report.check(abs(min(heights) - 9) < 0.1, f"lifted: lowest at {min(heights)}, not 9")
        report.check(heights[-1] > 9.5, f"lifted: ends at {heights[-1]}")
        low = end_of(result, "low", "y")
        report.check(abs(low - 3) < 0.05, f"lifted: the lower one is at {low}")


def slug():
    """What a slug of water and a plate have together: momentum; the plate is faster in the end than the water."""
    result = run("slug", SLUG)
    if report.finished(result, "slug"):
        plate, water = (end_of(result, name, "velocity_x") for name in ("plate", "slug"))
        gap = result.table("bodies.csv")
        report.check(plate > water + 1, f"slug: {plate}, {water}: they do not part")
        total = plate*8.93 + water*8
        report.check(abs(total/800 - 1) < 1e-9, f"slug: momentum {total} of 800, {len(gap)} rows")


def rows():
    """Of more than 100 pairs those have rows that are near each other; of fewer all."""
    head = BARS[:BARS.index("body one")].format(space=1, grid="", walls="")
    for number, every in ((14, True), (15, False)):
        blocks = "".join(
            f"body b{i} block material=m lower={0.5*i} upper={0.5*i + 0.25} ppc=2\n" for i in range(number)
        )
        result = run(f"rows_{number}", head + blocks + "velocity b0 x=0.05\nvelocity b1 x=-0.05\nhistory steps=1\n")
        if not report.finished(result, f"{number} blocks"):
            continue
        table = result.table("contact.csv")
        pairs = {row["bodies"] for row in table}
        all_pairs = number*(number - 1)//2
        report.check(len(pairs) == (all_pairs if every else 1), f"{number} blocks: rows of {len(pairs)} pairs")
        report.check("b0 b1" in pairs, f"{number} blocks: {pairs}")


def jet():
    """Where rod and block meet moves at half of the rod's velocity, for the pressure on both sides of it is the same;
    no part of the rod is inside the block, for the particles of both are split; without that it is, and is doubted."""
    halfway, result = run("jet_halfway", JET, t_end=40), run("jet", JET)
    if report.finished(halfway, "half a jet") and report.finished(result, "jet"):
        depths = [min(row["y"] for row in done.table("particles_end.csv") if row["body"] in (1, "rod"))
                  for done in (halfway, result)]
        speed = (depths[0] - depths[1])/40
        report.check(abs(speed/0.1 - 1) < 0.1, f"jet: the hole's bottom moves at {speed}, not 0.1: {depths}")
        report.check(result["verdict"] == "sound" and result["end_state.particles_inside_other_bodies"] == 0,
                     f"jet: {result['verdict_reasons']} {result['end_state']}")
        chosen = result["split_limit"], result["contact"]
        report.check(chosen == (0.75, "default"), f"jet: {chosen}")
    whole = run("jet_whole", JET, split="none")
    report.check(whole["verdict"] == "doubtful" and whole["end_state.particles_inside_other_bodies"] > 100,
                 f"jet, not split: {whole['verdict_reasons']} {whole['end_state']}")
    text = run("jet_told", JET, options=("--check",)).text
    report.check("particles of solids longer than 0.75 cells are split, one in 16 at most" in text, text)


def floats():
    """A light block that is set on water floats as deep as it should; where they are bonded strains are plain."""
    result = run("floats", FLOATS)
    if report.finished(result, "floats"):
        height = 2 + 0.5*1/2 - 0.5 + 0.5  # the surface is lifted by what the block displaces
        middle = [row["y"] for row in result.table("bodies.csv") if row["name"] == "m"][-1]
        report.check(abs(middle - height) < 0.1, f"floats: at {middle}, not {height}")
        report.check(result["contact"] == "default", f"floats: contact {result['contact']}")
    for words, expected in (("", "plain"), (" surfaces=corrected", "corrected")):
        deck = FLOATS.replace("end=30", "end=0.1").replace("sgmp", "sgmp" + words)
        bonded = run("floats_bonded", deck + "group one w,m\n")
        report.check(bonded["surfaces"] == expected, f"floats, bonded{words}: surfaces {bonded['surfaces']}")


def sinks():
    """What sinks is not entered by the water that flows round it."""
    result = run("sinks", SINKS)
    if not report.finished(result, "sinks"):
        return
    inside = result["end_state.particles_inside_other_bodies"]
    why = result["verdict_reasons"]
    report.check(inside == 0 and result["verdict"] != "doubtful", f"sinks: {inside} inside, {why}")
    heights = [row["y"] for row in result.table("bodies.csv") if row["name"] == "m"]
    report.check(3 < heights[-1] < 4 and heights == sorted(heights, reverse=True), f"sinks: {heights}")


def slams():
    """A wedge in water: the force grows with the time, 14.14 rho v^3 t for both faces at 30 degrees (similarity
    solution of Zhao and Faltinsen, J. Fluid Mech. 246, 1993, from memory of the literature); walls
    around take it up by some percent. At 45 degrees the first drop that is met, which is given next to nothing, does
    not end the run."""
    result = run("slams", SLAMS)
    if report.finished(result, "slams"):
        rows = [row for row in result.table("contact.csv") if row["time"] > 0.2]
        ratio = sum(abs(row["force_y"]) for row in rows)/sum(14.139/2*(row["time"] - 0.01) for row in rows)
        report.check(0.95 < ratio < 1.15, f"slams: {ratio} of the force")
        report.check(result["end_state.particles_inside_other_bodies"] == 0, "slams: water is inside the wedge")
    report.finished(run("slams_45", SLAMS, angle=45, depth=0.1), "slams, 45 degrees")


def carries():
    """What is rigid carries no layer of water along: in a shell of water of the radius b a cylinder of the radius a has
    the added mass rho pi a^2 (b^2 + a^2)/(b^2 - a^2)."""
    result = run("carries", CARRIES)
    if report.finished(result, "carries"):
        last = [row for row in result.table("bodies.csv") if row["name"] == "s"][-1]
        ratio = last["velocity_x"]/(0.1*2/(2 + 10/8)*last["time"])
        report.check(0.87 < ratio < 1.03, f"carries: {ratio} of the velocity")


def shaken():
    """Water stays in a tank."""
    result = run("shaken", SHAKEN)
    if report.finished(result, "shaken"):
        inside = result["end_state.particles_inside_other_bodies"]
        report.check(inside <= 16, f"shaken: {inside} of {result['particles']} particles are inside the tank's walls")


def told():
    """--check says what is done."""
    deck = BARS.format(space=1, grid="", walls="", at=("0", "1", "1.005", "2.005"))
    text = run("told", deck, options=("--check",)).text
    report.check("contact     one and two, friction 0" in text and "default   contact all" in text, text)
    text = run("told_layers", LAYERS, options=("--check",)).text
    report.check("left+right, stick" in text and "default: they touch at the start" in text, text)


bars()
layers()
lifted()
slug()
rows()
jet()
floats()
sinks()
slams()
carries()
shaken()
told()
report.end()
