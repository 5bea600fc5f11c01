#!/usr/bin/env python3
"""Contact in axisymmetric scenes: two rods that collide, a plate on a sphere, a sphere that falls on a plate, a plug
drawn along a bore, a punch; against closed forms and linear elasticity."""
import sys
from math import pi
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent/"contact_hertz")]
from common import NAMES, main, solve, subplots  # noqa: E402
from contact import METHODS, body, contact, deck  # noqa: E402
from elastic_sphere import curve, hertz  # noqa: E402

FOLDER = "contact_axisymmetric"
STIFFNESS = 1/(1 - 0.3**2)  # E*, of an elastic body on a rigid one


def rods(book, full):
    """One-dimensional waves: force, time of contact, speeds afterwards, momentum along the axis."""
    cases = [(method, ratio) for method in METHODS for ratio in (1, 4)]
    runs = solve(
        [deck(f"{FOLDER}/bars", method=method, cells=200 if full else 100, ratio=ratio) for method, ratio in cases]
    )
    for (method, ratio), run in zip(cases, runs):
        name = f"coaxial rods, impedance 1:{ratio}, {NAMES[method]}"
        force = 1e-3*ratio/(1 + ratio)*pi*0.1**2
        rows, history = contact(run), run.history()
        inside = (rows["time"] > 0.5) & (rows["time"] < 1.5)
        book.within(
            name, "force while in contact, over that of the exact stress", -rows["force_z"][inside].mean() / force, 1.0,
            0.02,
        )
        book.within(name, "time at which they part", rows["time"][-rows["force_z"] > 0.5*force][-1], 2.0, 0.02)
        for number, speed in ((1, (1 - ratio)/(1 + ratio)), (2, 2/(1 + ratio))):
            book.near(
                name, f"speed of rod {number} afterwards over that before", body(run, number)["velocity_z"][-1] / 1e-3,
                speed, 0.03,
            )
        book.at_most(
            name, "change of momentum along z, relative",
            max(abs(history["momentum_z"] / history["momentum_z"][0] - 1)), 1e-12,
        )
        book.at_most(name, "kinetic energy that the ledger does not explain, relative",
                     abs(history["energy_remainder"][-1])/history["total_energy"][0], 1e-12)
        book.at_most(
            name, "energy that contact gave, relative",
            -history["contact_dissipation"].min() / history["total_energy"][0], 1e-12,
        )
    book.command(runs[0].case)


def measured(run):
    """Approach at the middle of each row, force, contact radius: Hertz's pressure has its mean radius at 3 pi/16 a."""
    rows = contact(run)
    depth = 0.02*0.5*(rows["time"][1:] + rows["time"][:-1])/rows["time"][-1]
    return depth, rows["force_z"][1:], -rows["torque_y"][1:]/rows["force_z"][1:]*16/(3*pi)


def plate(book, full):
    """The plate on a sphere of verification/contact_hertz, on finer grids than it can afford."""
    sizes, exact = (24, 48, 96) if full else (24, 48), curve()
    runs = solve([deck(f"{FOLDER}/hertz", cells=cells) for cells in sizes])
    figure, axis = subplots(figsize=(7.2, 4.6))
    rows = []
    for cells, run in zip(sizes, runs):
        depth, force, radius = measured(run)
        reference = np.interp(depth, np.append(0, exact[:, 1]), np.append(0, exact[:, 2]**(2/3)))**1.5
        for low, high in ((0.004, 0.006), (0.008, 0.012), (0.013, 0.017), (0.017, 0.02)):
            band = (depth >= low) & (depth < high)
            middle = depth[band].mean()
            ratio, circle = force[band].mean()/reference[band].mean(), np.interp(middle, exact[:, 1], exact[:, 0])
            rows.append([cells, float(middle), float(ratio), float(radius[band].mean()/circle), float(circle*cells)])
            if cells != sizes[-1]:
                continue
            name = f"plate on a sphere, axisymmetric, {cells} cells per radius, d = {100*middle:.1f} % of R"
            book.within(name, "force over that of the elastic sphere", ratio, 1.0, 0.05)
            book.within(
                name, "contact radius over that of the elastic sphere", radius[band].mean() / circle, 1.0, 0.1,
                f"it is {circle * cells:.1f} cells", known=0.9 if low < 0.005 else None,
            )
        smooth = np.convolve(force, np.ones(9)/9, mode="same")[4:-4]
        axis.plot(100*depth[4:-4], smooth, label=f"{cells} cells per radius", linewidth=1)
    axis.plot(100*exact[:, 1], exact[:, 2], "k-", linewidth=2, label="elastic sphere")
    d = np.linspace(0, 0.02, 100)
    axis.plot(100*d, hertz(d), "k--", label="Hertz")
    axis.set(xlabel="approach of plate and centre (% of R)", ylabel="force / $E R^2$", xlim=(0, 2), ylim=(0, None))
    axis.legend()
    book.figure(
        "contact_axisymmetric", figure,
        "Plate on a sphere, axisymmetric: force against approach, running means over nine rows.",
    )
    book.table(
        "contact_axisymmetric", ["cells per R", "d/R", "F over elastic sphere", "a over elastic sphere", "a/h"], rows,
        "Force and contact radius.",
    )
    book.command(*[run.case for run in runs])


