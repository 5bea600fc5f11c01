#!/usr/bin/env python3
"""sgmp-view error: its intervals against closed forms, its copies of decks against the decks, its budget, its words.

usage: error_estimate.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import contextlib
import glob
import html
import importlib.util
import io
import json
import math
import os
import shutil
import subprocess
import sys

from _runs import ENVIRONMENT, INPUT, SCRATCH, SGMP, SOURCE, Report

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
    print("skipped: numpy and matplotlib are not installed")
    sys.exit(77)
sys.path.insert(0, os.path.join(SOURCE, "python"))
import numpy as np  # noqa: E402
from sgmp_view import command, deck_variations  # noqa: E402
from sgmp_view.deck_text import Deck  # noqa: E402
from sgmp_view.error_estimate import rounded  # noqa: E402
from sgmp_view.files import read_table  # noqa: E402
from sgmp_view.grid_convergence import convergence_of  # noqa: E402
from sgmp_view.shapes import Shape, distance  # noqa: E402
from sgmp_view.study_runs import Checked, Member, Runner  # noqa: E402
from sgmp_view.turning import AXIS, DEGREES, hindrance, rotation, with_turn  # noqa: E402

# The first mode of a bar between walls: v = v0 cos(w t) sin(pi x/L), w = pi/L sqrt(E/rho). No parameter, walls at both
# ends, a number of steps.
BAR = """
units mm g ms
dimension 1
grid cell=0.0625 x=0:1
wall x-=slip x+=slip
time dt=1e-3 steps=250   ! a quarter of a time unit
material m elastic density=25 young=50 poisson=0
body bar block material=m lower=0 upper=1 &
  spacing=0.03125
