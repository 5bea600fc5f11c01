#!/usr/bin/env python3
"""A run that goes on from a checkpoint ends with the bits, and leaves the files, of a run without interruption.

usage: restart.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _restarts import FULL, checkpoints, deck, goes_on, mpirun, straight
from _runs import Report

EVERYTHING = "output vtkhdf\noutput vtu fields=stress,displacement\noutput tecplot\ngauge middle point=(0.5,0.5,0.5)\n"
# Particles leave the grid on two sides, where they are dropped or turned back.
LEAVING = """
parameter policy = remove
dimension 2
grid cell=1 x=0:8 y=0:open
wall y-=slip
lost $policy
time end=0.012 cfl=0.5
material m elastic density=7.85e-3 young=210 poisson=0.3
body b block material=m lower=(1,0) upper=(6,4) spacing=0.5
velocity b x="300" y="-40"
bodyforce b x="1e3*sin(x0)" y="1e3*t*x"
history every=0.001
output vtkhdf every=0.0025 fields=initial_position,stress
output vtu every=0.0025
"""
# Two bodies at rest and one that is pushed, friction, a wall that moves.
PUSH = """
dimension 3
grid cell=1
time end=0.02 cfl=0.5
material m elastic density=7.85e-3 young=2100 poisson=0.3
body punch block material=m lower=(-2,0,0) upper=(0,3,3) spacing=0.5
body first block material=m lower=(0,0,0) upper=(3,3,3) spacing=0.5
body second block material=m lower=(3.6,0.4,0.4) upper=(6,3,3) spacing=0.5
rigid punch x="100*cos(50*t)" y="10"
contact all friction=0.3
history every=0.002
"""

# The Courant number is found anew behind the restart.
AUTOMATIC = LEAVING.replace("time end=0.012 cfl=0.5", "time steps=400 cfl=auto").replace("x=0:8", "x=open") + "history steps=20\n"
AUTOMATIC = AUTOMATIC.replace("history every=0.001\n", "")

# name, deck, settings, what a straight run takes in steps, threads after the restart
SCENES = [
    ("block", deck("block.inp", EVERYTHING), {"cells": 5, "steps": 40, "drift": 0.3, "jitter": 0.4}, 40, 2),
    ("johnson_cook", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "material": "johnson_cook"}, 30, 1),
    ("normalised", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "stress": "normalised"}, 30, 2),
    ("carried", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "jitter": 0.4, "carry": "carried"}, 30, 2),
    ("taylor_bar", deck("taylor_bar.inp"), {"h": 1.9, "t_end": 0.01, "cfl": 1, "material": "full"}, 26, 2),
    ("beam", deck("beam.inp", "output tecplot every=t_end/20\n"), {"h": 1.25, "t_end": 0.003}, 120, 3),
    ("bar", deck("bar.inp"), {"cells": 32, "steps": 200, "dt": 1e-3, "v0": 1}, 200, 1),
    ("tnt_slab", deck("tnt_slab.inp"), {"h": 2, "t_end": 0.006}, 180, 1),
    ("rings", deck("rings.inp"), {"h": 4, "speed": 30, "t_end": 0.4}, 60, 2),
    ("sphere_slope", deck("sphere_slope.inp"), {"h": 0.8, "young": 1.24e7, "t_end": 0.2}, 30, 2),
    ("leaving", LEAVING, {}, 10, 2),
    ("reflected", LEAVING.replace("policy = remove", "policy = reflect"), {}, 10, 1),
    ("automatic", AUTOMATIC, {}, 400, 2),
    ("push", PUSH, {}, 20, 2),
]
EVERY_UPDATE = {"bar": ("sgmp",), "block": ("sgmp", "gimp"), "rings": ("sgmp",)}
EVERY_METHOD = ("block", "rings", "bar")


def variants(name):
    """Methods and updates with which a scene is run."""
    yield "sgmp", "musl"
    for update in ("usf", "usl", "usavg"):
        for method in EVERY_UPDATE.get(name, ()):
            yield method, update
    for method in ("gimp", "mpm", "cpgimp") if name in EVERY_METHOD else ():
        yield method, "musl"


def other_ranks(report):
    """Checkpoints of some ranks, continued by others."""
    wanted = {"block", "leaving", "push"}
    if FULL:
        wanted |= {"normalised", "taylor_bar", "bar", "automatic", "rings", "sphere_slope"}
    for name, text, settings, steps, _ in SCENES:
        if name not in wanted:
            continue
        for method in ("sgmp", "gimp", "mpm") if name in ("block", "rings") else ("sgmp",):
            choice = {"method": method} if "include" in text else {}
            card = text + f"checkpoint every={max(2, steps//5)} keep=100\n"
            title = f"ranks_{name}_{method}"
            reference = straight(report, title, card, **settings, **choice)
            middle = checkpoints(reference.folder)[1]
            for before, after, threads in ((1, 2, 1), (3, 1, 2), (2, 3, 1)) if FULL or method == "sgmp" else ((2, 3, 1),):
                source = None
                if before > 1:
                    source = straight(report, f"{title}_{before}", card, launcher=mpirun(before), **settings, **choice)
                goes_on(report, reference, f"{title}_{before}_{after}", card, middle, threads, mpirun(after), source,
                        **settings, **choice)


def main():
    """Straight and interrupted runs of all scenes."""
    report = Report()
    other_ranks(report)
    for name, text, settings, steps, threads in SCENES:
        for method, update in variants(name):
            choice = {"method": method, "update": update} if "include" in text else {}
            title = f"{name}_{method}_{update}"
            card = text + f"checkpoint every={max(2, steps//5)} keep=100\n"
            reference = straight(report, title, card, **settings, **choice)
            saved = checkpoints(reference.folder)
            if report.check(len(saved) > 2, f"{title}: {reference.text} only the checkpoints {saved} of {steps} steps"):
                goes_on(report, reference, title + "_restarted", card, saved[len(saved)//2 - 1], threads, **settings, **choice)
    report.end()


main()