def drop(book, full):
    """A sphere that falls on a plate: Hertz's duration and largest force, rebound."""
    cells, speed = 64 if full else 32, 2e-3
    mass = 4/3*pi
    depth = (15*mass*speed**2/(16*STIFFNESS))**0.4
    runs = solve([deck(f"{FOLDER}/drop", method=method, cells=cells) for method in METHODS])
    for method, run in zip(METHODS, runs):
        name = f"sphere falls on a plate, {NAMES[method]}, {cells} cells per radius"
        rows = contact(run)
        touching = rows["time"][rows["force_z"] > 0]
        book.within(
            name, "duration over Hertz's",
            (touching[-1] - touching[0]) / (2.868 * (mass**2 / (STIFFNESS**2 * speed)) ** 0.2), 1.0, 0.06,
        )
        smooth = np.convolve(rows["force_z"], np.ones(21)/21, mode="same")
        book.within(
            name, "largest force, mean over one time unit, over Hertz's",
            smooth.max() / (4 / 3 * STIFFNESS * depth**1.5), 1.0, 0.06,
        )
        book.within(name, "speed of rebound over that of impact", body(run, 1)["velocity_z"][-1]/speed, 1.0, 0.03)
    book.command(runs[0].case)


def plug(book, full):
    """A plug under uniform pressure, drawn along by friction."""
    del full
    runs = solve([deck(f"{FOLDER}/plug", method=method, cells=24) for method in METHODS])
    for method, run in zip(METHODS, runs):
        name = f"plug in a bore, {NAMES[method]}"
        rows = contact(run)
        squeeze = 1e-3*2*pi*2  # pressure E d/R on 2 pi R L
        sliding = rows["time"] > 31
        book.within(
            name, "radial force over that of the exact pressure", -rows["force_x"][sliding].mean() / squeeze, 1.0, 0.05
        )
        book.within(
            name, "friction over normal force", rows["force_z"][sliding].mean() / -rows["force_x"][sliding].mean(), 0.2,
            1e-3,
        )
        moved = body(run, 1)
        book.within(
            name, "momentum of the plug over mu p 2 pi R L t",
            moved["mass"][-1] * moved["velocity_z"][-1] / (0.2 * squeeze * (moved["time"][-1] - 30)), 1.0, 0.05,
        )
    book.command(runs[0].case)


def punch(book, full):
    """A punch that closes a bore: the force of uniaxial strain."""
    del full
    runs = solve([deck(f"{FOLDER}/punch", method=method, cells=24) for method in METHODS])
    for method, run in zip(METHODS, runs):
        rows = contact(run)
        late = rows["time"] > 30
        modulus = 0.7/(1.3*0.4)
        book.within(f"punch in a bore, {NAMES[method]}", "force over (lambda + 2 mu) d/L pi R^2",
                    -rows["force_z"][late].mean()/(modulus*1e-3/2*pi), 1.0, 0.03)
    book.command(runs[0].case)


def check(book, full):
    """Quick: 24 and 48 cells to the sphere's radius; full: 96 too."""
    book.section("Contact: bodies of revolution")
    for part in (rods, plate, drop, plug, punch):
        part(book, full)


if __name__ == "__main__":
    main(check, __doc__)
