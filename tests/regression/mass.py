#!/usr/bin/env python3
"""A consistent mass of the nodes (doc/mass.md): waves run with their speed, momentum, angular momentum and the identity
of the energy stay, walls are mirrors; which scenes get it without a word; the same bits with threads and ranks, and
after a restart.

usage: mass.py SGMP SOURCE_DIR SCRATCH_DIR

Expected values are speeds of waves in closed form, and laws of conservation.
"""
import math
import os

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

SPEED = {"compression": math.sqrt(0.7/(1.3*0.4)), "shear": math.sqrt(1/2.6)}  # density and Young's modulus 1
# A standing wave, half of one along each axis, between slip walls.
WAVE = """
dimension {space}
grid cell=1/{n} {grid}
wall {walls}
method sgmp {words}
time end={end} cfl=0.4
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=({low}) upper=({high}) ppc=2
velocity m {velocity}
history every={end}/200
gauge g point=({point})
"""
PARTS = {  # axes, velocities, waves in one unit of length
    "line": ("x", ('x="1e-4*sin(2*pi*x)"',), 1, "compression"),
    "plane": ("xy", ('x="1e-4*sin(2*pi*x)*cos(2*pi*y)"', 'y="1e-4*cos(2*pi*x)*sin(2*pi*y)"'), math.sqrt(2),
              "compression"),
    "shear": ("xy", ('x="1e-4*sin(2*pi*x)*cos(2*pi*y)"', 'y="-1e-4*cos(2*pi*x)*sin(2*pi*y)"'), math.sqrt(2), "shear"),
    "space": ("xyz", ('x="1e-4*sin(2*pi*x)*cos(2*pi*y)*cos(2*pi*z)"', 'y="1e-4*cos(2*pi*x)*sin(2*pi*y)*cos(2*pi*z)"',
                      'z="1e-4*cos(2*pi*x)*cos(2*pi*y)*sin(2*pi*z)"'), math.sqrt(3), "compression"),
}


def wave(part, n, words):
    """The deck, and its exact period."""
    axes, velocity, waves, kind = PARTS[part]
    period = 1/(waves*SPEED[kind])
    return WAVE.format(
        space=len(axes), n=n, words=words, end=2.2*period, grid=" ".join(f"{axis}=0:0.5" for axis in axes),
        walls=" ".join(f"{axis}{side}=slip" for axis in axes for side in "-+"), low=",".join("0"*len(axes)),
        high=",".join(["0.5"]*len(axes)), velocity=" ".join(velocity),
        point=",".join(["0.25"] + ["0.01"]*(len(axes) - 1))), period


def waves(report):
    """Periods; with lumped masses they are long by a third and more of (k h)^2."""
    for part, n, words, low, high in (
        ("line", 20, "mass=consistent", -0.002, 0.002), ("line", 20, "mass=lumped", 0.03, 0.04),
        ("line", 40, "mass=consistent", -0.001, 0.001), ("plane", 28, "mass=consistent", -0.003, 0.003),
        ("plane", 28, "mass=consistent update=usf", -0.003, 0.003), ("plane", 28, "", -0.003, 0.003),
        ("plane", 28, "mass=consistent update=usl", -0.003, 0.003), ("plane", 28, "mass=lumped", 0.03, 0.04),
        ("plane", 28, "mass=consistent update=usavg", -0.003, 0.003), ("shear", 28, "mass=consistent", -0.003, 0.003),
        ("space", 24, "mass=consistent", -0.01, 0.01),
    ):
        name = f"{part}_{n}_{words}".replace(" ", "_").replace("=", "_")
        deck, exact = wave(part, n, words)
        result = run(name, deck)
        if not report.finished(result, name):
            continue
        rows = result.table("gauges.csv")
        zeros = [a["time"] - a["velocity_x"]*(b["time"] - a["time"])/(b["velocity_x"] - a["velocity_x"])
                 for a, b in zip(rows, rows[1:]) if a["velocity_x"]*b["velocity_x"] < 0]
        error = 2*(zeros[-1] - zeros[0])/(len(zeros) - 1)/exact - 1
        report.check(low < error < high, f"{name}: period off by {error}")
        # What swings between motion and stress, half a step apart, is no energy that is made or gone.
        report.check(words != "mass=consistent" or result["verdict"] == "sound", f"{name}: {result.text}")
        last = result.table("history.csv")[-1]
        report.check(abs(last["energy_remainder"]) < 1e-12*last["kinetic_energy"] + 1e-22,
                     f"{name}: remainder {last['energy_remainder']}")


