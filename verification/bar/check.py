#!/usr/bin/env python3
"""The bar with fixed ends (paper, 6.2.1): one step, short time, large deformation; errors, orders, cost."""

import csv
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent)]
from common import (  # noqa: E402
    COLOURS, MARKERS, NAMES, VARIANTS, Case, cell_ticks, main, point, slope_triangle, slopes, solve, subplots,
    work_precision,
)
from exact import error  # noqa: E402

DT, SHORT, LARGE = 1e-5, 0.02, 0.3536
METHODS = ("mpm", "gimp", "cpgimp", "sgmp", "bspline")


def references():
    """Errors of the independent implementation: (case, method, cells) -> value."""
    with open(Path(__file__).with_name("reference") / "errors.csv") as stream:
        return {(row["case"], row["method"], int(row["cells"])): float(row["value"]) for row in csv.DictReader(stream)}


def errors_of(deck, time, sizes, **parameters):
    """Error and CPU time for each number of cells."""
    runs = solve([Case(deck, cells=cells, **parameters) for cells in sizes])
    return [error(run, time) for run in runs], [run.cpu_seconds for run in runs], runs


def draw(book, name, title, curves, caption, ylabel="error $e_u$ (m)"):
    """Double logarithmic errors over the cell size; curves: (label, method, line, sizes, errors)."""
    figure, axis = subplots(figsize=(6.4, 4.6))
    for label, method, line, sizes, errors in curves:
        axis.loglog(
            [1 / cells for cells in sizes], errors, line, color=COLOURS[method], marker=MARKERS[method], markersize=4,
            label=label,
        )
    sizes, errors = curves[0][3], curves[0][4]
    slope_triangle(axis, 1 / sizes[-1] * 1.5, 0.3 * min(min(c[4]) for c in curves), 2)
    cell_ticks(axis, max((c[3] for c in curves), key=len))
    axis.set(xlabel="cell size h (m)", ylabel=ylabel)
    axis.set_title(title, loc="left", fontweight="bold")
    axis.legend()
    book.figure(name, figure, caption)


def one_step(book, full, reference):
    sizes = (8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192) if full else (8, 64, 512, 8192)
    curves = {}
    for method in ("mpm", "sgmp"):
        for ppc in (1, 2, 3, 4) if full else (1, 2):
            curves[method, ppc], _, runs = errors_of("bar", DT, sizes, method=method, ppc=ppc)
            overall, = slopes([1 / sizes[0], 1 / sizes[-1]], [curves[method, ppc][0], curves[method, ppc][-1]])
            book.near(
                "bar, one step", f"order from 1/{sizes[0]} to 1/{sizes[-1]}, {NAMES[method]} ({ppc} per cell)", overall,
                2.0, 0.01,
            )
            book.at_least("bar, one step", f"least order of all sizes, {NAMES[method]} ({ppc} per cell)",
                          min(slopes([1 / n for n in sizes], curves[method, ppc])), 1.95)
    book.command(*[run.case for run in runs[:1]])
    at = sizes.index(64)
    for method, ppc, value in (("mpm", 1, 4.259e-10), ("mpm", 2, 2.839e-10), ("sgmp", 2, 7.755e-10)):
        book.within(
            "bar, one step", f"error at 1/64, {NAMES[method]} ({ppc} per cell) (m)", curves[method, ppc][at], value,
            0.01,
        )
    same = max(abs(a / b - 1) for a, b in zip(curves["mpm", 1], curves["sgmp", 1]))
    book.at_most("bar, one step", "SGMP against MPM, 1 per cell, relative", same, 1e-6)
    for method in ("mpm", "sgmp"):
        for cells in (8, 64, 512, 8192):
            book.within("bar, one step", f"error at 1/{cells}, {NAMES[method]}, against the independent code",
                        curves[method, 2][sizes.index(cells)], reference["one step", method, cells], 0.01)
    lines = {1: "-", 2: "--", 3: "-.", 4: ":"}
    draw(
        book, "bar_one_step", "One step (Fig. 9a)",
        [(f"{NAMES[m]}, {p} per cell", m, lines[p], sizes, e) for (m, p), e in curves.items()],
        "Error after one step of 10 µs. Both methods are of second order; with one particle per cell SGMP is MPM.",
    )
    if full:
        book.table(
            "bar_one_step", ["cells"] + [f"{NAMES[m]} ({p})" for m, p in curves],
            [[cells] + [curves[key][i] for key in curves] for i, cells in enumerate(sizes)],
            "Errors after one step (m).",
        )