velocity bar x="1e-3*sin(pi*x)"
history steps=5
"""
OMEGA = math.pi * math.sqrt(50 / 25)
MEAN = 1e-3 * 2 / math.pi * math.cos(OMEGA * 0.25)      # of the velocity
ENERGY = 25 * 1e-6 / 4 * math.cos(OMEGA * 0.25) ** 2
# A block that flies: what cells and steps cannot change.
FLYING = """
parameter speed = 2
parameter h = 1
units mm g ms
dimension 2
grid cell=h
time end=2 cfl=auto
material m elastic density=3 young=100 poisson=0
body arrow block material=m lower=(0,0) upper=(6,4) spacing=h/2
velocity arrow x=$speed
output vtu every=0.3
"""
# What turns as it flies, with all that a turned copy must turn; without forces its centre and its angular velocity are
# known.
TUMBLING = """
parameter spin = 0.3
parameter climb = "(0.5+0*x)"
units mm g ms
dimension 3
grid cell=1
time end=0.5 cfl=0.5
gravity (0,0,-2)
material m elastic density=3 young=100 poisson=0
body stick block material=m lower=(0,0,0) upper=(3,2,2) spacing=0.5
subtract stick block lower=(0,0,0) upper=(1,1,1)
body ball sphere material=m centre=(9,1,1) radius=1.5
velocity ball x=-spin*(y-1) y=spin*(x-9)+0*sin(x) z=$climb
velocity stick z=1 omega_y=0.2
gauge tip point=(9.25,1.25,2.25) fields=stress
"""
WORDS = """
parameter h = 0.5          # a comment
parameter two = h/2
parameter courant = 0.6
parameter way = gimp
units mm g ms
title "a title with ! and # in it"
dimension 2
grid cell=$h x=-1:8.5 y=open
lost remove
method $way
time end=1 cfl=$courant
include "inner.inp"
body left block material=m lower=(0,0) upper=(2,2) spacing=two
body right block material=m lower=(4,0) upper=(6,2) spacing=0.25
body third block material=m lower=(0,4) upper=(2,6)
body fourth block material=m lower=(4,4) upper=(6,6) ppc=3
velocity left x="0.1*sin(pi*x)"
"""


def check(report, condition, what, seen=""):
    """Notes a failure with what was seen."""
    report.check(condition, f"{what}\n{seen}")


def view(*words):
    """Runs a command in the scratch folder; its exit code and what it prints."""
    printed = io.StringIO()
    code = 0
    with contextlib.redirect_stdout(printed):
        try:
            command.main(list(words))
        except SystemExit as end:
            code = end.code
    return (1, printed.getvalue() + code) if isinstance(code, str) else (code or 0, printed.getvalue())


def write(name, text):
    """A deck in the scratch folder; what was there of its study is removed."""
    with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
        file.write(text)
    shutil.rmtree(os.path.join(SCRATCH, name.replace(".inp", ".error")), ignore_errors=True)
    return os.path.join(SCRATCH, name)


def estimates(name):
    """What a study has written, by quantity."""
    with open(os.path.join(SCRATCH, name), encoding="utf-8") as file:
        return {estimate["quantity"]: estimate for estimate in json.load(file)}


def index(report):
    """The grid convergence index on series that are known."""
    cells = (0.1, 0.14, 0.2)
    for order, counted in ((1.0, 1.0), (1.7, 1.7), (2.0, 2.0)):
        found = convergence_of([(h, 5 + 0.3 * h**order) for h in cells], 0.1)
        check(
            report,
            abs(found.order - counted) < 1e-6 and math.isclose(found.half_width, 1.25 * 0.3 * 0.1**order, rel_tol=1e-6),
            f"order {order}", str(found),
        )
    found = convergence_of([(h, 5 + 0.3 * h**3) for h in cells], 0.1)
    check(
        report,
        found.order == 2
        and math.isclose(found.half_width, 3 * 0.3 * (0.14**3 - 0.1**3) / (0.14**2 - 0.1**2) * 0.01, rel_tol=1e-6),
        "what is steeper counts as 2, with the factor 3",
        str(found),
    )
    found = convergence_of([(h, 5 + 0.3 * h**2.8) for h in (0.1, 0.14, 0.2, 0.28)], 0.1)
    check(report, found.order == 2 and found.half_width > 3 * 0.3 * 0.1**2.8, "of four sizes, too", str(found))
    found = convergence_of([(0.1, 5), (0.2, 5.01), (0.3, 6)], 0.1)
    check(
        report, found.order is None and math.isclose(found.half_width, 0.03, rel_tol=1e-9),
        "an order that no method has is none", str(found),
    )
    coarse = convergence_of([(h, 5 + 0.3 * h**2) for h in cells], 0.2)
    check(
        report, math.isclose(coarse.half_width, 1.25 * 0.3 * 0.04, rel_tol=1e-6), "error of a coarse run", str(coarse)
    )
    for values in ((5, 6, 5.5), (5, 6, 6.4), (5, 5.5, 6.0)):
        found = convergence_of(list(zip((0.1, 0.2, 0.3), values)), 0.1)
        regular = values == (5, 5.5, 6.0)
        check(report, (found.order is not None) == regular, "an order where there is one", str(found))
        if not regular:
            check(
                report, math.isclose(found.half_width, 3 * (max(values) - 5) / 2),
                "else three times the spread over the ratio less 1", str(found),
            )
    for values, regular in (
        ((5.1, 5.2, 5.4, 5.0), False), ((5.1, 5.2, 5.4, 5.8, 5.0), True), ((5.1, 5.2, 5.1, 5.8, 6.0), False),
    ):
        found = convergence_of([(0.1 * 2**k, value) for k, value in enumerate(values)], 0.1)
        check(
            report,
            (found.order is not None) == regular,
            f"{values}: all sizes, or all but the coarsest of five",
            str(found),
        )
    check(
        report,
        math.isnan(convergence_of([(0.1, 5)], 0.1).half_width)
        and convergence_of([(0.1, 5), (0.2, 5)], 0.1).half_width == 0,
        "one size, equal values",
    )
    check(report, convergence_of([(0.1, 5), (0.2, 6)], 0.1).half_width == 3, "two sizes")
    for value, width, words in (
        (-303.2222, 130.77, ("-300", "130")), (16.794, 0.0742, ("16.794", "0.074")),
        (2e-7, 3.21e-9, ("2.000e-7", "0.032e-7")),
    ):
        check(report, rounded(value, width) == words, f"{words[0]} ± {words[1]}", str(rounded(value, width)))


def checked(deck):
    """What the program says of a deck, and its particles by body."""
    path = write("copy.inp", deck.text())
    done = subprocess.run(
        [SGMP, path, "--check", "--threads", "1"], capture_output=True, text=True, check=False, env=ENVIRONMENT
    )
    bodies = [int(line.split()[2]) for line in done.stdout.splitlines() if line.startswith("body ")]
    return Checked(done), bodies, done.stdout + done.stderr


def changed(path, change, *values):
    """The program's words about a copy."""
    deck = Deck(path)
    words = change(deck, *values)
    return (*checked(deck), words, deck)


