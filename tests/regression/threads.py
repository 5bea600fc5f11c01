#!/usr/bin/env python3
"""The final particle state has the same bits for any number of threads, and whatever is written.

usage: threads.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os

from _runs import (
    CONE, ERODING, FAILING, FLUIDS, HOOPS, INPUT, KEPT_PLANE, KEPT_SPACE, METALS, SCATTERED, SEAT, SPLIT, SPLIT_GAS,
    SPLIT_SPACE, SWIRL, Report, own, remove, run,
)

# Detonation from a corner of a charge in two or three dimensions, walls on two sides.
CHARGE = """
parameter method = sgmp
parameter update = musl
dimension {dimension}
grid cell=1 x=0:open y=0:open{z}
wall x-=fixed y-=slip
method $method update=$update
time end=0.0012 cfl=0.3
material tnt explosive density=1.63e-3 detonation_speed=6930 burn_cells=2
eos tnt jwl a=371200 b=3210 r1=4.15 r2=0.95 omega=0.30 energy0=6993
viscosity tnt quadratic=1.5 linear=0.06
body charge block material=tnt lower=(0,0,0) upper=({size}) spacing=0.5
detonation point=(0,0,0)
"""
PLANE = CHARGE.format(dimension=2, z="", size="12,12")
SPACE = CHARGE.format(dimension=3, z="", size="6,6,6")

# name, deck, settings
SCENES = [
    ("elastic", "block.inp", {"cells": 6, "steps": 30, "drift": 0.3}),
    ("jittered", "block.inp", {"cells": 6, "steps": 30, "drift": 0.3, "jitter": 0.4}),
    ("johnson_cook", "block.inp", {"cells": 6, "steps": 30, "drift": 0.3, "material": "johnson_cook"}),
    ("taylor_bar", "taylor_bar.inp", {"h": 1.9, "t_end": 0.01}),
    ("large_bar", "taylor_bar.inp", {"h": 0.5, "t_end": 0.003}),  # enough for threads to share new layouts and bins
    ("rings", HOOPS, {}),
    ("rings_normalised", HOOPS, {"stress": "normalised"}),
    ("swirl", SWIRL, {}),
    ("swirl_usf", SWIRL.replace("update=$update", "update=usf"), {"stress": "normalised"}),
    ("rotated_bar", "bar_rotated.inp", {"cells": 16, "steps": 60, "dt": 2e-3, "v0": 2}),
    ("beam", "beam.inp", {"h": 1.25, "t_end": 0.003}),
    ("jwl_2d", PLANE, {}),
    ("jwl_3d", SPACE, {}),
    ("fluids", FLUIDS, {}),
    ("failing", FAILING, {}),
    ("metals", METALS, {}),
    ("scattered", SCATTERED, {}),
    ("eroding", ERODING, {}),
    ("kept", KEPT_PLANE, {}),
    ("kept_space", KEPT_SPACE, {}),
    ("split", SPLIT, {}),
    ("split_gimp", SPLIT.replace("$method update=$update", "cpgimp update=usl"), {}),
    ("split_gas", SPLIT_GAS, {}),
    ("split_space", SPLIT_SPACE.replace("update=$update", "update=usavg"), {}),
    ("contact", "two_blocks.inp", {"width": 5, "length": 4, "steps": 60, "drift": 0.3, "speed": 0.05}),
    ("cone", CONE, {}),
    ("seat", SEAT, {}),
    ("bar", "bar.inp", {"cells": 32, "steps": 200, "dt": 1e-3, "v0": 1}),
    ("normalised_block", "block.inp", {"cells": 6, "steps": 30, "drift": 0.3, "jitter": 0.4, "stress": "normalised"}),
    ("rotation_block", "block.inp", {"cells": 6, "steps": 30, "drift": 0.3, "jitter": 0.4, "rotation": "exact"}),
    ("normalised_beam", "beam.inp", {"h": 1.25, "t_end": 0.003, "stress": "normalised"}),
    ("normalised_bar", "bar.inp", {"cells": 32, "steps": 200, "dt": 1e-3, "v0": 1, "stress": "normalised"}),
]


def same_for_threads(report):
    """1, 2 and 3 threads, once 7; all methods and updates with the block that drifts through the grid."""
    for name, deck, settings in own(SCENES):
        everything = name in ("jittered", "rings", "rotated_bar")
        for method in ("sgmp", "gimp", "mpm", "cpgimp", "bspline") if everything else ("sgmp",):
            for update in ("musl", "usf", "usl", "usavg") if everything and method in ("sgmp", "gimp") else ("musl",):
                sums = {}
                for threads in (1, 2, 3) + ((7,) if name == "jittered" and update == "musl" else ()):
                    title = f"{name}_{method}_{update}_{threads}"
                    result = run(title, deck, threads=threads, method=method, update=update, **settings)
                    if report.finished(result, title):
                        sums[threads] = (
                            result["checksum"], result["energy.total"], result["energy.kinetic"], result["steps"],
                        )
                        remove(result)
                report.check(len(set(sums.values())) == 1, f"{name} {method} {update}: {sums}")


def other_state_other_sum(report):
    """The checksum does tell states apart, and particles of the drifting block do change cells."""
    base = {"cells": 4, "steps": 10, "drift": 0.3}
    first = run("sum_1", "block.inp", **base)
    second = run("sum_2", "block.inp", **{**base, "young": 210e3*(1 + 1e-15)})
    report.check(first["checksum"] != second["checksum"], "a last bit of Young's modulus leaves the checksum alone")
    report.check(run("sum_3", "block.inp", **base)["checksum"] == first["checksum"], "the same run twice differs")
    rows = first.table("particles_end.csv")
    report.check(min(row["x"] for row in rows) > 3.0, "the block has not drifted by three cells")


def same_for_output(report):
    """Writing more, or nothing, changes nothing."""
    include = f'include "{os.path.join(INPUT, "block.inp")}"\n'
    settings = {"cells": 4, "steps": 20, "drift": 0.3, "jitter": 0.3}
    plain = run("plain", "block.inp", **settings)
    more = run(
        "more", include + "output vtu fields=stress,pressure,von_mises\noutput tecplot\ngauge g point=(1,1,1)\n",
        **settings,
    )
    if report.finished(plain, "plain") and report.finished(more, "more"):
        report.check(plain["checksum"] == more["checksum"], "output changes the result")
        report.check(
            any(name.endswith(".vtu") for _, _, files in os.walk(more.folder) for name in files), "no .vtu was written"
        )


def main():
    """All of it."""
    report = Report()
    for other in own((other_state_other_sum, same_for_output)):
        other(report)
    same_for_threads(report)
    report.end()


main()