def short_time(book, full, reference):
    sizes = (8, 16, 32, 64, 128, 256, 512, 1024) if full else (8, 64, 256, 512, 1024)
    curves, cost = {}, {}
    for method in METHODS:
        curves[method], cost[method], runs = errors_of("bar", SHORT, sizes, method=method, steps=2000)
        book.command(runs[0].case)
    for cells, value in ((8, 9.60e-5), (64, 1.54e-6), (512, 2.32e-8)):
        book.within(
            "bar, short time", f"error of SGMP at 1/{cells} (m)", curves["sgmp"][sizes.index(cells)], value, 0.02
        )
    best, finest = sizes.index(256), len(sizes) - 1
    book.within("bar, short time", "error of MPM at 1/256 (m)", curves["mpm"][best], 6.22e-8, 0.02)
    book.at_least(
        "bar, short time", "MPM at 1/1024 over MPM at 1/256: the error grows",
        curves["mpm"][finest] / curves["mpm"][best], 1.5,
    )
    for method in ("sgmp", "mpm", "cpgimp", "bspline"):
        for cells in (8, 64, 512):
            book.within("bar, short time", f"error at 1/{cells}, {NAMES[method]}, against the independent code",
                        curves[method][sizes.index(cells)], reference["short time", method, cells], 0.02)
    order, = slopes([1 / 8, 1 / 256], [curves["bspline"][sizes.index(n)] for n in (8, 256)])
    book.near("bar, short time", f"order of {NAMES['bspline']} from 1/8 to 1/256", order, 2.0, 0.02)
    drawn = [(NAMES[m], m, "-", sizes, curves[m]) for m in METHODS]
    if full:
        for steps, line in ((1000, "--"), (500, ":")):
            for method in ("mpm", "sgmp"):
                errors, _, _ = errors_of("bar", SHORT, sizes, method=method, steps=steps, dt=SHORT / steps)
                drawn.append((f"{NAMES[method]}, dt = {1e6 * SHORT / steps:.0f} µs", method, line, sizes, errors))
        errors, _, _ = errors_of("bar", SHORT, sizes, method="sgmp", update="usf", steps=500, dt=SHORT / 500)
        drawn.append(("SGMP USF, dt = 40 µs", "sgmp", "-.", sizes, errors))
    draw(
        book,
        "bar_short_time",
        "t = 0.02 s (Fig. 9b)",
        drawn,
        "Error at t = 0.02 s, two particles per cell at the Gauss points, dt = 10 µs unless stated, MUSL unless "
        "stated. MPM's error grows again "
        "where particles cross cells; SGMP's falls to the floor where the closed form, which is linear, stops being "
        "the solution. The curves of larger time steps lie upon the others: this error is the space's.",
    )
    book.table("bar_short_time", ["cells"] + [NAMES[m] for m in METHODS], [[cells] + [curves[m][i] for m in METHODS]
               for i, cells in enumerate(sizes)], "Errors at t = 0.02 s (m).")


