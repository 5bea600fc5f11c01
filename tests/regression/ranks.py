#!/usr/bin/env python3
"""The same bits for every layout of ranks and threads: particles, energies, histories and files.

With SGMP_TEST_FULL in the environment (`make test-full`) the decks of input/, with all methods and updates.

usage: ranks.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import concurrent.futures
import filecmp
import json
import os
import re
import subprocess

from _runs import (AVERAGED, CONE, DRAGGED, ENVIRONMENT, ERODING, FAILING, FLUIDS, FULL, HOOPS, INPUT, KEPT_PLANE,
                   KEPT_RINGS, KEPT_SPACE, METALS, OPEN_AIR, REFERENCE, REFERENCE_SPACE, RUBBED, SCRATCH, SCATTERED,
                   SEAT, SGMP, SPLIT, SPLIT_GAS, SPLIT_RINGS, SPLIT_SPACE, SWIRL, Report, Run, own)

# Ranks and threads. Three ranks have one between two others; where cuts move, four are more than it takes.
LAYOUTS = [(1, 1), (2, 1), (3, 1), (4, 1), (2, 2)] if FULL else [(1, 1), (2, 2), (4, 1)]
FEW = [(1, 1), (2, 1), (3, 2)] if FULL else [(1, 1), (3, 2)]
LEAST = [(1, 1), (3, 2)]
MPI = {**ENVIRONMENT, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
       "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "OMPI_MCA_mpi_yield_when_idle": "1"}
MPI.pop("OMPI_MCA_ess_singleton_isolated", None)

# A charge between walls on both sides of the slowest axis: folding and mirror images near the cuts.
WALLS = """
parameter method = sgmp
parameter update = musl
parameter rotation = plain
parameter stress = plain
dimension {dimension}
grid cell=1 x=0:open y=0:{top}{z}
wall x-=fixed y-=slip {walls}
method $method update=$update rotation=$rotation stress=$stress
time end=0.0012 cfl=0.3
material tnt explosive density=1.63e-3 detonation_speed=6930 burn_cells=2
eos tnt jwl a=371200 b=3210 r1=4.15 r2=0.95 omega=0.30 energy0=6993
viscosity tnt quadratic=1.5 linear=0.06
body charge block material=tnt lower=(0,0,0) upper=({size}) spacing=0.5
detonation point=(0,0,0)
output csv at=end fields=stress,density,displacement,initial_position
output vtu every=0.0005 fields=stress,pressure
output tecplot every=0.0007
output vtkhdf every=0.0005 fields=stress
history every=0.0001
gauge near point=({near})
gauge far point=({size})
"""
PLANE = WALLS.format(dimension=2, near="1,1", top=18, z="", walls="y+=slip", size="10,18,0")
SPACE = WALLS.format(dimension=3, near="1,1,1", top="open", z=" z=0:16", walls="z-=fixed z+=slip", size="5,6,16")
# Particles that cross several cells in a step, some of which leave the grid.
FAST = """
dimension 2
grid cell=1 x=0:40 y=0:40
lost remove
method sgmp
time dt=0.4 steps=12
material m elastic density=1 young=1e-3 poisson=0.2
body a block material=m lower=(4,2,0) upper=(12,20,0) ppc=2
body b block material=m lower=(20,2,0) upper=(24,20,0) ppc=2
velocity a y=8
velocity b x=4 y=-0.5
output csv at=end
"""
# Blocks that drift and spin across the cuts, at less than a cell a step.
CLIMB = """
parameter method = sgmp
parameter update = musl
parameter rotation = plain
dimension 3
grid cell=1 x=open:open y=open:open z=0:open
method $method update=$update rotation=$rotation
time dt=0.1 steps=40
material m elastic density=1 young=1 poisson=0.2
body a block material=m lower=(2,2,2) upper=(8,8,12) ppc=2 jitter=0.3
body b block material=m lower=(2,9,22) upper=(8,15,30) ppc=2
velocity a x="0.3*(z-7)" y=0.4 z="3-0.3*(x-5)"
velocity b z=-2.5
output csv at=end
"""
# A rigid plate, a body force that uses the initial position, gravity, particles from Gauss points.
RIGID = """
dimension 2
grid cell=1 x=0:open y=0:open
wall y-=slip
method gimp update=usf
time end=4 cfl=0.3
gravity (0,-0.01)
material m elastic density=1 young=1 poisson=0.2
body a block material=m lower=(1,0,0) upper=(9,12,0) layout=gauss ppc=3
body b block material=m lower=(14,2,0) upper=(18,4,0) ppc=2
velocity b y=0.5
bodyforce a x="0.01*x0*sin(t)" y="0.002*y0"
output csv at=end
"""
# A pile on a wall between bodies that slide, a cylinder on top, a tool that comes down, cuts that move all the time. Up
# to three bodies share a node; the planes between ranks go through all of them.
PILE = """
parameter method = sgmp
parameter update = musl
parameter rotation = plain
parameter normal = separating
dimension 2
grid cell=1 x=-20:open y=0:open
wall y-=slip
method $method update=$update rotation=$rotation
time steps=60 cfl=0.3
gravity (0,-0.02)
material m elastic density=1 young=1 poisson=0.2
material s elastic density=3 young=5 poisson=0.3
body a block material=m lower=(0,0,0) upper=(6,6,0) ppc=2 jitter=0.3
body b block material=s lower=(6,0,0) upper=(12,7,0) ppc=2
body c block material=m lower=(2,7,0) upper=(10,13,0) spacing=0.5
body d cylinder material=s centre=(5,17,0) axis=(0,0,1) radius=3.5 length=1 spacing=0.4
body e block material=m lower=(12.5,8,0) upper=(16,11,0) ppc=2
body tool block material=s lower=(-1,21,0) upper=(12,23,0) ppc=2
rigid tool x=0.05 y="-0.1-0.02*t"
velocity d y=-0.15 x=0.05
velocity c y=-0.1
velocity e x=-0.1 y=0.1
contact friction=0.3 normal=$normal
history steps=5
output csv at=end
balance every=3 gain=0
"""
# The same in space, with an obstacle beside it and a normal of its own for one pair.
TOWER = """
parameter method = sgmp
parameter update = musl
parameter rotation = plain
parameter normal = separating
dimension 3
grid cell=1 x=open:open y=0:open z=0:open
wall y-=slip z-=fixed
method $method update=$update rotation=$rotation
time steps=24 cfl=0.3
gravity (0,0,-0.02)
material m elastic density=1 young=1 poisson=0.2
material s elastic density=3 young=5 poisson=0.3
body a block material=m lower=(0,0,0) upper=(4,4,6) ppc=2 jitter=0.3
body b block material=s lower=(4,0,0) upper=(8,4,7) ppc=2
body c block material=m lower=(1,1,7) upper=(7,4,12) spacing=0.5
body d sphere material=s centre=(4,2.5,15) radius=2.5 spacing=0.4
body side block material=s lower=(8,0,0) upper=(10,4,13) ppc=2
body tool block material=s lower=(0,0,18) upper=(7,4,20) ppc=2
rigid tool x=0.05 z="-0.1-0.02*t"
rigid side
velocity d z=-0.15 x=0.1
velocity c z=-0.1 x="0.1*(z-9)"
contact friction=0.3 normal=$normal
contact b side friction=0.1 normal=stiffer
history steps=4
output csv at=end
balance every=3 gain=0
"""
# A projectile crosses half of the planes before it hits.
CROSSING = """
parameter gain = 0.03
dimension 2
units mm g ms
grid cell=2 x=open:open y=open:open
method sgmp
time end=0.12 cfl=0.5
balance every=8 gain=gain
material steel elastic density=7.85e-3 young=20e3 poisson=0.3
material soft elastic density=7.85e-3 young=2e3 poisson=0.3
body target block material=soft lower=(-12,70) upper=(12,130) ppc=2
body projectile block material=steel lower=(-8,-20) upper=(8,20) ppc=2
velocity projectile y=400
contact all
"""
# The tube is higher, to have rows for all ranks.
OUTPUTS = """
output csv at=end fields=stress,density,displacement,initial_position
output vtu every=2 fields=stress,pressure
output tecplot every=2
output vtkhdf every=2 fields=stress
history steps=5
gauge near point=(0,1)
gauge far point=(12,8)
balance every=5 gain=0
"""
RINGS, SWIRLS = HOOPS + OUTPUTS, SWIRL + OUTPUTS
# name, deck, settings, layouts
SCENES = [
    ("elastic", "block.inp", {"cells": 10, "steps": 24, "drift": 0.3, "jitter": 0.4}, LAYOUTS),
    ("gimp", "block.inp", {"cells": 10, "steps": 16, "drift": 0.3, "jitter": 0.4, "method": "gimp", "update": "usf"},
     FEW),
    ("mpm", "block.inp", {"cells": 10, "steps": 16, "drift": 0.3, "method": "mpm", "update": "usl"}, FEW),
    ("cpgimp", "block.inp", {"cells": 10, "steps": 16, "drift": 0.3, "method": "cpgimp", "update": "usavg"}, FEW),
    ("johnson_cook", "block.inp", {"cells": 10, "steps": 16, "drift": 0.3, "material": "johnson_cook"}, FEW),
    ("rotation", "block.inp", {"cells": 10, "steps": 16, "drift": 0.3, "jitter": 0.4, "rotation": "exact"}, FEW),
    ("taylor_bar", "taylor_bar.inp", {"h": 1.9, "t_end": 0.01}, LAYOUTS),
    ("taylor_bar_axisymmetric", "taylor_bar_axisymmetric.inp", {"h": 0.76, "t_end": 0.01}, FEW),
    ("hoops", RINGS, {"height": 16}, LAYOUTS),
    ("hoops_normalised", RINGS, {"height": 16, "stress": "normalised", "update": "usavg"}, FEW),
    ("hoops_gimp", RINGS, {"height": 16, "method": "gimp", "update": "usf"}, FEW),
    ("swirl", SWIRLS, {"height": 16}, LAYOUTS),
    ("swirl_usl", SWIRLS, {"height": 16, "update": "usl", "stress": "normalised"}, FEW),
    ("hoops_mpm", RINGS, {"height": 16, "method": "mpm"}, FEW),
    ("beam", "beam.inp", {"h": 1.25, "t_end": 0.003}, LAYOUTS),
    ("bar", "bar.inp", {"cells": 32, "steps": 40, "dt": 1e-3, "v0": 1}, LAYOUTS),
    ("tnt_slab", "tnt_slab.inp", {"t_end": 2e-4}, LAYOUTS),
    ("vortex", "vortex.inp", {"cells": 8, "part": 0.05}, FEW),
    ("plane", PLANE, {}, LAYOUTS),
    ("plane_normalised", PLANE, {"stress": "normalised"}, FEW),
    ("plane_gimp", PLANE, {"method": "gimp", "update": "musl"}, FEW),
    ("space", SPACE, {"update": "usf"}, FEW),
    ("space_normalised", SPACE, {"stress": "normalised"}, FEW),
    ("dragged", DRAGGED + "balance every=4 gain=0\n", {}, LAYOUTS),
    ("dragged_damped", DRAGGED + "balance every=4 gain=0\ndamping rate=0.5\n", {}, FEW),
    ("dragged_usf", DRAGGED + "balance every=4 gain=0\n", {"method": "gimp", "update": "usf"}, FEW),
    ("rubbed", RUBBED + "balance every=4 gain=0\n", {}, LAYOUTS),
    ("rubbed_usf", RUBBED + "balance every=4 gain=0\n", {"method": "bspline", "update": "usf"}, FEW),
    ("climb", CLIMB, {}, LAYOUTS),
    ("climb_gimp", CLIMB, {"method": "gimp", "update": "usl"}, FEW),
    ("climb_bspline", CLIMB, {"method": "bspline", "update": "musl"}, FEW),
    ("climb_cpgimp", CLIMB, {"method": "cpgimp", "update": "usf"}, FEW),
    ("climb_mpm", CLIMB, {"method": "mpm", "update": "usavg"}, FEW),
    ("climb_balanced", CLIMB + "balance every=3 gain=0\n", {}, FEW),
    ("climb_gimp_balanced", CLIMB + "balance every=4 gain=0\n", {"method": "gimp", "update": "usf"}, FEW),
    ("plane_rotation", PLANE, {"rotation": "exact"}, LAYOUTS),
    ("space_rotation", SPACE, {"rotation": "exact", "stress": "normalised", "update": "usavg"}, FEW),
    ("climb_rotation", CLIMB, {"rotation": "exact"}, LAYOUTS),
    ("climb_rotation_balanced", CLIMB + "balance every=3 gain=0\n", {"rotation": "exact", "update": "usf"}, FEW),
    ("fast", FAST, {}, LAYOUTS),
    ("rigid", RIGID, {}, FEW),
    ("rings", "rings.inp", {"h": 2, "t_end": 0.6, "spacing": "h/2"}, LAYOUTS),
    ("rings_gimp", "rings.inp", {"h": 2, "t_end": 0.3, "spacing": "h/2", "method": "gimp", "update": "usl"}, FEW),
    ("sphere_slope", "sphere_slope.inp", {"h": 0.4, "t_end": 0.01, "stress": "normalised"}, FEW),
    ("fluids", FLUIDS, {}, FEW),
    ("open_air", OPEN_AIR, {}, FEW),
    ("open_air_gimp", OPEN_AIR + "balance every=3 gain=0\n", {"method": "gimp", "update": "usl"}, FEW),
    ("failing", FAILING, {}, FEW),
    ("averaged", AVERAGED, {"t_end": 0.025}, LAYOUTS),
    ("averaged_gimp", AVERAGED, {"t_end": 0.02, "method": "gimp", "update": "usf"}, FEW),
    ("metals", METALS, {}, FEW),
    ("scattered", SCATTERED, {}, FEW),
    ("eroding", ERODING, {}, LAYOUTS),
    ("kept", KEPT_PLANE, {}, FEW),
    ("kept_space", KEPT_SPACE, {}, FEW),
    ("kept_rings", KEPT_RINGS, {}, FEW),
    ("reference", REFERENCE, {}, FEW),
    ("reference_space", REFERENCE_SPACE + "balance every=3 gain=0\n", {"method": "mpm", "update": "usf"}, FEW),
    ("split", SPLIT, {}, LAYOUTS),
    ("split_gas", SPLIT_GAS, {}, FEW),
    ("split_rings", SPLIT_RINGS, {}, FEW),
    ("split_space", SPLIT_SPACE, {}, LAYOUTS),
    ("split_balanced", SPLIT_SPACE + "balance every=3 gain=0\n", {"method": "cpgimp", "update": "usl"}, FEW),
    ("pile", PILE, {}, LAYOUTS),
    ("pile_gimp", PILE, {"method": "gimp", "update": "usf", "normal": "average"}, FEW),
    ("pile_mpm", PILE, {"method": "mpm", "update": "usavg"}, FEW),
    ("pile_rotation", PILE, {"rotation": "exact"}, LAYOUTS),
    ("seat", SEAT + "balance every=3 gain=0\n", {}, LAYOUTS),
    ("cone", CONE, {}, FEW),
    ("seat_gimp", SEAT, {"method": "gimp", "update": "usavg", "normal": "average"}, FEW),
    ("tower", TOWER, {}, FEW),
    ("tower_rotation", TOWER, {"rotation": "exact", "update": "usl"}, FEW),
    ("tower_cpgimp", TOWER, {"method": "cpgimp", "update": "usf", "normal": "first"}, FEW),
]
# Shortened so that a run takes a second or two; every method and update for some.
DECKS = {
    "taylor_bar.inp": {"h": 1.9, "t_end": 0.01},
    "taylor_bar_axisymmetric.inp": {"h": 0.76, "t_end": 0.01, "cfl": 1},
    "bar.inp": {"cells": 32, "steps": 40, "dt": 1e-3, "v0": 1},
    "bar_large.inp": {"cells": 16, "t_end": 0.002},
    "bar_rotated.inp": {"cells": 16, "steps": 60, "dt": 2e-3},
    "bar_stability.inp": {"cells": 16, "t_end": 0.2},
    "beam.inp": {"h": 1.25, "t_end": 0.003},
    "tnt_slab.inp": {"t_end": 3e-4},
    "block.inp": {"cells": 10, "steps": 24, "drift": 0.3, "jitter": 0.4},
    "vortex.inp": {"cells": 8, "part": 0.1},
    "rings.inp": {"h": 2, "t_end": 1, "spacing": "h/2"},
    "sphere_slope.inp": {"h": 0.4, "t_end": 0.02},
    "projectile.inp": {"h": 4, "t_end": 0.02, "gain": 0.0, "every": 3},
    "two_blocks.inp": {"width": 3, "length": 5, "steps": 20},
    "rod_plate.inp": {"h": 1.5, "t_end": 0.001},
}
# What goes wrong on any layout: MPM with USL.
UNSTABLE = {("rings.inp", "mpm", "usl"), ("pile", "mpm", "usl"), ("tower", "mpm", "usl")}
# USL gains energy at the Courant numbers of these decks, on one rank as on many.
UNSTABLE |= {(deck, method, "usl") for deck in ("taylor_bar.inp", "taylor_bar_axisymmetric.inp")
             for method in ("sgmp", "gimp", "mpm", "cpgimp", "bspline")}
UNSTABLE |= {("bar_stability.inp", method, "usl") for method in ("mpm", "cpgimp")}
METHODS = ("sgmp", "gimp", "mpm", "cpgimp", "bspline")
UPDATES = ("musl", "usf", "usl", "usavg")
# What differs from run to run and not because of the layout.
OWN_WORDS = ("summary.json", "run.log")


def run_on(name, deck, ranks, threads, settings, timeout=300):
    """Runs a deck of input/, or one of this script's, on some ranks with some threads each."""
    folder = os.path.join(SCRATCH, f"{name}_{ranks}x{threads}")
    subprocess.run(["rm", "-rf", folder], check=True)
    path = os.path.join(INPUT, deck)
    if "\n" in deck:
        path = os.path.join(SCRATCH, name + ".inp")
        with open(path, "w", encoding="utf-8") as file:
            file.write(deck)
    launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []  # which takes longer to start than most scenes
    command = [*launcher, SGMP, path, "--quiet", "--threads", str(threads), "--output", folder]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=timeout, check=False,
                          env=MPI if launcher else ENVIRONMENT)
    return Run(done.returncode, done.stdout.decode("utf-8", "replace"), folder)


