#!/usr/bin/env python3
"""A sudden pressure in a spherical cavity of an endless elastic solid (Blake 1952), with edges that let waves out at
five radii.

F. G. Blake, J. Acoust. Soc. Am. 24 (1952), 211-215: the potential f(t - (r - R)/c)/r of the outgoing wave obeys a
damped oscillator; with Poisson's ratio 1/4, f'' + 4/3 (c/R) f' + 4/3 (c/R)^2 f = -p R/density, u = df/dr. From that the
values below, by quadrature here. At 160 us waves that edges at 0.5 m had sent back would be at the cavity again.
Dashpots for plane waves bear no load at rest: near them what is left when the wave has passed is too large. With the
place of the source (springs.inp) edges bear it (doc/loads.md).
"""

import sys
from math import cos, exp, sin, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

DECK, SPRINGS = "verification/cavity/cavity.inp", "verification/cavity/springs.inp"
RADIUS, DENSITY, YOUNG, PRESSURE, TIME = 0.1, 3000.0, 62.5e9, 1e6, 160e-6
SHEAR, SPEED = YOUNG / 2.5, 5000.0  # Poisson's ratio 1/4: c^2 = 3 G/density


def potential(s):
    """f, f' and f'' at the retarded time s: a step response of the oscillator."""
    if s <= 0:
        return 0.0, 0.0, -PRESSURE * RADIUS / DENSITY if s == 0 else 0.0
    a, w = 2 / 3 * SPEED / RADIUS, sqrt(4 / 3 - 4 / 9) * SPEED / RADIUS
    end = -PRESSURE * RADIUS / DENSITY / (a * a + w * w)
    f = end * (1 - exp(-a * s) * (cos(w * s) + a / w * sin(w * s)))
    first = end * exp(-a * s) * (a * a + w * w) / w * sin(w * s)
    return f, first, -PRESSURE * RADIUS / DENSITY - 2 * a * first - (a * a + w * w) * f


def exact(r, t=TIME):
    """Radial displacement, radial and hoop stress."""
    f, first, second = potential(t - (r - RADIUS) / SPEED)
    u = -f / r**2 - first / (SPEED * r)
    stretch = 2 * f / r**3 + 2 * first / (SPEED * r**2) + second / (SPEED**2 * r)
    # lambda = G
    return u, SHEAR * (stretch + 2 * u / r) + 2 * SHEAR * stretch, SHEAR * (stretch + 2 * u / r) + 2 * SHEAR * u / r


def found(run):
    """Radius, radial displacement, radial and hoop stress of all particles."""
    p = run.particles()
    x, z = p.points[:, 0], p.points[:, 2]
    u = [p.column(f"displacement_{axis}") for axis in "xz"]
    s = {name: p.column(f"stress_{name}") for name in ("xx", "zz", "yy", "xz")}
    radius = np.hypot(x - u[0], z - u[1])
    n = (x - u[0]) / radius, (z - u[1]) / radius
    radial = s["xx"] * n[0] ** 2 + s["zz"] * n[1] ** 2 + 2 * s["xz"] * n[0] * n[1]
    return radius, u[0] * n[0] + u[1] * n[1], radial, s["yy"]


def check(book, full):
    book.section("Blake's cavity")
    book.say("No part of the paper. The hole is cut out of a lattice of cubes, so its face is a staircase; means over "
             "shells one cell thick.")
    figure, axes = subplots(1, 2, figsize=(9, 3.4))
    line = np.linspace(RADIUS, 0.5, 200)
    for axis, k in zip(axes, (0, 1)):
        axis.plot(line, [exact(r)[k] for r in line], color="black", label="exact")
    rows = []
    kinds = [(10, "absorbing"), (10, "springs"), (10, "slip")]
    for cells, kind in kinds + ([(20, "absorbing"), (20, "springs")] if full else []):
        case = Case(SPRINGS, cells=cells) if kind == "springs" else Case(DECK, cells=cells, kind=kind)
        run, = solve([case], workers=1)
        radius, *values = found(run)
        h = RADIUS / cells
        row = [cells, kind]
        for r, k, bound in ((RADIUS + 0.75 * h, 0, 0.06), (0.15, 1, 0.04), (0.15, 2, 0.04), (0.4, 0, 0.1)):
            shell = np.abs(radius - r) < 0.5 * h
            scale = np.mean([exact(one)[k] for one in radius[shell]])
            error = float(values[k][shell].mean() / scale - 1)
            name = ("displacement", "radial stress", "hoop stress")[k]
            if kind == "springs" or (kind == "absorbing" and r < 0.4):
                book.near(f"{cells} cells to the radius, {kind}", f"{name} at r = {r:.4g} over the exact one",
                          1 + error, 1.0, bound)
            row.append(f"{100 * error:+.1f} %")
        rows.append([*row, f"{run.cpu_seconds:.0f}"])
        order = np.argsort(radius)
        for axis, k in zip(axes, (0, 1)):
            axis.plot(radius[order][::7], values[k][order][::7], ".", markersize=2, label=f"{cells} cells, {kind}")
    for axis, name in zip(axes, ("displacement (m)", "radial stress (Pa)")):
        axis.set(xlabel="radius (m)", ylabel=name)
    axes[0].legend(fontsize=7)
    book.figure("cavity", figure, "Blake's cavity after 160 us, every seventh particle.")
    book.table("cavity", ["cells", "edges", "u at the cavity", "radial stress at 0.15", "hoop stress at 0.15",
                          "u at 0.4", "CPU s"], rows, "Blake's cavity, deviations.")
    book.command(Case(DECK))
    book.command(Case(SPRINGS))


if __name__ == "__main__":
    main(check, __doc__)
