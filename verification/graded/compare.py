#!/usr/bin/env python3
"""Grids with unequal cells beside equal ones of the smallest side (doc/grids.md): what comes out, and user CPU seconds.

usage: compare.py SGMP SCRATCH_DIR [SCENE[:H] …]      scenes: plate disc target taylor blast block; H: smallest cell
"""
import csv
import json
import math
import os
import re
import resource
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
FINE = re.compile(r" (fine_[xyzr]|ratio|largest)=\S+")


def run(sgmp, scratch, scene, cell, graded):
    """Runs a scene; its folder and user CPU seconds."""
    with open(os.path.join(HERE, scene + ".inp"), encoding="utf-8") as file:
        text = file.read()
    if not graded:
        text = FINE.sub("", text)
    name = os.path.join(scratch, f"{scene}_{cell or 'h'}_{'unequal' if graded else 'equal'}")
    with open(name + ".inp", "w", encoding="utf-8") as file:
        file.write(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([sgmp, name + ".inp", "--quiet", "--output", name] + (["--set", f"h={cell}"] if cell else []),
                   check=True, env={**os.environ, "OMP_WAIT_POLICY": "passive"})
    return name, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def table(folder, name):
    """Rows of a file of columns."""
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return list(csv.DictReader(file))


def of_body(folder, name):
    """The last row of a body."""
    return [row for row in table(folder, "bodies.csv") if row["name"].strip() == name][-1]


def plate(folder):
    """Residual velocity of the ball; radius of a round hole as large as what has failed in the middle of a plate."""
    rows = [row for row in table(folder, "particles_end.csv") if row["body"] == "2"]
    rows = [row for row in rows if math.hypot(float(row["x0"]), float(row["y0"])) < 20]
    there = sum(float(row["mass"]) for row in rows)
    whole = sum(float(row["mass"]) for row in rows if float(row["damage"]) < 1)
    return {"residual velocity (m/s)": -float(of_body(folder, "ball")["velocity_z"]),
            "radius of the hole (mm)": 20*math.sqrt(max(0.0, 1 - whole/there))}


def disc(folder):
    """The same of a disc."""
    return plate(folder)


def target(folder):
    """Depth of the ball's lowest point, and what moves of the target upwards of its surface."""
    rows = table(folder, "particles_end.csv")
    ball = [float(row["z"]) for row in rows if row["body"] == "1"]
    return {"depth of the ball's centre (mm)": -float(of_body(folder, "ball")["z"]),
            "height of the rim (mm)": max(float(row["z"]) for row in rows if row["body"] == "2"),
            "deepest particle (mm)": -min(ball)}


def taylor(folder):
    """Length, the end as far above the last particles as at the start, and radius of the foot: the outermost
    particles."""
    rows = table(folder, "particles_end.csv")
    foot = [math.hypot(float(row["x"]), float(row["y"])) for row in rows if float(row["z"]) < 0.4]
    return {"centre of mass (mm)": float(of_body(folder, "bar")["z"]),
            "length (mm)": max(float(row["z"]) - float(row["z0"]) for row in rows
                               if float(row["z0"]) > 24.5) + 25.4, "radius of the foot (mm)": max(foot)}


def blast(folder):
    """Sag of the middle and half way to the rim at the end, and momentum that the blast has left."""
    rows = table(folder, "gauges.csv")
    middle, half = ([row for row in rows if row["name"].strip() == name] for name in ("middle", "half"))
    return {"sag of the middle (mm)": float(middle[0]["z"]) - float(middle[-1]["z"]),
            "sag half way (mm)": float(half[0]["z"]) - float(half[-1]["z"]),
            "largest sag (mm)": float(middle[0]["z"]) - min(float(row["z"]) for row in middle)}


def block(folder):
    """Height of its centre: the same motion in both."""
    return {"height of the centre (mm)": float(of_body(folder, "block")["z"])}


def main():
    """All scenes, a table of each."""
    sgmp, scratch = (os.path.abspath(path) for path in sys.argv[1:3])
    os.makedirs(scratch, exist_ok=True)
    for chosen in sys.argv[3:] or ("plate", "disc", "target", "taylor", "blast"):
        scene, _, cell = chosen.partition(":")
        found = {}
        for graded in (True, False):
            folder, seconds = run(sgmp, scratch, scene, cell, graded)
            with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
                summary = json.load(file)
            found[graded] = {"particles": summary["particles"], "CPU seconds": seconds,
                             "energy drift": summary["energy"]["drift"], **globals()[scene](folder)}
        print(f"| {chosen} | unequal | equal | |\n|---|---|---|---|")
        for key, value in found[True].items():
            other = found[False][key]
            note = f"{other/value:.3g} times"
            if key not in ("particles", "CPU seconds"):
                note = f"{100*(value/other - 1):+.2f} %"
            print(f"| {key} | {value:.5g} | {other:.5g} | {note} |", flush=True)


if __name__ == "__main__":
    main()
