#!/usr/bin/env python3
"""Particles that move with the velocity that strains them: bodies with free surfaces keep their tension, at rest and as
a grip pulls them; which scenes get it without a word; the same bits with threads and ranks, and after a restart.

usage: drift.py SGMP SOURCE_DIR SCRATCH_DIR

Expected values are those of equilibrium and of Hooke's law.
"""
import math
import os

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

TENSION = 0.1  # over Young's modulus
REST = """
dimension 2
grid cell=1 x=0:20
wall x-=slip x+=slip
method sgmp{words}
time end=1200 cfl=0.4
material stuff elastic density=1 young=1 poisson=0
body strip block material=stuff lower=(0,0.25) upper=(20,4.25) spacing=0.5 jitter=0.01
initial_stress strip xx=0.1
history every=60
"""
# Five cells wide; its upper end is pulled away to a strain of 3 %, in many times its time of oscillation.
PULLED = """
dimension 2
grid cell=1 x=open y=open
method {method}
time end=800 cfl=0.4
material stuff elastic density=1 young=1 poisson=0
body strip block material=stuff lower=(-2.3,-14) upper=(2.7,14) spacing=0.5
motion strip where="y<-10" x=0 y=0
motion strip where="y>10" x=0 y="0.6/800*(t<800)"
history every=80
output csv at=end fields=stress
checkpoint every=900
"""


def rest(report):
    """Kinetic energy over the elastic one, and what is left of that."""
    for words, stays in (("", True), (" drift=plain", False), (" update=usavg", True), (" stress=normalised", True)):
        name = "rest" + words.replace(" ", "_").replace("=", "_")
        result = run(name, REST.format(words=words))
        if not report.finished(result, name):
            continue
        rows = result.table("history.csv")
        elastic = 0.5*TENSION**2*20*4
        moving = rows[-1]["kinetic_energy"]/elastic
        lost = (rows[0]["internal_energy"] - rows[-1]["internal_energy"])/elastic
        if stays:
            report.check(moving < 1e-4 and abs(lost) < 1e-3, f"{name}: kinetic {moving}, lost {lost} of it")
        else:  # what the cure is there for
            report.check(moving > 0.01, f"{name}: kinetic {moving}: nothing to cure")
        report.check(result["drift"] == ("remapped" if stays else "plain"), f"{name}: drift {result['drift']}")


def pulled(report):
    """Stress in the middle of a strip in a testing machine, and how much of it is noise."""
    deck = PULLED.format(method="sgmp")
    result = straight(report, "pulled", deck)
    if not result.summary:
        return
    inside = [row["stress_yy"] for row in result.table("particles_end.csv") if abs(row["y"]) < 5]
    mean = sum(inside)/len(inside)
    noise = math.sqrt(sum((stress - mean)**2 for stress in inside)/len(inside))
    report.check(abs(mean/math.log(1 + 0.6/20) - 1) < 0.03, f"pulled: stress {mean}")
    report.check(noise < 0.05*mean, f"pulled: stress is off its mean by {noise/mean}")
    for name, threads, launcher in (("pulled_threads", 2, ()), ("pulled_ranks", 1, mpirun(2))):
        other = straight(report, name, deck, threads, launcher)
        report.check(other.summary and other["checksum"] == result["checksum"], f"{name}: other bits")
    goes_on(report, result, "pulled_again", deck, checkpoints(os.path.join(SCRATCH, "pulled"))[0])


def moments(rows):
    """Velocity along x and spin about the middle of some particles."""
    mass = sum(row["mass"] for row in rows)
    x, y, u, v = (sum(row["mass"]*row[key] for row in rows)/mass for key in ("x", "y", "velocity_x", "velocity_y"))
    turn = sum(row["mass"]*((row["x"] - x)*(row["velocity_y"] - v) - (row["y"] - y)*(row["velocity_x"] - u))
               for row in rows)/sum(row["mass"]*((row["x"] - x)**2 + (row["y"] - y)**2) for row in rows)
    return u, turn