def same_files(report, title, first, other):
    """All files of two runs have the same bytes, but for those that speak of the run itself."""
    names = sorted(os.listdir(first.folder))
    report.check(names == sorted(os.listdir(other.folder)),
                 f"{title}: files {names} and {sorted(os.listdir(other.folder))}")
    for name in names:
        if name in OWN_WORDS:
            continue
        report.check(filecmp.cmp(os.path.join(first.folder, name), os.path.join(other.folder, name), shallow=False),
                     f"{title}: {name} differs")


def figures(result):
    """What must not depend on the layout."""
    return json.dumps([result[key] for key in ("checksum", "steps", "time", "particle_steps", "particles",
                                               "particles_lost", "energy")])


def same_everywhere(name, deck, settings, layouts):
    """One scene on all its layouts; a report of its own."""
    report = Report()
    first = None
    for ranks, threads in layouts:
        title = f"{name} on {ranks}x{threads}"
        result = run_on(name, deck, ranks, threads, settings)
        if not report.finished(result, title):
            continue
        report.check(result["ranks"] == ranks, f"{title}: {result['ranks']} ranks")
        if first is None:
            first = result
            continue
        report.check(figures(result) == figures(first), f"{title}: {figures(result)}\nis not {figures(first)}")
        same_files(report, title, first, result)
    return report


