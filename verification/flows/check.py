#!/usr/bin/env python3
"""Slow and fast flow of liquids: between plates at rest and beside one that moves against the exact profiles, and a
column of water that collapses against Martin and Moyce's experiment."""
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import COLOURS, NAMES, Case, main, slopes, solve, subplots  # noqa: E402
from sgmp_view.files import dumps_of  # noqa: E402

PUSH, NU = 1e-4, 0.5
SPEED = 1e-4
WIDTH, G = 0.05715, 9.81
# J. C. Martin and W. J. Moyce, An experimental study of the collapse of liquid columns on a rigid horizontal plane,
# Phil. Trans. R. Soc. A 244 (1952) 312-324, figure 3:
# t sqrt(2 g/a) and the place of the front over a, columns twice as high as a = 2.25 inches wide.
EXPERIMENT = np.array(
    [
        (0.832, 1.217), (1.219, 1.474), (1.997, 2.292), (2.547, 2.995), (3.345, 4.134), (4.034, 4.944), (4.418, 5.881),
        (5.091, 6.980), (5.685, 7.945), (6.306, 8.966), (6.822, 9.986),
    ]
).T


def deck(name, **parameters):
    return Case(f"verification/flows/{name}.inp", keep_dumps=name == "dam", **parameters)


def velocity(x, time):
    """Between plates at x = 0 and 1 under a body force, from rest: Poiseuille's parabola less a series of sines."""
    n = 2*np.arange(1, 200)[:, None] - 1
    return PUSH*(x*(1 - x)/(2*NU) - 4/(NU*np.pi**3)*(np.sin(n*np.pi*x)/n**3*np.exp(-(n*np.pi)**2*NU*time)).sum(0))


def dragged(x, time):
    """Between a plate at rest at x = 0 and one at x = 1 that is suddenly moved: Couette's line less a series of
    sines."""
    n = np.arange(1, 200)[:, None]
    return SPEED*(x + 2/np.pi*((-1.0)**n*np.sin(n*np.pi*x)/n*np.exp(-(n*np.pi)**2*NU*time)).sum(0))


def plate_work(start, end, length):
    """Of the shear stress at the moving plate."""
    n = np.arange(1, 200)
    rate = (n*np.pi)**2*NU
    return NU*SPEED**2*length*(end - start + (2/rate*(np.exp(-rate*start) - np.exp(-rate*end))).sum())


def profile(run):
    """Places across and velocities along the channel in its middle."""
    particles = run.particles()
    start = particles.fields["initial_position"]
    middle = abs(start[:, 1]) < 0.3
    return start[middle, 0], particles.fields["velocity"][middle, 1]


def channel(book, full):
    book.say(
        "A liquid between two plates is set in motion by gravity along them (ν = 0.5, width 1, c0 = 10; "
        "displacements are 1e-5 of the width). Exact: Poiseuille's parabola, and the series of its start."
    )
    sizes = (8, 16, 32)
    figure, axis = subplots(figsize=(5.5, 3.8))
    rows = []
    for method in ("sgmp", "gimp", "mpm", "bspline"):
        runs = solve([deck("channel", method=method, cells=n, t_end=0.1) for n in sizes])
        errors = []
        for n, run in zip(sizes, runs):
            x, v = profile(run)
            exact = velocity(x, 0.1)
            errors.append(math.sqrt(((v - exact)**2).mean())/exact.max())
            rows.append([NAMES[method], n, 0.1, errors[-1]])
        book.at_least(
            "start of Poiseuille's flow", f"order of the rms error, {NAMES[method]}, 8 to 32 cells",
            slopes(1 / np.array(sizes), errors).mean(), 1.5,
        )
        x, v = profile(runs[1])
        axis.plot(
            x, v / velocity(np.array([0.5]), 9.0), ".", color=COLOURS[method], markersize=3,
            label=f"{NAMES[method]}, t = 0.1",
        )
    for method in ("sgmp", "gimp"):
        run = solve([deck("channel", method=method, cells=16, half=4, t_end=1.0)])[0]
        x, v = profile(run)
        error = math.sqrt(((v - velocity(x, 1.0))**2).mean())/velocity(x, 1.0).max()
        rows.append([NAMES[method], 16, 1.0, error])
        book.at_most(
            "Poiseuille's parabola", f"rms error over the largest velocity, {NAMES[method]}, 16 cells", error, 0.03
        )
        axis.plot(x, v/velocity(np.array([0.5]), 9.0), ".", color=COLOURS[method], markersize=3)
    line = np.linspace(0, 1, 200)
    for time in (0.1, 1.0):
        axis.plot(line, velocity(line, time)/velocity(np.array([0.5]), 9.0), color="0.2", linewidth=0.9)
    axis.set(xlabel="place across the channel", ylabel="velocity over that of the end")
    axis.legend(fontsize=7)
    book.figure("channel", figure, "Flow between plates at t = 0.1 and 1, 16 cells; lines: exact.")
    book.table("channel", ["method", "cells", "t", "rms error"], rows, "Errors over the largest velocity.")
    book.command(deck("channel"))


