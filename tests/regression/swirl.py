#!/usr/bin/env python3
"""What turns about an axis and is rubbed, driven or read from the grid (doc/theory.md, 8): discs that friction stops, a
rod that is twisted, PIC.

usage: swirl.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: a disc of radius R on a rough plane under the pressure p turns slower by (4/3) mu p/(rho H R) a
time, H its height; torque of a rod G pi R^4/2 times its twist over its length; the angular momentum of what nothing
turns.
"""
import math

from _runs import SWIRL, Report, changed, run

UPDATES = ("musl", "usf", "usl", "usavg")
MU, BEGIN = 0.3, 0.3
DISC = f"""
parameter update = musl
parameter mu = {MU}
parameter poisson = 0.3
dimension axisymmetric swirl=yes
grid cell=0.125 r=0:open z=0:open
wall z-=slip
wallfriction z- friction=mu
method sgmp update=$update
time end=1.3 cfl=0.4
material m elastic density=1 young=250 poisson=poisson
body b block material=m lower=(0,0) upper=(1,0.5) ppc=2
velocity b spin=1
bodyforce b z="-sin(pi/2*min(t/{BEGIN},1))^2"
history every=0.1
output csv at=end fields=mass
"""
CEILING = changed(
    DISC, ("z=0:open", "z=open:0"), ("z-", "z+"), ("lower=(0,0) upper=(1,0.5)", "lower=(0,-0.5) upper=(1,0)"),
    ('z="-sin', 'z="sin'))
# The same disc on another at rest that slips on the plane. Without Poisson's ratio all pressures are alike.
STACK = changed(
    DISC, ("wallfriction z- friction=mu", "contact friction=mu"),
    ("lower=(0,0) upper=(1,0.5)", "lower=(0,0.5) upper=(1,1)"),
    ("velocity b", "body a block material=m lower=(0,0) upper=(1,0.5) ppc=2\nvelocity b"),
    ("bodyforce b", "bodyforce all"))
# Turned at one end, held at the other.
ROD = """
parameter update = musl
parameter cells = 8
parameter pull = 0
dimension axisymmetric swirl=yes
grid cell=1/cells r=0:open z=open:open
method sgmp update=$update
time end=16 cfl=0.4
material m elastic density=1 young=250 poisson=0.25
body b block material=m lower=(0,0) upper=(1,4) ppc=2
motion b where="z<0.25" r=0 z=0 spin=0
motion b where="z>3.75" r=0 z=pull spin="0.005*min(t,1)*min(max(11-t,0),1)"
damping rate=3
history every=0.25
"""
WAVY = """
parameter update = musl
parameter flip = 1
dimension axisymmetric swirl=yes
grid cell=0.125 r=0:open z=open:open
method sgmp update=$update flip=flip
time end=1 cfl=0.4
material m elastic density=1 young=250 poisson=0.25
body b block material=m lower=(0,0) upper=(1,1) ppc=2
velocity b spin="1+0.3*sin(5*z)"
history every=0.5
"""
# A free rod in its first mode of torsion.
RINGS = """
parameter update = musl
dimension axisymmetric swirl=yes
grid cell=0.125 r=0:open z=open:open
method sgmp update=$update flip=0.8
time end=0.7 cfl=0.4
material m elastic density=1 young=250 poisson=0.25
body b block material=m lower=(0,0) upper=(1,4) ppc=2
velocity b spin="1e-3*cos(pi*z/4)"
history steps=1
"""


def rates(result):
    """Angular velocity of each body."""
    momentum, inertia = {}, {}
    for row in result.table("particles_end.csv"):
        body, arm = row["body"], row["mass"]*row["x"]
        momentum[body] = momentum.get(body, 0.0) + arm*row["velocity_y"]
        inertia[body] = inertia.get(body, 0.0) + arm*row["x"]
    return {body: momentum[body]/inertia[body] for body in sorted(inertia)}