# A disk that spins, is stretched and falls; and, with the word for the mass given, two that bounce off each other.
DISK = """
dimension {space}
grid cell=0.25 x=open y=open{grid}
{walls}
method sgmp {words}
time end={end} cfl=0.4
{more}
material m neo_hookean density=1 young=100 poisson=0.3
body disk {shape} material=m centre=(0.03,0.05{z}) radius=1 spacing=0.125
velocity disk x="0.3*x-2*y" y="2*x-0.1*y"
history every={end}/20
output csv at=end fields=mass,initial_position
checkpoint every=60
"""
SECOND = """
body other cylinder material=m centre=(2.3,0.3) radius=1 spacing=0.125
velocity other x=-3
contact disk other
"""


def disk(space, words="mass=consistent", more="", end=1):
    return DISK.format(space=space, words=words, more=more, end=end, shape="cylinder" if space == 2 else "sphere",
                       grid="" if space == 2 else " z=open", walls="", z="" if space == 2 else ",0.02")


def turn(rows):
    """Angular momentum about the origin."""
    return sum(row["mass"]*(row["x"]*row["velocity_y"] - row["y"]*row["velocity_x"]) for row in rows)


def conserved(report):
    """Momentum and energy to round-off, angular momentum to what exact rotation leaves of it."""
    for space in (2, 3):
        result = run(f"disk_{space}", disk(space))
        if not report.finished(result, f"disk_{space}"):
            continue
        first, last = result.table("history.csv")[0], result.table("history.csv")[-1]
        scale = first["kinetic_energy"]
        for axis in "xyz":
            change = last[f"momentum_{axis}"] - first[f"momentum_{axis}"]
            report.check(abs(change) < 1e-12*scale, f"disk_{space}: momentum along {axis} by {change}")
        report.check(abs(last["energy_remainder"]) < 1e-12*scale, f"disk_{space}: {last['energy_remainder']}")
        report.check(abs(last["total_energy"]/first["total_energy"] - 1) < 0.01, f"disk_{space}: energy")
        rows = result.table("particles_end.csv")
        start = sum(row["mass"]*(row["x0"]*(2*row["x0"] - 0.1*row["y0"]) - row["y0"]*(0.3*row["x0"] - 2*row["y0"]))
                    for row in rows)
        report.check(abs(turn(rows)/start - 1) < 5e-3, f"disk_{space}: turns {turn(rows)/start}")


def falls(report):
    """Gravity does the work that a fall says."""
    result = run("falls", disk(2, more="gravity (0,-3)"))
    if report.finished(result, "falls"):
        first, last = result.table("history.csv")[0], result.table("history.csv")[-1]
        rows = result.table("particles_end.csv")
        work = sum(-3*row["mass"]*(row["y"] - row["y0"]) for row in rows)
        report.check(abs(last["external_work"]/work - 1) < 0.01, f"falls: work {last['external_work']} of {work}")
        report.check(abs(last["energy_remainder"]) < 1e-12*first["kinetic_energy"], "falls: remainder")


# A bar that a force pulls at its end, slowly beside its waves.
PULLED = """
dimension 2
grid cell=0.25 x=0:open y=open
wall x-=slip
method sgmp mass=consistent
time end={end} cfl={cfl}
{damping}
material m elastic density=1 young=100 poisson=0.3
body bar block material=m lower=(0,-0.5) upper=(4,0.5) ppc=2
load bar where="x>3.5" x="{force}"
history every={end}/20
output csv at=end fields=mass,initial_position
"""


def pulled(report):
    """The work of a force is that along the ways of what it acts on, and all of it is found again: in motion, in
    stress, and in what of the forces particles do not feel."""
    sudden = run("sudden", PULLED.format(end=0.6, cfl=0.03, damping="", force="0.5"))
    if report.finished(sudden, "sudden"):
        rows = [row for row in sudden.table("particles_end.csv") if row["x0"] > 3.5]
        work = 0.5*sum(row["x"] - row["x0"] for row in rows)/len(rows)
        found = sudden.table("history.csv")[-1]["external_work"]/work
        report.check(abs(found - 1) < 2e-3, f"sudden: work {found} of that of its way")
    for name, damping in (("slow", ""), ("damped", "damping rate=1")):
        result = run(name, PULLED.format(end=20, cfl=0.3, damping=damping, force="0.5*min(t/10,1)"))
        if not report.finished(result, name):
            continue
        last = result.table("history.csv")[-1]
        report.check(last["unfelt_dissipation"] > 1e-6*last["external_work"], f"{name}: unfelt {last}")
        report.check(abs(result["energy.drift"]) < 2e-3, f"{name}: drift {result['energy.drift']}")


