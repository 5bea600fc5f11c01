#!/usr/bin/env python3
"""Bodies that touch themselves (`contact … self=yes`, doc/contact.md): parts of one body behave as bodies of their own
do, matter stays whole along the seams between its velocity fields, nothing sticks or passes, the same bits.

usage: self_contact.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: two blocks that collide do so whether the deck calls them one body or two; contact makes no energy
and no momentum; a symmetric body stays symmetric; a body that meets nothing does not feel the word.
"""
import math

from _restarts import checkpoints, goes_on, mpirun, same_files, straight
from _runs import Report

# Two blocks, with {whole} = "add a" parts of one body. Both have seams when they meet: patches are cubes of 8 cells.
BLOCKS = """
dimension {dimension}
grid cell=1
method {method}
time cfl=0.4 end=75
material m elastic density=1 young=1 poisson=0.3
body a block material=m lower=({x},0) upper=({x}+7.5,{thick}) ppc=2
{whole} block lower=({x}+34,3) upper=({x}+46,3+{thick}) {rest}
velocity all x="-0.2*max(-1,min(1,{axis}))" {along}=0.01
contact all {self} friction=0.3
history steps=20
output csv at=end fields=stress
"""
# The same in a plane, and a third block that comes down on the seam of one of them.
PRESSED = """
dimension 2
grid cell=1
method {method}
time cfl=0.4 end=60
material m elastic density=1 young=1 poisson=0.3
body a block material=m lower=(0,0) upper=(17.5,20) ppc=2
{whole} block lower=(34,3) upper=(56,23) {rest}
body c block material=m lower=(35,26.5) upper=(47,35) ppc=2
velocity all x="-0.2*max(-1,min(1,x-25))" y=0.01
velocity c x=-0.2 y=-0.1
contact all {self}
history steps=20
"""
# Blocks that fly to one point.
CROWD = """
dimension 2
grid cell=1
method gimp update=usavg
time cfl=0.4 end=60
material m elastic density=1 young=1 poisson=0.3
body c {first} material=m ppc=2
{others}
velocity c x="-0.3*(x-4)/sqrt((x-4)^2+(y-4)^2)" y="-0.3*(y-4)/sqrt((x-4)^2+(y-4)^2)"
contact c self=yes
history steps=20
"""
# A block with a foot on the ground, compressed by a press that then draws its head aside. With {gap} the head starts
# above and comes down with the press: foot and head are the faces of a crack that closes.
CRACK = """
dimension 2
grid cell=1 y=0:60 x=open
wall y-=fixed
method gimp update=usavg
time cfl=0.4 end={shears}+32
material m elastic density=1 young=25 poisson=0.3
body c block material=m lower=(-6,0) upper=(16,6) ppc=2
add c block lower=(0,6+{gap}) upper=(10,12+{gap})
body press block material=m lower=(-4,12+{gap}) upper=(14,15+{gap}) ppc=2
rigid press y="-0.5*max(0,min(1,({shears}-10-t)/2))" x="0.05*max(0,min(1,(t-{shears})/2))"
velocity c y="{speed}*max(0,min(1,y-10))"
damping rate=1 until={shears}
contact press c friction=10
{card}
history steps=10
"""
# Two plates that begin near each other.
NEAR = """
dimension 2
grid cell=1
method mpm
time end=0.01
material m elastic density=1 young=1 poisson=0.3
body c block material=m lower=(0,0) upper=(40,8) ppc=1
add c block lower=(0,{low}) upper=(40,30)
contact c self=yes
"""
# A ring in four fragments, one body or bodies of their own, two of which fly into the other two.
RING = """
dimension 2
grid cell=1
method {method}
time cfl=0.4 end=70
material m elastic density=1 young=1 poisson=0.3
{fragments}
velocity all x="-0.2*max(-1,min(1,x))" y="0.02*max(0,min(1,x))"
contact all {self} friction=0.3
history steps=20
"""
# Two U back to back, or one of them at a mirror.
TWIN = """
dimension 2
grid cell=1 {grid}
{wall}
method {method}
time cfl=0.4 end=100
material m elastic density=1 young=1 poisson=0.3
body u block material=m lower=({low},0) upper=(40,6) ppc=2
add u block lower=({low},26) upper=(40,32)
add u block lower=({web},0) upper=(8,32)
velocity u y="0.2*max(-1,min(1,(16-y)/5))*max(0,min(1,(abs(x)-8)/32))"
contact all self=yes friction=0.2
history steps=20
"""
# A U whose legs come together.
STRIP = """
dimension 2
grid cell=1
method {method}
time cfl=0.4 end={end}
material m elastic density=1 young=1 poisson=0.3
body u block material=m lower=(0,0) upper=(40,6) ppc=2
add u block lower=(0,26) upper=(40,32)
add u block lower=(0,0) upper=(8,32)
velocity u y="0.2*max(-1,min(1,(16-y)/5))*max(0,min(1,(x-8)/32))"
{contact}
history steps=20
checkpoint every=100 keep=9
output csv at=end
"""


