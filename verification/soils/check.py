#!/usr/bin/env python3
"""Plasticity with a limit load: a strip pressed into metal."""
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import NAMES, Case, main, slopes, solve  # noqa: E402


def deck(name, **parameters):
    return Case(f"verification/soils/{name}.inp", **parameters)


def pressure(run):
    """Mean pressure under the strip over the second half of its way."""
    rows = np.genfromtxt(run.folder / "contact.csv", delimiter=",", names=True, usecols=range(12))
    late = rows["time"] > 0.5*rows["time"][-1]
    return rows["force_y"][late].mean()


def punch(book, full):
    book.say("A rigid strip is pressed slowly into metal of constant shear strength k (J2, plane strain, ν = 0.45, E = 2000 k), by 0.03 of half its width. Prandtl's slip lines: (2 + π) k, rough or smooth. "
             "The strip is as good as half a cell wider on each side, for contact acts at nodes: so much more it bears.")
    exact = 2 + math.pi
    sizes = (4, 8, 16)
    cases = [("sgmp", n, f) for f in (10, 0) for n in sizes] + [(m, 8, 10) for m in (("gimp", "mpm", "bspline") if full else ("gimp",))]
    runs = dict(zip(cases, solve([deck("punch", method=method, cells=n, friction=friction) for method, n, friction in cases])))
    table = []
    for (method, n, friction), run in runs.items():
        over = pressure(run)/exact
        table.append([NAMES[method], "rough" if friction else "smooth", n, float(over), float(over/(1 + 0.5/n))])
    for friction, name in ((10, "rough"), (0, "smooth")):
        errors = [pressure(runs["sgmp", n, friction])/exact - 1 for n in sizes]
        book.at_least("strip pressed into metal", f"order of the error, {name}, 4 to 16 cells, SGMP", slopes(1/np.array(sizes), errors).mean(), 0.8)
        for n, error in zip(sizes, errors):
            book.within("strip pressed into metal", f"mean pressure over (2 + π) k and the width with half a cell more on each side, {name}, {n} cells to half the width, SGMP",
                        (1 + error)/(1 + 0.5/n), 1.0, 0.03)
    book.at_most("strip pressed into metal", "error of the mean pressure, rough, 16 cells, SGMP", pressure(runs["sgmp", 16, 10])/exact - 1, 0.05)
    book.table("punch", ["method", "strip", "cells to half the width", "mean pressure over (2 + π) k", "the same over the width with half a cell more on each side"], table,
               "Strip pressed into metal: means over the second half of the way.")
    book.command(deck("punch"))


def check(book, full):
    book.section("Limit loads")
    punch(book, full)


if __name__ == "__main__":
    main(check, __doc__)
