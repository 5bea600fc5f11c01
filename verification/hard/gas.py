"""Gas that expands into nothing."""
import sys
from pathlib import Path

import numpy as np
from table import figure, run_methods, within

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import COLOURS, NAMES  # noqa: E402

GAMMA = 1.4
ENERGY = 2.5  # of the gas at the start
SPLIT = ((20, 20.5, 0.2, (2, 10, 100)), (2, 193, 0.4, (1000,)))  # cells, end, Courant number, lengths


def lagrange(zones=400, most=1.2e3):
    """Mean specific volume and kinetic energy over the whole energy, in time: staggered Lagrangian differences, no
    viscosity."""
    x, v = np.linspace(0, 1, zones + 1), np.zeros(zones + 1)
    mass, energy = 1.0/zones, np.full(zones, ENERGY)
    volume = np.diff(x)/mass
    nodal = np.full(zones + 1, mass)
    nodal[[0, -1]] = mass/2
    rows, time = [], 0.0
    while x[-1] < most:
        pressure = (GAMMA - 1)*energy/volume
        dt = 0.3*np.min(mass*volume/np.sqrt(GAMMA*pressure*volume))
        force = -np.diff(np.concatenate([[0.0], pressure, [0.0]]))
        force[0] = 0.0
        v = v + dt*force/nodal
        v[0] = 0.0
        x = x + dt*v
        new = np.diff(x)/mass
        energy = energy*(volume/new)**(GAMMA - 1)  # isentropic, exactly
        volume, time = new, time + dt
        rows.append((time, x[-1], 1 - energy.mean()/ENERGY))
    return np.array(rows).T


def vacuum(table):
    """To a thousandth of the density, without and with splitting of particles."""
    table.case(
        "Expansion into vacuum",
        """
Gas of density 1, pressure 1 and gamma = 1.4 between a wall at x = 0 and x = 1 is set free into nothing at t = 0
(one dimension, 20 cells, Courant number 0.2, to t = 200). Measured: the part of the internal energy that has become
kinetic when the gas fills 2, 10, 100 and 1000 times its length (the place of the outermost particle). Reference:
400 Lagrangian zones, isentropic. Then the same with particles that are split in two when they have become longer
than 0.75 cells: 20 cells to 100 times the length, 2 cells to 1000 times (Courant number 0.4). To 10000 times the
length, a density of 10^-4, one cell in the slab takes 151631 particles in the end and some minutes; SGMP has 0.990
there instead of 0.972 (`sgmp verification/hard/vacuum.inp --set split=0.75 --set cells=1 --set cfl=0.4 --set
t_end=1845`; not in the table).""",
    )
    time, front, kinetic = lagrange()
    canvas, axis = figure(figsize=(6.4, 3.6))
    axis.semilogx(time, kinetic, color="0.3", label="Lagrangian zones")

    def rows(runs, expansions, words, reasons=None):
        for expansion in expansions:
            when, expected = np.interp(expansion, front, time), float(np.interp(expansion, front, kinetic))
            values = {m: kinetic_part(run, when) for m, run in runs.items()}
            table.row(
                f"kinetic energy over all when the length is {expansion} times the first (t = {when:.4g}){words}",
                values, expected, within(expected, 0.03), runs, reasons,
            )

    whole = run_methods("vacuum")
    rows(
        whole,
        (2, 10, 100, 1000),
        "",
        {
            "all": "particles further apart than a cell feel each other no more (those at the head of the fan from "
            "the first): what is internal energy then stays so. Splitting of particles cures it, below"
        },
    )
    start = 0.0
    for cells, end, cfl, expansions in SPLIT:
        runs = run_methods("vacuum", cells=cells, t_end=end, cfl=cfl, split=0.75)
        rows(runs, expansions, f", split, {cells} cell{'s' if cells > 1 else ''}")
        for method, run in runs.items():
            axis.semilogx(*curve(run, start), color=COLOURS[method], label="" if start else f"{NAMES[method]}, split")
        start = end
    for method, run in whole.items():
        axis.semilogx(*curve(run), color=COLOURS[method], linestyle=":", label=NAMES[method])
    axis.set(xlabel="time", ylabel="kinetic energy over all", xlim=(0.05, start))
    axis.legend(ncols=2)
    table.picture(
        "vacuum", canvas,
        "Expansion into vacuum: internal energy that has become kinetic, particles split (lines) and not (dots).",
    )


def kinetic_part(run, when):
    """Kinetic energy over all at a time, NaN of a run that has not come so far."""
    if run.summary.get("time", 0) < 0.99*when:
        return np.nan
    return float(np.interp(when, run.history()["time"], run.history()["kinetic_energy"]))/ENERGY


def curve(run, start=0.0):
    """Times from a start on, and kinetic energy over all."""
    history = run.history()
    late = history["time"] > start
    return history["time"][late], history["kinetic_energy"][late]/ENERGY
