#!/usr/bin/env python3
"""The card blast: what it prints beside a printed table; the momentum of a free plate; clamped plates beside Nurick and
Martin's fit.

Printed: TM 5-1300 (1990), Figure 2-7 (spheres of TNT in free air), as OpenRadioss has it
(common_source/modules/loads/pblast_mod.F90: 256 distances in cm/g^(1/3), values in Mbar and us per g^(1/3)); five of
them in m, kg, kPa and ms. Clamped plates: Nurick and Martin, Int. J. Impact Engng 8 (1989), 171-186: deflection of the
middle over thickness = 0.425 phi + 0.277 with phi = I/(pi R t^2 sqrt(density yield)), I the impulse (both constants at
second hand: the paper was not at hand). Their loads were uniform. The bound is a thickness.
"""

import re
import subprocess
import sys
from math import hypot, log10, pi, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import ROOT, SOLVER, Case, main, solve, subplots  # noqa: E402

NEAREST, PLATE = "verification/blast_load/nearest.inp", "verification/blast_load/plate.inp"
NAMES = (
    "arrival (ms)", "duration (ms)", "incident peak (kPa)", "incident impulse (kPa ms)", "reflected peak (kPa)",
    "reflected impulse (kPa ms)",
)
PRINTED = {0.30514903495: (0.0703146, 0.185942, 8775.62, 149.327, 80935.8, 3080.36),
           1.0190762144: (0.550946, 1.80608, 896.334, 171.977, 4739.06, 545.421),
           3.0645214321: (4.13413, 2.71650, 78.1323, 63.1356, 204.370, 143.567),
           10.234280769: (23.3714, 4.22911, 10.7531, 20.6676, 22.5810, 38.7578),
           29.979794980: (80.5595, 5.72975, 2.53588, 7.16683, 5.12347, 12.4941)}
CHARGES, RADIUS, THICKNESS, HEIGHT, DENSITY, YIELD = (25, 50, 100, 150), 50.0, 1.6, 150.0, 7850.0, 270e6


def found(distance):
    """What --check prints, in kPa and ms."""
    case = Case(NEAREST, distance=distance)
    text = subprocess.run(
        [str(SOLVER), str(case.deck), *case.arguments(), "--check"], capture_output=True, text=True, check=True,
        cwd=ROOT,
    ).stdout
    text = text[text.index("arrives at"):text.index("memory")]
    values = [float(word) for word in re.findall(r"\d+\.\d+(?:E[-+]?\d+)?", text)]
    return values[:2] + [1e3 * value for value in values[2:]]


def impulse(distance):
    """Reflected and incident impulse in free air (kPa ms/kg^(1/3)) by Kingery and Bulmash's fits."""
    x = -0.204004553231 + 1.37882996018 * log10(distance)
    reflected = 10 ** (2.55875660396 - 0.903118886091 * x + 0.101771877942 * x**2 - 0.0242139751146 * x**3)
    x = 2.34723921354 + 3.24299066475 * log10(distance)  # to 0.792
    return reflected, 10 ** (
        2.38830516757 - 0.443749377691 * x + 0.168825414684 * x**2 + 0.0348138030308 * x**3 - 0.010435192824 * x**4
    )


def on_plate(charge, rings=2000):
    """Impulse on the plate (N s): both waves decay within one duration, so impulses add as pressures do."""
    root, total = (1e-3 * charge) ** (1 / 3), 0.0
    for i in range(rings):
        r = RADIUS * (i + 0.5) / rings
        distance = hypot(r, HEIGHT)
        c = HEIGHT / distance
        reflected, incident = impulse(1e-3 * distance / root)
        total += root * (c * c * reflected + (1 + c * c - 2 * c) * incident) * 2 * pi * r * RADIUS / rings * 1e-6
    return total


def gauge(run):
    table = np.genfromtxt(run.folder / "gauges.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    z = table["z"] if "z" in table.dtype.names else table["y"]
    return table["time"], z[0] - z


def check(book, full):
    book.section("Air blast without air: the card blast")
    book.say(
        "Arrival, duration, peaks and impulses of 1 kg in free air at five distances beside what is printed; then a "
        "plate, free and clamped."
    )
    rows = []
    for distance, printed in PRINTED.items():
        values = found(distance)
        worst = max(abs(value / reference - 1) for value, reference in zip(values, printed))
        book.at_most(f"1 kg at {distance:.3f} m", "largest deviation of the six values from those printed", worst, 1e-3)
        rows += [
            [f"{distance:.4f}", name, f"{value:.6g}", f"{reference:.6g}"]
            for name, value, reference in zip(NAMES, values, printed)
        ]
    book.table("blast_load", ["distance (m)", "value", "by --check", "printed"], rows, "1 kg of TNT in free air.")
    book.command(Case(NEAREST, distance=1.0190762144))

    free = solve([Case(PLATE, charge=charge, free=1, t_end=0.25) for charge in CHARGES], workers=1)
    impulses = []
    for charge, run in zip(CHARGES, free):
        impulses.append(-1e-3 * float(run.history()["momentum_z"][-1]))
        book.within(
            f"free plate, {charge} g", "momentum (N s), integral of the load over the plate", impulses[-1],
            on_plate(charge), 0.01,
        )

    shapes = [("gimp", 4)] + ([("gimp", 8), ("sgmp", 4), ("bspline", 4)] if full else [])
    figure, axis = subplots(figsize=(6, 3.6))
    rows = []
    for method, cells in shapes:
        runs = solve([Case(PLATE, charge=charge, method=method, cells=cells) for charge in CHARGES], workers=1)
        numbers, deflections = [], []
        for charge, total, run in zip(CHARGES, impulses, runs):
            phi = total / (pi * 1e-3 * RADIUS * (1e-3 * THICKNESS) ** 2 * sqrt(DENSITY * YIELD))
            time, deflection = gauge(run)
            last = deflection[time > 0.3].mean() / THICKNESS  # it has come to rest but for elastic vibrations
            book.near(
                f"clamped plate, {charge} g, {method}, {cells} cells",
                "deflection over thickness, fit 0.425 phi + 0.277", last, 0.425 * phi + 0.277, 1.0,
            )
            numbers.append(phi)
            deflections.append(last)
            rows.append(
                [
                    method, cells, charge, f"{total:.3f}", f"{phi:.2f}", f"{last:.2f}", f"{0.425 * phi + 0.277:.2f}",
                    f"{100 * (last / (0.425 * phi + 0.277) - 1):+.1f} %",
                    f"{deflection[time > 0.3].max() / THICKNESS - last:.2f}", run.summary["verdict"],
                    f"{run.cpu_seconds:.0f}",
                ]
            )
        axis.plot(numbers, deflections, "o-", markersize=4, label=f"{method}, {cells} cells")
    axis.plot(numbers, [0.425 * phi + 0.277 for phi in numbers], "k--", label="Nurick and Martin")
    axis.set(xlabel="impulse number phi", ylabel="deflection over thickness")
    axis.legend(fontsize=7)
    book.figure("blast_load", figure, "Deflection of clamped plates.")
    book.table(
        "blast_load_plates",
        [
            "method", "cells", "g", "N s", "phi", "deflection/thickness", "fit", "deviation", "vibration", "verdict",
            "CPU s",
        ],
        rows,
        "Clamped plates.",
    )
    book.command(Case(PLATE, charge=50))


if __name__ == "__main__":
    main(check, __doc__)