def copies(report):
    """Copies of decks: as they are, with cells twice as large, moved, with more particles."""
    with open(os.path.join(SCRATCH, "inner.inp"), "w", encoding="utf-8") as file:
        file.write("material m elastic density=25 young=50 poisson=0\n")
    words = write("words.inp", WORDS)
    own, bodies, text, _, _ = changed(words, lambda deck: "same")
    check(report, own.accepted and bodies == [64, 64, 64, 144], "a copy is the deck", text)
    _, bodies, text, _, deck = changed(words, deck_variations.with_cells, 2.0)
    check(report, bodies == [16, 16, 16, 36], "half as many particles along each axis, however they are given", text)
    check(report, deck.number(deck.one("grid").get("cell")) == 1.0, "cells twice as large", deck.text())
    check(
        report, deck.one("grid").get("x") == "-1.0:8.5" and "x=-1:9 in the place of -1:8.5" in text,
        "an end without a wall moves outwards to the grid", text,
    )
    _, bodies, text, said, _ = changed(words, deck_variations.with_more_particles)
    check(report, bodies == [144, 144, 144, 256] and "3 or 4" in said, "one more particle per cell and axis", text)
    now, bodies, text, _, deck = changed(words, deck_variations.with_other_lines, 1.03)
    check(
        report,
        bodies == [64, 64, 64, 144] and now.masses == own.masses and abs(deck_variations.cell_of(deck) - 0.515) < 1e-12,
        "other lines of the grid, the same particles", text,
    )
    now, bodies, text, said, _ = changed(words, deck_variations.with_half_step, 0.6)
    check(report, math.isclose(now.work, 2 * own.work, rel_tol=1e-2), "half the Courant number, twice the steps", text)
    now, bodies, text, said, deck = changed(words, deck_variations.with_shift, [0.0, 0.0], 1)
    low = deck.one("grid").get("y").partition(":")[0]
    check(
        report, now.accepted and said == "grid moved along x, y" and abs(float(low) / 0.5 % 1 - 0.41) < 1e-9,
        "the grid moved by a part of a cell", deck.text(),
    )
    _, _, text, said, _ = changed(words, deck_variations.with_other_method, lambda deck: checked(deck)[0].accepted, 0.6)
    check(report, said == "method bspline" and "bspline, musl" in text, "another method", text)
    _, _, text, said, _ = changed(
        words, deck_variations.with_other_method, lambda deck: checked(deck)[0].accepted, 0.9, ("bspline",)
    )
    check(
        report, said == "method sgmp, Courant number 0.8" and "sgmp, musl" in text,
        "a second one, at a step that all bear", text,
    )
    bar = Deck(write("bar.inp", BAR))
    check(
        report,
        deck_variations.fitting(bar, 1.03, close=True) == [16 / 15]
        and deck_variations.fitting(Deck(words), 1.03, close=True) == [1.03],
        "cells close by",
    )
    factors = deck_variations.fitting(bar, 1.4)
    check(
        report,
        factors and all(abs(16 / f - round(16 / f)) < 1e-9 for f in factors) and abs(factors[0] - 16 / 11) < 1e-9,
        "cells that fit the walls", str(factors),
    )
    check(report, deck_variations.with_shift(bar, [0.0], 1) is None, "walls at both ends hold the grid")
    for path in sorted(glob.glob(os.path.join(INPUT, "*.inp")))[::3]:
        target = (deck_variations.fitting(Deck(path), 2.0) or [1.0])[0]
        now, _, text, _, deck = changed(path, deck_variations.with_cells, target)
        check(
            report,
            now.accepted
            and math.isclose(deck_variations.cell_of(deck), target * deck_variations.cell_of(Deck(path)), rel_tol=1e-9),
            path,
            text,
        )