def balanced(report, result, name):
    """The kinetic identity holds to round-off."""
    report.check(abs(result["energy.remainder"]) < 1e-12, f"{name}: remainder {result['energy.remainder']:.2e}")


def discs(report):
    """A disc that a rough plane slows down, from below and from above."""
    slowed = 4/3*MU*(1.3 - BEGIN/2)
    for update in UPDATES:
        for name, deck in ((f"disc_{update}", DISC), (f"ceiling_{update}", CEILING)):
            result = run(name, deck, update=update)
            if not report.finished(result, name):
                continue
            rows = result.table("history.csv")
            found = rows[-1]["angular_momentum"]/rows[0]["angular_momentum"]
            report.check(abs(found - (1 - slowed)) < 2e-3, f"{name}: {found:.5f} instead of {1 - slowed:.5f}")
            taken = rows[-1]["contact_dissipation"]
            lost = rows[0]["kinetic_energy"] - rows[-1]["kinetic_energy"]
            report.check(abs(taken/lost - 1) < 0.02, f"{name}: friction took {taken:.4f} of {lost:.4f}")
            balanced(report, result, name)


def stacks(report):
    """Two discs: what one loses the other gains, until they turn alike."""
    given = 4/3*MU*(1.3 - BEGIN/2)
    for update in UPDATES:
        name = f"stack_{update}"
        result = run(name, STACK, update=update, poisson=0)
        if not report.finished(result, name):
            continue
        below, above = rates(result).values()
        if below > above:
            below, above = above, below
        report.check(abs(below - given) < 5e-3, f"{name}: {below:.4f} instead of {given:.4f}")
        report.check(abs(above - (1 - given)) < 5e-3, f"{name}: {above:.4f} instead of {1 - given:.4f}")
        rows = result.table("history.csv")
        kept = rows[-1]["angular_momentum"]/rows[0]["angular_momentum"]
        report.check(abs(kept - 1) < 1e-13, f"{name}: angular momentum {kept - 1:.1e}")
        balanced(report, result, name)
        torque = result.table("contact.csv")[-1]
        arm = abs(torque["torque_z"]/torque["friction_y"])
        report.check(abs(arm - 2/3) < 0.02, f"{name}: torque over friction {arm:.4f} instead of 2/3")
    result = run("stuck", STACK, mu=3, poisson=0)
    if report.finished(result, "stuck"):
        for rate in rates(result).values():
            report.check(abs(rate - 0.5) < 0.05, f"discs that stick turn with {rate:.4f} instead of 0.5")


