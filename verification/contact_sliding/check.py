#!/usr/bin/env python3
"""A block slides down an incline, and rides on a plate that slows down, turned against the grid: Coulomb's solution."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import main, solve  # noqa: E402
from contact import METHODS, NAMES, body, contact, deck  # noqa: E402

TURNS, G = (0, 30, 45), 10.0
# a block of 1e6 Pa bends by half a per cent under its weight: its surface is not that of the plate, and
STIFF = 1e7
                 # friction over normal force, both in the directions of the plate, is off by as much
SLIDING = 0.1    # (s) by when all of the block slides; before, parts of it still stick and friction is less


def axes(turn):
    """Unit vectors along and normal to a surface turned against the grid."""
    angle = np.radians(turn)
    return np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])


def way(rows, turn):
    """Displacement along the surface."""
    along, _ = axes(turn)
    return np.array([rows["x"][-1] - rows["x"][0], rows["y"][-1] - rows["y"][0]]) @ along


def incline(book, method, turn, run):
    """Way, reaction force and torque on a slope of 30 degrees with friction 0.3."""
    name = f"incline at {turn} degrees to the grid, {NAMES[method]}"
    slope, block, rows = np.radians(30), body(run, 2), contact(run)
    exact = 0.5*G*(np.sin(slope) - 0.3*np.cos(slope))*block["time"][-1]**2
    book.within(name, "way after 1 s (m)", abs(way(block, turn)), exact, 0.01)
    along, normal = axes(turn)
    span = np.diff(rows["time"], prepend=0.0)
    force = np.array([(rows["force_x"]*span).sum(), (rows["force_y"]*span).sum()])/rows["time"][-1]
    weight = block["mass"][0]*G*np.cos(slope)
    book.within(name, "mean normal force over m g cos", force @ normal/weight, 1.0, 0.02)
    late = rows["time"] > SLIDING
    force = np.array([(rows["force_x"]*span)[late].sum(), (rows["force_y"]*span)[late].sum()])
    book.within(
        name, f"friction over normal force, means from {SLIDING} s on", abs(force @ along) / (force @ normal), 0.3,
        0.005,
    )
    # A block that does not turn: the contact's moment about its centroid has the mean 0.
    middle = {axis: 0.5*(block[axis] + np.append(block[axis][0], block[axis][:-1])) for axis in "xy"}
    moment = rows["torque_z"] - (middle["x"]*rows["force_y"] - middle["y"]*rows["force_x"])
    book.at_most(name, "mean moment about the centroid over normal force and half length",
                 abs((moment*span).sum()/rows["time"][-1])/(weight*0.5), 0.05)


def check(book, full):
    """All methods and angles to the grid."""
    book.section("Contact: sliding block")
    cases = [(method, turn) for method in METHODS for turn in TURNS]
    runs = solve([deck("contact_sliding/slide", method=method, turn=turn, young=STIFF) for method, turn in cases])
    for (method, turn), run in zip(cases, runs):
        incline(book, method, turn, run)
    book.command(runs[0].case)
    cases = [(method, turn, friction) for method in METHODS for turn in TURNS for friction in (0.3, 2)]
    runs = solve(
        [
            deck("contact_sliding/decelerating", method=method, turn=turn, friction=friction)
            for method, turn, friction in cases
        ]
    )
    for (method, turn, friction), run in zip(cases, runs):
        block = body(run, 2)
        time = block["time"][-1]
        book.within(
            f"decelerating plate at {turn} degrees, friction {friction}, {NAMES[method]}", "way of the block (m)",
            way(block, turn), 3 * time - 0.5 * min(6.0, friction * G) * (time - 0.3) ** 2, 0.01,
        )
    book.command(runs[0].case)


if __name__ == "__main__":
    main(check, __doc__)
