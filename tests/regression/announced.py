#!/usr/bin/env python3
"""Answers that once were wrong and called sound, or right and doubted: each is cured now, or the verdict tells.

usage: announced.py SGMP SOURCE_DIR SCRATCH_DIR

Others of the kind have their own scripts: damping.py (static strain with every update, damping until a time), slice.py
(a slice of space), verdict.py (crushed foam with mpm, projection behind damping).
"""
import math
import os

from _runs import SOURCE, Report, run

# A soft ball that breaks on a plate and is eroded whole before anything of it meets the wall behind: 0.8 % of the mass,
# all of the energy.
ERODED = """
dimension 2
grid cell=1 x=0:open y=0:20
wall x-=slip y-=slip y+=slip
method sgmp
time end=2 cfl=0.4
material soft j2 density=1 young=100 poisson=0.3 yield=1
failure soft plastic_strain=0.2
erode soft failed=yes
material hard elastic density=8 young=1000 poisson=0.3
body plate block material=hard lower=(10,0) upper=(20,20) ppc=2
body ball sphere material=soft centre=(28,10) radius=2 ppc=2
velocity ball x=-10
contact all
history steps=20
"""
# A bar that rings at a wave length of two cells, which usl damps; a light piece leaves the grid meanwhile.
LEAVING = """
dimension 1
grid cell=0.125 x=0:4
wall x-=fixed
method sgmp update=usl
lost remove
time end=20 cfl=0.5
material stuff elastic density=1 young=1 poisson=0
material light elastic density=1e-8 young=1e-8 poisson=0
body bar block material=stuff lower=0 upper=2 ppc=2
body piece block material=light lower=3 upper=3.5 ppc=2
velocity bar x="0.001*sin(8*pi*x)"
velocity piece x=0.1
stop energy_growth=1e6
"""
# A deck of which the program has something to say before it runs.
WARNED = """
parameter unused = 3
dimension 1
grid cell=0.5 x=0:20
time steps=3
material m elastic density=1 young=1 poisson=0
body b block material=m lower=2 upper=8 ppc=2
"""
# Sod's tube; exact between the tail of the fan and the shock: 0.92745 and 0.30313.
SOD = """
parameter method = sgmp
parameter update = musl
parameter courant = 0.4
dimension 1
grid cell=0.01 x=0:1
wall x-=slip x+=slip
method $method update=$update
time end=0.2 cfl=courant
material a fluid density=1
eos a ideal_gas gamma=1.4 energy0=2.5
material b fluid density=0.125
eos b ideal_gas gamma=1.4 energy0=0.25
viscosity all
body a block material=a lower=0 upper=0.5 ppc=2
body b block material=b lower=0.5 upper=1 ppc=2
history steps=20
output csv at=end fields=velocity,pressure
"""
# Equal bars that collide exchange their velocities.
BARS = """
parameter method = sgmp
parameter update = musl
parameter cells = 20
parameter speed = 0.01
parameter gap = 0.5
dimension 1
grid cell=1/cells
method $method update=$update
time end=gap/cells/speed+3.5 cfl=0.4
material m elastic density=1 young=1 poisson=0
body a block material=m lower=0 upper=1 ppc=2
body b block material=m lower=1+gap/cells upper=2+gap/cells ppc=2
velocity a x=speed
contact all
history steps=10
"""
# A bar that flies against a wall comes back with its velocity.
BOUNCE = """
parameter method = sgmp
parameter update = musl
parameter cells = 20
dimension 1
grid cell=1/cells x=0:open
wall x-=slip
method $method update=$update
time end=300/cells+2.5 cfl=0.4
material m elastic density=1 young=1 poisson=0
body m block material=m lower=1.5/cells upper=1+1.5/cells ppc=2
velocity m x=-0.01
history steps=20
"""
# A block at an angle under a pressure on all faces, damped to rest: every stress is the pressure.
PRESSED = """
parameter method = sgmp
parameter update = musl
parameter angle = 27
dimension 2
grid cell=1
method $method update=$update
time end=150 cfl=0.5
damping rate=0.15
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=(0.3,0.6) upper=(12.3,6.6) ppc=2 rotation=angle
pressure m face=x- p="1e-3*min(t/60,1)"
pressure m face=x+ p="1e-3*min(t/60,1)"
pressure m face=y- p="1e-3*min(t/60,1)"
pressure m face=y+ p="1e-3*min(t/60,1)"
history steps=20
output csv at=end fields=stress
"""
# A ball of eight cells across in its first radial mode (poisson=0.25: x = 2.5634 of Love's equation, speed of sound
# sqrt(1.2)).
BALL = """
parameter method = sgmp
dimension 3
grid cell=0.25
method $method
time end=5.4 cfl=0.2
material m elastic density=1 young=1 poisson=0.25
body m sphere material=m centre=(0.1,0.2,0.3) radius=1 ppc=2
velocity m x="1e-3*(x-0.1)" y="1e-3*(y-0.2)" z="1e-3*(z-0.3)"
history steps=1
"""
WAYS = [
    (method, update)
    for method in ("sgmp", "mpm", "gimp", "cpgimp", "bspline")
    for update in ("musl", "usf", "usavg", "usl")
]


