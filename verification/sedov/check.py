#!/usr/bin/env python3
"""Sedov's point blast in an axisymmetric scene: at t = 1 radius 1 of the shock; behind it density 6, velocity 1/3,
pressure 2/15.

L. I. Sedov, Similarity and Dimensional Methods in Mechanics; the energy 0.851072 for gamma = 1.4 and radius 1 is that
of J. R. Kamm, LA-UR-00-6055 (from memory of the literature). The jump conditions are those of a strong shock of speed
2/5.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

SEDOV, DENSITY, VELOCITY, PRESSURE = "verification/sedov/sedov.inp", 6.0, 1 / 3, 2 / 15


def profile(run, n):
    """Means of density, radial velocity and pressure of the particles in shells a cell thick."""
    p = run.particles()
    radius = np.hypot(p.points[:, 0], p.points[:, 2])
    speed = (p.column("velocity_x") * p.points[:, 0] + p.column("velocity_z") * p.points[:, 2]) / radius
    shell = np.floor(radius * n).astype(int)
    rows = [[(k + 0.5) / n] + [float(values[shell == k].mean())
                               for values in (p.column("density"), speed, p.column("pressure"))]
            for k in range(int(1.15 * n)) if np.any(shell == k)]
    return np.array(rows)


def front(shells):
    """Radius at which the density, from outside, is half way up to that of the shock."""
    half = 0.5 * (1 + DENSITY)
    for (r1, d1), (r2, d2) in zip(shells[::-1, :2], shells[-2::-1, :2]):
        if d1 < half <= d2:
            return r2 + (d2 - half) / (d2 - d1) * (r1 - r2)
    return float(shells[shells[:, 1].argmax(), 0])


def check(book, full):
    book.section("Sedov's blast")
    book.say("No part of the paper. Bulk viscosity spreads the shock over three to four cells, which hold most of the "
             "mass: its place is known, its peaks are not yet.")
    figure, axis = subplots(figsize=(6, 3.4))
    rows, sizes = [], (25, 40) if full else (25,)
    for n, run in zip(sizes, solve([Case(SEDOV, n=n) for n in sizes], workers=1)):
        shells = profile(run, n)
        energy = run.history()["total_energy"]
        at, peaks = front(shells), shells[:, 1:].max(axis=0)
        book.near(f"sedov, h = 1/{n}", "radius of the shock", at, 1.0, 1.0 / n)
        book.at_most(f"sedov, h = 1/{n}", "density behind the shock, deviation", abs(peaks[0] / DENSITY - 1), 0.4)
        book.at_most(f"sedov, h = 1/{n}", "energy at the end over that of the start, less one",
                     abs(float(energy[-1] / energy[0] - 1)), 0.03)
        behind = shells[(shells[:, 0] > at - 3 / n) & (shells[:, 0] < at)]
        rows.append([n, f"{at:.3f}", f"{peaks[0]:.2f}", f"{behind[:, 2].max():.3f}", f"{behind[:, 3].max():.4f}",
                     f"{float(energy[-1]/energy[0] - 1):.1e}",
                     f"{run.cpu_seconds:.0f}"])
        axis.plot(shells[:, 0], shells[:, 1], linewidth=0.9, label=f"h = 1/{n}")
    axis.axvline(1.0, color="black", linewidth=0.6)
    axis.axhline(DENSITY, color="black", linewidth=0.6, linestyle="--")
    axis.set(xlabel="radius", ylabel="density")
    axis.legend(fontsize=7)
    book.figure("sedov", figure, "Sedov's blast at t = 1: means over shells one cell thick.")
    book.table("sedov", ["cells to 1", "shock (1)", "density (6)", "velocity (0.333)", "pressure (0.1333)", "energy",
                         "CPU s"], rows, "Sedov's blast, bspline.")
    book.command(Case(SEDOV, n=25))


if __name__ == "__main__":
    main(check, __doc__)
