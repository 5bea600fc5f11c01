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
    """A wheel rolls down as far as a rigid one, by the program's own choice; what does not roll has no exact rotation
    beside friction."""
    result = run("rolls", ROLLS)
    if report.finished(result, "rolls"):
        rows = [row for row in result.table("bodies.csv") if row["name"].strip() == "wheel"]
        way = (rows[-1]["x"] - rows[0]["x"])/(10*0.5/3)
        report.check(abs(way - 1) < 0.02, f"rolls: {way} of a rigid wheel's way")
        report.check(result["rotation"] == "exact", f"rolls: rotation {result['rotation']}")
    block = ROLLS.replace("sphere material=m centre=(0,1) radius=1", "block material=m lower=(-1,0) upper=(1,1)")
    for name, deck in (("block", block), ("flies", ROLLS.replace("gravity (5,-8.660254)\n", ""))):
        result = run(f"rolls_{name}", deck.replace("end=1", "end=0.01"))
        if report.finished(result, f"rolls_{name}"):
            report.check(result["rotation"] == "plain", f"rolls_{name}: rotation {result['rotation']}")


def main():
    report = Report()
    for check in (rest, pulled, chosen, rolls):
        check(report)
    report.end()


if __name__ == "__main__":
    main()