def surfaces(report):
    """Distances of surfaces of particles whose shapes are known."""
    def block(spacing, lower, upper):
        axes = [np.arange(a + spacing / 2, b, spacing) for a, b in zip(lower, upper)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(lower))
        return Shape(points, np.full(len(points), spacing ** len(lower)))

    def ball(spacing, radius, centre):
        whole = block(spacing, -np.full(len(centre), radius), np.full(len(centre), radius)).points
        points = whole[(whole**2).sum(axis=1) < radius**2]
        return Shape(
            points + centre,
            np.full(len(points), {2: math.pi, 3: math.pi * 4 / 3}[len(centre)] * radius ** len(centre) / len(points)),
        )

    for first, second, mean, largest, allowed in (
            # other particles, the same shape
            (block(0.5, (0, 0), (10, 4)), block(0.25, (0, 0), (10, 4)), 0, 0, 0.02),
            (block(0.5, (0,), (10,)), block(0.25, (0,), (11,)), math.sqrt(0.5), 1, 1e-9),     # one end of two has moved
            # cos of the angle, squared: a half
            (ball(0.25, 5, (0, 0)), ball(0.25, 5, (1, 0)), math.sqrt(0.5), 1, 0.03),
            (ball(0.5, 5, (0, 0)), ball(0.25, 5.5, (0, 0)), 0.5, 0.5, 0.1),
            (ball(0.5, 4, (0, 0, 0)), ball(0.4, 4.5, (0, 0, 0)), 0.5, 0.5, 0.12)):
        found = distance(first, second)
        check(
            report, abs(found[0] - mean) <= allowed and abs(found[1] - largest) <= allowed,
            f"surfaces {mean:.3g}, at most {largest:.3g} apart", str(found),
        )
    half = block(0.5, (0, 0), (5, 4))
    shorter = block(0.25, (0, 0), (4, 4))
    found = distance(Shape(half.points, half.sizes, True), Shape(shorter.points, shorter.sizes, True))
    check(
        report,
        abs(found[0] - math.sqrt(0.5 * ((4 + 2 / 3) / 14 + (2 + 2 / 3) / 12))) < 0.03 and abs(found[1] - 1) < 0.05,
        "round about an axis that is no surface", str(found),
    )


def turned(report):
    """Scenes turned against the grid: what their runs say is said in the axes of the deck."""
    from sgmp_view.quantities import quantity_of
    write("tumbling.inp", TUMBLING)
    code, text = view(
        "error", "tumbling.inp", "--sgmp", SGMP, "--threads", "1", "--quantity", "bodies.ball.z", "--quantity",
        "gauges.tip.velocity_y", "--budget", "1m",
    )
    check(report, code == 0 and "the scene turned by 17 degrees" in text, "a scene in space is turned", text)
    exact = {
        "bodies.ball.z": 1 + 0.5 * 0.5 - 0.25,
        "bodies.ball.x": 9,
        "bodies.ball.velocity_x": 0,
        "bodies.stick.velocity_x": 0,
        "history.momentum_y": 0,
    }
    for quantity, value in exact.items():
        found = quantity_of(os.path.join("tumbling.error", "turned"), quantity)
        check(report, abs(found - value) < 1e-4, f"{quantity} of the turned scene is {value}", str(found))
    for quantity in (
        "bodies.stick.x", "bodies.stick.y", "bodies.stick.z", "gauges.tip.velocity_x", "gauges.tip.velocity_y",
        "gauges.tip.stress_xx", "gauges.tip.stress_xy", "extent.ball.x_max", "extent.ball.z_length",
        "bodies.ball.velocity_z", "history.kinetic_energy",
    ):
        pair = [quantity_of(os.path.join("tumbling.error", run), quantity) for run in ("deck", "turned")]
        check(
            report, abs(pair[0] - pair[1]) < 0.02 * max(abs(pair[0]), 0.1), f"{quantity} is nearly that of the deck",
            str(pair),
        )
    check(
        report,
        np.allclose(rotation(DEGREES, AXIS) @ AXIS, AXIS)
        and math.isclose(np.trace(rotation(DEGREES, AXIS)), 1 + 2 * math.cos(math.radians(DEGREES))),
        "a rotation",
    )
    plane = FLYING.replace("upper=(6,4)", "upper=(6,4) rotation=30 pivot=(1,2)")
    deck, copy = Deck(write("turn.inp", plane)), Deck(write("turn.inp", plane))
    with_turn(copy)
    body = copy.all("body")[0]
    turn, pivot = (
        math.radians(float(body.get("rotation"))),
        [float(part) for part in body.get("pivot")[1:-1].split(",")],
    )
    both = rotation(math.degrees(turn), (0, 0, 1))
    corner = rotation(30, (0, 0, 1)) @ (np.array([6, 4, 0]) - [1, 2, 0]) + [1, 2, 0]
    check(
        report, np.allclose(both @ (np.array([6, 4, 0]) - pivot) + pivot, rotation(DEGREES, (0, 0, 1)) @ corner),
        "on top of a rotation that a body has", copy.text(),
    )
    check(report, hindrance(deck) is None, "a free scene can be turned")
    for text, reason in (
        (BAR, "a line"), (FLYING.replace("grid cell=h", "grid cell=h y=0:open\nwall y-=slip"), "walls"),
        (FLYING + "load arrow (1,0,0)\n", "the card load"),
        (FLYING.replace("dimension 2", "dimension axisymmetric"), "their axis"),
        (FLYING.replace("spacing=h/2", "layout=gauss"), "lattice"),
    ):
        check(
            report, reason in hindrance(Deck(write("turn.inp", text))), f"not turned: {reason}",
            hindrance(Deck("turn.inp")),
        )


