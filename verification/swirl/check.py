#!/usr/bin/env python3
"""Swirl of axisymmetric scenes: a torsional wave, a rotor and a thin disc against closed forms; angular momentum.

Torsion of a rod runs at sqrt(G/rho) whatever its length. Rotor: plane strain, sigma_r = w^2 (3 - 2 nu)/(8 (1 - nu)) (1
- r^2), sigma_theta = w^2/(8 (1 - nu)) (3 - 2 nu - (1 + 2 nu) r^2); disc: plane stress, the means over its thickness are
sigma_r = w^2 (3 + nu)/8 (1 - r^2), sigma_theta = w^2/8 (3 + nu - (1 + 3 nu) r^2).
"""

import sys
from math import pi, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve  # noqa: E402

TORSION, ROTOR, DISC = (f"verification/swirl/{name}.inp" for name in ("torsion", "rotor", "disc"))
POISSON, SHEAR, SPIN = 0.3, 1 / 2.6, 1e-3


def moment_kept(run):
    """Largest change of the angular momentum, over its value at the start."""
    moment = np.array(run.history()["angular_momentum"])
    return float(np.abs(moment - moment[0]).max() / abs(moment[0]))


def torsion(book):
    """Stress and velocity after 1.2 periods, which no wave of another speed would have."""
    example, sizes, speed = "swirl: torsional wave", (8, 16, 32), sqrt(SHEAR)
    rows = []
    for update, stress in (
        ("musl", "plain"), ("musl", "normalised"), ("usf", "plain"), ("usl", "plain"), ("usavg", "plain"),
    ):
        runs = solve([Case(TORSION, n=n, update=update, stress=stress, t_end=1.2 * 2 / speed) for n in sizes])
        errors = []
        for run in runs:
            particles, time = run.particles(), run.summary["time"]
            if update == "usf":  # which knows the strain of the last step only when the next one begins
                time -= run.history()["dt"][-1]
            start = particles.fields["initial_position"]
            exact = -SHEAR * start[:, 0] * 1e-4 / speed * np.sin(pi * start[:, 2]) * np.sin(pi * speed * time)
            errors.append(
                float(np.sqrt(np.mean((particles.column("stress_yz") - exact) ** 2)) / (0.5e-4 * SHEAR / speed))
            )
        name = f"{update} {stress}"
        rows.append([name, *(f"{error:.2e}" for error in errors), f"{np.log2(errors[-2] / errors[-1]):.2f}"])
        book.at_least(
            example, f"order of the shear stress, {name}, 1/16 to 1/32", float(np.log2(errors[-2] / errors[-1])), 1.8
        )
    book.table("swirl_torsion", ["", *(f"h = 1/{n}" for n in sizes), "order"], rows,
               "Torsional wave after 1.2 periods: rms error of the shear stress over the largest there is in the wave.")
    book.command(Case(TORSION, n=32, t_end=1.2 * 2 / speed))


def profile(run):
    """Radii and the means of sigma_r and sigma_theta over the particles that began at each."""
    particles = run.particles()
    radius = np.round(particles.fields["initial_position"][:, 0], 9)
    radii = np.unique(radius)
    return radii, *(
        np.array([particles.column(name)[radius == r].mean() for r in radii]) for name in ("stress_xx", "stress_yy")
    )


def columns(sizes, values):
    """Cells of a table for the sizes that there are."""
    return [f"{dict(zip(sizes, values))[n]:.2e}" if n in sizes else "" for n in (8, 16, 32)]


def turning(book):
    """Stresses of what turns, apart from one cell and a half at the surface."""
    rows = []
    strain, shell = SPIN**2 / (8 * (1 - POISSON)), SPIN**2 / 8
    cases = (
        (
            "rotor with plain stress and C(2)",
            ROTOR,
            (8, 16, 32),
            {"stress": "plain", "hoop": 0.125},
            strain * (3 - 2 * POISSON),
            strain * (1 + 2 * POISSON),
        ),
        (
            "rotor with normalised stress", ROTOR, (8, 16, 32), {}, strain * (3 - 2 * POISSON),
            strain * (1 + 2 * POISSON),
        ),
        (
            "disc of thickness R/8 with normalised stress", DISC, (16, 32), {}, shell * (3 + POISSON),
            shell * (1 + 3 * POISSON),
        ),
    )
    for name, deck, sizes, chosen, top, fall in cases:
        example, errors, middle = f"swirl: {name}", [], []
        runs = solve([Case(deck, n=n, **chosen) for n in sizes])
        for n, run in zip(sizes, runs):
            r, radial, hoop = profile(run)
            inside = r < 1 - 1.5 / n
            errors.append(max(float(np.sqrt(np.mean((found - exact)[inside] ** 2)) / top)
                              for found, exact in ((radial, top * (1 - r**2)), (hoop, top - fall * r**2))))
            middle.append(
                float(max(abs(radial[0] / (top * (1 - r[0] ** 2)) - 1), abs(hoop[0] / (top - fall * r[0] ** 2) - 1)))
            )
            book.at_most(example, f"change of the angular momentum at R/h = {n}, over itself", moment_kept(run), 1e-13)
        rows.append([name, *columns(sizes, errors), *columns(sizes, middle)])
        book.at_least(
            example, f"order of the stresses, R/h = {sizes[-2]} to {sizes[-1]}",
            float(np.log2(errors[-2] / errors[-1])), 1.3 if deck == DISC else 1.7,
        )
        book.at_most(
            example, f"error of the stress next to the axis at R/h = {sizes[-1]}", middle[-1],
            0.025 if deck == DISC else 2.5e-3,
        )
    book.table(
        "swirl_turning",
        ["", *(f"inside R/h = {n}" for n in (8, 16, 32)), *(f"next to the axis R/h = {n}" for n in (8, 16, 32))],
        rows,
        "Bodies that turn: rms error of the worse of radial and hoop stress over the stress in the middle, and "
        "error in the first column of particles.",
    )
    book.command(Case(ROTOR, n=32))


def check(book, full):
    book.section("Swirl")
    book.say(
        "No part of the paper. Torsion of a rod and stresses of what turns, in closed form; angular momentum is "
        "kept to round-off."
    )
    torsion(book)
    turning(book)


if __name__ == "__main__":
    main(check, __doc__)
