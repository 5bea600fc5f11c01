#!/usr/bin/env python3
"""Failure and softening that have a length of the material (failure length=): what tears a notched bar and what a shear
band bears, with cells of h, h/2 and h/4.

Known from outside: both must not depend on the cell. Without a length they do: the same decks with a length far below
the cell say so."""
import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

NOTCHED, SHEAR = "verification/length/notched.inp", "verification/length/shear.inp"
NONE = 1e-3  # mm: local


def force(run, body):
    """Time and force along x on the first driven part of a body, without the ringing of a few rows."""
    with open(run.folder / "motion.csv", encoding="utf-8") as stream:
        rows = [row for row in csv.DictReader(line for line in stream if not line.startswith("#"))
                if row["name"] == body]
    first = rows[0]["motion"]
    values = np.array([[float(row["time"]), float(row["force_x"])] for row in rows if row["motion"] == first])
    return values[:, 0], np.convolve(np.abs(values[:, 1]), np.ones(9) / 9, "same")


def band(run):
    """Heat of the band above that far away, over its largest value (mm): its width; and that value (K); over the middle
    of the strip."""
    end = run.particles()
    inside = np.abs(end.column("initial_position_x")) < 1
    y, heat = end.column("initial_position_y")[inside], end.column("temperature")[inside] - 293
    levels = np.unique(np.round(y, 6))
    profile = np.array([heat[np.abs(y - level) < 1e-5].mean() for level in levels])
    above = profile - profile.min()
    return float(above.sum() * (levels[1] - levels[0]) / above.max()), float(profile.max())


def check(book, full):
    book.section("A length of the material")
    sizes = (0.5, 0.25, 0.125) if full else (0.5, 0.25)
    known = {0.25: 1.052, 0.125: 1.021}[sizes[-1]]
    rows = []
    for length in (1, NONE):
        runs = solve([Case(NOTCHED, h=h, length=length) for h in sizes], workers=1)
        works = [run.summary["energy"]["supplied"] for run in runs]
        peaks = [force(run, "bar")[1].max() for run in runs]
        rows += [["notched bar", length, h, f"{work:.1f}", f"{peak:.0f}", run.summary["verdict"]]
                 for h, work, peak, run in zip(sizes, works, peaks, runs)]
        if length == 1:
            book.within("notched bar", f"work of tearing, h = {sizes[-2]} over that with {sizes[-1]} mm",
                        works[-2] / works[-1], 1.0, 0.02, "the notch itself is made of cells", known)
        else:
            book.at_least("notched bar, no length", f"work of tearing, h = {sizes[-2]} over that with {sizes[-1]} mm: "
                                                    f"it follows the cell", works[-2] / works[-1], 1.1)
    book.table("length_notched", ["scene", "length (mm)", "h (mm)", "work (mJ/mm)", "largest force (N/mm)", "verdict"],
               rows, "Notched bar that is torn.")
    rows, sizes = [], (0.2, 0.1, 0.05) if full else (0.2, 0.1)
    figure, axis = subplots(figsize=(6, 3.6))
    for length in (0.2, NONE):
        runs = solve([Case(SHEAR, h=h, length=length) for h in sizes], workers=1)
        curves = [force(run, "upper") for run in runs]
        late = [float(values[times > 0.9 * times[-1]].mean()) for times, values in curves]
        bands = [band(run) for run in runs]
        for h, (times, values) in zip(sizes, curves):
            axis.plot(1e3 * times, values, "-" if length > NONE else ":", label=f"l = {length} mm, h = {h} mm")
        rows += [[length, h, f"{values.max():.0f}", f"{end:.0f}", f"{width:.2f}", f"{heat:.0f}"]
                 for h, (_, values), end, (width, heat) in zip(sizes, curves, late, bands)]
        if length > NONE:
            book.within("shear band", f"force in the end, h = {sizes[-2]} over that with {sizes[-1]} mm",
                        late[-2] / late[-1], 1.0, 0.02)
            book.within("shear band", f"width, h = {sizes[-2]} over that with {sizes[-1]} mm",
                        bands[-2][0] / bands[-1][0], 1.0, 0.1)
    axis.set(xlabel="time (µs)", ylabel="force (N/mm)")
    axis.legend(fontsize=7)
    book.figure("length", figure, "Force on the edge of a strip that is sheared.")
    book.table("length_shear", ["length (mm)", "h (mm)", "largest force (N/mm)", "force in the end (N/mm)",
                                "width (mm)", "heat (K)"], rows, "Strip that is sheared.")
    book.command(Case(NOTCHED, h=0.25))
    book.command(Case(SHEAR, h=0.1))


if __name__ == "__main__":
    main(check, __doc__)