def every_way():
    """All decks with all methods and updates."""
    for deck, settings in DECKS.items():
        for method in METHODS:
            for update in UPDATES:
                if (deck, method, update) not in UNSTABLE:
                    layouts = LAYOUTS if (method, update) == ("sgmp", "musl") else LEAST
                    yield f"{deck.split('.')[0]}_{method}_{update}", deck, {**settings, "method": method,
                                                                            "update": update}, layouts


def piles():
    """Contact of many bodies with every method, update and normal."""
    for title, deck in (("pile", PILE), ("tower", TOWER)):
        for method in METHODS:
            for update in UPDATES:
                for normal in ("separating", "average", "second"):
                    if (title, method, update) not in UNSTABLE:
                        yield (f"{title}_{method}_{update}_{normal}", deck,
                               {"method": method, "update": update, "normal": normal},
                               FEW if normal == "separating" else LEAST)


def one_message(report):
    """A failure of one rank ends all of them with one message and its own exit code."""
    blow_up = {"cells": 8, "steps": 400, "dt": 0.0012, "jitter": 0.3, "drift": 0.1}
    messages = {}
    for ranks in (1, 3):
        result = run_on("failure", "block.inp", ranks, 1, blow_up)
        report.check(result.code == 4, f"blow-up on {ranks} ranks: exit code {result.code}\n{result.text}")
        found = re.findall(r"^error: .*$", result.text, re.MULTILINE)
        report.check(len(found) == 1, f"blow-up on {ranks} ranks: {len(found)} messages\n{result.text}")
        messages[ranks] = found
    report.check(messages[1] == messages[3], f"{messages}")
    wrong = run_on("wrong", "block.inp", 2, 1, {"cells": "nonsense"})
    report.check(wrong.code == 3 and wrong.text.count("nonsense") >= 1,
                 f"deck error: exit code {wrong.code}\n{wrong.text}")