def eroded(report):
    """What erosion takes is judged by energy and by body, not only by mass."""
    result = run("eroded", ERODED)
    if report.finished(result, "eroded"):
        share = result["eroded.mass"]/(result["eroded.mass"] + result.table("bodies.csv")[-2]["mass"])
        report.check(share < 0.01, f"eroded: {share} of the mass")
        report.check(result["verdict"] == "doubtful", f"eroded: {result['verdict']}")
        for words in ("of the energy that the scene was given was eroded", "erosion has left nothing of body 'ball'"):
            report.check(
                any(words in reason for reason in result["verdict_reasons"]), f"eroded: {result['verdict_reasons']}"
            )


def leaving(report):
    """A loss of energy is a loss, also where a particle has left the grid."""
    result = run("leaving", LEAVING)
    if report.finished(result, "leaving"):
        report.check(result["particles_lost"] > 0, f"leaving: {result['particles_lost']} particles have left")
        report.check(
            result["verdict"] == "doubtful" and any("is gone" in reason for reason in result["verdict_reasons"]),
            f"leaving: {result['verdict_reasons']}",
        )


def told(report, name, result, errors, allowed):
    """No run is sound and wrong, or coarse and wrong by more than it tells, or right and doubted."""
    worst = max(abs(error) for error in errors)
    right = worst <= allowed
    kept = result["verdict"] != "coarse" or worst <= max(allowed, result["verdict_error"])
    report.check(kept and (right or result["verdict"] != "sound") and not (right and result["verdict"] == "doubtful"),
                 f"{name}: off by {worst} and {result['verdict']} {result['verdict_reasons']}")
    return right


def between(result):
    """Errors of velocity and pressure in Sod's tube."""
    rows = [row for row in result.table("particles_end.csv") if 0.54 < row["x"] < 0.8]
    return [
        sum(row[key] for row in rows) / len(rows) / exact - 1
        for key, exact in (("velocity_x", 0.92745), ("pressure", 0.30313))
    ]


def velocities(speed):
    """Errors of the velocities of bars."""
    return lambda result: [
        row["velocity_x"] / speed - wanted for row, wanted in zip(result.table("bodies.csv")[-2:], (0, 1))
    ]


def stresses(result):
    """Errors of the mean stresses under pressure."""
    rows = result.table("particles_end.csv")
    return [sum(row[f"stress_{axis}"] for row in rows)/len(rows)/1e-3 + 1 for axis in ("xx", "yy")]


def family(report, title, deck, scenes, errors, allowed):
    """Runs of a deck by every method and update: each ends, or fails with mpm and usl, and its verdict
    goes with the truth; most are right."""
    right = 0
    for number, (method, update) in enumerate(WAYS):
        name = f"{title}_{method}_{update}"
        result = run(name, deck, method=method, update=update, **scenes[number % len(scenes)])
        if (method, update) == ("mpm", "usl") and result.code == 4:
            report.check("verdict: doubtful: it failed: " in result.text, f"{name}: {result.text}")
        elif report.finished(result, name):
            right += told(report, name, result, errors(result), allowed)
    report.check(right >= 0.5*len(WAYS), f"{title}: {right} of {len(WAYS)} are right")


