"""The scenes of doc/speed-and-accuracy.md: deck, sizes, methods, Courant numbers to try, and how far a run is from its
reference."""
import csv
import json
import math
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "contact_hertz"), str(HERE.parent / "tnt_slab/reference"),
                str(HERE.parent / "tube")]
import bar_surface  # noqa: E402
import lines  # noqa: E402
from elastic_sphere import curve as sphere_curve  # noqa: E402
from taylor_wave import TaylorWave  # noqa: E402
from verify import load  # noqa: E402

# Card method of each curve: the default, the paper's SGMP, others.
METHODS = {"sgmp": "sgmp", "plain": "sgmp stress=plain rotation=plain surfaces=plain",
           **{name: name for name in ("mpm", "gimp", "cpgimp", "bspline")}}
UPDATES = {f"sgmp {update}": f"sgmp update={update}" for update in ("usf", "usl", "usavg")}
NORMALISED = {"sgmp normalised": "sgmp stress=normalised"}  # of explosives and gases it is no default
REFERENCE = json.loads((HERE.parent / "surfaces/bounce.json").read_text())


@dataclass
class Scene:
    """One example. Every curve is run at the sizes of `scan` with all Courant numbers, at those of `fine` with its best
    one."""

    title: str
    deck: str                      # below the root
    size: Callable                 # parameters of a size and a Courant number
    scan: tuple
    fine: tuple
    courants: tuple
    error: Callable                # of a finished run
    label: str                     # of the error
    goals: tuple                   # errors whose price the summary gives
    unit: str                      # of a size
    reference: str                 # what the error is measured against
    seen: str = ""                 # what the figure shows, and why
    keeps: str = ""                # cards of output that the error needs
    curves: dict = field(default_factory=lambda: {**METHODS, **UPDATES})
    extra: dict = field(default_factory=dict)  # parameters of a curve beyond its card


def by_cells(cells, courant):
    return {"cells": cells, "cfl": courant}


def by_h(h, courant):
    return {"h": h, "cfl": courant}


def bar_size(cells, courant):
    """The deck wants a step that divides the time; the wave speed is the root of 2."""
    end = 0.3536
    steps = int(np.ceil(end * cells * 2**0.5 / courant))
    return {"cells": cells, "dt": end / steps}


def vortex_error(run):
    cloud = run.particles()
    moved = cloud.points[:, :2] - load("vortex").exact(
        cloud.fields["initial_position"][:, :2], 0.25, run.summary["time"]
    )
    return float(np.sqrt(np.mean(np.sum(moved**2, axis=1))))


def hertz_error(run, exact=[]):
    """Root mean square of the relative errors of the force at the two largest approaches."""
    exact = exact or exact.append(sphere_curve()) or exact
    depth, force, _ = load("contact_axisymmetric").measured(run)
    reference = np.interp(depth, np.append(0, exact[0][:, 1]), np.append(0, exact[0][:, 2]**(2 / 3)))**1.5
    bands = [(depth >= low) & (depth < high) for low, high in load("contact_hertz").BANDS[2:]]
    return float(np.sqrt(np.mean([(force[band].mean() / reference[band].mean() - 1)**2 for band in bands])))