def chosen(report):
    """What a deck without the word gets."""
    short = PULLED.replace("time end=800", "time steps=2").replace("checkpoint every=900\n", "")
    for method, drift in (("sgmp", "remapped"), ("sgmp update=usavg", "remapped"), ("sgmp update=usf", "plain"),
                          ("sgmp update=usl", "plain"), ("sgmp stress=plain", "plain"), ("sgmp volumes=kept", "plain"),
                          ("sgmp stress=plain drift=remapped", "remapped"), ("mpm", "plain"), ("gimp", "plain"),
                          ("mpm drift=remapped", "remapped"), ("bspline update=usavg drift=remapped", "remapped")):
        name = "chosen_" + method.replace(" ", "_").replace("=", "_")
        result = run(name, short.format(method=method))
        if report.finished(result, name):
            report.check(result["drift"] == drift, f"{name}: drift {result['drift']}, not {drift}")
    gas = run("chosen_gas", short.format(method="sgmp").replace(
        "elastic density=1 young=1 poisson=0", "fluid density=1\neos stuff ideal_gas gamma=1.4 energy0=1"))
    if report.finished(gas, "chosen_gas"):
        report.check(gas["drift"] == "plain", f"chosen_gas: drift {gas['drift']}")


ROLLS = """
dimension 2
grid cell=0.2 x=-1:open y=-1:3
method sgmp
time end=1 cfl=0.5
gravity (5,-8.660254)
material m elastic density=1 young=1e5 poisson=0.3
body wheel sphere material=m centre=(0,1) radius=1 ppc=2
body slope block material=m lower=(-1,-0.6) upper=(4,0) ppc=2
rigid slope
contact wheel slope friction=0.4
history every=0.1
"""


def rolls(report):
    """A wheel rolls down as far as a rigid one, by the program's own choice. Beside friction in contact rotation is
    exact where gravity presses a solid or something round springs back, a metal too where it is slow and nothing drives
    it on, but not about parts that a card motion moves."""
    result = run("rolls", ROLLS)
    if report.finished(result, "rolls"):
        rows = [row for row in result.table("bodies.csv") if row["name"].strip() == "wheel"]
        way = (rows[-1]["x"] - rows[0]["x"])/(10*0.5/3)
        report.check(abs(way - 1) < 0.02, f"rolls: {way} of a rigid wheel's way")
        report.check(result["rotation"] == "exact", f"rolls: rotation {result['rotation']}")
    for shape in ("sphere", "cylinder"):
        result = run(f"rolls_{shape}", ROLLS.replace("sphere", shape).replace("friction=0.4", "friction=0.1"))
        report.check(result.summary and result["verdict"] == "coarse" and "rolls or slides" in result.text,
                     f"rolls_{shape}: {result.text}")
    block = ROLLS.replace("sphere material=m centre=(0,1) radius=1", "block material=m lower=(-1,0) upper=(1,1)")
    flies = ROLLS.replace("gravity (5,-8.660254)\n", "")
    metal = flies.replace("elastic density=1", "j2 yield=1e3 density=1")
    slow, quick = (metal + f"velocity wheel x={speed}\n" for speed in (3.1, 3.2))  # Y/sqrt(rho E) is 3.16
    driven = metal.replace("rigid slope", "rigid slope x=0.001")
    moved = block.replace("rigid slope", 'motion slope where="y<-0.3" x=0 y=0')
    other = block + "body far block material=m lower=(20,1) upper=(21,2) ppc=2\nmotion far where=1 x=0 y=0\n"
    for name, deck, rotation in (("block", block, "exact"), ("flies", flies, "exact"), ("metal", metal, "exact"),
                                 ("slow", slow, "exact"), ("quick", quick, "plain"), ("driven", driven, "plain"),
                                 ("moved", moved, "plain"), ("other", other, "exact")):
        result = run(f"rolls_{name}", deck.replace("end=1", "end=0.01"))
        if report.finished(result, f"rolls_{name}"):
            report.check(result["rotation"] == rotation, f"rolls_{name}: rotation {result['rotation']}")


FLOORS = """
dimension {space}
grid cell=0.2 x=-2:open {floor}
wall {face}=slip reactions=yes
wallfriction {face} friction=0.4
method sgmp
time end=1.2 cfl=0.5
gravity ({along},{down})
material m elastic density=1 young=1e5 poisson=0.3
body wheel {shape} radius=1 ppc=2
history every=0.1
output csv at=end fields=velocity,mass
checkpoint every=300
"""


