#!/usr/bin/env python3
"""A thick-walled tube under sudden pressure against a second implementation in one dimension (lines.py)."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]
import numpy as np  # noqa: E402
from common import COLOURS, NAMES, VARIANTS, Case, main, solve, subplots  # noqa: E402
from lines import breathe  # noqa: E402

TUBE, END = "verification/tube/tube.inp", 20.0


def check(book, full):
    book.section("Tube under sudden pressure")
    book.say(
        "No part of the paper. Gas under pressure fills an elastic tube that is at rest and without stress; the "
        "outer radius is compared with a Lagrangian code in one dimension."
    )
    times, exact = breathe(400, END, 400)
    _, coarser = breathe(200, END, 400)
    largest = np.abs(exact).max()
    book.at_most(
        "tube", "the second implementation at half its cells, over the largest displacement",
        np.abs(coarser - exact).max() / largest, 5e-3,
    )
    sizes = (8, 16, 32)
    figure, axis = subplots(figsize=(6, 3.4))
    axis.plot(times, exact, color="black", label="one dimension, 400 cells to the bore's radius")
    rows = []
    for name in ("sgmp", "normalised", "gimp", "mpm"):
        errors = []
        for run in solve([Case(TUBE, n=n, **VARIANTS[name]) for n in sizes]):
            gauges = run.folder / "gauges.csv"
            table = np.genfromtxt(gauges, delimiter=",", names=True, dtype=None, encoding=None)
            way = table["x"] - table["x"][0]
            errors.append(float(np.sqrt(np.mean((way - np.interp(table["time"], times, exact)) ** 2)) / largest))
        axis.plot(table["time"], way, color=COLOURS[name], linewidth=0.8, label=f"{NAMES[name]}, {sizes[-1]}")
        rows.append([NAMES[name], *(f"{error:.2e}" for error in errors)])
        if name == "mpm":
            book.at_least(
                "tube", "MPM does not converge, gas crosses its cells: rms error at 32 cells over that at 8",
                errors[2] / errors[0], 1.5,
            )
            continue
        book.at_most(
            "tube",
            f"rms error of the outer radius over 2.5 periods, {NAMES[name]}, 32 cells to the bore's radius, over "
            f"the largest displacement",
            errors[-1],
            0.02,
        )
        book.at_least(
            "tube", f"order of that error, {NAMES[name]}, 1/8 to 1/32", float(np.log2(errors[0] / errors[2]) / 2), 0.9
        )
    axis.set_xlabel("time")
    axis.set_ylabel("displacement of the outer radius")
    axis.legend(fontsize=7)
    book.figure("tube", figure, "Outer radius of the tube.")
    book.table(
        "tube", ["", *(f"{n} cells" for n in sizes)], rows,
        "Outer radius of the tube: rms error over two and a half periods, over the largest displacement.",
    )
    book.command(Case(TUBE, n=32))


if __name__ == "__main__":
    main(check, __doc__)