def shapes(report):
    """The final shape beside another run, and between the runs of a study."""
    words = (
        "error", "flying.inp", "--sgmp", SGMP, "--threads", "1", "--set", "speed=3", "--quantity", "shape.arrow.mean",
        "--quantity", "shape.arrow.largest",
    )
    code, text = view(*words)
    from sgmp_view.quantities import quantity_of

    write(
        "round.inp",
        FLYING.replace("dimension 2", "dimension axisymmetric")
        .replace("x=$speed", "z=$speed")
        .replace("grid cell=h", "grid cell=h r=0:open z=open"),
    )
    subprocess.run([SGMP, "round.inp", "--set", "speed=0", "--quiet"], check=True, env=ENVIRONMENT)
    for name, value in (("x_max", 6), ("x_min", 0), ("z_length", 4)):
        seen = quantity_of("round.out", f"extent.arrow.{name}")
        check(report, abs(seen - value) < 1e-9, f"{name} of a cylinder is {value}", str(seen))
    found = estimates("flying.error/error.json")
    check(
        report, code == 0 and "surface of arrow (mean) = " in text and "converged to 5 %" in text,
        "beside the deck's own", text,
    )
    check(
        report,
        found["shape.arrow.largest"]["half_width"] < 0.1
        and math.isclose(found["shape.arrow.mean"]["tolerance"], 0.05 * 6),
        "the same shape with all cells",
        text,
    )
    check(report, found["shape.arrow.mean"]["unit"] == "mm", "in mm")
    write("behind.inp", FLYING.replace("end=2", "end=1.8"))
    subprocess.run([SGMP, "behind.inp", "--set", "speed=3", "--quiet"], check=True, env=ENVIRONMENT)
    code, text = view(*words, "--against", "behind.out")
    found = estimates("flying.error/error.json")
    check(
        report,
        abs(found["shape.arrow.largest"]["value"] - 0.6) < 0.02 and found["shape.arrow.largest"]["half_width"] < 0.05,
        "beside a run that ends 0.6 mm earlier", text,
    )
    check(
        report, abs(found["shape.arrow.mean"]["value"] - 0.6 * math.sqrt(0.4)) < 0.03,
        "its mean: two sides of four have moved by it", text,
    )
    code, text = view(
        "error", "flying.inp", "--sgmp", SGMP, "--set", "speed=3", "--quantity", "shape.arrow.mean", "--check", "-o",
        "other.error",
    )
    check(
        report, code == 0 and "as it is" in text and not os.path.exists("other.error/deck"),
        "--check tells costs and runs a step only", text,
    )
    code, text = view("compare", "flying.error/deck", "behind.out", "--shape", "arrow")
    check(report, code == 0 and "surface of arrow" in text and "0.6" in text, "compare knows shapes", text)


