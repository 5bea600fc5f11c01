"""What the contact checks share."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from common import NAMES, ROOT, Case  # noqa: E402,F401
from sgmp_view.files import read_table  # noqa: E402

METHODS = ("sgmp", "mpm", "gimp")


def deck(name, **parameters):
    """A case of a deck of verification/, named by folder and file."""
    return Case(f"verification/{name}.inp", **parameters)


def body(run, number):
    """Rows of one body in bodies.csv, as columns."""
    table = read_table(run.folder / "bodies.csv")
    return {name: column[table["body"] == number] for name, column in table.items()}


def contact(run):
    """Rows of contact.csv, as columns."""
    return read_table(run.folder / "contact.csv")


def pairs_of(run, name):
    """Numbers of the pairs in contact.csv whose first body has a name."""
    rows = contact(run)
    return sorted({int(pair) for pair, bodies in zip(rows["pair"], rows["bodies"]) if bodies.split()[0] == name})


def excess(history, update, supplied=None):
    """Energy of unknown origin over the energy supplied (the largest work): total less external work and the energy
    taken by contact.

    MUSL and USF know the kinetic energy (and with it the work) half a step before and after the internal energy: it is
    taken to the same time by its slope. Its mean over the last fifth, the largest value, how far the energy taken by
    contact ever fell, and that energy.
    """
    dt = np.gradient(history["time"])/np.maximum(np.gradient(history["step"]), 1)
    moving = history["kinetic_energy"] - history["external_work"] + history["contact_dissipation"]
    moving = moving + {"musl": 0.5, "usf": -0.5}.get(update, 0.0)*dt*np.gradient(moving, history["time"])
    made = moving + history["internal_energy"] - history["total_energy"][0]
    work = supplied or np.abs(history["external_work"]).max()
    falls = np.maximum(0.0, -np.diff(history["contact_dissipation"])).sum()
    return made[-len(made)//5:].mean()/work, made.max()/work, falls/work, history["contact_dissipation"][-1]/work
