#!/usr/bin/env python3
"""Plasticity with a limit load: a strip pressed into metal, a slope of which strength is reduced, columns of sand that collapse."""
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


def slope(book, full):
    book.say("A slope of 2 : 1 without a layer below it, φ = 20°, c = 0.05 γ H, sets under its weight while tan φ and c are divided by a factor. Griffiths and Lane (1999, example 1): it gives way at a factor of 1.4; Bishop and "
             "Morgenstern's charts: 1.38. Moving or at rest: the speed of the crest in the end.")
    cases = [(10, factor, "sgmp") for factor in (1.3, 1.35, 1.4, 1.45)] + [(20, factor, "sgmp") for factor in (1.35, 1.4)]
    cases += [(n, factor, method) for n, method in ((10, "gimp"), (10, "mpm")) for factor in (1.3, 1.35, 1.4, 1.45)] if full else []
    table, last = [], {}
    for (n, factor, method), run in zip(cases, solve([deck("slope", cells=n, factor=factor, method=method) for n, factor, method in cases])):
        row = np.genfromtxt(run.folder / "gauges.csv", delimiter=",", names=True, usecols=range(10))[-1]
        speed = math.hypot(row["velocity_x"], row["velocity_y"])
        table.append([NAMES[method], n, factor, float(speed)])
        last[method, n, factor] = speed
    for n in (10, 20):
        book.at_most("slope", f"speed of the crest over √(g H), factor {1.3 if n == 10 else 1.35:g}, {n} cells to the height", last["sgmp", n, 1.3 if n == 10 else 1.35], 3e-5)
        book.at_least("slope", f"speed of the crest over √(g H), factor 1.4, {n} cells to the height", last["sgmp", n, 1.4], 5e-4)
    book.table("slope", ["method", "cells to the height", "factor", "speed of the crest over √(g H)"], table, "Slope of which strength is reduced, in the end.")
    book.command(deck("slope"))


def ends(run):
    """Place of the front in the end, single grains left out (99 % of the mass is behind it), and the height of the heap."""
    particles = run.particles()
    density = particles.column("density")
    radius, height = particles.points[:, 0], particles.points[:, -1 if "round" in run.folder.parent.name else 1]
    weight = particles.column("mass") if "mass" in particles.fields else np.ones(len(density))
    order = np.argsort(radius)
    return radius[order][np.searchsorted(np.cumsum(weight[order])/weight.sum(), 0.99)], height.max()


def collapse(book, full):
    book.say("Columns of dry sand collapse over a rough floor; Lube et al. (2004, 2005): the run-out over the half width (the radius) is 1.2 (1.24) times the ratio of height to it, for ratios below 2.3 (1.7), whatever the sand. "
             "Their sand comes to rest at 31°. In simple shear without dilatancy Mohr and Coulomb's sand slides at the ratio sin φ of shear to normal stress (Davis 1968), Drucker and Prager's at 2 √3 sin φ/(3 - sin φ): tan 31° "
             "are φ = 36.9° and 26.3°.")
    cases = [("collapse", "mohr_coulomb", 36.9, 2, 2.4), ("collapse", "drucker_prager", 26.3, 2, 2.4), ("collapse", "mohr_coulomb", 31, 2, 2.4), ("collapse", "drucker_prager", 31, 2, 2.4),
             ("collapse", "mohr_coulomb", 36.9, 1, 1.2), ("round", "mohr_coulomb", 36.9, 1, 1.24), ("round", "mohr_coulomb", 36.9, 0.5, 0.62)]
    table = []
    for (name, law, friction, aspect, lube), run in zip(cases, solve([deck(name, material=law, friction=friction, aspect=aspect) for name, law, friction, aspect, _ in cases])):
        front, top = ends(run)
        table.append([name, law, friction, aspect, float(front - 1), lube, float(top)])
        if abs(friction - 31) > 1:
            book.within("column of sand", f"run-out, {name}, {law}, {friction:g} degrees, height {aspect:g}", front - 1, lube, 0.15)
    book.table("collapse", ["column", "law", "friction (degrees)", "height", "run-out", "Lube et al.", "height in the end"], table, "Columns of sand, lengths over half of the width or the radius.")
    book.command(deck("collapse"), deck("round"))


def check(book, full):
    book.section("Limit loads and sand")
    punch(book, full)
    slope(book, full)
    collapse(book, full)


if __name__ == "__main__":
    main(check, __doc__)