def intervals(report):
    """A bar whose end is known: the interval holds it, is not much wider, and says whether it may be quoted."""
    write("bar.inp", BAR)
    words = ("error", "bar.inp", "--sgmp", SGMP, "--threads", "1", "--budget", "2m", "--quantity")
    code, text = view(
        *words, "bodies.bar.velocity_x", "--quantity", "history.kinetic_energy", "--quantity",
        "history.kinetic_energy:max",
    )
    check(report, code == 0 and "v_x of bar = " in text and "converged to 5 %" in text, "a bar between walls", text)
    found = estimates("bar.error/error.json")
    for quantity, exact in (("bodies.bar.velocity_x", MEAN), ("history.kinetic_energy", ENERGY)):
        estimate = found[quantity]
        error = abs(estimate["value"] - exact)
        check(report, error <= estimate["half_width"], f"{quantity}: the interval holds {exact}", text)
        check(report, estimate["half_width"] < 0.15 * abs(exact), f"{quantity}: and is narrow", text)
    check(
        report, abs(found["history.kinetic_energy:max"]["value"] / (25e-6 / 4) - 1) < 1e-2, "largest of all rows",
        str(found["history.kinetic_energy:max"]["value"]),
    )
    check(
        report,
        {run["part"] for run in estimate["runs"]} == {"deck", "cells", "step", "grid's place", "method", "particles"},
        "all parts", text,
    )
    with open(os.path.join(SCRATCH, "bar.error/deck/summary.json"), encoding="utf-8") as file:
        kept = json.load(file)["error_estimate"]
    check(report, kept["bodies.bar.velocity_x"]["line"] in text, "summary.json has it", str(kept))
    code, text = view(*words, "bodies.bar.velocity_x", "--tolerance", "0.0001%")
    check(
        report, code == 0 and "not converged; do not quote" in text and text.count("done before") >= 8,
        "a narrow tolerance; nothing is run twice", text,
    )
    code, text = view(*words, "bodies.bar.velocity_x", "--tolerance", "1e-3")
    check(report, "converged to 1e-3 m/s" in text and "is reached for the least by" in text, "in its unit", text)
    kept = estimates("bar.error/error.json")
    code, text = view("report", "bar.error/deck")
    with open(os.path.join(SCRATCH, "bar.error/deck/report.html"), encoding="utf-8") as file:
        page = file.read()
    check(
        report,
        code == 0
        and "How wrong the numbers are" in page
        and html.escape(kept["bodies.bar.velocity_x"]["line"]) in page,
        "the report has it",
        text,
    )
    code, text = view("compare", "bar.error/deck", "bar.error/step")
    check(report, code == 0 and "deck: v_x of bar = " in text and "step: v_x" not in text, "compare has it", text)


def narrow(report):
    """Three cells between walls: what does not fit is named, with what does."""
    write(
        "narrow.inp", BAR.replace("cell=0.0625", "cell=1/3").replace("0.03125", "1/6").replace("steps=250", "steps=20")
    )
    code, text = view(
        "error", "narrow.inp", "--sgmp", SGMP, "--threads", "1", "--quantity", "bodies.bar.velocity_x", "--budget", "1m"
    )
    check(
        report,
        code == 0
        and "no cell near 0.667 fits the walls; there fit 1, 0.5, 0.3333, 0.25, 0.2 …" in text
        and "cell 0.5 " in text,
        "walls",
        text,
    )


