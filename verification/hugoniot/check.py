#!/usr/bin/env python3
"""Hugoniots: symmetric impact of six metals and of water against the jump conditions with the measured shock speed."""
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parents[2]/"scripts/dev")]
from common import COLOURS, ROOT, Case, main, slopes, solve, subplots  # noqa: E402
from material_library import constants  # noqa: E402

MATTER = ("copper", "aluminium_2024_t3", "nickel", "tantalum", "tungsten_alloy", "lead", "water")
SPEEDS = (300.0, 1000.0, 2000.0)  # of either plate (m/s)
CELLS = (100, 200)
LENGTH = 10.0


def equation(name):
    """Constants of a material of the library, in mm, g, ms."""
    cards = constants(ROOT/"input/materials"/f"{name}.inp")
    eos = cards["eos"]
    return {
        "density": cards["material"]["density"] * 1e-6,
        **{key: eos.get(key, 0.0) for key in ("c0", "s", "s2", "s3", "gamma0")},
    }


def jump(c, up):
    """Shock speed, pressure and density behind a shock with particle velocity up: mass and momentum are kept."""
    us = c["c0"] + c["s"]*up
    for _ in range(200):
        us = c["c0"] + up*(c["s"] + c["s2"]*(up/us) + c["s3"]*(up/us)**2)
    return us, c["density"]*us*up, c["density"]/(1 - up/us)


def measured(run, up, t_end, pressure, front):
    """The same from the particles: means by volume over the middle of what the shocks have passed, without the plane of
    impact, which is heated; place of half the pressure."""
    particles = run.particles()
    x, p, rho = abs(particles.points[:, 0]), particles.fields["pressure"], particles.fields["density"]
    inside = (x > 0.25*front) & (x < 0.75*front)
    noise = float(np.sqrt(np.average((p[inside]/pressure - 1)**2, weights=1/rho[inside])))
    order = np.argsort(x)
    last = np.nonzero(p[order] > 0.5*pressure)[0][-1]
    before, behind = order[last + 1], order[last]
    place = x[behind] + (x[before] - x[behind])*(p[behind] - 0.5*pressure)/(p[behind] - p[before])
    outwards = np.sign(particles.points[:, 0])*particles.fields["velocity"][:, 0]
    still = float(abs(np.average(outwards[inside], weights=1/rho[inside])))
    return (
        place / t_end + up, float(np.average(p[inside], weights=1 / rho[inside])),
        inside.sum() / (1 / rho[inside]).sum(), still, noise,
    )


