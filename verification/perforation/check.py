#!/usr/bin/env python3
"""A hard projectile through 12 mm of steel: ballistic limit and residual speeds against Borvik, Langseth, Hopperstad
and Malo, Int. J. Impact Engng 27 (2002), 19-35.

Measured limits: 292.1 m/s with a hemispherical and 184.5 m/s with a blunt nose, to some 5 m/s; plugs of 15.1 to 36.0 g.
Residual speeds: Recht and Ipson, J. Appl. Mech. 30 (1963), 384-390, vr = a sqrt(vi^2 - v50^2) with a = M/(M + m), M =
197 g, m the mass of the plug, and the measured limit.
"""

import csv
import sys
from math import sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

PLATE = "verification/perforation/plate.inp"
LIMIT, NOSE = {1: 292.1, 0: 184.5}, {1: "hemispherical", 0: "blunt"}
MASS, PLUG = 197.0, (15.1, 36.0)
THROUGH = 20.0  # m/s in the end; what is stopped moves with the plate, at some 10 m/s at most
# Speeds by nose and cells through the thickness: the first two bracket the limit.
QUICK = {(1, 12): (310, 315, 325, 350, 400), (0, 12): (290, 310)}
FULL = {(1, 24): (290, 300, 350, 400), (0, 24): (230, 250)}
# With strength that damage takes, as published: a smaller plate, whose edge no wave comes back from in time, 48 cells.
COUPLED = {"round": 0, "cells": 48, "critical": 0.3, "wide": 80, "t_end": 0.15}
BRACKET = (185, 200)


def residual(speed, limit, plug):
    return MASS / (MASS + plug) * sqrt(max(0.0, speed**2 - limit**2))


def last_speed(run):
    with open(run.folder / "rigid.csv", encoding="utf-8") as stream:
        return -float(list(csv.DictReader(stream))[-1]["velocity_z"])


def coupled(book):
    """The blunt nose with the published coupling of damage and strength; rows of its table."""
    runs = solve([Case(PLATE, speed=v, **COUPLED) for v in BRACKET], workers=1)
    found = [last_speed(run) for run in runs]
    case = "blunt nose, 48 cells through 12 mm, damage takes 0.3 of the strength"
    book.at_most(case, f"last speed of a projectile at {BRACKET[0]} m/s (m/s): it is stopped", found[0], THROUGH)
    book.at_least(case, f"last speed of a projectile at {BRACKET[1]} m/s (m/s): it is through", found[1], THROUGH)
    name = f"ballistic limit, middle of {BRACKET[0]} and {BRACKET[1]} m/s"
    book.within(case, name, 0.5 * sum(BRACKET), LIMIT[0], 0.05)
    return [
        [
            NOSE[0] + ", coupled", COUPLED["cells"], v, f"{end:.1f}",
            f"{residual(v, LIMIT[0], PLUG[1]):.0f} to {residual(v, LIMIT[0], PLUG[0]):.0f}",
            f"{run.summary['eroded']['mass']:.1f}", run.summary["verdict"], f"{run.cpu_seconds:.0f}",
        ]
        for v, end, run in zip(BRACKET, found, runs)
    ]


def check(book, full):
    book.section("Projectile through a steel plate")
    book.say(
        "Johnson and Cook's law with damage, matter that has failed is removed; contact without friction between "
        "the plate and a rigid projectile."
    )
    rows, figure_axis = [], subplots(figsize=(6, 3.6))
    figure, axis = figure_axis
    for (nose, cells), speeds in {**QUICK, **(FULL if full else {})}.items():
        runs = solve(
            [Case(PLATE, round=nose, cells=cells, speed=v, t_end=0.4 if v <= 315 else 0.25) for v in speeds], workers=1
        )
        found = [last_speed(run) for run in runs]
        for v, end, run in zip(speeds, found, runs):
            rows.append(
                [
                    NOSE[nose], cells, v, f"{end:.1f}",
                    f"{residual(v, LIMIT[nose], PLUG[1]):.0f} to {residual(v, LIMIT[nose], PLUG[0]):.0f}",
                    f"{run.summary['eroded']['mass']:.1f}", run.summary["verdict"], f"{run.cpu_seconds:.0f}",
                ]
            )
        case = f"{NOSE[nose]} nose, {cells} cells through 12 mm"
        book.at_most(case, f"last speed of a projectile at {speeds[0]} m/s (m/s): it is stopped", found[0], THROUGH)
        book.at_least(case, f"last speed of a projectile at {speeds[1]} m/s (m/s): it is through", found[1], THROUGH)
        middle = 0.5 * (speeds[0] + speeds[1])
        known = {(0, 12): 300, (0, 24): 240}.get((nose, cells))
        book.within(
            case,
            f"ballistic limit, middle of {speeds[0]} and {speeds[1]} m/s",
            middle,
            LIMIT[nose],
            0.1,
            "the plug is sheared off in bands of a tenth of a millimetre; the limit falls with the cells"
            if nose == 0
            else "",
            known,
        )
        for v, end in list(zip(speeds, found))[-2:] if nose == 1 else ():
            known = {(350, 24): 203.5, (400, 24): 280.4}.get((v, cells))
            book.within(
                case, f"residual speed at {v} m/s against Recht and Ipson's, plug of 25.5 g", end,
                residual(v, LIMIT[nose], 0.5 * sum(PLUG)), 0.15,
                "the plate takes less energy from faster projectiles; cause not known", known,
            )
        axis.plot(speeds, found, "o-" if nose else "s--", markersize=4, label=case)
    if full:
        rows += coupled(book)
    fast = np.linspace(150, 400, 300)
    for nose, shade in ((1, "0.8"), (0, "0.9")):
        low, high = ([residual(v, LIMIT[nose], plug) for v in fast] for plug in reversed(PLUG))
        axis.fill_between(fast, low, high, color=shade, label=f"Recht and Ipson, measured limit, {NOSE[nose]}")
    axis.set(xlabel="speed before (m/s)", ylabel="speed behind (m/s)")
    axis.legend(fontsize=7)
    book.figure("perforation", figure, "Speed of the projectile behind the plate.")
    book.table(
        "perforation",
        [
            "nose", "cells", "m/s", "behind (m/s)", "Recht and Ipson, plug of 36.0 to 15.1 g", "removed (g)", "verdict",
            "CPU s",
        ],
        rows,
        "All runs.",
    )
    book.command(Case(PLATE, speed=350))


if __name__ == "__main__":
    main(check, __doc__)
