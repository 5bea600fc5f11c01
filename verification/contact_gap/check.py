#!/usr/bin/env python3
"""The gap between a block at rest and a rigid plate, with the default distance criterion and with lambda = 1 (paper,
Fig. 19)."""
import sys
from pathlib import Path

import numpy as np
from matplotlib.collections import PatchCollection
from matplotlib.patches import Circle

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import NAMES, Case, main, solve, subplots  # noqa: E402
from contact import METHODS, deck  # noqa: E402

SPACING = 0.05


def gap(run, turn):
    """Mean gap between the surfaces in particle spacings: lowest layer of the block, top layer of the plate."""
    particles, angle = run.particles(), np.radians(turn)
    height = particles.points[:, 1]*np.cos(angle) - particles.points[:, 0]*np.sin(angle)
    number = particles.column("body")
    lowest = np.sort(height[number == 2])[:round(1/SPACING)]
    return (lowest.mean() - height[number == 1].max())/SPACING - 1


def picture(book):
    """The sphere's foot for both criteria, a slice through the middle."""
    runs = solve([Case("sphere_slope", t_end=0.5, h=0.2, **more) for more in ({"lambda": 1}, {})])
    figure, axes = subplots(1, 2, figsize=(9, 3.6), sharey=True)
    for axis, run, title in zip(axes, runs, ("lambda = 1", "lambda = spacing/h = 0.5 (default)")):
        particles = run.particles()
        x, _, z = particles.points.T
        near = (abs(particles.points[:, 1]) < 0.1) & (z < 1)
        number = particles.column("body")
        middle = x[number == 1].mean()
        near &= abs(x - middle) < 1.4
        half = 0.5*run.summary["spacing"]
        for body, colour in ((1, "#1f5fb4"), (2, "#8c564b")):  # discs as large as particles
            centres = np.unique(np.column_stack([x - middle, z])[near & (number == body)].round(9), axis=0)
            discs = [Circle(centre, half) for centre in centres]
            axis.add_collection(PatchCollection(discs, facecolor=colour, edgecolor="white", linewidth=0.3))
        for line in np.arange(-0.4, 1.3, 0.2):
            axis.axhline(line, color="0.85", linewidth=0.6, zorder=0)
        axis.set(xlim=(-1.2, 1.2), ylim=(-0.35, 0.85), xlabel="x from the centroid (m)", aspect="equal")
        axis.set_title(title, loc="left", fontweight="bold")
    axes[0].set_ylabel("height (m)")
    book.figure(
        "contact_gap", figure,
        "Foot of the sphere on the slope (45 degrees, h = 0.2 m, after 0.5 s): with lambda = 1 it floats.",
    )
    book.command(*[run.case for run in runs])


def check(book, full):
    """Heights and angles to the grid."""
    book.section("Contact: gap at rest")
    cases = [(method, turn, 0) for method in METHODS for turn in (0, 30, 45)] + [("sgmp", 0, 0.03), ("sgmp", 0, 0.07)]
    runs = solve([deck("contact_gap/gap", method=method, turn=turn, lift=lift) for method, turn, lift in cases])
    for (method, turn, lift), run in zip(cases, runs):
        book.near(
            f"block at rest, {turn} degrees, {lift / 0.1:g} cells above the nodes, {NAMES[method]}", "gap (spacings)",
            gap(run, turn), 0.0, 0.3,
        )
    book.command(runs[0].case)
    cases = [(turn, lift) for turn in (0, 30) for lift in (0, 0.03)]
    runs = solve([deck("contact_gap/gap", turn=turn, lift=lift, **{"lambda": 1}) for turn, lift in cases])
    for (turn, lift), run in zip(cases, runs):
        book.near(
            f"block at rest, {turn} degrees, {lift / 0.1:g} cells above the nodes, SGMP, lambda = 1", "gap (cells)",
            0.5 * gap(run, turn), 0.5, 0.1,
        )
    book.command(runs[0].case)
    if full:
        picture(book)


if __name__ == "__main__":
    main(check, __doc__)