def blocks(dimension, method, self_):
    axial = dimension == "axisymmetric"
    text = BLOCKS.format(
        dimension=dimension, method=method, x=0, thick=10, self="self=yes" if self_ else "",
        axis="y-20" if axial else "x-20", along="z" if axial else "y", rest="" if self_ else "material=m ppc=2",
        whole="add a" if self_ else "body b",
    )
    if axial:  # the same along the axis, as rings
        for one, other in (("lower=(0,0)", "lower=(5,0)"), ("upper=(0+7.5,10)", "upper=(15,7.5)"),
                           ("lower=(0+34,3)", "lower=(8,34)"), ("upper=(0+46,3+10)", "upper=(18,46)"),
                           ("x=\"-0.2", "z=\"-0.2"), ("y-20", "z-20"), (" z=0.01", "")):
            text = text.replace(one, other)
    return text


def as_two(report):
    """One body of two blocks, and two bodies."""
    plain = "sgmp stress=plain rotation=plain surfaces=plain"
    equal = "grid cell=1"
    unequal = "grid cell=0.5 x=open y=open fine_x=(15,25) fine_y=(2,6) ratio=1.2 largest=1"
    for dimension, method, grid in (
        ("2", "mpm update=musl", equal), ("2", "gimp update=usavg", equal), ("2", "bspline update=usf", equal),
        ("2", f"{plain} update=usl", equal), ("axisymmetric", "mpm update=usavg", equal),
        ("2", f"{plain} update=musl", unequal), ("axisymmetric", f"{plain} update=usavg", unequal.replace(
            " x=open y=open fine_x=", " r=open z=open fine_z=").replace("fine_y=", "fine_r=")),
    ):
        name = dimension + "_" + "_".join([method.split()[0], method.split()[-1]]) + "_unequal"*(grid != equal)
        one, two = (
            straight(report, f"{number}_{name}", blocks(dimension, method, number == "one").replace(equal, grid))
            for number in ("one", "two"))
        report.check(two["energy.contact_dissipation"] > 1e-3*two["energy.initial_total"], f"{name}: no collision")
        for key in ("energy.kinetic", "energy.internal", "energy.contact_dissipation"):
            a, b = one[key], two[key]
            report.check(
                abs(a - b) < 1e-9*two["energy.initial_total"], f"{name}: {key} of one body {a}, of two {b}",
            )


def ring(report):
    """Fragments of a ring that fly into each other: what they do as bodies of their own, no momentum, no energy."""
    round_ = "ring material=m centre=(0,0) radius=40 inner=32 ppc=2"
    one = f"body r {round_}\nsubtract r block lower=(-9,-41) upper=(9,41)\nsubtract r block lower=(-41,-9) upper=(41,9)"
    four = "\n".join(
        f"body {name} {round_}\nintersect {name} block lower=({x},{y}) upper=({x + 32},{y + 32})"
        for name, x, y in (("a", 9, 9), ("b", -41, 9), ("c", -41, -41), ("d", 9, -41))
    )
    # Friction at seams of round bodies is known to 1e-5 with gimp.
    for method, most in (
        ("gimp update=usavg", 1e-5), ("sgmp stress=plain rotation=plain surfaces=plain update=usavg", 1e-12),
    ):
        name = method.split()[0]
        runs = [
            straight(report, f"ring_{len(word)}_{name}", RING.format(method=method, fragments=fragments, self=word))
            for fragments, word in ((one, "self=yes"), (four, ""))
        ]
        first = runs[1]["energy.initial_total"]
        report.check(runs[1]["energy.contact_dissipation"] > 1e-2*first, f"ring, {name}: no collision")
        for key in ("energy.kinetic", "energy.internal", "energy.contact_dissipation"):
            a, b = (result[key] for result in runs)
            report.check(abs(a - b) < most*first, f"ring, {name}: {key} of one body {a}, of four {b}")
        rows = runs[0].table("history.csv")
        for row in rows:
            gained = [row[f"momentum_{axis}"] - rows[0][f"momentum_{axis}"] for axis in "xy"]
            report.check(abs(gained[0]) + abs(gained[1]) < 1e-11, f"ring, {name}: momentum gained {gained}")
            energy = (row["total_energy"] + row["contact_dissipation"])/first
            report.check(energy < 1.003, f"ring, {name}: energy {energy} at {row['time']}")


