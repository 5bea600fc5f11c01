#!/usr/bin/env python3
"""Every deck of input/, shortened, with all methods and update schemes: it ends well and its energies make sense.

usage: decks.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math
import os

from _runs import INPUT, Report, own, run

# deck: parameters that shorten it; the total energy may change by these fractions of its reference, the second with
# usl. They
# are regression values, twice the largest drift of any method: velocities belong to the middle of steps, stresses to
# their
# ends, which coarse, fast ringing shows, and usl damps it as well. What each method should reach is in verification/.
SHORT = {
    "bar.inp": ({"cells": 16, "steps": 50, "dt": 1e-4}, 2e-05, 2e-05),
    "bar_large.inp": ({"cells": 8, "t_end": 0.01, "dt": 1e-4}, 5e-05, 4e-05),
    "bar_rotated.inp": ({"cells": 8, "steps": 20, "dt": 1e-4}, 1.1e-05, 1.1e-05),
    "bar_stability.inp": ({"cells": 16, "cfl": 0.2, "t_end": 1e-4}, 0.032, 0.032),
    "beam.inp": ({"h": 1.25, "t_end": 0.001}, 0.0013, 0.018),
    "block.inp": ({"cells": 4, "steps": 20}, 0.18, 1),
    "projectile.inp": ({"h": 4, "t_end": 0.004}, 1e-12, 1e-12),
    "rings.inp": ({"h": 4, "t_end": 0.2, "spacing": "h/2"}, 0.045, 0.15),
    "rod_plate.inp": ({"h": 1.5, "t_end": 0.001}, 0.07, 0.08),
    "sphere_slope.inp": ({"h": 0.8, "t_end": 0.04}, 1e-12, 1e-12),
    "taylor_bar.inp": ({"h": 1.9, "t_end": 0.002, "cfl": 0.3}, 0.012, 0.06),
    "taylor_bar_axisymmetric.inp": ({"h": 1.9, "t_end": 0.002, "cfl": 0.3}, 0.012, 0.06),
    "tnt_slab.inp": ({"h": 1, "t_end": 0.0005}, 6e-05, 0.00025),
    "two_blocks.inp": ({"width": 3, "length": 5, "steps": 20}, 0.25, 0.31),
    "vortex.inp": ({"cells": 8, "part": 0.3, "cfl": 0.2}, 0.075, 0.023),
}
VARIANTS = [("block.inp", {"material": "j2"}), ("block.inp", {"material": "johnson_cook"}),
            ("taylor_bar.inp", {"material": "full"}), ("bar_large.inp", {"poisson": 0.3})]


def check(report, deck, method, update, more):
    """One run."""
    settings, tolerance, tolerance_usl = SHORT[deck]
    name = "_".join([deck[:-4], method, update, *map(str, more.values())])
    result = run(name, deck, method=method, update=update, **settings, **more)
    if not report.finished(result, name):
        return
    energy = result["energy"]
    report.check(all(math.isfinite(value) for value in energy.values()), f"{name}: energies {energy}")
    reference = max(abs(energy["initial_total"]), abs(energy["external_work"]), energy["kinetic"])
    drift = abs(energy["total"] - energy["initial_total"] - energy["external_work"])
    report.check(energy["kinetic"] > 0 and drift <= (tolerance_usl if update == "usl" else tolerance)*reference,
                 f"{name}: energy drifts by {drift/reference:.3g}")
    report.check(abs(energy["remainder"]) <= 1e-9*reference, f"{name}: energy remainder {energy['remainder']:.3g}")
    report.check(result["method"] == method and result["update"] == update, f"{name}: ran another method")
    report.check(result["particles_lost"] == 0 and result["steps"] > 5, f"{name}: {result['steps']} steps")
    history = result.table("history.csv")
    report.check(len(history) >= 2 and history[0]["step"] == 0 and history[-1]["step"] == result["steps"],
                 f"{name}: history from step {history[0]['step']} to {history[-1]['step']}")
    report.check(
        abs(history[-1]["total_energy"] - energy["total"]) <= 1e-14 * abs(energy["total"]),
        f"{name}: history ends elsewhere",
    )
    if os.path.exists(os.path.join(result.folder, "particles_end.csv")):
        particles = result.table("particles_end.csv")
        report.check(
            [row["id"] for row in particles] == list(range(1, result["particles"] + 1)), f"{name}: ids of particles"
        )


def main():
    """All decks, methods and updates."""
    report = Report()
    decks = {name for name in os.listdir(INPUT) if name.endswith(".inp")}
    for deck in sorted(decks ^ set(SHORT)):
        report.check(False, f"{deck}: in input/ or in this test, but not in both")
    for deck in own(sorted(decks & set(SHORT))):
        result = run("check", deck, options=["--check"])
        report.check(result.code == 0 and "memory" in result.text, f"{deck} --check: {result.code}\n{result.text}")
        for method in ("mpm", "gimp", "cpgimp", "bspline", "sgmp"):
            for update in ("usf", "musl", "usl"):
                check(report, deck, method, update, {})
    for deck in own(sorted(decks & set(SHORT))):
        check(report, deck, "sgmp", "usavg", {})
        with open(os.path.join(INPUT, deck), encoding="utf-8") as file:
            if "parameter stress" in file.read():
                check(report, deck, "sgmp", "musl", {"stress": "normalised"})
    for deck, more in own(VARIANTS):
        for method in ("mpm", "gimp", "sgmp"):
            check(report, deck, method, "musl", more)
    for deck in own(sorted(os.listdir(os.path.join(INPUT, "gallery")))):
        if deck.endswith(".inp"):
            result = run("check", os.path.join("gallery", deck), options=["--check"])
            report.check(
                result.code == 0 and "memory" in result.text, f"gallery/{deck} --check: {result.code}\n{result.text}"
            )
    report.end()


main()