def bounce_error(case):
    """Mean velocity of the left body over time beside that of finite elements, root mean square, over the first."""
    reference = np.loadtxt(HERE.parent / f"surfaces/bounce_{case}.csv", delimiter=",", skiprows=1)

    def error(run):
        with open(run.folder / "bodies.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["name"].strip() == "left"]
        time, speed = (np.array([float(row[key]) for row in rows]) for key in ("time", "velocity_x"))
        exact = np.interp(time, reference[:, 0], reference[:, 2])
        return float(np.sqrt(np.mean((speed/REFERENCE[case]["speed"] - exact)**2)))

    return error


def bouncing(case):
    """Parameters of bounce.inp for a body of bounce.json."""
    body = REFERENCE[case]
    given = {key: body[key] for key in ("outer", "poisson", "speed", "end")}
    return lambda h, courant: {"h": h, "cfl": courant, "inner": body["inner"] or 1e-6*body["outer"], **given}


def beam_error(run):
    """The first mode of the beam in its third period beside that in its first, as complex amplitudes at the frequency
    of finite elements: what is off in phase and in size."""
    omega, angle = load("surfaces").BEAM, math.radians(15)
    table = np.genfromtxt(run.folder / "gauges.csv", delimiter=",", names=True, dtype=None, encoding=None)
    across = math.cos(angle)*table["velocity_y"] - math.sin(angle)*table["velocity_x"]
    amplitudes = []
    for period in (0, 2):
        part = np.floor(omega*table["time"]/(2*math.pi)) == period
        waves = np.column_stack([np.cos(omega*table["time"][part]), np.sin(omega*table["time"][part])])
        found, *_ = np.linalg.lstsq(waves, across[part], rcond=None)
        amplitudes.append(complex(*found))
    return float(abs(amplitudes[1]/amplitudes[0] - 1))


def spin_error(run):
    """Stresses of a disk after a turn, beside the closed form, inside a rim of a cell and a half: root mean square,
    over that of the closed form. They turn with the disk, which is held together by them."""
    radius, poisson = run.case.parameters["radius"], 0.3
    cloud = run.particles()
    place, stress = cloud.points[:, :2] - cloud.points[:, :2].mean(axis=0), cloud.fields["stress"]
    r = np.hypot(*place.T) + 1e-12
    inside = r < radius - 1.5
    c, s, r, stress = place[inside, 0]/r[inside], place[inside, 1]/r[inside], r[inside], stress[inside]
    spin = 0.1/radius
    size = radius
    a, b = (spin**2*k/(8*(1 - poisson)) for k in (3 - 2*poisson, 1 + 2*poisson))
    radial = stress[:, 0]*c*c + stress[:, 1]*s*s + 2*stress[:, 3]*c*s
    around = stress[:, 0]*s*s + stress[:, 1]*c*c - 2*stress[:, 3]*c*s
    exact = np.concatenate([a*(size**2 - r**2), a*size**2 - b*r**2])
    return float(np.sqrt(np.mean((np.concatenate([radial, around]) - exact)**2)/np.mean(exact**2)))


def tube_error(run, exact=[]):
    """Outer radius of the tube, root mean square over two and a half periods, over the largest displacement."""
    exact = exact or exact.append(lines.breathe(400, 20.0, 400)) or exact
    table = np.genfromtxt(run.folder / "gauges.csv", delimiter=",", names=True, dtype=None, encoding=None)
    way = np.interp(table["time"], *exact[0])
    return float(np.sqrt(np.mean((table["x"] - table["x"][0] - way)**2))/np.abs(way).max())


def membrane_error(run, exact=[]):
    """Deflection along the membrane, root mean square, over that of the middle."""
    statics = load("statics")
    exact = exact or exact.append(statics.held(statics.SPAN, 2e-5, 0.0, statics.POISSON)) or exact
    places, moved = statics.columns(run, 1)
    errors = moved/exact[0][2][-1] - np.interp(places, exact[0][0], exact[0][2])/exact[0][2][-1]
    return float(np.sqrt(np.mean(errors**2)))


SCENES = {
    "bar": Scene(
        "Bar with large deformation, 1D",
        "input/bar_large.inp",
        bar_size,
        (16, 64, 256),
        (1024,),
        (0.1, 0.3, 0.6, 1.0, 1.5, 2.0),
        lambda run: load("bar").error(run, 0.3536),
        "error of displacement, rms (m)",
        (1e-4, 1e-5, 1e-6, 1e-7),
        "cells",
        "the manufactured solution at the largest strain (7 %), exact",
        "Runs up to 256 cells cost little more than the start of the process. SGMP (its stress is normalised) falls "
        "to 3e-8 m with C = 1. Plain SGMP, GIMP and B-spline stop at some 4e-6 m and get worse with more cells, for "
        "what their quadrature of the stress lacks does not vanish with h "
        "([normalised-stress.md](normalised-stress.md)). cpGIMP goes on falling, with particles laid at equal "
        "distances, as it wants them. MPM does not converge: particles cross cells.",
        extra={name: {"layout": "uniform"} for name in ("gimp", "cpgimp")},
    ),
    "beam": Scene(
        "Free vibration of a beam, plane strain",
        "input/beam.inp",
        by_h,
        (1.25, 0.625),
        (0.3125,),
        (0.4, 0.8, 1.2, 1.6, 2.0),
        lambda run: load("beam").deflection_error(run),
        "error of deflection, rms (mm)",
        (0.03, 0.01, 0.003, 0.001),
        "mm",
        "the deflection of the middle line at 50 µs by finite elements, two meshes extrapolated (largest 0.487 mm, "
        "good to 0.0001 mm)",
        "SGMP is the cheapest down to 0.005 mm and at 0.001 mm, with C = 2. Between them GIMP and cpGIMP win, whose "
        "error falls with h² from the start; that of SGMP is small on the coarse grid (0.0047 mm with eight cells "
        "over the height), falls slowly from there to 0.0032 and then to 0.0009 mm. Without its corrections (plain) "
        "SGMP needs four times the work for 0.01 mm. The good coarse value of MPM is luck: its error grows with "
        "finer cells.",
    ),
    "taylor_rings": Scene(
        "Taylor bar, axisymmetric",
        "input/taylor_bar_axisymmetric.inp",
        by_h,
        (0.76, 0.4),
        (0.2,),
        (0.25, 0.5, 1.0, 1.5, 2.0),
        lambda run: bar_surface.error(bar_surface.of_rings(run, run.summary["h"] / 2)),
        "error of shape, mean of L, D, W (1)",
        (0.01, 0.005, 0.003),
        "mm",
        "the converged shape: L 16.34, D 13.43, W 10.135 mm; mean of the three relative errors, by the outermost rings",
        "USF is the cheapest by far: at C = 2 it lets the bar of 0.4 mm cells come out as well as MUSL does with "
        "0.2 mm. Methods with MUSL lie within a factor of two of each other, MPM falls behind. The corrections cost "
        "SGMP a fifth and change the shape by less than 0.1 %.",
    ),
    "taylor_cubes": Scene(
        "Taylor bar, 3D",
        "input/taylor_bar.inp",
        by_h,
        (1.0, 0.76),
        (0.5,),
        (0.5, 1.0, 1.5, 2.0, 2.2),
        lambda run: bar_surface.error(bar_surface.of_cubes(run)),
        "error of shape, mean of L, D, W (1)",
        (0.02, 0.01, 0.007),
        "mm",
        "the same shape; the surface of cubes is a flight of stairs, whose largest radius per sector is taken",
        "What is left below one per cent is the surface, not the method: finer cells hardly help, and rings get the "
        "same error in a tenth of the time. Plain SGMP is the cheapest down to 1 %; the corrections cost half as "
        "much again and take the error from 0.79 to 0.69 % with cells of 0.5 mm.",
        curves=dict(METHODS),
    ),
    "tnt": Scene(
        "TNT slab, 1D",
        "input/tnt_slab.inp",
        lambda h, courant: {**by_h(h, courant), "t_end": 0.014},
        (1.0, 0.25),
        (0.1,),
        (0.05, 0.1, 0.2, 0.4, 0.8),
        lambda run: load("tnt_slab").measure(run, TaylorWave())["L1"],
        "error of pressure behind the front, L1 (GPa)",
        (0.5, 0.3, 0.1),
        "mm",
        "the Chapman-Jouguet state and the Taylor wave at 14 µs, exact (peak 20.98, plateau 5.63 GPa)",
        "The far side is open, so SGMP keeps the stress of an explosive plain. With normalised stress it is the "
        "only one below 0.1 GPa and the cheapest below 0.3. Plain SGMP gets worse from 0.25 to 0.1 mm: the noise of "
        "its quadrature grows with the number of steps. B-spline comes next (0.15 GPa). GIMP stays at 0.6 GPa, MPM "
        "is off by more with each refinement. A C of 0.8 is good enough for this norm, which looks behind the "
        "front; the peak wants 0.1 (verification/tnt_slab).",
        curves={**METHODS, **NORMALISED, **UPDATES},
    ),
    "vortex": Scene(
        "Generalised vortex, 2D",
        "input/vortex.inp",
        by_cells,
        (8, 16),
        (32,),
        (0.4, 0.8, 1.2, 1.6, 2.0),
        vortex_error,
        "error of position, rms (m)",
        (0.02, 0.01, 0.004),
        "cells/m",
        "the manufactured solution after one period, amplitude 0.25 (largest shear 1.7), exact",
        "Most of the time goes into the body force, a long formula of place, so that a cheaper step gains little "
        "here. SGMP falls from 1 to 0.32 cm between 16 and 32 cells per metre, with any update; MPM, GIMP and "
        "cpGIMP get worse, as their particles leave the lattice.",
    ),
    "hertz": Scene(
        "Plate on a sphere (Hertz), axisymmetric, contact",
        "verification/contact_axisymmetric/hertz.inp",
        by_cells,
        (16, 32),
        (48,),
        (0.2, 0.4, 0.8),
        hertz_error,
        "error of force, rms of two approaches (1)",
        (0.05, 0.02, 0.01),
        "cells/radius",
        "linear elasticity of a sphere between plates (Legendre series), at approaches of 1.5 and 1.9 % of the "
        "radius, where the contact circle is 0.13 radii",
        "MPM and SGMP are the cheapest as long as 3 % are enough. **Below 2 % SGMP loses**: with 48 cells to the "
        "radius GIMP, cpGIMP and B-spline have half its error at one and a half times its cost; no C above 0.8 was "
        "tried, for contact bears none (doc/time-step.md), so that SGMP's larger step brings nothing. Errors do not "
        "fall in order with h, as the contact circle is 2 to 6 cells wide: 1.9 % by USL with 16 cells and 1 % by "
        "MPM with 32 are chance, with 48 cells both are worse.",
    ),
    "rings": Scene(
        "Two rubber rings that bounce, contact",
        "verification/surfaces/bounce.inp",
        bouncing("rings"),
        (4, 2),
        (1,),
        (0.2, 0.4, 0.8),
        bounce_error("rings"),
        "error of mean velocity, rms, over the first (1)",
        (0.1, 0.03, 0.015),
        "mm",
        "finite elements, two meshes (the rings of `input/rings.inp`, 10 mm thick, come back with 0.833)",
        "Only SGMP with its corrections comes below 5 %, with every update; plain it is off by 12 %, MPM by 40 %. "
        "GIMP comes to 5.4 % with C = 0.2, in three times the time.",
    ),
    "disks": Scene(
        "Two disks that bounce, contact",
        "verification/surfaces/bounce.inp",
        bouncing("disks"),
        (10, 5),
        (2.5,),
        (0.2, 0.4, 0.8),
        bounce_error("disks"),
        "error of mean velocity, rms, over the first (1)",
        (0.1, 0.05, 0.03),
        "mm",
        "finite elements, two meshes (disks of 40 mm radius come back with 0.939)",
        "Bodies that touch at one place and do not bend: all but MPM are off by 1.2 % or less with 16 cells to the "
        "radius, plain SGMP is the cheapest, USF the best.",
    ),
    "oblique": Scene(
        "Free beam at 15 degrees, plane strain",
        "verification/surfaces/beam.inp",
        lambda cells, courant: {**by_cells(cells, courant), "omega": load("surfaces").BEAM},
        (4, 8),
        (16,),
        (0.25, 0.5, 1.0, 1.5),
        beam_error,
        "error of the mode in its third period (1)",
        (0.3, 0.1, 0.03),
        "cells/thickness",
        "its first mode in the first period, at the frequency of finite elements",
        "Plain SGMP is of no use here: its strains at oblique surfaces are the gradient of nothing "
        "([surfaces.md](surfaces.md)). Corrected it has the smallest error of all at 8 and 16 cells and takes three "
        "fifths of the time of GIMP, which comes close.",
        keeps="gauge",
    ),
    "spin": Scene(
        "Disk that spins under stress",
        "verification/rotation/stressed.inp",
        lambda radius, courant: {"radius": radius, "cfl": courant},
        (8, 16),
        (32,),
        (0.25, 0.5, 1.0, 1.5),
        spin_error,
        "error of stress after a turn, rms (1)",
        (0.2, 0.05, 0.02),
        "cells/radius",
        "linear elasticity of a spinning disk, exact; its rim moves at a tenth of the speed of sound",
        "Only SGMP with its corrections keeps the stress that holds the disk together; that of all others is noise. "
        "With USL, which has one velocity, it is off by 2 to 4 %; with MUSL noise of 7 % remains around means that "
        "are right to 1 to 2 % ([rotation.md](rotation.md)).",
    ),
    "tube": Scene(
        "Tube under sudden gas pressure, axisymmetric",
        "verification/tube/tube.inp",
        lambda n, courant: {"n": n, "cfl": courant},
        (8, 16),
        (32,),
        (0.2, 0.4, 0.8),
        tube_error,
        "error of outer radius, rms (1)",
        (0.1, 0.03, 0.01),
        "cells/radius",
        "a Lagrangian code in one dimension with 400 cells to the bore's radius",
        "Gas and steel share cells at the bore. All but MPM converge with first order there; GIMP and cpGIMP have "
        "two thirds of SGMP's error.",
        keeps="gauge",
        curves={**METHODS, **NORMALISED, **UPDATES},
    ),
    "membrane": Scene(
        "Membrane between clamps under load, damped to rest",
        "verification/statics/membrane.inp",
        by_cells,
        (2,),
        (3,),
        (0.25, 0.5, 1.0),
        membrane_error,
        "error of deflection, rms (1)",
        (0.03, 0.01, 0.005),
        "cells/thickness",
        "Reissner's extensible elastic line",
        "SGMP falls from 0.66 to 0.43 % from two to three cells over the thickness, at the largest step. MPM, GIMP "
        "and cpGIMP have less error with two cells and more with three, B-spline is too stiff by a quarter there: "
        "damped motion across cells makes noise that changes the tension. Plain SGMP is too soft.",
    ),
}