def twin(report):
    """Half of a symmetric body at a mirror touches itself as the whole one does."""
    for method in ("mpm update=musl", "gimp update=usavg"):
        name = method.split()[0]
        whole = straight(report, f"twin_{name}", TWIN.format(method=method, grid="", wall="", low=-40, web=-8))
        half = straight(report, f"half_{name}", TWIN.format(method=method, grid="x=0:open", wall="wall x-=slip", low=0,
                                                            web=0))
        first = whole["energy.initial_total"]
        report.check(whole["energy.contact_dissipation"] > 1e-3*first, f"twin, {name}: nothing touches")
        for key in ("energy.kinetic", "energy.internal", "energy.contact_dissipation"):
            report.check(
                abs(2*half[key] - whole[key]) < 1e-9*first,
                f"twin, {name}: {key} of a half {half[key]}, of the whole {whole[key]}",
            )


def pressed(report):
    """What presses on a seam presses on one body: seams are where the right block has some of two labels."""
    for method in ("mpm update=musl", "gimp update=usavg", "bspline update=usf",
                   "sgmp stress=plain rotation=plain surfaces=plain update=usl"):
        name = method.split()[0]
        one = straight(report, f"pressed_one_{name}", PRESSED.format(method=method, whole="add a", self="self=yes",
                                                                     rest=""))
        two = straight(report, f"pressed_two_{name}", PRESSED.format(method=method, whole="body b", self="",
                                                                     rest="material=m ppc=2"))
        for key in ("energy.kinetic", "energy.internal", "energy.contact_dissipation"):
            a, b = one[key], two[key]
            report.check(
                abs(a - b) < 1e-5*two["energy.initial_total"], f"pressed, {name}: {key} of one body {a}, of two {b}",
            )
        force = [max(abs(row["force_y"]) for row in run.table("contact.csv") if row["bodies"] == f"{first} c")
                 for run, first in ((one, "a"), (two, "b"))]
        report.check(abs(force[0] - force[1]) < 0.01*force[1], f"pressed, {name}: force {force[0]}, of two {force[1]}")


def crowded(report):
    """Four fields are enough for four parts that meet at one place, and the verdict says so of a fifth."""
    for number in (4, 5):
        angles = [2*math.pi*k/number for k in range(number)]
        corners = [(round(2.5 + 20*math.cos(angle)), round(2.5 + 20*math.sin(angle))) for angle in angles]
        blocks = [f"block lower=({x},{y}) upper=({x + 3},{y + 3})" for x, y in corners]
        result = straight(report, f"crowd_{number}", CROWD.format(
            first=blocks[0], others="\n".join("add c " + block for block in blocks[1:]),
        ))
        said = "met than it has velocity fields" in " ".join(result["verdict_reasons"])
        report.check(said == (number > 4), f"{number} parts that meet: {result['verdict_reasons']}")
        rows = result.table("history.csv")
        for row in rows if number == 4 else ():
            gained = [row[f"momentum_{axis}"] - rows[0][f"momentum_{axis}"] for axis in "xy"]
            report.check(abs(gained[0]) + abs(gained[1]) < 1e-12, f"{number} parts: momentum gained {gained}")
            energy = (row["total_energy"] + row["contact_dissipation"])/rows[0]["total_energy"]
            report.check(abs(energy - 1) < 0.01, f"{number} parts: energy {energy} at {row['time']}")


def crack(report):
    """A closed crack bears what a whole block bears, but for what contact of 6 cells on 6 is too soft; its shear is
    limited by Coulomb's law."""
    bears = {}
    for name, gap, friction in (("whole", 0, 0), ("crack", 17, 0.1), ("crack", 17, 0.3)):
        begins = 2*(gap + 0.27) + 1 + 10  # at half a cell in unit time, with two units to stop and ten to come to rest
        result = straight(report, f"{name}_{friction}", CRACK.format(
            gap=gap, shears=begins, speed=-0.5 if gap else 0,
            card=f"contact c self=yes friction={friction}" if gap else "",
        ))
        rows = [row for row in result.table("contact.csv") if row["bodies"] == "press c"]
        pressed, sheared = ([row for row in rows if first < row["time"] - begins < last]
                            for first, last in ((-3, 0), (14, 32)))
        bears[name] = sum(row["force_y"] for row in pressed)/len(pressed)
        limit = -sum(row["force_x"] for row in sheared)/sum(row["force_y"] for row in sheared)
        if gap:
            report.check(abs(limit - friction) < 0.07*friction, f"crack: shear {limit} of pressure, {friction}")
            ratio = bears["crack"]/bears["whole"]
            report.check(0.92 < ratio < 1.02, f"crack: it bears {ratio} of what a whole block does")
        else:
            report.check(limit > 0.5, f"whole block: shear over pressure {limit}")


