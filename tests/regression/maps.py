#!/usr/bin/env python3
"""Runs that begin where others stand: `sgmp-view map` and the state in particle files.

usage: maps.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import subprocess
import sys
from math import isclose

import numpy as np

from _runs import SCRATCH, SOURCE, Report, run

# A ball of explosive whose detonation has just reached its surface.
MATERIAL = """
material tnt explosive density=1.63e-3 detonation_speed=6930
eos tnt jwl a=371.2e3 b=3.231e3 r1=4.15 r2=0.95 omega=0.3 energy0=7000
viscosity tnt quadratic=1.5 linear=0.06
"""
BALL = """
parameter t_end = 0.003
dimension axisymmetric
grid cell=2 r=0:open
time end=$t_end cfl=0.2
""" + MATERIAL + """
body charge {body}
detonation point=(0,0)
history steps=1
checkpoint every=10000
"""
SPHERE = "sphere material=tnt centre=(0,0) radius=20 spacing=1"
# A quarter of it in space.
QUARTER = """
dimension 3
grid cell=2 x=0:open y=0:open
wall x-=slip y-=slip
time end=0.002 cfl=0.2
""" + MATERIAL + """
body charge {body}
detonation point=(0,0,0)
history steps=1
"""
# A wave in a plastic bar, on a line and as a strip.
BAR = """
parameter t_end = 12
dimension {dimension}
grid cell=1 {grid}
wall {walls}
method sgmp stress=plain rotation=plain surfaces=plain
time end=$t_end dt=0.25
material m j2 density=1 young=1 poisson=0.3 yield=0.01
eos m gruneisen c0=1 s=1.5 gamma0=2
body bar {body}
history steps=1
checkpoint every=10000
output csv at=end fields=stress,velocity,plastic_strain,energy,density
"""
LINE = {"dimension": 1, "grid": "x=0:open", "walls": "x-=slip"}
STRIP = {"dimension": 2, "grid": "x=0:4 y=0:open", "walls": "x-=slip x+=slip y-=slip"}


def mapped(report, result, stem, *options):
    """The particle file of a body from the checkpoint of a run."""
    checkpoint = next(os.path.join(result.folder, name) for name in os.listdir(result.folder) if name.endswith(".h5"))
    done = subprocess.run(
        [
            sys.executable, os.path.join(SOURCE, "scripts", "sgmp-view"), "map", checkpoint, "-o",
            os.path.join(SCRATCH, stem), *options,
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
        text=True,
    )
    report.check(done.returncode == 0, f"map {stem}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def from_file(stem, body, material, spacing):
    """What stands behind the name of the body in the deck."""
    return f"file material={material} file={stem}_{body}.txt spacing={spacing}"


def energies(rows):
    """Kinetic, internal energy and momentum along z of a row of history.csv."""
    return np.array([rows["kinetic_energy"], rows["internal_energy"], rows["momentum_z"]])


def balls(report):
    """A ball goes on about its axis, and as a quarter in space."""
    half = run("half", BALL.format(body=SPHERE))
    whole = run("whole", BALL.format(body=SPHERE), t_end=0.005)
    for result in (half, whole):
        report.finished(result, "ball")
    mapped(report, half, "same")
    begun = run("begun", BALL.format(body=from_file("same", "charge", "tnt", 1)), t_end=0.002)
    report.finished(begun, "begun")
    begins(report, "begun", begun, half, 1.0, 1e-12)
    goes_on(report, "begun", begun, whole, 1.0, 0.03)
    mapped(report, half, "quarter", "--space", "3", "--sector", "90")
    text = mapped(report, half, "coarse", "--space", "3", "--sector", "90", "--merge", "2")
    report.check("which is heat now" in text, f"coarse: {text}")
    for stem, spacing, most in (("quarter", 1, 0.05), ("coarse", 2, 0.05)):
        result = run(stem, QUARTER.format(body=from_file(stem, "charge", "tnt", spacing)))
        report.finished(result, stem)
        begins(report, stem, result, half, 0.25, 1e-9)
        goes_on(report, stem, result, whole, 0.25, most)


def pieces(report):
    """A ball whose particles have been split goes on: what they keep of their stretch is left out."""
    split = run("split", BALL.format(body=SPHERE).replace("grid cell", "method sgmp split=0.52\ngrid cell"))
    report.finished(split, "split")
    report.check(split["energy.split_energy"] != 0, "split: no particle was split")
    mapped(report, split, "pieces")
    begun = run("pieces", BALL.format(body=from_file("pieces", "charge", "tnt", 1)), t_end=0.0001)
    if report.finished(begun, "pieces"):
        begins(report, "pieces", begun, split, 1.0, 1e-12)


def begins(report, name, result, before, part, tolerance):
    """A run begins with the energy and mass of the one before, or a part of them."""
    first, last = result.table("history.csv")[0], before.table("history.csv")[-1]
    totals = [row["kinetic_energy"] + row["internal_energy"] for row in (first, last)]
    report.check(
        isclose(totals[0], part * totals[1], rel_tol=tolerance),
        f"{name}: begins with the energy {totals[0]}, {part} of {totals[1]}",
    )
    mass = [run_.table("bodies.csv")[-1]["mass"] for run_ in (result, before)]
    report.check(isclose(mass[0], part * mass[1], rel_tol=1e-12), f"{name}: mass {mass[0]}, {part} of {mass[1]}")


def goes_on(report, name, result, whole, part, most):
    """And ends with nearly the kinetic energy that the straight run has: half a step of acceleration is missing."""
    ends = [run_.table("history.csv")[-1]["kinetic_energy"] for run_ in (result, whole)]
    report.check(
        isclose(ends[0], part * ends[1], rel_tol=most),
        f"{name}: ends with the kinetic energy {ends[0]}, {part} of {ends[1]}",
    )


def bars(report):
    """A line goes on as a strip along y as it does as a line, and much as it would have done."""
    body = 'block material=m lower=0 upper=20 ppc=2\nvelocity bar x="-0.1*(x<10)"'
    half = run("bar", BAR.format(body=body, **LINE))
    whole = run("bar_whole", BAR.format(body=body, **LINE), t_end=18)
    mapped(report, half, "line")
    mapped(report, half, "strip", "--space", "2", "--axis", "y", "--across", "0:4", "--spacing", "0.5")
    line = run("line", BAR.format(body=from_file("line", "bar", "m", 0.5), **LINE), t_end=6)
    strip = run("strip", BAR.format(body=from_file("strip", "bar", "m", 0.5), **STRIP), t_end=6)
    for name, result in (("bar", half), ("bar_whole", whole), ("line", line), ("strip", strip)):
        report.finished(result, name)
    begins(report, "line", line, half, 1.0, 1e-12)
    begins(report, "strip", strip, half, 4.0, 1e-12)
    alone = {round(row["x"], 6): row for row in line.table("particles_end.csv")}
    straight = sorted(whole.table("particles_end.csv"), key=lambda row: row["x"])
    for row in strip.table("particles_end.csv"):
        twin = alone.get(round(row["y"], 6))
        if not report.check(twin is not None, f"strip: a particle at y = {row['y']} where the line has none"):
            return
        for there, here in (
            ("stress_xx", "stress_yy"), ("stress_yy", "stress_zz"), ("plastic_strain", "plastic_strain"),
            ("velocity_x", "velocity_y"),
        ):
            report.check(
                isclose(twin[there], row[here], rel_tol=1e-7, abs_tol=1e-11),
                f"strip: {here} {row[here]}, of the line {twin[there]}",
            )
    for row, other in zip(sorted(line.table("particles_end.csv"), key=lambda row: row["x"]), straight):
        report.check(abs(row["x"] - other["x"]) < 0.02, f"line: x {row['x']}, of the straight run {other['x']}")
        report.check(
            abs(row["plastic_strain"] - other["plastic_strain"]) < 0.03 * 0.16,
            f"line: plastic strain {row['plastic_strain']} of {other['plastic_strain']}",
        )


def broken(report):
    """What a file cannot give."""
    deck = BAR.format(body=from_file("wrong", "bar", "m", 0.5), **LINE)
    for head, row, message in (
        ("x volume density", "1 0.5 0", "gives a density that is not positive"),
        ("x volume damage", "1 0.5 0.5", "gives damage, which material of body 'bar' does not keep"),
        ("x volume plastic_strian", "1 0.5 0.5", "a particle has no 'plastic_strian'"),
    ):
        with open(os.path.join(SCRATCH, "wrong_bar.txt"), "w", encoding="utf-8") as file:
            file.write(f"{head}\n{row}\n")
        result = run("wrong", deck)
        report.check(result.code == 3 and message in result.text, f"{head}: exit code {result.code}, {result.text}")
    with open(os.path.join(SCRATCH, "wrong_bar.txt"), "w", encoding="utf-8") as file:
        file.write("x volume stress_xx\n1 0.5 0.001\n")
    result = run("wrong_stress", deck.replace("eos m", "! ").replace("history", "initial_stress bar xx=1\nhistory"))
    report.check(
        result.code == 3 and "has a card initial_stress" in result.text,
        f"initial_stress: exit code {result.code}, {result.text}",
    )


def main():
    report = Report()
    balls(report)
    pieces(report)
    bars(report)
    broken(report)
    report.end()


if __name__ == "__main__":
    main()
