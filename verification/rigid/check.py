#!/usr/bin/env python3
"""Free rigid bodies: a block that tumbles, a body that hits an elastic rod, a cylinder and a ball that roll down a
slope."""
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import Case, main, slopes, solve  # noqa: E402

MOMENTS = np.array([5.0, 10.0, 13.0])
SPIN = np.array([0.5, 3.0, 1.0])
END = 10.0


def deck(name, **parameters):
    return Case(f"verification/rigid/{name}.inp", **parameters)


def rows(run):
    """The free body's rows of rigid.csv by column."""
    return np.genfromtxt(run.folder / "rigid.csv", delimiter=",", names=True, usecols=range(22))


def matrices(quaternions):
    """Rotations of unit quaternions (n, 4), scalar first."""
    s, x, y, z = quaternions.T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)],
            [2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)],
            [2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


def euler(steps=20000):
    """Attitude at the end by Euler's equations in the frame of the body, Runge and Kutta's method of fourth order.
    Shares nothing with the solver."""
    def rate(state):
        s, v, w = state[0], state[1:4], state[4:]
        return np.concatenate([[-0.5*v @ w], 0.5*(s*w + np.cross(v, w)), np.cross(MOMENTS*w, w)/MOMENTS])

    state, step = np.concatenate([[1, 0, 0, 0], SPIN]), END/steps
    for _ in range(steps):
        a = rate(state)
        b = rate(state + 0.5*step*a)
        c = rate(state + 0.5*step*b)
        d = rate(state + step*c)
        state = state + step/6*(a + 2*b + 2*c + d)
    return state[:4]/np.linalg.norm(state[:4])


def tumbling(book, full):
    book.say(
        "A block of moments of inertia 5, 10 and 13 turns without forces, ω = (0.5, 3, 1) at the start, for five "
        "turns. Energy and angular momentum from attitude and ω of rigid.csv; the attitude in the "
        "end against Euler's equations by Runge and Kutta's method."
    )
    steps = (0.02, 0.01, 0.005)
    exact = matrices(euler()[None])[0]
    angles, table = [], []
    for step, run in zip(steps, solve([deck("tumbling", step=step) for step in steps])):
        found = rows(run)
        turned = matrices(np.column_stack([found[f"attitude_{name}"] for name in "0xyz"]))
        spin = np.column_stack([found[f"omega_{name}"] for name in "xyz"])
        momentum = np.einsum("nij,j,nkj,nk->ni", turned, MOMENTS, turned, spin)
        energy = 0.5*(momentum*spin).sum(1)
        angles.append(math.acos(min(1.0, 0.5*(np.trace(turned[-1].T @ exact) - 1))))
        lost, gone = (
            np.abs(momentum - momentum[0]).max() / np.linalg.norm(momentum[0]),
            np.abs(energy / energy[0] - 1).max(),
        )
        table.append([step, float(gone), float(lost), angles[-1]])
        book.at_most("tumbling block", f"change of the energy, steps of {step:g}", gone, 1e-10)
        book.at_most("tumbling block", f"change of the angular momentum, steps of {step:g}", lost, 1e-10)
    book.at_most(
        "tumbling block", f"angle to Euler's equations after {END:g}, steps of {steps[-1]:g} (radians)", angles[-1],
        2e-3,
    )
    book.near("tumbling block", "order of that angle", slopes(steps, angles).mean(), 2.0, 0.1)
    book.table(
        "tumbling", ["step", "energy", "angular momentum", "angle (radians)"], table,
        "Tumbling block: largest changes, angle to the exact attitude in the end.",
    )
    book.command(deck("tumbling"))


def rod(book, full):
    book.say(
        "A free rigid body hits the end of an elastic rod that is held at the other (Saint-Venant). With m the mass "
        "of the body over that of the rod, below 1.7, the waves that go to and fro give it "
        "2 exp(-1 - exp(-2/m)/2) of its speed back, after (2 + m (1 + exp(-2/m)/2)) L/c."
    )
    sizes = (25, 50, 100, 200, 400) if full else (25, 50, 100, 200)
    table = []
    for mass in (0.5, 1.0, 1.25):
        back, until = 2*math.exp(-1 - 0.5*math.exp(-2/mass)), 2 + mass*(1 + 0.5*math.exp(-2/mass))
        errors = []
        for cells, run in zip(sizes, solve([deck("rod", cells=cells, mass=mass) for cells in sizes])):
            found = rows(run)
            errors.append(found["velocity_x"][-1]/1e-3/back - 1)
            touched = found["time"][np.flatnonzero(found["force_x"] > 0)[[0, -1]]]
            table.append([mass, cells, float(errors[-1]), float((touched[1] - touched[0])/until - 1)])
        book.within(
            "body on a rod", f"speed afterwards over that before, mass {mass:g}, {cells} cells",
            back * (1 + errors[-1]), back, 0.02,
        )
        book.within(
            "body on a rod", f"time of contact over L/c, mass {mass:g}, {cells} cells", until * (1 + table[-1][3]),
            until, 0.02,
        )
    book.table(
        "rod", ["mass over the rod's", "cells", "error of the speed", "error of the time"], table,
        "Rigid body on an elastic rod.",
    )
    book.command(deck("rod"))


def rolling(book, full):
    book.say(
        "A free cylinder and a free ball, six cells to the radius, roll down 30 degrees on an elastic floor "
        "(`rotation=exact`): 2/3 and 5/7 g sin θ."
    )
    cases = [("cylinder", cells) for cells in ((6, 8, 12) if full else (6, 8))] + [
        ("ball", cells) for cells in ((6, 9) if full else (6,))
    ]
    table = []
    for (name, cells), run in zip(cases, solve([deck(name, cells=cells) for name, cells in cases])):
        found, part = rows(run), 2/3 if name == "cylinder" else 5/7
        way = found["x"][-1]/(0.5*part*5*found["time"][-1]**2)
        last = found["time"] > 0.6*found["time"][-1]
        slip = np.mean(-found["velocity_x"][last]/(3*found["omega_z"][last]))
        history = run.history()
        kept = history["internal_energy"][-1]/history["external_work"][-1]
        table.append([name, cells, float(way), float(slip), float(kept)])
        book.within(f"{name} on a slope", f"way over the exact one, {cells} cells to the radius", way, 1.0, 0.02)
        book.within(
            f"{name} on a slope", f"v/(ω R), mean of the last 0.4, {cells} cells to the radius", slip, 1.0, 0.08
        )
    book.table(
        "rolling",
        ["body", "cells to the radius", "way over the exact one", "v/(ω R)", "energy in the floor over the work"],
        table, "Free rigid bodies that roll down 30 degrees.",
    )
    book.command(deck("cylinder"), deck("ball"))


def check(book, full):
    book.section("Free rigid bodies")
    tumbling(book, full)
    rod(book, full)
    rolling(book, full)


if __name__ == "__main__":
    main(check, __doc__)