def floors(report):
    """What rolls down a rough floor does so as a rigid one: it rests on its round surface, not on the facets of its
    lattice, and friction acts there. On facets, with friction at the centres of particles, a disk of ten cells across
    came as far as 0.72 of the way on 10 degrees."""
    disk, floor = "cylinder material=m centre=(0,1)", "y=0:open"
    for name, space, shape, face, slope, allowed in (
        ("below", 2, disk, "y-", 10, 0.05), ("above", 2, disk.replace("(0,1)", "(0,-1)"), "y+", 10, 0.05),
        ("ball", 3, "sphere material=m centre=(0,1,0)", "y-", 30, 0.03), ("tube", 2, disk, "y-", 30, 0.03),
    ):
        along, down = 10*math.sin(math.radians(slope)), -10*math.cos(math.radians(slope))
        shape, inertia = (shape, 0.4) if space == 3 else (shape, 0.5)
        if name == "tube":
            shape, inertia = shape.replace("cylinder", "ring").replace("centre", "inner=0.4 centre"), 0.5*(1 + 0.4**2)
        if face == "y+":
            floor, down = "y=open:0", -down
        else:
            floor = "y=0:open"
        deck = FLOORS.format(space=space, floor=floor, face=face, along=along, down=down, shape=shape)
        result = straight(report, f"floors_{name}", deck)
        if not result.summary:
            continue
        rows = result.table("bodies.csv")
        speed = along/(1 + inertia)*1.2
        way = (rows[-1]["x"] - rows[0]["x"])/(0.6*speed)
        velocity, spin = moments(result.table("particles_end.csv"))
        report.check(abs(way - 1) < allowed, f"floors_{name}: {way} of a rigid wheel's way")
        report.check(abs(velocity/speed - 1) < allowed, f"floors_{name}: {velocity/speed} of its velocity")
        report.check(abs(abs(spin)/speed - 1) < 0.05, f"floors_{name}: {spin/speed} of its spin")
        report.check(abs(result["energy"]["drift"]) < 1e-3, f"floors_{name}: drift {result['energy']['drift']}")
        pushed = result.table("history.csv")[-1][f"wall_{face}_impulse_x"]
        gained = rows[-1]["mass"]*(velocity - along*1.2)
        report.check(abs(pushed/gained - 1) < 1e-3, f"floors_{name}: momentum {gained}, wall {pushed}")
        if name != "below":
            continue
        short = deck.replace("time end=1.2", "time end=0.15").replace("every=300", "every=50")
        begun = straight(report, "floors_short", short)
        for other, threads, launcher in (("threads", 2, ()), ("ranks", 1, mpirun(2))):
            again = straight(report, f"floors_{other}", short, threads, launcher)
            report.check(again.summary and again["checksum"] == begun["checksum"], f"floors_{other}: other bits")
        goes_on(report, begun, "floors_again", short, checkpoints(os.path.join(SCRATCH, "floors_short"))[0])
        plain = run("floors_plain", deck.replace("method sgmp", "method sgmp rotation=plain"))
        report.check(plain.summary and "its way wants rotation=exact" in plain.text, f"floors_plain: {plain.text}")
        fallen = run("floors_fallen", deck.replace("centre=(0,1)", "centre=(0,1.3)"))
        report.check(fallen.summary and fallen["verdict"] == "coarse" and "falls on" in fallen.text,
                     f"floors_fallen: {fallen.text}")


RUBS = """
dimension 2
grid cell=1/8{floor}
method sgmp
time end=90 cfl=0.5
material m elastic density=1 young=1 poisson=0.3
body ball sphere material=m radius=1 ppc=2
velocity ball x=0.03 y=-0.01
{ground}
history steps=50
output csv at=end fields=velocity,mass
"""


def rubs(report):
    """A disk that bounces off a plate or a wall with friction and slides throughout: what it loses along the plate is
    the friction times what it gets across it, and its spin is twice that over its radius."""
    plate = "body plate block material=m lower=(-2,-1.5) upper=(5,-1.1) ppc=2\nrigid plate\n"
    for name, floor, ground in (("plate", "", plate + "contact ball plate friction=0.3"),
                                ("wall", " y=-1.3:open", "wall y-=slip\nwallfriction y- friction=0.3")):
        result = run(f"rubs_{name}", RUBS.format(floor=floor, ground=ground))
        if not report.finished(result, f"rubs_{name}"):
            continue
        rows = [row for row in result.table("particles_end.csv") if row["body"] == 1]
        u, turn = moments(rows)
        v = sum(row["mass"]*row["velocity_y"] for row in rows)/sum(row["mass"] for row in rows)
        kick = 0.3*(v + 0.01)
        report.check(abs((0.03 - u)/kick - 1) < 0.02, f"rubs_{name}: lost {0.03 - u}, not {kick}")
        report.check(abs(-turn/(2*kick) - 1) < (0.05 if name == "plate" else 0.06),
                     f"rubs_{name}: spin {turn}, not {-2*kick}")


def main():
    report = Report()
    for check in (rest, pulled, chosen, rolls, floors, rubs):
        check(report)
    report.end()


if __name__ == "__main__":
    main()