def misfit(report):
    """A cell that does not fit between walls: the nearest that does is taken, and the others fit, too. The box stays
    where it depends on the cell."""
    write(
        "misfit.inp",
        BAR.replace("cell=0.0625", "cell=0.07").replace("0.03125", "1/28").replace("steps=250", "steps=20"),
    )
    code, text = view(
        "error", "misfit.inp", "--sgmp", SGMP, "--threads", "1", "--quantity", "bodies.bar.velocity_x", "--budget", "1m"
    )
    check(
        report,
        code == 0
        and "cell 0.07 does not fit between the walls; the nearest that does is taken in its place: 0.07143" in text,
        "a cell that fits",
        text,
    )
    sides = [
        run["setting"]
        for run in estimates("misfit.error/error.json")["bodies.bar.velocity_x"]["runs"]
        if run["part"] in ("deck", "cells")
    ]
    check(
        report, len(sides) > 3 and all(abs(1 / side - round(1 / side)) < 1e-6 for side in sides), "all cells fit",
        str(sides),
    )
    deck = Deck(
        write(
            "box.inp",
            "parameter h = 0.1\ndimension 2\ngrid cell=h x=0:20*h y=-5*h:open\nwall x-=slip x+=slip y-=slip\n",
        )
    )
    deck_variations.with_cells(deck, 2.0)
    check(
        report,
        deck.one("grid").get("x") == "0.0:2.0"
        and deck.one("grid").get("y") == "-0.5:open"
        and abs(deck_variations.cell_of(deck) - 0.2) < 1e-12,
        "a box in cells",
        deck.text(),
    )
    both = Deck(write("both.inp", "dimension 2\ngrid cell=0.1 x=0:1.2 y=0:0.9\nwall x-=slip x+=slip y-=slip y+=slip\n"))
    check(
        report,
        [round(0.1 * f, 9) for f in deck_variations.fitting(both, 3.0)] == [0.3]
        and deck_variations.fitting(both, 2.0) == [],
        "cells that fit on all axes",
    )


def flight(report):
    """A block that flies: no error in what is exact, next to none where particles do not fit it (a tenth of a cell at
    its ends, where particles are larger or smaller); its numbers are found with the deck's parameters."""
    write("flying.inp", FLYING)
    code, text = view(
        "error", "flying.inp", "--sgmp", SGMP, "--threads", "1", "--set", "speed=3", "--quantity", "bodies.arrow.x",
        "--quantity", "extent.arrow.x_max",
        *(word for how in ("mean", "integral", "time_of_max") for word in ("--quantity", f"bodies.arrow.x:{how}")),
    )
    found = estimates("flying.error/error.json")
    for quantity, exact, wide in (
        ("bodies.arrow.x", 9, 2e-3), ("extent.arrow.x_max", 12, 0.1), ("bodies.arrow.x:mean", 6, 2e-3),
        ("bodies.arrow.x:integral", 12, 2e-3), ("bodies.arrow.x:time_of_max", 2, 1e-9),
    ):
        check(
            report, abs(found[quantity]["value"] - exact) < 1e-9 and found[quantity]["half_width"] < wide,
            f"{quantity} is {exact}", text,
        )
    check(
        report, [found[name]["unit"] for name in ("bodies.arrow.x", "bodies.arrow.x:integral")] == ["mm", "mm ms"],
        "with their units", text,
    )
    steps = [read_table(os.path.join("flying.error", name, "history.csv"))["time"] for name in ("deck", "step", "gimp")]
    check(
        report, all(min(abs(times - 0.3)) < 1e-12 for times in steps), "all runs land on the times of the deck's dumps",
        str(steps),
    )
    check(
        report,
        os.path.exists("flying.error/deck/particles.pvd") and not glob.glob("flying.error/[cgs]*/particles_*.vtu"),
        "only the deck's dumps are kept",
    )
    code, text = view("error", "flying.inp", "--sgmp", SGMP, "--list")
    check(
        report,
        code == 0
        and any(line.split()[0] == "bodies.arrow.velocity_x" and line.endswith(" 2 m/s") for line in text.splitlines()),
        "the list",
        text,
    )