def near(report):
    """Parts that cannot be told apart are named before the run; one piece is not, nor parts that are far."""
    for low, launcher in ((8, ()), (14, ()), (14, mpirun(3)), (26, ())):
        result = straight(report, f"near_{low}_{len(launcher)}", NEAR.format(low=low), launcher=launcher)
        said = "less than 16 cells apart" in " ".join(result["warnings"])
        report.check(said == (low == 14), f"plates from 0 to 8 and from {low} on: {result['warnings']}")


def strip(method, contact, end=100):
    return STRIP.format(method=method, contact=contact, end=end)


def closes(report):
    """The legs neither pass nor stick; momentum, symmetry, energy; they would stick without the card."""
    result = straight(report, "strip", strip("gimp update=usavg", "contact all self=yes friction=0.2", end=240))
    first = result["energy.initial_total"]
    for row in result.table("history.csv"):
        report.check(
            abs(row["momentum_x"]) + abs(row["momentum_y"]) < 1e-12, f"strip: momentum at {row['time']}",
        )
        energy = row["total_energy"] + row["contact_dissipation"]
        report.check(energy < 1.002*first, f"strip: energy {energy} at {row['time']}, first {first}")
    touched = [row for row in result.table("contact.csv") if row["contact_nodes"] > 0]
    report.check(touched, "strip: nothing touches")
    report.check(not result.table("contact.csv")[-1]["contact_nodes"], "strip: the legs have not come apart again")
    legs = [row["y"] for row in result.table("particles_end.csv") if row["x"] > 20]
    report.check(
        abs(sum(legs)/len(legs) - 16) < 1e-9, f"strip: mean height {sum(legs)/len(legs)} of what is symmetric about 16",
    )
    gap = min(y for y in legs if y > 16) - max(y for y in legs if y < 16)
    report.check(gap > 0.25, f"strip: a gap of {gap} cells between the legs")
    report.check(sum(y > 16 for y in legs)*2 == len(legs), "strip: legs have passed each other")


def feels_nothing(report):
    """Where nothing meets the word changes no bit of any particle."""
    for method in ("mpm update=musl", "sgmp stress=plain rotation=plain surfaces=plain update=usavg"):
        name = method.split()[0]
        found = []
        for title, contact in (("with", "contact all self=yes"), ("without", "")):
            result = straight(report, f"{title}_{name}", strip(method, contact, end=8))
            with open(result.folder + "/particles_end.csv", "rb") as file:
                found.append(file.read())
        report.check(found[0] == found[1], f"{name}: self=yes is felt where nothing meets")


def same_bits(report):
    """Threads, ranks, restart; of a U, and of blocks that another one presses on while labels change."""
    strips = strip("mpm update=musl", "contact all self=yes friction=0.2", end=70)
    pressing = PRESSED.format(method="gimp update=usavg", whole="add a", self="self=yes friction=0.2", rest="")
    for scene, text in (("strip", strips), ("pressed", pressing + "checkpoint every=100 keep=9\noutput csv at=end\n")):
        first = straight(report, f"first_{scene}", text)
        at = [step for step in checkpoints(first.folder) if step % 100 == 0][-1]  # labels have changed by then
        for name, options in (("threads", {"threads": 2}), ("ranks", {"launcher": mpirun(3)})):
            other = straight(report, f"{name}_{scene}", text, **options)
            report.check(first["checksum"] == other["checksum"], f"{scene}, {name}: other bits")
            same_files(report, first.folder, other.folder, name, layouts=True)
        goes_on(report, first, f"restart_{scene}", text, at)
        goes_on(report, first, f"restart_ranks_{scene}", text, at, launcher=mpirun(3))


if __name__ == "__main__":
    REPORT = Report()
    as_two(REPORT)
    ring(REPORT)
    twin(REPORT)
    pressed(REPORT)
    crowded(REPORT)
    crack(REPORT)
    near(REPORT)
    closes(REPORT)
    feels_nothing(REPORT)
    same_bits(REPORT)
    REPORT.end()
