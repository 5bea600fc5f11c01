#!/usr/bin/env python3
"""Noh's spherical shock in an axisymmetric scene against its exact solution: radius 0.2 of the shock, densities on both
sides."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

NOH, TIME, SHOCK = "verification/noh/noh.inp", 0.6, 0.2


def profile(run):
    """Radius and density of all particles, and means over shells."""
    particles = run.particles()
    radius, density = np.hypot(particles.points[:, 0], particles.points[:, 2]), particles.column("density")
    edges = np.arange(0.0, 0.6, 0.01)
    inside = np.digitize(radius, edges)
    shells = np.array(
        [
            [0.5 * (edges[k - 1] + edges[k]), density[inside == k].mean()]
            for k in range(1, len(edges))
            if np.any(inside == k)
        ]
    )
    return radius, density, shells


def shock(shells):
    """Radius where the density, from outside, has passed half of 64; that of the densest shell where none has."""
    above = np.nonzero(shells[:, 1] > 32)[0]
    if not len(above):
        return float(shells[shells[:, 1].argmax(), 0])
    (r1, d1), (r2, d2) = shells[above[-1] : above[-1] + 2]
    return float(r1 + (d1 - 32) / (d1 - d2) * (r2 - r1))


def check(book, full):
    book.section("Noh's sphere")
    book.say(
        "No part of the paper. The hardest of the shocks that have a closed form: gas at rest at 64 times its "
        "density around a point."
    )
    figure, axis = subplots(figsize=(6, 3.4))
    exact = np.linspace(0.005, 0.5, 400)
    axis.plot(exact, np.where(exact < SHOCK, 64.0, (1 + TIME / exact) ** 2), color="black", label="exact")
    rows, found = [], []
    sizes = (50, 100, 200) if full else (50, 100)
    for n, run in zip(sizes, solve([Case(NOH, n=n) for n in sizes])):
        radius, density, shells = profile(run)
        front = shock(shells)
        rest = density[(radius > 0.5 * SHOCK) & (radius < 0.9 * SHOCK)].mean()
        outside = (shells[:, 0] > 0.35) & (shells[:, 0] < 0.5)
        before = float(np.abs(shells[outside, 1] / (1 + TIME / shells[outside, 0]) ** 2 - 1).max())
        energy = run.history()["total_energy"]
        found.append((front / SHOCK - 1, rest / 64 - 1, before))
        rows.append(
            [
                f"{n}", f"{front:.3f}", f"{rest:.1f}", f"{before:.1e}", f"{float(energy[-1] / energy[0] - 1):.1e}",
                f"{run.cpu_seconds:.0f}",
            ]
        )
        axis.plot(shells[:, 0], shells[:, 1], linewidth=0.9, label=f"h = 1/{n}")
    axis.set_xlabel("radius")
    axis.set_ylabel("density")
    axis.legend(fontsize=7)
    for (first, second, third), n in zip(found[-1:], sizes[-1:]):
        book.at_most("noh", f"radius of the shock at h = 1/{n}, relative error", abs(first), limits(n)[0])
        book.at_most(
            "noh", f"density between half and 0.9 of the shock's radius at h = 1/{n}, relative error", abs(second),
            limits(n)[1],
        )
        book.at_most("noh", f"density before the shock at h = 1/{n}, relative error", third, limits(n)[2])
    book.at_least(
        "noh", "error of the shock's radius, each size over the next",
        min(abs(a[0] / b[0]) for a, b in zip(found, found[1:])), 1.3,
    )
    book.figure("noh", figure, "Noh's sphere at t = 0.6: means over shells of 0.01.")
    book.table(
        "noh", ["cells to 1", "shock (0.2)", "density behind (64)", "error before it", "energy", "CPU s"], rows,
        "Noh's sphere, SGMP.",
    )
    book.command(Case(NOH, n=100))


def limits(n):
    """Bounds of the shock's radius, of the density behind it and of that before it. Bulk viscosity spreads a shock over
    three to four cells: its place is known to two. Behind it the scheme is of first order, before it of second, and a
    quarter and a hundredth are what is allowed at 100 cells."""
    return 2 / n / SHOCK, 25 / n, 100 / n**2


if __name__ == "__main__":
    main(check, __doc__)