def couette(book, full):
    book.say(
        "The same liquid beside a plate that is suddenly moved along itself (card `wallmotion`). Exact: Couette's "
        "line, and the series of its start; the plate's work from t = 0.5 to 1 against "
        "that of the exact shear stress at it."
    )
    sizes = (8, 16, 32)
    figure, axis = subplots(figsize=(5.5, 3.8))
    rows = []
    for method in ("sgmp", "gimp", "mpm", "bspline"):
        runs = solve([deck("couette", method=method, cells=n, t_end=0.1) for n in sizes])
        errors = []
        for n, run in zip(sizes, runs):
            x, v = profile(run)
            errors.append(math.sqrt(((v - dragged(x, 0.1))**2).mean())/SPEED)
            rows.append([NAMES[method], n, 0.1, errors[-1]])
        book.at_least(
            "start of Couette's flow", f"order of the rms error, {NAMES[method]}, 8 to 32 cells",
            slopes(1 / np.array(sizes), errors).mean(), 1.5,
        )
        x, v = profile(runs[1])
        axis.plot(x, v/SPEED, ".", color=COLOURS[method], markersize=3, label=f"{NAMES[method]}, t = 0.1")
    for method in ("sgmp", "gimp"):
        run = solve([deck("couette", method=method, cells=16, half=4, t_end=1.0)])[0]
        x, v = profile(run)
        error = math.sqrt(((v - dragged(x, 1.0))**2).mean())/SPEED
        rows.append([NAMES[method], 16, 1.0, error])
        book.at_most("Couette's line", f"rms error over the plate's speed, {NAMES[method]}, 16 cells", error, 0.03)
        history = run.history()
        work = np.interp([0.5, 1.0], history["time"], history["external_work"])
        book.within(
            "Couette's line", f"work of the plate from t = 0.5 to 1, {NAMES[method]}, 16 cells", work[1] - work[0],
            plate_work(0.5, 1.0, 8), 0.03,
        )
        axis.plot(x, v/SPEED, ".", color=COLOURS[method], markersize=3)
    line = np.linspace(0, 1, 200)
    for time in (0.1, 1.0):
        axis.plot(line, dragged(line, time)/SPEED, color="0.2", linewidth=0.9)
    axis.set(xlabel="place across the channel", ylabel="velocity over that of the plate")
    axis.legend(fontsize=7)
    book.figure("couette", figure, "Flow beside a plate that moves at t = 0.1 and 1, 16 cells; lines: exact.")
    book.table("couette", ["method", "cells", "t", "rms error"], rows, "Errors over the plate's speed.")
    book.command(deck("couette"))


def front(run):
    """Times over sqrt(a/(2 g)), places of the front over a: the eighth particle from the tip, which leaves single drops
    out."""
    dumps = dumps_of(run.folder)
    return (
        np.array([dump.time for dump in dumps]) * math.sqrt(2 * G / WIDTH),
        np.array([np.sort(dump.read().points[:, 0])[-8] for dump in dumps]) / WIDTH,
    )


def dam(book, full):
    book.say(
        "A column of water, 2.25 inches wide and twice as high, collapses over a smooth dry floor; places of the "
        "front against Martin and Moyce. Water without viscosity over a floor without friction runs ahead of the "
        "experiment, whose thin tongue is held back by its floor and whose time begins with the bursting of a "
        "membrane; Ritter's front of shallow water would run at 2, the experiment's at 1.6."
    )
    cases = [("sgmp", 16), ("gimp", 16)] + ([("sgmp", 24), ("mpm", 16), ("bspline", 16)] if full else [])
    runs = solve([deck("dam", method=method, cells=cells) for method, cells in cases])
    figure, axis = subplots(figsize=(5.5, 3.8))
    axis.plot(*EXPERIMENT, "ko", markersize=4, label="Martin and Moyce")
    time, place = EXPERIMENT
    late = time > 1.9
    rows = []
    for (method, cells), run in zip(cases, runs):
        name = f"{NAMES[method]}, {cells} cells over the width"
        when, where = front(run)
        ours = np.interp(time, when, where)
        ahead, speed = (
            ours[late] / place[late] - 1,
            np.polyfit(time[late], ours[late], 1)[0] / np.polyfit(time[late], place[late], 1)[0],
        )
        rows.append([name, float(ahead.max()), float(speed)])
        note = "no viscosity, no friction of the floor, no membrane that bursts"
        book.at_most(
            "Martin and Moyce's column", f"front ahead of the experiment's, largest, {name}", ahead.max(), 0.15, note
        )
        book.within(
            "Martin and Moyce's column", f"speed of the front over the experiment's, {name}", speed, 1.0, 0.12, note
        )
        axis.plot(when, where, color=COLOURS[method], linewidth=1.0 if cells == 16 else 0.6, label=name)
    axis.set(xlabel="t √(2g/a)", ylabel="place of the front over a", xlim=(0, 7), ylim=(0.9, 11))
    axis.legend(fontsize=7)
    book.figure("dam", figure, "Front of the collapsing column.")
    book.table("dam", ["run", "front ahead by", "speed over the experiment's"], rows, "Martin and Moyce's column.")
    book.command(deck("dam"))


def check(book, full):
    book.section("Flows")
    channel(book, full)
    couette(book, full)
    dam(book, full)


if __name__ == "__main__":
    main(check, __doc__)
