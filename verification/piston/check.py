#!/usr/bin/env python3
"""An elastic-plastic piston: precursor and plastic shock against their jump conditions."""
import sys
from math import exp, sqrt
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parent.parent)]
from common import Case, main, solve  # noqa: E402

DENSITY, SHEAR, YIELD, C0, S, GAMMA = 2.79e-3, 28.6e3, 260.0, 5330.0, 1.34, 2.0
SPEED, T_END = 100.0, 5e-3
METHODS = ("sgmp", "gimp", "mpm")
CELLS = (0.1, 0.05)
# Why the deviator is 3 to 11 % low though pressure and stress are right, by method at 0.05 mm.
RIPPLES = (
    "ripples behind the front unload elastically, and each takes 2G times its strain off the deviator: a ripple of "
    "1 % of the compression is enough; "
    "viscosity linear=0.5 leaves 1 %"
)
CROSSING = "particles that cross cells make noise, which dissipates"
KNOWN = {"sgmp": 250.6, "gimp": 252.4, "mpm": 231.3}


def pressure(density, energy):
    """Mie-Grueneisen on the straight Hugoniot Us = c0 + s up; energy per mass."""
    mu = density/DENSITY - 1
    hugoniot = DENSITY*C0**2*mu*(1 + mu)/(1 - (S - 1)*mu)**2
    return hugoniot*(1 - 0.5*GAMMA*mu/(1 + mu)) + GAMMA*DENSITY*energy


def jump(before, density):
    """State behind a jump from (density, velocity, stress, energy) to a density with the deviator at yield; and the
    speed of the jump."""
    rho, u, stress, energy = before
    volume = 1/rho - 1/density

    def surplus(e):
        return e - energy - 0.5*(stress + pressure(density, e) + 2*YIELD/3)*volume

    low, high = energy, energy + 1e9
    for _ in range(200):
        middle = 0.5*(low + high)
        low, high = (middle, high) if surplus(middle) < 0 else (low, middle)
    new = pressure(density, low) + 2*YIELD/3
    speed = u + sqrt((new - stress)/(rho**2*volume))
    return (density, u + sqrt((new - stress)*volume), new, low), speed


def exact():
    """Precursor: the deviator reaches yield where ln(density ratio) is Y/2G. Then the shock behind which matter has the
    piston's velocity."""
    first, precursor = jump((DENSITY, 0.0, 0.0, 0.0), DENSITY*exp(YIELD/(2*SHEAR)))
    low, high = first[0]*(1 + 1e-9), DENSITY*1.2
    for _ in range(200):
        middle = 0.5*(low + high)
        low, high = (middle, high) if jump(first, middle)[0][1] < SPEED else (low, middle)
    second, shock = jump(first, low)
    return first, precursor, second, shock


def means(run):
    """Pressure, axial stress and von Mises stress where both waves have passed; places of the waves; velocity between
    them."""
    particles = run.particles()
    x, fields = particles.points[:, 0], particles.fields
    order = np.argsort(x)
    u = SPEED + fields["velocity"][order, 0]
    behind = (x > 5) & (x < 20)
    front = crossing(x[order], u, 0.5*(SPEED + 29.57))
    return (
        float(fields["pressure"][behind].mean()), float(-fields["stress"][behind, 0].mean()),
        float(fields["von_mises"][behind].mean()), front, crossing(x[order], u, 0.5 * 29.57),
    )


def crossing(x, u, level):
    """Last place where the velocity falls through a level."""
    last = np.nonzero(u > level)[0][-1]
    return float(x[last] + (u[last] - level)/(u[last] - u[last + 1])*(x[last + 1] - x[last]))


def check(book, full):
    book.section("Elastic-plastic piston")
    book.say(
        "A bar of aluminium meets a smooth wall with 100 m/s. Exact: the jump conditions of an elastic precursor, "
        "behind which the deviator is at yield, and of a plastic shock."
    )
    first, precursor, second, shock = exact()
    book.say(
        f"Precursor {precursor:.0f} m/s, {first[1]:.2f} m/s, pressure {first[2] - 2 * YIELD / 3:.1f} MPa; shock "
        f"{shock:.0f} m/s, pressure {second[2] - 2 * YIELD / 3:.1f} MPa, stress {second[2]:.1f} MPa."
    )
    settings = [(method, h, 0.06) for method in METHODS for h in (CELLS if full else CELLS[-1:])] + [
        ("sgmp", CELLS[-1], 0.5)
    ]
    cases = [
        Case("verification/piston/piston.inp", method=method, h=h, linear=linear, t_end=T_END)
        for method, h, linear in settings
    ]
    rows = []
    for (method, h, linear), run in zip(settings, solve(cases)):
        p, stress, mises, front, wave = means(run)
        speeds = [place/T_END + SPEED for place in (front, wave)]   # the wall is at rest: the bar comes with the speed
        rows.append([method, h, linear, speeds[1], speeds[0], p, stress, mises])
        title = f"piston, {method}, h = {h} mm, linear = {linear}"
        book.within(
            title, "plastic shock (m/s)", speeds[0], shock, 0.01, CROSSING if method == "mpm" else "",
            5391 if method == "mpm" else None,
        )
        book.within(title, "precursor (m/s)", speeds[1], precursor, 0.01)
        book.within(title, "pressure (MPa)", p, second[2] - 2*YIELD/3, 0.01)
        book.within(
            title, "axial stress (MPa)", stress, second[2], 0.01, CROSSING if method == "mpm" else "",
            1582 if method == "mpm" else None,
        )
        book.within(
            title, "von Mises stress (MPa)", mises, YIELD, 0.02, RIPPLES if linear < 0.5 else "",
            KNOWN[method] if linear < 0.5 else None,
        )
    book.table(
        "piston",
        [
            "method", "h (mm)", "linear", "precursor (m/s)", "shock (m/s)", "pressure (MPa)", "axial stress (MPa)",
            "von Mises (MPa)",
        ],
        rows,
        "Behind the shock, means over 5 to 20 mm from the wall.",
    )


if __name__ == "__main__":
    main(check, __doc__)