def check(book, full):
    book.section("Hugoniots")
    book.say(
        "Two plates of the same matter meet: either is brought to rest by a shock, so that the particle velocity "
        "behind it is their speed. Exact: p = ρ0 Us up and ρ = ρ0/(1 - up/Us) with the "
        "measured Us = c0 + s up + s2 (up/Us) up + s3 (up/Us)² up of the material library (Steinberg 1996; water: "
        "LS-DYNA AWG). No strength, `eos … shock`, b1 = 1.5, b2 = 0.3."
    )
    rows, figure_rows = [], []
    for name in MATTER:
        c = equation(name)
        for up in SPEEDS:
            us, pressure, density = jump(c, up)
            t_end = 0.8*LENGTH/us
            cases = [Case("verification/hugoniot/impact.inp", cells=n, speed=up, t_end=t_end, **c) for n in CELLS]
            errors = []
            for n, run in zip(CELLS, solve(cases)):
                found = measured(run, up, t_end, pressure, (us - up)*t_end)
                errors.append([abs(value/exact - 1) for value, exact in zip(found, (us, pressure, density))])
                rows.append(
                    [
                        name, up, n, us, found[0], pressure / 1e3, found[1] / 1e3, density * 1e6, found[2] * 1e6,
                        found[3], found[4],
                    ]
                )
            title = f"Hugoniot of {name}, {up:.0f} m/s"
            for quantity, value, exact in zip(
                ("shock speed (m/s)", "pressure (MPa)", "density (g/mm³)"), found, (us, pressure, density)
            ):
                book.within(title, f"{quantity}, {CELLS[-1]} cells", value, exact, 0.01)
            book.at_most(title, "particle velocity left behind the shock over up", found[3]/up, 0.005)
            rows[-1].append(float(slopes(1/np.array(CELLS), np.array(errors)[:, 0])[0]))
            rows[-2].append("")
            figure_rows.append((name, up, found[0]))
    book.table(
        "hugoniot",
        [
            "matter", "up", "cells", "Us exact", "Us", "p exact (GPa)", "p (GPa)", "ρ exact (kg/m³)", "ρ (kg/m³)",
            "|u| behind", "noise of p", "order of Us",
        ],
        rows,
        "Behind the shocks; m/s. Noise: rms of the particles' pressure over the exact one. Order: of the error of "
        "the shock speed with the cell; "
        "at 1000 and 2000 m/s it is the length of the steps that limits it.",
    )
    series(book)
    steps(book)
    figure, axes = subplots(1, 1, figsize=(7, 4.5))
    for k, name in enumerate(MATTER):
        c, up = equation(name), np.linspace(0, 2200, 50)
        colour = list(COLOURS.values())[k % len(COLOURS)] if k < len(COLOURS) else "0.4"
        axes.plot(up/1e3, [jump(c, u)[0]/1e3 for u in up], color=colour, linewidth=0.9)
        axes.plot(
            [u / 1e3 for n, u, _ in figure_rows if n == name], [us / 1e3 for n, _, us in figure_rows if n == name], "o",
            color=colour, label=name,
        )
    axes.set(xlabel="particle velocity (km/s)", ylabel="shock speed (km/s)")
    axes.legend(fontsize=8)
    book.figure("hugoniot", figure, f"Measured shock speeds ({CELLS[-1]} cells) on the published Hugoniots.")
    book.command(Case("verification/hugoniot/impact.inp", speed=1000.0))


def series(book):
    """What `eos … gruneisen`, a cubic in the compression, makes of copper."""
    rows, c = [], equation("copper")
    for up in (500.0, 1000.0, 1500.0):
        us, pressure, _ = jump(c, up)
        t_end = 0.8*LENGTH/us
        run = solve(
            [
                Case(
                    "verification/hugoniot/impact.inp", cells=CELLS[-1], speed=up, t_end=t_end, equation="gruneisen",
                    **c,
                )
            ]
        )[0]
        found = measured(run, up, t_end, pressure, (us - up)*t_end)
        rows.append([up, pressure/1e3, found[1]/1e3, 100*(found[1]/pressure - 1)])
    book.table(
        "hugoniot_series", ["up (m/s)", "p exact (GPa)", "p (GPa)", "off (%)"], rows,
        "Copper with `eos … gruneisen`, whose Hugoniot is a series to the third order.",
    )


def steps(book):
    """The energy that long steps gain in a strong shock is pressure behind it."""
    rows, up = [], 2000.0
    for name in ("water", "copper"):
        c = equation(name)
        us, pressure, density = jump(c, up)
        t_end = 0.8*LENGTH/us
        for cfl in (0.4, 0.2, 0.1):
            run = solve(
                [Case("verification/hugoniot/impact.inp", cells=CELLS[-1], speed=up, t_end=t_end, cfl=cfl, **c)]
            )[0]
            found = measured(run, up, t_end, pressure, (us - up)*t_end)
            energy = run.history()["total_energy"]
            rows.append(
                [
                    name, cfl, *(100 * (value / exact - 1) for value, exact in zip(found, (us, pressure, density))),
                    100 * float(energy[-1] / energy[0] - 1),
                ]
            )
    book.table("hugoniot_steps", ["matter", "CFL", "Us off (%)", "p off (%)", "ρ off (%)", "energy gained (%)"], rows,
               f"up = 2000 m/s, {CELLS[-1]} cells: what the length of the steps does.")


if __name__ == "__main__":
    main(check, __doc__)
