#!/usr/bin/env python3
"""Normalised stress beside the plain one (no part of the paper): stability, Taylor bar, scheme USAVG, threshold,
cost."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent.parent / "taylor_bar")]
import numpy as np  # noqa: E402
from common import COLOURS, Case, main, solve, subplots  # noqa: E402

STRESSES = ("plain", "normalised")
COLOUR = {"plain": COLOURS["sgmp"], "normalised": COLOURS["normalised"]}
LEVEL = {"bar_stability": 2.0, "beam": 1.05, "taylor_bar": 1.05}  # Emax/E0 of a sound run


def growth(run):
    """Largest total energy over the initial one; 100 for a run that ended early or lost particles."""
    total = run.history()["total_energy"]
    return 100.0 if run.exit_code or run.summary["particles_lost"] else min(100.0, float(total.max() / total[0]))


def stability(book, full):
    """The largest Courant number up to which all runs are sound."""
    scans = [("bar_stability", f"bar, 1/{n}, {layout} layout", {"cells": n, "layout": layout}, np.arange(20, 31) / 10)
             for n in (32, 50) for layout in ("uniform", "gauss")]
    scans += [("beam", f"beam, h = {h} mm", {"h": h}, np.arange(20, 31) / 10) for h in ((1.0, 0.5) if full else (1.0,))]
    scans += [
        ("taylor_bar", f"Taylor bar, h = {h} mm", {"h": h}, np.arange(16, 26) / 10)
        for h in ((1.0, 0.76) if full else (1.0,))
    ]
    figure, axes = subplots(1, len(scans), figsize=(2.6 * len(scans), 3.8))
    rows, least = [], {}
    for axis, (deck, name, parameters, cfls) in zip(axes, scans):
        row = [name]
        for stress in STRESSES:
            runs = solve([Case(deck, cfl=float(c), stress=stress, **parameters) for c in cfls], may_fail=True)
            values = np.array([growth(run) for run in runs])
            unsound = np.flatnonzero(values > LEVEL[deck])
            largest = (
                float(cfls[unsound[0] - 1])
                if len(unsound) and unsound[0]
                else float(cfls[-1])
                if not len(unsound)
                else float("nan")
            )
            row.append(largest)
            least[stress, name] = largest
            axis.semilogy(
                cfls, values, color=COLOUR[stress], marker="s" if stress == "plain" else "D", markersize=3.5,
                label=stress,
            )
        axis.axhline(LEVEL[deck], color="0.5", linewidth=0.8)
        axis.set_title(name.replace(", h", ",\nh").replace(", 1/", ",\n1/"), loc="left", fontsize=9, fontweight="bold")
        axis.set_xlabel("Courant number")
        rows.append(row)
        book.at_least(
            "normalised stress", f"largest sound CFL less the plain one, {name}", round(row[2] - row[1], 3), 0.0
        )
    axes[0].set_ylabel("largest energy / initial energy")
    axes[0].legend()
    book.figure(
        "normalised_stability",
        figure,
        "Growth of the energy against the Courant number, SGMP MUSL with plain and normalised stress (cut at 100). "
        "Grey: the level called sound "
        "(2 for the bar, 1.05 for beam and Taylor bar).",
    )
    book.table(
        "normalised_stability", ["", "plain", "normalised"], rows,
        "Largest Courant number up to which all runs of the scan, in steps of 0.1, are sound; SGMP MUSL.",
    )
    book.command(*[Case(deck, cfl=2.0, stress="normalised", **parameters) for deck, _, parameters, _ in scans])


def taylor(book, full):
    """Shape and cost of the Taylor bar."""
    from check_taylor import mean_error, shape  # the example's own rules
    rows = []
    for cfl in (0.8, 1.8, 2.0) if full else (1.8,):
        found = {}
        for stress, run in zip(
            STRESSES, solve([Case("taylor_bar", cfl=cfl, stress=stress) for stress in STRESSES], workers=1)
        ):
            found[stress] = shape(run)
            rows.append(
                [
                    stress, cfl, *(found[stress][k] for k in "LDW"), 100 * mean_error(found[stress]), growth(run),
                    run.cpu_ns,
                ]
            )
        for key in "LDW":
            book.within(
                "Taylor bar, h = 0.76 mm", f"{key} with normalised stress against plain, CFL {cfl} (mm)",
                found["normalised"][key], found["plain"][key], 0.02,
            )
        book.at_most(
            "Taylor bar, h = 0.76 mm", f"error e with normalised stress, CFL {cfl}", mean_error(found["normalised"]),
            0.03,
        )
    book.table(
        "normalised_taylor",
        ["stress", "CFL", "L (mm)", "D (mm)", "W (mm)", "e (%)", "Emax/E0", "ns per particle-step"], rows,
        "Taylor bar, h = 0.76 mm, SGMP MUSL.",
    )


def usavg(book):
    """Energy over 35 periods of the stiff bar."""
    rows = []
    for stress in STRESSES:
        for v0 in (10, 100):
            for update in ("musl", "usf", "usavg"):
                cases = [Case("bar_stability", cfl=c, update=update, stress=stress, v0=v0) for c in (0.5, 1.0, 2.0)]
                for case, run in zip(cases, solve(cases, may_fail=True)):
                    total = run.history()["total_energy"]
                    late = total[len(total) - len(total) // 35:].mean() / total[:len(total) // 35].mean()
                    cfl = case.parameters["cfl"]
                    rows.append(
                        [update.upper(), stress, v0, cfl, float(late), float(total.min() / total[0]), growth(run)]
                    )
                    if update == "usavg" and v0 == 10:
                        book.near(
                            "USAVG",
                            f"energy of the last of 35 periods over that of the first, {stress} stress, CFL {cfl}",
                            late, 1.0, 1e-3,
                        )
    book.table(
        "normalised_usavg",
        ["scheme", "stress", "v0 (m/s)", "CFL", "last / first period", "Emin/E0", "Emax/E0"],
        rows,
        "Total energy of the stiff bar (6.2.3), h = 1/32: mean of the last of 35 periods over that of the first. "
        "The largest strain is v0/c: 0.3 % and 2.8 %.",
    )


def threshold(book, values=(None, 0.02, 0.1, 0.25, 0.5, 0.7, 0.9)):
    """How full must a cell and its neighbours be? None: plain stress."""
    from check_beam import deflection_error
    from check_taylor import mean_error, shape
    from check_vortex import error
    rows = []
    for interior in values:
        words = {"stress": "plain"} if interior is None else {"stress": "normalised", "interior": interior}
        beam, bar = solve([Case("beam", h=0.5, **words), Case("taylor_bar", h=1.0, cfl=1.8, **words)])
        twist, = solve([Case("vortex", keep_dumps=True, cells=16, amplitude=0.5, cfl=0.8, **words)], may_fail=True)
        total = beam.history()["total_energy"]
        rows.append(
            [
                "plain" if interior is None else interior, deflection_error(beam), 100 * (total[-1] / total[0] - 1),
                *(shape(bar)[k] for k in "LDW"), 100 * mean_error(shape(bar)), growth(bar),
                error(twist, 1.0) if twist.exit_code == 0 else "failed",
            ]
        )
    book.table(
        "normalised_threshold",
        [
            "interior",
            "beam: error (mm)",
            "beam: energy (%)",
            "L (mm)",
            "D (mm)",
            "W (mm)",
            "e (%)",
            "Emax/E0",
            "vortex: error (m)",
        ],
        rows,
        "The threshold `interior`: beam, h = 0.5 mm, 50 µs; Taylor bar, h = 1 mm, CFL 1.8; vortex, A = 0.5, h = "
        "1/16, one period.",
    )


def cost(book, full):
    """Nanoseconds per particle and step, from the CPU times of a long and a short run, so that the start does not
    count."""
    variants = (
        ("SGMP", {"method": "sgmp", "stress": "plain"}),
        ("SGMP, normalised stress", {"method": "sgmp", "stress": "normalised"}), ("cpGIMP", {"method": "cpgimp"}),
    )
    scenes = [
        ("block", "block, 32³ cells, elastic (3D)", {"cells": 32}, "steps", 5, 35),
        ("beam", "beam, h = 0.5 mm (2D)", {"h": 0.5}, "t_end", 0.002, 0.012),
        ("bar", "bar, 1/8192 (1D)", {"cells": 8192}, "steps", 50, 350),
    ]
    rows = []
    for deck, name, parameters, key, short, long in scenes:
        found = {label: [] for label, _ in variants}
        for repeat in range(5 if full else 3):           # in turn, so that a busy time of the machine meets all
            for label, words in variants:
                few, many = solve(
                    [
                        Case(deck, tag=f"price {repeat}", **parameters, **words, **{key: value})
                        for value in (short, long)
                    ],
                    workers=1,
                )
                found[label].append(
                    1e9
                    * (many.cpu_seconds - few.cpu_seconds)
                    / (many.summary["particle_steps"] - few.summary["particle_steps"])
                )
        price = {label: float(np.median(values)) for label, values in found.items()}
        ratio = price["SGMP, normalised stress"] / price["SGMP"] - 1
        rows.append([name, *price.values(), 100 * ratio])
        if "3D" in name:
            book.at_most(
                "normalised stress", f"extra cost per particle-step, {name}", ratio, 0.05,
                "a time, so never counted as a failure", known=ratio,
            )
    book.table(
        "normalised_cost",
        ["scene", *[f"{label} (ns)" for label, _ in variants], "extra (%)"],
        rows,
        "CPU time per particle and step, the median of several runs in turn, one core. With the two particles per "
        "cell of the bar a chunk of eight lanes is a quarter full, and "
        "a column more costs accordingly.",
    )


def share(example, name):
    """Makes another example's check importable as check_NAME."""
    import importlib.util
    path = Path(__file__).resolve().parent.parent / example / "check.py"
    specification = importlib.util.spec_from_file_location(f"check_{name}", path)
    module = importlib.util.module_from_spec(specification)
    sys.modules[f"check_{name}"] = module
    specification.loader.exec_module(module)


def check(book, full):
    for example, name in (("taylor_bar", "taylor"), ("beam", "beam"), ("vortex", "vortex")):
        share(example, name)
    book.section("Normalised stress")
    book.say(
        "An addition to the paper (doc/normalised-stress.md). Its errors are in the sections of bar, TNT slab, beam "
        "and vortex; here is what it must not spoil."
    )
    stability(book, full)
    taylor(book, full)
    usavg(book)
    if full:
        threshold(book)
    cost(book, full)


if __name__ == "__main__":
    main(check, __doc__)
