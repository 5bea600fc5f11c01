#!/usr/bin/env python3
"""Generalised vortex inside a block, a manufactured solution with large shear (no part of the paper): errors, orders,
cost."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import (  # noqa: E402
    COLOURS, MARKERS, NAMES, VARIANTS, Case, cell_ticks, main, point, slope_triangle, slopes, solve, subplots,
    work_precision,
)
from sgmp_view.files import read_pvd, read_vtu  # noqa: E402

METHODS = ("sgmp", "normalised", "cpgimp")
CFL = 0.8


def exact(start, amplitude, time):
    """Where the particles that start there are (input/vortex.inp)."""
    radius = np.hypot(*start.T)
    d = np.clip(radius - 1, -0.25, 0.25)
    angle = 0.5 * amplitude * (1 - np.cos(2 * np.pi * time)) * (1 - 16 * d**2)**3
    cos, sin = np.cos(angle), np.sin(angle)
    return np.column_stack([cos * start[:, 0] - sin * start[:, 1], sin * start[:, 0] + cos * start[:, 1]])


def error(run, part):
    """Root mean square distance (m) of the particles from where they should be, after that part of the period."""
    for time, path in read_pvd(run.folder / "particles.pvd"):
        if abs(time - part) < 1e-9:
            cloud = read_vtu(path)
            moved = cloud.points[:, :2] - exact(
                cloud.fields["initial_position"][:, :2], run.case.parameters["amplitude"], time
            )
            return float(np.sqrt(np.mean(np.sum(moved**2, axis=1))))
    raise ValueError(f"no dump at t = {part} in {run.folder}")


def case_of(method, amplitude, cells):
    """With A = 1 only half a period is run: after that, particles of all methods go astray and the time step with
    them."""
    part = {"part": 0.5} if amplitude == 1.0 else {}
    return Case("vortex", keep_dumps=True, amplitude=amplitude, cells=cells, cfl=CFL, **part, **VARIANTS[method])


def check(book, full):
    book.section("Generalised vortex inside a block")
    book.say(
        "Rings of a neo-Hookean block turn about its centre and back, driven by the body force that makes α = "
        "(A/2)(1 - cos 2πt/T)(1 - 16 (R-1)²)³ exact. "
        "The block goes on on both sides of the ring that moves, so no free surface limits the order; the walls are "
        "far. The largest shear is 6.9 A. "
        f"Two particles per cell and axis, ν = 0.3, CFL {CFL} (0.4 changes the error at 1/32 by less than 1 %)."
    )
    plan = {0.25: (16, 32, 64, 128), 0.5: (16, 32), 1.0: (16, 32)} if full else {0.25: (16, 32)}
    keys = [(amplitude, method, n) for amplitude, sizes in plan.items() for method in METHODS for n in sizes
            if method != "cpgimp" or (amplitude == 0.25 and n < 64)]
    # the long runs first, so that no core waits for them in the end
    keys.sort(key=lambda key: -key[2])
    runs = dict(zip(keys, solve([case_of(method, amplitude, n) for amplitude, method, n in keys])))
    rows, points, errors = [], [], {}
    for amplitude, sizes in plan.items():
        parts = (0.5,) if amplitude == 1.0 else (0.5, 1.0)
        for method in METHODS:
            used = [n for n in sizes if (amplitude, method, n) in runs]
            if not used:
                continue
            book.command(runs[amplitude, method, used[0]].case)
            for part in parts:
                errors[amplitude, method, part] = [error(runs[amplitude, method, n], part) for n in used]
            for i, n in enumerate(used):
                run, cells = runs[amplitude, method, n], []
                for part in (0.5, 1.0):
                    e = errors.get((amplitude, method, part))
                    cells += (
                        [e[i], f"{slopes([1 / used[i - 1], 1 / n], e[i - 1 : i + 1])[0]:.2f}" if i else ""]
                        if e
                        else ["", ""]
                    )
                rows.append([NAMES[method], amplitude, f"1/{n}", *cells, run.loop_seconds, run.cpu_ns])
                if amplitude == 0.25:
                    points.append(point(NAMES[method], method, f"h = 1/{n}", run, errors[amplitude, method, 1.0][i]))
    book.table(
        "vortex",
        ["method", "A", "h (m)", "e(T/2) (m)", "order", "e(T) (m)", "order", "CPU time (s)", "ns per particle-step"],
        rows,
        "Root mean square error of the positions of all particles. Most of the time is spent in evaluating the body "
        "force.",
    )
    judge(book, full, errors)
    figure, axes = subplots(1, 2, figsize=(11, 4.6), sharey=True)
    styles = dict(zip(plan, ("-", "--", ":")))
    for axis, part, title in ((axes[0], 0.5, "Half a period: largest shear"), (axes[1], 1.0, "One period")):
        for (amplitude, method, at), values in errors.items():
            if at == part:
                axis.loglog(
                    [1 / n for n in plan[amplitude][: len(values)]], values, styles[amplitude], color=COLOURS[method],
                    marker=MARKERS[method], markersize=4, label=f"{NAMES[method]}, A = {amplitude}",
                )
        slope_triangle(
            axis, 1 / plan[0.25][-1] * 1.3, 0.5 * min(errors[0.25, "normalised", 0.5]), 2, 2.0 if full else 1.3
        )
        cell_ticks(axis, plan[0.25])
        axis.set(xlabel="cell size h (m)")
        axis.set_title(title, loc="left", fontweight="bold")
    axes[0].set_ylabel("rms error of position (m)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncol=3)
    book.figure("vortex", figure, "Error over the cell size for three amplitudes A of the turning angle (rad).")
    work_precision(
        book, "vortex_work_precision", "Vortex, A = 0.25, one period", points, "rms error (m)", (1e-2, 1e-3, 3e-4)
    )


def judge(book, full, errors):
    """The checks."""
    for part, name in ((0.5, "half a period"), (1.0, "one period")):
        plain, normalised = (errors[0.25, m, part] for m in ("sgmp", "normalised"))
        n = 16 * 2**(len(normalised) - 1)
        if full or part == 0.5:
            book.at_least("vortex, A = 0.25", f"order of SGMP with normalised stress, 1/{n // 2} to 1/{n}, {name}",
                          slopes([1.0, 0.5], normalised[-2:])[0], 1.8)
        book.at_most(
            "vortex, A = 0.25", f"error with normalised stress over the plain one, 1/{n}, {name}",
            normalised[-1] / plain[-1], 1.0,
        )
    if full:
        book.at_most("vortex, A = 0.25", "order of plain SGMP, 1/64 to 1/128, one period: refinement no longer helps",
                     slopes([1.0, 0.5], errors[0.25, "sgmp", 1.0][-2:])[0], 1.0)
        book.at_most(
            "vortex, A = 0.5", "error with normalised stress over the plain one, 1/32, one period",
            errors[0.5, "normalised", 1.0][1] / errors[0.5, "sgmp", 1.0][1], 0.2,
        )


if __name__ == "__main__":
    main(check, __doc__)