def budget(report):
    """What does not fit is left out and said; what was stopped is gone on with."""
    for method in ("gimp", "bspline"):
        shutil.rmtree(os.path.join(SCRATCH, "flying.error", method))
    code, text = view(
        "error", "flying.inp", "--sgmp", SGMP, "--threads", "1", "--set", "speed=3", "--quantity", "bodies.arrow.x",
        "--budget", "0s",
    )
    check(
        report, code == 0 and "left out" in text and "as far as was looked, not at: method" in text,
        "a part that is left out is named", text,
    )
    shutil.rmtree(os.path.join(SCRATCH, "flying.error/deck"))
    code, text = view(
        "error", "flying.inp", "--sgmp", SGMP, "--threads", "1", "--set", "speed=3", "--quantity", "bodies.arrow.x",
        "--budget", "0s",
    )
    check(
        report, code == 1 and "the budget is" in text and "it needs about" in text,
        "a budget too small for the deck itself", text,
    )
    deck = FLYING.replace("upper=(6,4)", "upper=(160,80)").replace("end=2", "end=45").replace("cfl=auto", "cfl=0.5")
    member = Member("deck", "long", "", deck, 1.0)
    shutil.rmtree(os.path.join(SCRATCH, "budget"), ignore_errors=True)
    first = Runner(os.path.join(SCRATCH, "budget"), SGMP, 1, 1.0)
    check(
        report, not first.run(member) and member.code == 6 and member.note == "stopped at the budget",
        "stopped at the budget", f"{member}",
    )
    second = Runner(os.path.join(SCRATCH, "budget"), SGMP, 1, 300)
    check(report, second.run(member) and member.code == 0, "gone on with", f"{member}")
    check(report, second.summary(member)["restarted_from"] != "", "from its checkpoint", str(second.summary(member)))


def coarse(report):
    """Parts whose runs do not fit are looked at with coarser cells: counted is the change from the run with these
    cells. The budget is counted in particle-steps here, so that the machine does not matter."""
    write("bar.inp", BAR)
    spent = []
    taken, expected, left = Runner.run, Runner.expected, Runner.left
    Runner.run = lambda runner, member: taken(runner, member) and (spent.append(member.work) or True)
    Runner.expected = lambda runner, member: 0.0 if runner.is_done(member) else member.work
    # the deck, cells twice and 1.4 times as large, half the step, another place: 1 + 0.25 + 0.47 + 2 + 1
    Runner.left = lambda runner: 5.5 - sum(spent)
    try:
        code, text = view("error", "bar.inp", "--sgmp", SGMP, "--threads", "1", "--quantity", "bodies.bar.velocity_x")
    finally:
        Runner.run, Runner.expected, Runner.left = taken, expected, left
    found = estimates("bar.error/error.json")["bodies.bar.velocity_x"]
    check(
        report, code == 0 and all(width is not None for width in found["parts"].values()), "all parts are looked at",
        text,
    )
    check(
        report, set(found["coarse_parts"]) == {"method", "particles"} and "with cells of 0.125" in found["line"],
        "two of them with coarser cells, as is said", text,
    )
    values = {run["setting"]: run["value"] for run in found["runs"]}
    change = abs(values["3 particles per cell and axis, with cells of 0.125"] - values[0.125])
    check(
        report, 0 < change and math.isclose(found["parts"]["particles"], change),
        "counted is the change with these cells", str(values),
    )
    check(
        report, abs(found["value"] - MEAN) <= found["half_width"] < 0.3 * abs(MEAN),
        "the interval holds the closed form", text,
    )


def words_of_errors(report):
    """What is said of mistakes."""
    for words, said in (
        (("--quantity", "bodies.arow.x"), "near it: bodies.arrow.x"),
        (("--quantity", "bodies.arrow.x:maxx"), "there is none"),
        (("--quantity", "energy.kinetic:max"), "there is none"), ((), "which number?"),
        (("--quantity", "bodies.arrow.x", "--set", "sped=3"), "the deck has no parameter 'sped'"),
        (("--quantity", "bodies.arrow.x", "--budget", "ten"), "expected a time"),
        (("--quantity", "bodies.arrow.x", "--set", "h=-1"), "cell"),
    ):
        code, text = view("error", "flying.inp", "--sgmp", SGMP, *words)
        check(report, code == 1 and said in text, f"{words}: {said}", text)


def main():
    """All of them, in the scratch folder."""
    os.environ.update(ENVIRONMENT)
    os.chdir(SCRATCH)
    report = Report()
    for part in (
        index, surfaces, copies, intervals, narrow, misfit, flight, shapes, turned, budget, coarse, words_of_errors,
    ):
        part(report)
    report.end()


if __name__ == "__main__":
    main()
