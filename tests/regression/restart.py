#!/usr/bin/env python3
"""A run that goes on from a checkpoint ends with the bits, and leaves the files, of a run without interruption.

usage: restart.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os

from _restarts import FULL, checkpoints, command, deck, execute, goes_on, mpirun, same_files, straight
from _runs import (AVERAGED, CONE, DRAGGED, ERODING, FAILING, FLUIDS, KEPT_PLANE, METALS, OPEN_AIR, REFERENCE,
                   REFERENCE_SPACE, RUBBED, SCATTERED, SEAT, SPLIT, SPLIT_SPACE, SWIRL, Report, own)

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
output vtu every=0.004
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
AUTOMATIC = LEAVING.replace("time end=0.012 cfl=0.5",
                            "time steps=400 cfl=auto").replace("x=0:8", "x=open") + "history steps=20\n"
AUTOMATIC = AUTOMATIC.replace("history every=0.001\n", "")

# Ends where the kinetic energy has fallen to a part of its maximum, which was at the start.
CALMING = """
dimension 1
grid cell=0.05 x=0:1
wall x-=fixed x+=fixed
time end=1 cfl=0.2
material m elastic density=4 young=16 poisson=0
body b block material=m lower=0 upper=1
velocity b x="1e-4*sin(pi*x)"
stop kinetic_below=0.04
"""
# Steps that grow as fast as they may.
GROWING = """
dimension 1
grid cell=0.5 x=0:open
wall x-=fixed
time cfl=0.4 growth=1.02 steps=60
material gas explosive density=2 detonation_speed=1e6
eos gas jwl a=300 b=3 r1=4 r2=1 omega=0.3 energy0=7
body b block material=gas lower=0 upper=2 ppc=2
detonation point=(0,0,0)
"""
# Nodes are light beside a particle that has left the grid by the time of the checkpoint.
LIGHT = LEAVING.replace("body b", "material lead elastic density=0.04 young=210 poisson=0.3\nmethod sgmp "
                        "mass_cutoff=0.05\nbody gone block material=lead lower=(7,6) upper=(8,7) spacing=0.5\nvelocity "
                        "gone x=900\nbody b")

# A block that moves past edges that let waves out, across the planes that ranks own, between two of its kind.
ABSORBING = """
parameter method = sgmp
parameter update = musl
dimension 3
grid cell=1 x=0:8 y=0:6 z=0:9
wall x-=slip x+=absorbing y+=absorbing z-=absorbing z+=absorbing
method $method update=$update
time steps=40 cfl=0.5
gravity (0,0,-1e-4)
material m elastic density=1 young=1 poisson=0.3
body b block material=m lower=(0,0,0) upper=(8,6,9) ppc=2
velocity b x="0.05*exp(-((x-4)^2+(y-3)^2+(z-4)^2)/4)" z="0.05*cos(z)"
initial_stress b surface=9
history steps=5
output csv at=end
"""

# More particles than a checkpoint writes at a time.
MANY = """
dimension 1
grid cell=1 x=0:5000
time dt=0.1 steps=10
material m elastic density=1 young=1 poisson=0
body b block material=m lower=0 upper=5000 ppc=2
velocity b x="sin(0.01*x)+0.1*sin(3*x)"
output csv at=end
"""

# name, deck, settings, what a straight run takes in steps, threads after the restart
SCENES = [
    ("block", deck("block.inp", EVERYTHING), {"cells": 5, "steps": 40, "drift": 0.3, "jitter": 0.4}, 40, 2),
    ("johnson_cook", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "material": "johnson_cook"}, 30, 1),
    ("normalised", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "stress": "normalised"}, 30, 2),
    ("rotation", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "jitter": 0.4, "rotation": "exact"}, 30, 2),
    ("rotation_usf", deck("block.inp"), {"cells": 5, "steps": 30, "drift": 0.3, "jitter": 0.4, "rotation": "exact",
                                         "update": "usf"}, 30, 2),
    ("taylor_bar", deck("taylor_bar.inp"), {"h": 1.9, "t_end": 0.01, "cfl": 1, "material": "full"}, 26, 2),
    ("rings_of_a_bar", deck("taylor_bar_axisymmetric.inp", "gauge foot point=(0,0)\n"),
     {"h": 0.76, "t_end": 0.01, "cfl": 1, "material": "full"}, 66, 2),
    ("beam", deck("beam.inp", "output tecplot every=t_end/20\n"), {"h": 1.25, "t_end": 0.003}, 120, 3),
    ("bar", deck("bar.inp"), {"cells": 32, "steps": 200, "dt": 1e-3, "v0": 1}, 200, 1),
    ("tnt_slab", deck("tnt_slab.inp"), {"h": 2, "t_end": 0.006}, 180, 1),
    ("rings", deck("rings.inp"), {"h": 4, "speed": 30, "t_end": 0.4}, 60, 2),
    ("sphere_slope", deck("sphere_slope.inp"), {"h": 0.8, "young": 1.24e7, "t_end": 0.2}, 30, 2),
    ("leaving", LEAVING, {}, 10, 2),
    ("reflected", LEAVING.replace("policy = remove", "policy = reflect"), {}, 10, 1),
    ("automatic", AUTOMATIC, {}, 400, 2),
    ("push", PUSH, {}, 20, 2),
    ("cone", CONE, {}, 300, 2),
    ("seat", SEAT, {}, 60, 2),
    ("swirl", SWIRL, {}, 60, 2),
    ("dragged", DRAGGED, {}, 30, 2),
    ("rubbed", RUBBED, {"update": "usavg"}, 30, 2),
    ("fluids", FLUIDS, {}, 40, 2),
    ("failing", FAILING, {}, 80, 2),
    ("averaged", AVERAGED.replace("end=t_end", "steps=800"), {}, 800, 2),
    ("metals", METALS, {}, 80, 2),
    ("scattered", SCATTERED, {}, 80, 2),
    ("eroding", ERODING, {}, 80, 2),
    ("absorbing", ABSORBING, {}, 40, 2),
    ("open_air", OPEN_AIR, {}, 100, 2),
    ("kept", KEPT_PLANE, {}, 80, 2),
    ("reference", REFERENCE, {}, 80, 2),
    ("reference_space", REFERENCE_SPACE, {"method": "mpm"}, 30, 1),
    ("split", SPLIT, {}, 60, 2),
    ("split_space", SPLIT_SPACE, {}, 16, 1),
    ("calming", CALMING, {}, 40, 1),
    ("growing", GROWING, {}, 60, 1),
    ("light", LIGHT, {}, 10, 1),
    ("many", MANY, {}, 10, 1),
]
EVERY_UPDATE = {"bar": ("sgmp",), "block": ("sgmp", "gimp"), "rings": ("sgmp",)}
EVERY_METHOD = ("block", "rings", "bar")


def variants(name):
    """Methods and updates with which a scene is run."""
    yield "sgmp", "musl"
    for update in ("usf", "usl", "usavg"):
        for method in EVERY_UPDATE.get(name, ()):
            yield method, update
    for method in ("gimp", "mpm", "cpgimp", "bspline") if name in EVERY_METHOD else ():
        yield method, "musl"


def other_ranks(report):
    """Checkpoints of some ranks, continued by others."""
    wanted = {"block", "leaving", "push", "split_space"}
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
            for before, after, threads in ((1, 2, 1), (3, 1, 2),
                                           (2, 3, 1)) if FULL or method == "sgmp" else ((2, 3, 1),):
                source = None
                if before > 1:
                    source = straight(report, f"{title}_{before}", card, launcher=mpirun(before), **settings, **choice)
                goes_on(report, reference, f"{title}_{before}_{after}", card, middle, threads, mpirun(after), source,
                        **settings, **choice)


def kept(report):
    """As many checkpoints are kept as the deck says, the last ones; two where it says nothing."""
    for keep, expected in (("", 2), (" keep=1", 1), (" keep=3", 3)):
        result = straight(report, "kept", deck("block.inp", f"checkpoint every=4{keep}\n"), cells=4, steps=26)
        steps = [*range(4, 26, 4), 26]
        report.check(checkpoints(result.folder) == steps[-expected:], f"keep{keep}: {checkpoints(result.folder)}")


def other_fields(report):
    """A field that particles.vtkhdf does not have: the restart is refused, and the steps that it has stay as they
    are."""
    card = "output vtkhdf every=5e-4 fields=stress\ncheckpoint every=10\n"
    reference = straight(report, "fields", deck("block.inp", card), cells=4, steps=20)
    path = os.path.join(reference.folder, "particles.vtkhdf")
    result = execute(command("fields", deck("block.inp", card.replace("=stress", "=stress,density")),
                             ["--restart", "latest"],
                             {"cells": 4, "steps": 40}), "fields")
    report.check(result.code == 5 and path in result.text and "density" in result.text,
                 f"other fields: {result.code}\n{result.text}")
    result = execute(command("fields", deck("block.inp", card), ["--restart", "latest"], {"cells": 4, "steps": 40}),
                     "fields")
    whole = straight(report, "fields_whole", deck("block.inp", card), cells=4, steps=40)
    if report.finished(result, "the same fields"):
        same_files(report, whole.folder, result.folder, "the same fields")


def main():
    """Straight and interrupted runs of all scenes."""
    report = Report()
    for other in own((other_ranks, kept, other_fields)):
        other(report)
    for (name, text, settings, steps, threads), (method, update) in own((scene, variant) for scene in SCENES
                                                                        for variant in variants(scene[0])):
        choice = {"method": method, "update": update} if "include" in text else {}
        title = f"{name}_{method}_{update}"
        card = text + f"checkpoint every={max(2, steps//5)} keep=100\n"
        reference = straight(report, title, card, **{**choice, **settings})
        saved = checkpoints(reference.folder)
        if report.check(len(saved) > 2, f"{title}: {reference.text} only the checkpoints {saved} of {steps} steps"):
            goes_on(report, reference, title + "_restarted", card, saved[len(saved)//2 - 1], threads,
                    **{**choice, **settings})
    report.end()


main()