def balanced(report):
    """A projectile crosses the planes: the cuts follow it, which changes no bit; without that they do not."""
    follows = run_on("projectile", CROSSING, 4, 1, {})
    stays = run_on("projectile_stays", CROSSING, 4, 1, {"gain": 0.99})
    alone = run_on("projectile_alone", CROSSING, 1, 1, {})
    if not all([report.finished(run, "projectile") for run in (follows, stays, alone)]):
        return
    for other in (follows, stays):
        report.check(figures(other) == figures(alone), f"projectile: {figures(other)}\nis not {figures(alone)}")
    print(f"projectile on 4 ranks: most particles of a rank over the mean {follows['balance.largest_imbalance']:.3f} "
          f"with {follows['balance.cuts']} new cuts, {stays['balance.largest_imbalance']:.3f} without")
    report.check(follows["balance.largest_imbalance"] < 1.25, f"imbalance {follows['balance.largest_imbalance']}")
    report.check(follows["balance.cuts"] > 0 and stays["balance.cuts"] == 0, "cuts that do not follow, or that do")
    report.check(stays["balance.largest_imbalance"] > 1.25, f"nothing to balance: {stays['balance.largest_imbalance']}")


def main():
    """The scenes of `make test`, or with SGMP_TEST_FULL all decks with all methods."""
    report = Report()
    scenes = [*every_way(), *piles(), *SCENES] if FULL else SCENES
    with concurrent.futures.ThreadPoolExecutor(2 if FULL else 1) as lanes:
        for part in lanes.map(lambda scene: same_everywhere(*scene), own(scenes)):
            report.add(part)
    for other in own((balanced, one_message)):
        other(report)
    report.end()


main()