def large_deformation(book, full, reference):
    book.say(
        "<b>Large deformation.</b> Eq. 98 of the paper prints ν where the shear modulus µ belongs; with ν the "
        "closed form is not a solution. "
        "cpGIMP starts from equal distances, for which its particles fill the bar; Gauss points do not suit it."
    )
    sizes = (8, 16, 32, 64, 128, 256)
    targets = {
        "sgmp": (2.63e-4, 6.1e-5, 2.5e-5, 1.0e-5, 4.3e-6, 3.6e-6),
        "cpgimp": (8.8e-5, 1.9e-5, 4.1e-6, 5.9e-7, 2.2e-7, 8.1e-8),
    }
    layouts = {
        "sgmp": "gauss",
        "cpgimp": "uniform",
        "mpm": "gauss",
        "gimp": "gauss",
        "bspline": "gauss",
        "normalised": "gauss",
    }
    curves, used, points = {}, {}, []
    for method in (
        ("sgmp", "normalised", "cpgimp", "mpm", "bspline", "gimp")
        if full
        else ("sgmp", "normalised", "cpgimp", "mpm", "bspline")
    ):
        used[method] = (
            sizes + (512, 1024)
            if full and method in ("sgmp", "normalised", "cpgimp")
            else sizes
            if full or method != "mpm"
            else sizes[:4]
        )
        curves[method], _, runs = errors_of(
            "bar_large", LARGE, used[method], **VARIANTS[method], layout=layouts[method]
        )
        points += [
            point(NAMES[method], method, f"h = 1/{n}, {layouts[method]} layout", run, e)
            for n, run, e in zip(used[method], runs, curves[method])
        ]
        book.command(runs[0].case)
    for method, values in targets.items():
        for cells, value, found in zip(sizes, values, curves[method]):
            book.within("bar, large deformation", f"error of {NAMES[method]} at 1/{cells} (m)", found, value, 0.05)
            book.within(
                "bar, large deformation", f"error of {NAMES[method]} at 1/{cells}, against the independent code", found,
                reference["large deformation", method, cells], 0.02,
            )
    for cells in (8, 16, 32, 64, 128):
        book.within("bar, large deformation", f"error of {NAMES['bspline']} at 1/{cells}, against the independent code",
                    curves["bspline"][sizes.index(cells)], reference["large deformation", "bspline", cells], 0.02)
    for cells, value in ((64, 3.4e-6), (256, 2.3e-7)):
        book.regression(
            "bar, large deformation", f"error of SGMP with normalised stress at 1/{cells} (m)",
            curves["normalised"][sizes.index(cells)], value, 0.05,
        )
    order, = slopes([1 / 16, 1 / 256], [curves["normalised"][sizes.index(n)] for n in (16, 256)])
    book.at_least("bar, large deformation", "order of SGMP with normalised stress, 1/16 to 1/256", order, 1.9)
    book.at_most(
        "bar, large deformation", "error of SGMP with normalised stress at 1/256 (m)",
        curves["normalised"][sizes.index(256)], 3.5e-7,
    )
    if full:
        book.at_most(
            "bar, large deformation", "error of SGMP with normalised stress at 1/1024 (m)", curves["normalised"][-1],
            5e-8,
        )
    book.at_least(
        "bar, large deformation", "least error of MPM over its error at 1/8: no convergence",
        min(curves["mpm"][1:]) / curves["mpm"][0], 0.8,
    )
    draw(
        book,
        "bar_large",
        "Large deformation, t = 0.3536 s (Fig. 10)",
        [(f"{NAMES[m]} ({layouts[m]} layout)", m, "-", used[m], e) for m, e in curves.items()],
        "Error at the largest deformation (strain 7 %), dt = 10 µs. MPM does not converge, SGMP to about 4e-6, "
        "cpGIMP and SGMP with normalised stress (no part of the paper) further.",
    )
    book.table(
        "bar_large",
        ["cells"] + [NAMES[m] for m in curves],
        [
            [cells] + [e[i] if i < len(e) else "" for e in curves.values()]
            for i, cells in enumerate(max(used.values(), key=len))
        ],
        "Errors at t = 0.3536 s (m).",
    )
    work_precision(
        book, "bar_large_work_precision", "Bar, large deformation, dt = 10 µs", points, "error e (m)",
        (1e-4, 1e-5, 1e-6, 1e-7),
    )


def cost(book):
    """Work-precision of the short time: methods with a small and a large time step, and the schemes of SGMP with the
    large one."""
    sizes = (8, 16, 32, 64, 128, 256, 512)
    curves = [
        (f"{NAMES[m]}, dt = {1e6 * dt:.0f} µs", m, line, {"dt": dt})
        for m in METHODS
        for dt, line in ((1e-5, "-"), (1e-4, "--"))
    ]
    curves += [(f"SGMP {u.upper()}, dt = 100 µs", "sgmp", line, {"dt": 1e-4, "update": u})
               for u, line in (("usf", (0, (1, 1))), ("usl", (0, (6, 1.5))), ("usavg", "-."))]
    points = []
    for curve, method, line, parameters in curves:
        steps = round(SHORT / parameters["dt"])
        repeats = [
            solve([Case("bar", cells=n, method=method, steps=steps, tag=f"cost {i}", **parameters) for n in sizes])
            for i in range(3)
        ]
        for cells, runs in zip(sizes, zip(*repeats)):  # these runs are short: the least of three
            points.append(
                point(
                    curve, method, f"h = 1/{cells}", runs[0], error(runs[0], SHORT), line,
                    min(run.loop_seconds for run in runs),
                )
            )
    work_precision(book, "bar_work_precision", "Bar, t = 0.02 s", points, "error e (m)", (1e-5, 1e-6, 1e-7))


def check(book, full):
    book.section("Bar with fixed ends (6.2.1)")
    book.say(
        "An elastic bar, 1 m long, both ends fixed, starts with v = v<sub>0</sub> sin(πx/L). The error is the L2 "
        "norm of the displacement of the "
        "particles (Eq. 97) against the closed form at the material point. The reference errors come from a second "
        "implementation by another "
        "route (verification/bar/reference/independent.py)."
    )
    reference = references()
    one_step(book, full, reference)
    short_time(book, full, reference)
    large_deformation(book, full, reference)
    if full:
        cost(book)


if __name__ == "__main__":
    main(check, __doc__)