def burnt(report):
    """TNT that fills a box and has burnt, by its equation of state at the energy that is left, but for waves: with usf
    the mean pressure is too high, and the verdict says so."""
    with open(os.path.join(SOURCE, "verification/truth/worst/burn_600329.inp"), encoding="utf-8") as file:
        deck = file.read()
    cold = sum(factor*(1 - 0.30/rate)*math.exp(-rate) for factor, rate in ((371200, 4.15), (3210, 0.95)))
    for update, words in (("usf", True), ("musl", False)):
        result = run(f"burnt_{update}", deck.replace("update=usf", f"update={update}"))
        if report.finished(result, f"burnt_{update}"):
            rows = result.table("particles_end.csv")
            exact = cold + 0.30*(6993 - result.table("history.csv")[-1]["kinetic_energy"]/(6*12))
            error = sum(row["pressure"]*row["mass"] for row in rows)/sum(row["mass"] for row in rows)/exact - 1
            told(report, f"burnt_{update}", result, [error], 0.1)
            report.check(
                words == any("update=usf" in reason for reason in result["verdict_reasons"]),
                f"burnt_{update}: {error} {result['verdict_reasons']}",
            )


def balls(report):
    """The period of a small ball, from the first four instants at which it stands still; it is too long, and every
    method says so."""
    period = 2*math.pi/(2.5634*math.sqrt(1.2))
    for method in ("sgmp", "gimp", "cpgimp", "bspline", "mpm"):
        result = run(f"ball_{method}", BALL, method=method)
        if report.finished(result, f"ball_{method}"):
            rows = result.table("history.csv")
            still = [
                b["time"]
                for a, b, c in zip(rows, rows[1:], rows[2:])
                if a["kinetic_energy"] > b["kinetic_energy"] <= c["kinetic_energy"]
            ]
            error = 1.5*period/(still[3] - still[0]) - 1 if len(still) > 3 else 1.0
            report.check(-0.1 < error < 0.02 and result["verdict"] == "coarse" and result["verdict_error"] >= 0.1,
                         f"ball_{method}: off by {error} and {result['verdict']} {result['verdict_reasons']}")


def warned(report):
    """Warnings of a deck: on the terminal, with --quiet, too, in the log and in summary.json."""
    result = run("warned", WARNED)
    words = "warned.inp:2:11: "
    if not report.finished(result, "warned"):
        return
    report.check(words + "warning: parameter 'unused' is not used" in result.text, f"warned: {result.text}")
    with open(os.path.join(result.folder, "run.log"), encoding="utf-8") as file:
        log = file.read()
    report.check("warning: " in log and words in log, "warned: no line in run.log")
    report.check(any(words in text for text in result.summary["warnings"]), f"warned: {result.summary['warnings']}")


def main():
    """All of them."""
    report = Report()
    eroded(report)
    leaving(report)
    warned(report)
    balls(report)
    burnt(report)
    family(report, "sod", SOD, ({"courant": 0.4}, {"courant": 0.2}, {"courant": 0.3}), between, 0.05)
    family(
        report,
        "bars",
        BARS,
        (
            {"gap": 0.5},
            {"gap": 2.3, "cells": 8},
            {"gap": 1.5, "cells": 40},
            {"gap": 0.3, "cells": 4},
            {"gap": 0.5, "cells": 12},
        ),
        velocities(0.01),
        0.05,
    )
    family(
        report,
        "bounce",
        BOUNCE,
        ({"cells": 10}, {"cells": 40}, {"cells": 6}),
        lambda result: [result.table("bodies.csv")[-1]["velocity_x"] / 0.01 - 1],
        0.05,
    )
    family(report, "pressed", PRESSED, ({"angle": 27}, {"angle": 0}, {"angle": 63}), stresses, 0.05)
    report.end()


main()
