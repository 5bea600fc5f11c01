#!/usr/bin/env python3
"""A hard ogive through and into concrete of 48 MPa, Holmquist, Johnson and Cook's law: residual speeds behind slabs of
178 mm against Hanchak, Forrestal, Young and Ehrgott, Int. J. Impact Engng 12 (1992), 1-7, and depths against Forrestal,
Altman, Cargile and Hanchak, Int. J. Impact Engng 15 (1994), 395-405.

The speeds before and behind the slab and the formula of the depth with its S(fc) = 82.6 fc^-0.544 (fc in MPa) are from
memory of the literature: no print of them could be seen.
"""

import csv
import sys
from math import log, pi, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import Case, main, solve, subplots  # noqa: E402

SLAB = "verification/concrete/slab.inp"
TESTS = {1058: 947, 749: 615, 606: 449, 434: 214, 381: 136, 360: 67, 301: 0}
MASS, RADIUS, CALIBRES, STRENGTH, DENSITY = 0.5, 0.0127, 3.0, 48.0, 2440.0  # kg, m, MPa, kg/m3
SPEEDS = {4: (1058, 749, 606, 434), 6: (749,)}
DEEP = {4: (300,)}
WEAK = ("slow projectiles meet too little resistance; cause not known: no friction, no reinforcement, matter that has "
        "cracked open bears nothing")
WIDE = "the hole that contact opens is half a cell too wide"
KNOWN, DEPTHS = {434: (WEAK, 249)}, {300: (WEAK, 142)}
THICK, TIMES = {300: 300}, {300: 1.1}


def depth(speed):
    """Forrestal's, in mm: a crater of two diameters, then a resistance of S fc + N rho v^2 on the section."""
    nose = (8 * CALIBRES - 1) / (24 * CALIBRES**2)
    area, bears = pi * RADIUS**2, 82.6 * STRENGTH**-0.544 * STRENGTH * 1e6
    crater = 4 * pi * RADIUS**3
    entry = (MASS * speed**2 - crater * bears) / (MASS + crater * nose * DENSITY)
    return 1e3 * (MASS / (2 * area * nose * DENSITY) * log(1 + nose * DENSITY * entry / bears) + 4 * RADIUS)


def rows_of(run):
    with open(run.folder / "rigid.csv", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def last_speed(run):
    return -float(rows_of(run)[-1]["velocity_z"])


def deepest(run):
    """How far the tip got, in mm: it begins on the surface."""
    places = [float(row["z"]) for row in rows_of(run)]
    return places[0] - min(places)


def check(book, full):
    book.section("Projectile into concrete")
    book.say("Holmquist, Johnson and Cook's law with the constants of the library; a rigid projectile without "
             "friction, axisymmetric; the hole that contact opens is half a cell too wide.")
    figure, axis = subplots(figsize=(6, 3.6))
    rows, behind = [], {}
    for cells, speeds in SPEEDS.items():
        runs = solve([Case(SLAB, speed=v, cells=cells, t_end=round(0.3 + 250 / v, 2)) for v in speeds], workers=1)
        for v, run in zip(speeds, runs):
            behind[v, cells] = last_speed(run)
            rows.append([cells, v, f"{behind[v, cells]:.0f}", TESTS[v], run.summary["verdict"],
                         f"{run.cpu_seconds:.0f}"])
        axis.plot(speeds, [behind[v, cells] for v in speeds], "o-" if cells == 4 else "s--", markersize=4,
                  label=f"{cells} cells to the radius")
    axis.plot(list(TESTS), list(TESTS.values()), "k+", label="measured")
    axis.set(xlabel="speed before (m/s)", ylabel="speed behind (m/s)")
    axis.legend(fontsize=7)
    for v in SPEEDS[4]:
        book.within("concrete", f"speed behind the slab, {v} m/s, 4 cells to the radius (m/s)", behind[v, 4], TESTS[v],
                    0.1, *KNOWN.get(v, ()))
    for v in SPEEDS[6]:
        book.within("concrete", f"speed behind the slab, {v} m/s, 6 cells over 4 cells", behind[v, 6] / behind[v, 4],
                    1.0, 0.05, WIDE, 1.064)
    book.figure("concrete", figure, "Speed of the projectile behind the slab.")
    book.table("concrete", ["cells", "m/s", "behind (m/s)", "measured", "verdict", "CPU s"], rows, "Slabs of 178 mm.")
    rows, found = [], {}
    for cells, speeds in DEEP.items():
        runs = solve([Case(SLAB, speed=v, cells=cells, thick=THICK[v], t_end=TIMES[v]) for v in speeds], workers=1)
        for v, run in zip(speeds, runs):
            found[v, cells] = deepest(run)
            rows.append([cells, v, f"{found[v, cells]:.0f}", f"{depth(v):.0f}", f"{last_speed(run):.0f}",
                         run.summary["verdict"], f"{run.cpu_seconds:.0f}"])
    for v in DEEP[4]:
        book.within("concrete", f"depth at {v} m/s, 4 cells to the radius (mm)", found[v, 4], depth(v), 0.1,
                    *DEPTHS.get(v, ()))
    book.table("concrete_depth", ["cells", "m/s", "depth (mm)", "Forrestal", "speed in the end (m/s)", "verdict",
                                  "CPU s"], rows, "Thick targets.")
    book.command(Case(SLAB, speed=749))

if __name__ == "__main__":
    main(check, __doc__)