def rods(report):
    """Torque, work and energy of a rod that is twisted and at rest, and of one that is let go on."""
    twist = 0.005*10
    lengths = {}
    for cells, update in ((8, "musl"), (8, "usf"), (8, "usl"), (8, "usavg"), (12, "musl")):
        name = f"rod_{update}_{cells}"
        result = run(name, ROD, update=update, cells=cells)
        if not report.finished(result, name):
            continue
        held, turned = result.table("motion.csv")[-2:]
        report.check(abs(held["torque_z"]/turned["torque_z"] + 1) < 1e-3, f"{name}: torques of the ends differ")
        # What is gripped is stiff but for the half cell in which it ends.
        lengths[update, cells] = 100*math.pi/2*twist/turned["torque_z"]
        report.check(
            3.5 < lengths[update, cells] < 3.5 + 1.1/cells, f"{name}: as soft as a rod of {lengths[update, cells]:.4f}")
        energy = 0.5*turned["torque_z"]*twist
        last = result.table("history.csv")[-1]
        found = last["internal_energy"]
        report.check(abs(found/energy - 1) < 2e-3, f"{name}: energy {found:.6f} instead of {energy:.6f}")
        work = turned["work"] - last["damping_dissipation"]
        report.check(abs(work/energy - 1) < 3e-3, f"{name}: work {work:.6f} instead of {energy:.6f}")
        balanced(report, result, name)
    result = run("spun", changed(WAVY, ("velocity b", "motion b spin=0.1+0.1*t\nvelocity b"), ("every=0.5", "steps=1")))
    if report.finished(result, "spun"):  # as a whole: what turns it is its own inertia
        rows, history = result.table("motion.csv"), result.table("history.csv")
        gained = sum(row["torque_z"]*(row["time"] - before["time"]) for before, row in zip(rows, rows[1:]))
        end = history[-1]["angular_momentum"]
        first = history[0]["angular_momentum"]/(math.pi/2)
        report.check(abs(first - 0.1) < 1e-3, f"spun: it begins with {first}")
        report.check(abs(gained/(end - history[0]["angular_momentum"]) - 1) < 1e-12, f"spun: {gained} to {end}")
    result = run("rod_pulled", ROD.replace("damping rate=3\n", ""), pull=0.01)
    if report.finished(result, "rod_pulled"):
        balanced(report, result, "rod_pulled")
        # All torques since the start are the angular momentum.
        rows, gained = result.table("motion.csv"), 0.0
        for before, row in zip(rows, rows[2:]):
            gained += row["torque_z"]*(row["time"] - before["time"])
        end = result.table("history.csv")[-1]["angular_momentum"]
        scale = max(abs(row["torque_z"]) for row in rows)
        report.check(abs(gained - end) < 1e-5*scale*16, f"rod_pulled: torques gave {gained:.3e}, it has {end:.3e}")


def pic(report):
    """PIC damps waves but neither the angular momentum nor a rigid rotation; they keep their frequency."""
    for update in UPDATES:
        result = run(f"rings_{update}", RINGS, update=update)
        if report.finished(result, f"rings_{update}"):
            rows = result.table("history.csv")
            low = [row["time"] for before, row, after in zip(rows, rows[1:], rows[2:])
                   if row["kinetic_energy"] <= min(before["kinetic_energy"], after["kinetic_energy"])]
            report.check(len(low) == 2 and abs((low[1] - low[0])/0.4 - 1) < 0.02, f"rings_{update}: at rest at {low}")
    for update in UPDATES:
        for flip in (0.9, 0):
            name = f"pic_{update}_{flip}"
            result = run(name, WAVY, update=update, flip=flip)
            if not report.finished(result, name):
                continue
            rows = result.table("history.csv")
            kept = rows[-1]["angular_momentum"]/rows[0]["angular_momentum"] - 1
            report.check(abs(kept) < 1e-13, f"{name}: angular momentum {kept:.1e}")
            left = rows[-1]["internal_energy"] + rows[-1]["kinetic_energy"]
            # 2 pi times 1/2 r^2 r dr: 1/4 pi, with the mean rate; r grows by the centrifugal force
            rigid = 2*rows[0]["angular_momentum"]**2/math.pi
            report.check(0.97 < left/(0.5*rigid) < 1.02, f"{name}: energy {left:.4f}, rigid {0.5*rigid:.4f}")


def mixed(report):
    """Everything at once on what is curved and displaced: the kinetic identity."""
    cards = "wallfriction z- friction=0.3\ncontact friction=0.2\nmotion tube where=\"z>6\" spin=\"0.1*sin(t)\"\n"
    for update in UPDATES:
        for more in ("", " flip=0.9", " rotation=exact"):
            name = f"mixed_{update}{more.strip().replace('=', '_')}"
            deck = changed(SWIRL, ("update=$update", "update=$update" + more)) + cards
            result = run(name, deck, update=update)
            if report.finished(result, name):
                balanced(report, result, name)
                report.check(
                    result.table("history.csv")[-1]["contact_dissipation"] > 0.0, f"{name}: friction took nothing")


def main():
    """All of them."""
    report = Report()
    discs(report)
    stacks(report)
    rods(report)
    pic(report)
    mixed(report)
    report.end()


main()
