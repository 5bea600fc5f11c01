"""Gas that expands into nothing."""
import sys
from pathlib import Path

import numpy as np
from table import METHODS, figure, run_methods, within

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import COLOURS, NAMES  # noqa: E402

GAMMA = 1.4
EXPANSIONS = (2, 10, 100, 1000)


def lagrange(zones=400, most=1.2e3):
    """Mean specific volume and kinetic energy over the whole energy, in time: staggered Lagrangian differences, no viscosity."""
    x, v = np.linspace(0, 1, zones + 1), np.zeros(zones + 1)
    mass, energy = 1.0/zones, np.full(zones, 2.5)
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
        rows.append((time, x[-1], 1 - energy.mean()/2.5))
    return np.array(rows).T


def vacuum(table):
    """To a thousandth of the density."""
    table.case("Expansion into vacuum", """
Gas of density 1, pressure 1 and gamma = 1.4 between a wall at x = 0 and x = 1 is set free into nothing at t = 0 (one dimension, 20 cells, Courant number 0.2, to t = 200). Measured: the part of the internal energy that has become kinetic when the gas
fills 2, 10, 100 and 1000 times its length (the place of the outermost particle). Reference: 400 Lagrangian zones, isentropic.""")
    time, front, kinetic = lagrange()
    runs = run_methods("vacuum")
    curves = {}
    for method, run in runs.items():
        history = run.history()
        curves[method] = (history["time"], history["kinetic_energy"]/2.5)
    for expansion in EXPANSIONS:
        when, expected = np.interp(expansion, front, time), np.interp(expansion, front, kinetic)
        values = {m: float(np.interp(when, *curves[m])) if runs[m].summary.get("time", 0) >= 0.99*when else np.nan for m in METHODS}
        table.row(f"kinetic energy over all when the length is {expansion} times the first (t = {when:.4g})", values, float(expected), within(expected, 0.03), runs,
                  {"all": "particles further apart than a cell feel each other no more (those at the head of the fan from the first): what is internal energy then stays so. Only splitting of particles would help"})
    canvas, axis = figure(figsize=(6.4, 3.6))
    axis.semilogx(time, kinetic, color="0.3", label="Lagrangian zones")
    for method, curve in curves.items():
        axis.semilogx(curve[0][1:], curve[1][1:], color=COLOURS[method], label=NAMES[method])
    axis.set(xlabel="time", ylabel="kinetic energy over all", xlim=(0.05, 200))
    axis.legend()
    table.picture("vacuum", canvas, "Expansion into vacuum: internal energy that has become kinetic.")
