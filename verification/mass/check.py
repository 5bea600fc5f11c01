#!/usr/bin/env python3
"""How fast waves run in elastic bodies, with lumped and with consistent masses of the nodes (doc/mass.md).

Standing waves of compression and of shear in a block between slip walls, along the grid and along its diagonal, and
Rayleigh's wave on a free surface; the period of each is exact (Lord Rayleigh 1885 for the last). Dispersion: the period
over the exact one less 1, over (k h)^2.
"""

import sys
from math import pi, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

WAVES, RAYLEIGH = "verification/mass/waves.inp", "verification/mass/rayleigh.inp"
COMPRESSION, SHEAR = sqrt(0.7 / (1.3 * 0.4)), sqrt(1 / 2.6)  # speeds; Young's modulus 1, Poisson's ratio 0.3, density 1
KINDS = {  # deck, settings, component, exact period, waves in one unit of length
    "compression": (WAVES, {}, "x", 1 / COMPRESSION, 1.0),
    "compression, diagonal": (WAVES, {"across": 1}, "x", 1 / COMPRESSION / sqrt(2), sqrt(2)),
    "shear, diagonal": (WAVES, {"across": 1, "shear": 1}, "x", 1 / SHEAR / sqrt(2), sqrt(2)),
    "Rayleigh's": (RAYLEIGH, {}, "y", 1 / (0.92741270970290 * SHEAR), 1.0),
}


def rayleigh(r):
    """Rayleigh's equation for the speed of the wave over that of shear."""
    return (2 - r * r) ** 2 - 4 * sqrt((1 - (r * SHEAR / COMPRESSION) ** 2) * (1 - r * r))


def period(run, component):
    """Mean period, from the zeros of a velocity."""
    table = np.genfromtxt(run.folder / "gauges.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    t, v = table["time"], table[f"velocity_{component}"]
    at = np.nonzero(v[:-1] * v[1:] < 0)[0]
    zeros = t[at] - v[at] * (t[at + 1] - t[at]) / (v[at + 1] - v[at])
    return 2 * (zeros[-1] - zeros[0]) / (len(zeros) - 1)


def check(book, full):
    book.section("Waves in elastic bodies")
    book.say("No part of the paper. Periods of standing waves over the exact ones.")
    book.near("Rayleigh's wave", "equation of its speed", rayleigh(0.92741270970290), 0.0, 1e-12)
    sizes = (10, 20, 40, 80) if full else (10, 20, 40)
    figure, axis = subplots(figsize=(6, 3.4))
    rows = []
    for kind, (deck, settings, component, exact, waves) in KINDS.items():
        for label, words in (("lumped", {"mass": "lumped"}), ("consistent", {"mass": "consistent"}),
                             ("gimp", {"method": "gimp"}), ("mpm", {"method": "mpm"})):
            if label == "mpm" and kind != "compression":
                continue
            runs = solve([Case(deck, n=n, **settings, **words) for n in sizes])
            errors = np.array([period(run, component) / exact - 1 for run in runs])
            cells = np.array(sizes) / waves
            rows.append([kind, label, *(f"{100 * error:+.2f} %" for error in errors)])
            constant = errors[1] * (cells[1] / (2 * pi)) ** 2
            if label == "lumped" and kind == "compression":
                book.near(kind, "dispersion with lumped masses", constant, 1 / 3, 0.03,
                          "1/3 by the theory of dense particles (doc/mass.md)")
            if label == "consistent":
                book.at_most(kind, "error of the period with consistent masses, 20 cells along x", abs(errors[1]),
                             0.005)
                book.at_most(kind, "the same, 10 cells", abs(errors[0]), 0.05)
            if kind == "compression":
                axis.loglog(sizes, np.abs(errors), marker="o", label=label)
    axis.set_xlabel("cells to a wave")
    axis.set_ylabel("error of the period")
    axis.legend(fontsize=7)
    book.figure("mass", figure, "Wave of compression along the grid.")
    book.table("mass", ["wave", "masses", *(f"{n} cells" for n in sizes)], rows,
               "Period over the exact one, less 1; cells to a wave along x.")
    book.command(Case(WAVES, n=20), Case(RAYLEIGH, n=20))


if __name__ == "__main__":
    main(check, __doc__)
