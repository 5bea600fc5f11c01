#!/usr/bin/env python3
"""Taylor bars of copper, Armco iron and 4340 steel with the library's constants: against finite elements and against
measured bars.

Finite elements: reference/lagrange.py, a Lagrangian code of its own, same constants (reference/shapes.csv is what it
writes). Measured: reference/measured.csv, with sources.
"""

import csv
import sys
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from bar_surface import of_rings  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

BAR = "verification/taylor_metals/bar.inp"
REFERENCE = Path(__file__).with_name("reference")
BARS = (
    ("copper", 190), ("copper_zerilli", 190), ("iron", 221), ("iron", 279), ("iron_zerilli", 221), ("steel_4340", 208),
    ("steel_4340", 343),
)
TITLE = {
    "copper": "copper",
    "copper_zerilli": "copper (Zerilli and Armstrong)",
    "iron": "Armco iron",
    "iron_zerilli": "Armco iron (Zerilli and Armstrong)",
    "steel_4340": "4340 steel",
}


def rows_of(name):
    with open(REFERENCE / name, encoding="utf-8") as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


def shape(run, spacing, length):
    """L, D at the foot and W at 0.2 of the initial length, from the bar's own foot: in the end it may have left the
    wall."""
    particles = run.particles()
    z, z0 = particles.points[:, 2], particles.fields["initial_position"][:, 2]
    lowest, second = (z[np.abs(z0 / spacing - place) < 0.1] for place in (0.5, 1.5))
    moved = particles.points.copy()
    moved[:, 2] -= lowest.min() - 0.5 * np.median(second - lowest)
    standing = SimpleNamespace(points=moved, fields=particles.fields)
    return of_rings(SimpleNamespace(particles=lambda: standing), spacing, length)


def computed(metal, speed, cells, radius=3.81, length=25.4):
    runs = solve([Case(BAR, metal=metal, speed=speed, cells=n, radius=radius, length=length) for n in cells], workers=1)
    return [shape(run, radius / n / 2, length) for n, run in zip(cells, runs)]


def against_elements(book, cells):
    reference = {
        (row["metal"], int(row["speed"]), int(row["cells"])): [float(row[key]) for key in "LDW"]
        for row in rows_of("shapes.csv")
    }
    table = []
    for metal, speed in BARS:
        want = reference[metal, speed, 24]
        table.append([TITLE[metal], speed, "finite elements 24", *want])
        for n, found in zip(cells, computed(metal, speed, cells)):
            table.append([TITLE[metal], speed, f"sgmp {n}", *found])
        for name, value, expected, tolerance in zip("LDW", found, want, (0.005, 0.02, 0.01)):
            book.within(
                "Taylor bars of three metals",
                f"{name} of {TITLE[metal]}, {speed} m/s, {n} cells to the radius (mm), against finite elements", value,
                expected, tolerance,
            )
    book.table(
        "taylor_metals", ["", "m/s", "code and cells to the radius", "L (mm)", "D (mm)", "W (mm)"], table,
        "Bars of 25.4 by 7.62 mm after 90 µs.",
    )


def against_experiments(book, cells):
    table, curves = [], {}
    for row in rows_of("measured.csv"):
        speed, radius, length = (float(row[key]) for key in ("speed", "radius", "length"))
        laws = ("", "_zerilli") if row["law"] == "both" else ("",)
        for law in laws:
            metal = row["metal"] + law
            found = dict(zip("LDW", computed(metal, speed, cells, radius, length)[-1]))
            want = {key: float(row[key]) for key in "LDW" if row[key]}
            table.append(
                [
                    TITLE[metal],
                    row["source"],
                    f"{speed:g}",
                    *(
                        f"{found[key]:.2f} ({want[key]:.2f}, {100 * (found[key] / want[key] - 1):+.1f} %)"
                        if key in want
                        else f"{found[key]:.2f}"
                        for key in "LDW"
                    ),
                ]
            )
            error = float(np.mean([abs(found[key] / value - 1) for key, value in want.items()]))
            known = float(row["known" + law]) if row["known" + law] else None
            book.at_most(
                "Taylor bars of three metals",
                f"{TITLE[metal]}, {speed:g} m/s ({row['source']}): mean error of {', '.join(want)} against the "
                f"measured bar",
                error,
                0.05,
                row["note"],
                known,
            )
            if row["metal"] == "copper":
                curves.setdefault(metal, []).append((speed, found["L"] / length, want["L"] / length))
    book.table(
        "taylor_metals_measured", ["", "bar", "m/s", "L (mm)", "D (mm)", "W (mm)"], table,
        "Computed (measured, difference); D is the largest diameter where the source has that.",
    )
    figure, axis = subplots(figsize=(6, 3.4))
    for metal, points in curves.items():
        speeds, found, want = np.array(sorted(points)).T
        axis.plot(speeds, found, "o", fillstyle="none", label=TITLE[metal])
    speeds, found, want = np.array(sorted(curves["copper"])).T
    axis.plot(speeds, want, "kx", label="measured")
    axis.set(xlabel="speed (m/s)", ylabel="final length over the first")
    axis.legend()
    book.figure("taylor_metals", figure, "Copper bars of six tests: coppers and slenderness differ.")


def check(book, full):
    book.section("Taylor bars of three metals")
    book.say(
        "Constants of the library as they are published, none fitted to these bars. Finite elements show what "
        "belongs to the program, measured bars what belongs to the constants."
    )
    cells = (12, 24, 48) if full else (12, 24)
    against_elements(book, cells)
    against_experiments(book, (24,))
    book.command(Case(BAR, metal="iron", speed=221, cells=24))


if __name__ == "__main__":
    main(check, __doc__)
