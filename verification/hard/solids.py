"""Solids: plastic flow in any direction, nearly incompressible elasticity."""
import sys
from pathlib import Path

import numpy as np
from finite_elements import membrane as membrane_by_elements
from pictures import portraits
from table import METHODS, at_most, figure, run_methods, value_of, within

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import COLOURS, MARKERS, NAMES  # noqa: E402
from contact import read_table  # noqa: E402

DIRECTIONS = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "(1,1,1)": (1, 1, 1)}
LOAD = 2e-7


def taylor(table):
    """Taylor bar along four directions."""
    table.case(
        "Taylor bar along x, y, z and a diagonal",
        """
The halves of a copper cylinder of radius 3.8 mm and length 50.8 mm run into each other end-on at 190 m/s each, so
each hits a mirror as a Taylor bar hits a rigid smooth wall, and no wall fixes the direction. Density 8.93e-3
g/mm^3, E = 117 GPa, nu = 0.35, yield stress 157 MPa + 425 MPa times the plastic strain, Grueneisen c0 = 3940 m/s, s
= 1.49, gamma = 1.96; h = 1.27 mm (three cells per radius), 80 us, Courant number 0.5. The particles lie on the same
axis-parallel lattice whatever the axis. Length: 25.4 mm times the extent along the axis over that at the start.
Foot: 7.6 mm times the largest distance from the axis of particles within h of the middle over that at the start.
Experiment: 16.2 and 13.5 mm.""",
    )
    found = {name: run_methods("taylor", ax=a[0], ay=a[1], az=a[2]) for name, a in DIRECTIONS.items()}
    shapes = {name: {m: shape_of(run, DIRECTIONS[name]) for m, run in runs.items()} for name, runs in found.items()}
    for number, (what, experiment) in enumerate((("length", 16.2), ("diameter of the foot", 13.5))):
        for name, runs in found.items():
            table.row(
                f"{what} along {name} (mm)",
                {m: shapes[name][m][number] for m in METHODS},
                experiment,
                within(experiment, 0.05),
                runs,
            )
        spread = {m: np.ptp([shapes[name][m][number] for name in DIRECTIONS])/experiment for m in METHODS}
        table.row(f"{what}, spread over the directions", spread, 0.0, at_most(0.02))
    portraits(
        table, "taylor", found["x"], "plastic_strain",
        "Section through the axis of both halves along x in the end (mm).", axes=(0, 1, 2), cut=True,
    )


def shape_of(run, direction):
    """Length and diameter of the foot of a half; NaN of a run that failed."""
    if run.exit_code:
        return np.nan, np.nan
    axis = np.array(direction)/np.linalg.norm(direction)
    extents = []
    for points in (run.particles().fields["initial_position"], run.particles().points):
        along = points @ axis
        across = np.linalg.norm(points - np.outer(along, axis), axis=1)
        extents.append((np.ptp(along), across[np.abs(along) < 1.27].max()))
    return 25.4*extents[1][0]/extents[0][0], 7.6*extents[1][1]/extents[0][1]


def membrane(table):
    """Cook's membrane."""
    table.case(
        "Cook's membrane, nearly incompressible",
        """
Plane strain; corners (0,0), (48,44), (48,60), (0,44), clamped at x = 0, E = density = 1, loaded from rest by a body
force of 2e-7 per volume along y at t = 0 and never damped; h = 2. The mean of the deflection at (47.5, 59.5) over t
= 0 to 1500 under a Hann window is the static one. Reference: finite elements of nine nodes, 20 x 20 (the last row
has the largest difference from 14 x 14, that of nu = 0.4999). Pressure: time means under the same window of the 16
particles nearest to (22, 32), a square of 4 x 4 at distances of h/2; their rms deviation from the plane that fits
them best, over their rms.""",
    )
    poissons = (0.3, 0.49, 0.499, 0.4999)
    tips, check = {}, {}
    for poisson in poissons:
        runs = run_methods("membrane", poisson=poisson)
        reference = membrane_by_elements(poisson, LOAD, 20)(47.5, 59.5)[1]
        check[poisson] = membrane_by_elements(poisson, LOAD, 14)(47.5, 59.5)[1]/reference - 1
        found = {m: measures(run) for m, run in runs.items()}
        tips[poisson] = {m: found[m][0]/reference for m in METHODS}
        locking = {
            "sgmp": "no locking, but too soft, by 2.4 % at nu = 0.3 already",
            "all": "volumetric locking: every particle is a constraint on volume, more than the nodes can take; "
            "there is no F-bar or B-bar here",
        }
        table.row(
            f"deflection over the finite elements', nu = {poisson}", tips[poisson], 1.0, within(1, 0.03), runs, locking
        )
        table.row(
            f"roughness of the pressure, nu = {poisson}",
            {m: found[m][1] for m in METHODS},
            0.0,
            at_most(0.1),
            runs,
            {
                "sgmp": "pressures that alternate from cell to cell exert no force on the nodes, so what a sudden "
                "load leaves of them stays, it seems. A static linear calculation with the same quadrature, "
                "without the program, has 0.06 at any nu (verification/hard/at_rest.py); "
                "a mean volumetric strain (F-bar) makes it worse there: 0.65 (mean of the particles around a "
                "centre) and 0.81 (of the centres around a node) at nu = 0.4999",
                "all": "pressures alternate between the particles of a cell: the other face of locking, below",
            },
        )
    table.row(
        "finite elements 14 x 14 over 20 x 20, less 1, largest",
        {"sgmp": max(abs(v) for v in check.values())},
        0.0,
        at_most(0.02),
    )
    canvas, axis = figure(figsize=(6.4, 3.6))
    for method in METHODS:
        axis.semilogx(
            [0.5 - p for p in poissons], [tips[p][method] for p in poissons], color=COLOURS[method],
            marker=MARKERS[method], label=NAMES[method],
        )
    axis.axhline(1, color="0.5", linewidth=0.8)
    axis.set(xlabel="1/2 - nu", ylabel="deflection over the finite elements'")
    axis.invert_xaxis()
    axis.legend()
    table.picture(
        "membrane", canvas,
        "Cook's membrane: deflection over that of finite elements as the material becomes incompressible.",
    )


def measures(run):
    """Mean deflection of the tip and roughness of the pressure."""
    if run.exit_code:
        return np.nan, np.nan
    gauges = read_table(run.folder / "gauges.csv")
    gauge = gauges["gauge"]  # the tip, then the square
    tip = {key: values[gauge == 1] for key, values in gauges.items()}
    window = np.sin(np.pi*tip["time"]/tip["time"][-1])**2
    deflection = np.average(tip["y"] - tip["y"][0], weights=window)
    places, pressures = [], []
    for i in range(4):
        for j in range(4):
            pressures.append(np.average(gauges["pressure"][gauge == 2 + 4*i + j], weights=window))
            places.append((1, i, j))
    pressures, places = np.array(pressures), np.array(places, float)
    rest = pressures - places @ np.linalg.lstsq(places, pressures, rcond=None)[0]
    return deflection, np.sqrt(np.mean(rest**2)/np.mean(pressures**2))