def bits(report):
    """Threads, ranks and a restart, with contact in the plane."""
    for name, deck in (("plane", disk(2, more=SECOND, end=0.6)), ("space", disk(3, end=0.4)),
                       ("plain", disk(2, "mass=consistent rotation=plain surfaces=plain", end=0.4)),
                       ("turns", disk(2, "mass=consistent surfaces=plain", end=0.4)),
                       ("turns_space", disk(3, "mass=consistent surfaces=plain", end=0.3)),
                       ("first", disk(2, "mass=consistent update=usf", end=0.4)),
                       ("both", disk(2, "mass=consistent update=usavg", more=SECOND, end=0.4))):
        result = straight(report, name, deck)
        if not result.summary:
            continue
        rows = result.table("history.csv")
        report.check(max(abs(row["energy_remainder"]) for row in rows) < 1e-12*rows[0]["kinetic_energy"],
                     f"{name}: remainder {rows[-1]['energy_remainder']}")
        for other, threads, launcher in (("threads", 2, ()), ("ranks", 1, mpirun(2))):
            again = straight(report, f"{name}_{other}", deck, threads, launcher)
            report.check(again.summary and again["checksum"] == result["checksum"], f"{name}: other bits, {other}")
        goes_on(report, result, f"{name}_again", deck, checkpoints(os.path.join(SCRATCH, name))[0])


def chosen(report):
    """What a deck without the word gets."""
    short = disk(2, "{words}").replace("end=1 cfl=0.4", "steps=2 {time}").replace("every=1/20", "every=1")
    # A metal springs back where speeds stay below Y/sqrt(rho E) and loads below Y over the square of the slenderness.
    yields = short.replace("neo_hookean density=1", "j2 yield=1 density=1")
    strong = yields.replace("yield=1", "yield=33")
    slim = strong.replace("cylinder", "block").replace("centre=(0.03,0.05) radius=1", "lower=(-1,-0.25) upper=(1,0.25)")
    press = "pressure disk face=x+ p=3*t\n"
    for name, deck, words, time, mass in (
        ("elastic", short, "", "", "consistent"), ("usavg", short, "update=usavg", "", "consistent"),
        ("usf", short, "update=usf", "", "lumped"), ("usl", short, "update=usl", "", "lumped"),
        ("courant", short, "", "cfl=0.9", "lumped"), ("auto", short, "", "cfl=auto", "consistent"),
        ("step", short, "", "dt=1e-4", "lumped"), ("paper", short, "stress=plain", "", "lumped"),
        ("paper_surfaces", short, "surfaces=plain", "", "lumped"),
        ("mpm", short.replace("sgmp", "mpm"), "", "", "lumped"),
        ("asked", short, "mass=lumped", "", "lumped"), ("split", short, "split=0.75", "", "lumped"),
        ("metal", yields, "", "", "lumped"), ("metal_strong", strong, "", "", "consistent"),
        ("metal_quick", strong.replace("yield=33", "yield=30"), "", "", "lumped"),
        ("metal_heavy", strong + "gravity (0,-17)\n", "", "", "lumped"),
        ("metal_light", strong + "gravity (0,-16)\n", "", "", "consistent"),
        ("metal_pressed", strong + press, "", "end=10.9", "consistent"),
        ("metal_crushed", strong + press, "", "end=11.1", "lumped"),
        ("slim_pressed", slim + press, "", "end=0.68", "consistent"),
        ("slim_crushed", slim + press, "", "end=0.69", "lumped"),
        ("metal_pulled", strong + 'load disk where="x>0" x=0.001\n', "", "", "lumped"),
        ("metal_driven", strong + "bodyforce disk x=0.001\n", "", "", "lumped"),
        ("metal_asked", yields, "mass=consistent", "", "consistent"),
        ("soil", short.replace("neo_hookean density=1", "drucker_prager friction=30 density=1"), "mass=consistent", "",
         "lumped"),
        ("fails", yields + "failure m pmin=-1\n", "mass=consistent", "", "lumped"),
        ("contact", short.replace("{more}", SECOND) + SECOND, "", "", "lumped"),
    ):
        result = run(f"chosen_{name}", deck.replace("{words}", words).replace("{time}", time))
        if report.finished(result, f"chosen_{name}"):
            report.check(result["mass"] == mass, f"chosen_{name}: {result['mass']}, not {mass}")
    liquid = run("chosen_liquid", short.replace("{words}", "mass=consistent").replace("{time}", "").replace(
        "neo_hookean density=1 young=100 poisson=0.3", "fluid density=1\neos m tait c0=10"))
    if report.finished(liquid, "chosen_liquid"):
        report.check(liquid["mass"] == "lumped", f"chosen_liquid: {liquid['mass']}")


def main():
    report = Report()
    waves(report)
    conserved(report)
    falls(report)
    pulled(report)
    bits(report)
    chosen(report)
    report.end()


if __name__ == "__main__":
    main()
