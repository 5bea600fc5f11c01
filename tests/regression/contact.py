#!/usr/bin/env python3
"""Contact in runs from decks: momentum, force pairs, threads, rebound, friction.

usage: contact.py SGMP_EXECUTABLE SOURCE_FOLDER SCRATCH_FOLDER
"""
import csv
import json
import math
import os
import subprocess
import sys

BARS = """
title "Two bars"
parameter method=sgmp
dimension 1
grid cell=0.02
method $method mass_cutoff=0
time end=3 cfl=0.5
material one elastic density=1 young=1 poisson=0
body left block material=one lower=-1 upper=0
body right block material=one lower=0 upper=1
velocity left x=1e-3
contact left right
history steps=1
"""

SLIDE = """
title "Block on an incline turned against the grid"
parameter turn=30
parameter slope=30
dimension 2
grid cell=0.1
method sgmp
time end=0.3 cfl=0.5
gravity (10*sin((slope+turn)*pi/180),-10*cos((slope+turn)*pi/180))
material soft elastic density=1000 young=1e6 poisson=0.3
body plate block material=soft lower=(-0.5,-0.4) upper=(2,0) rotation=turn
body block block material=soft lower=(0,0) upper=(1,0.5) rotation=turn
rigid plate
contact block plate friction=0.3
history steps=1
"""


def run(executable, folder, deck, *options):
    """Runs a deck given as text; returns its tables."""
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, "deck.inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(deck)
    subprocess.run([executable, path, "--output", folder, "--quiet", *options], check=True)
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    return {name: table(os.path.join(folder, name + ".csv")) for name in ("history", "bodies", "contact")}, summary


def table(path):
    """Rows of a history as dictionaries of numbers."""
    with open(path, encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()}
                for row in csv.DictReader(line for line in file if not line.startswith("#"))]


def check(condition, text):
    """Prints a finding and remembers failures."""
    print(("ok    " if condition else "FAILED ") + text)
    return bool(condition)


def bars(executable, scratch):
    """Momentum of the bars, impulse of the pair, rebound."""
    good = True
    for method in ("mpm", "gimp", "sgmp"):
        data, _ = run(executable, os.path.join(scratch, "bars_" + method), BARS, "--threads", "1", "--set", "method=" + method)
        start = data["history"][0]["momentum_x"]
        drift = max(abs(row["momentum_x"]/start - 1) for row in data["history"])
        good &= check(drift < 1e-12, f"{method}: total momentum constant, drift {drift:.1e}")
        impulse = sum(-row["force_x"]*(row["time"] - before["time"])
                      for before, row in zip(data["contact"], data["contact"][1:]))
        right = [row for row in data["bodies"] if row["body"] == 2][-1]
        gained = right["mass"]*right["velocity_x"]
        good &= check(abs(impulse/gained - 1) < 1e-10, f"{method}: impulse of the pair is what the second body gained")
        good &= check(gained/start > 0.97, f"{method}: the second bar leaves with {gained/start:.4f} of the momentum")
        last = max(row["time"] for row in data["contact"] if abs(row["force_x"]) > 0.25e-3)
        good &= check(abs(last/2 - 1) < 0.02, f"{method}: they part after {last:.3f} (exact 2)")
        remainder = abs(data["history"][-1]["energy_remainder"])/data["history"][0]["total_energy"]
        good &= check(remainder < 1e-12, f"{method}: the ledger explains the kinetic energy, remainder {remainder:.1e}")
    return good


def sliding(executable, scratch):
    """Coulomb friction at an angle to the grid, and the same bits for any number of threads."""
    checksums = set()
    for threads in ("1", "2", "3"):
        data, summary = run(executable, os.path.join(scratch, "slide_" + threads), SLIDE, "--threads", threads)
        checksums.add(summary["checksum"])
    good = check(len(checksums) == 1, "the same bits with 1, 2 and 3 threads")
    block = [row for row in data["bodies"] if row["body"] == 2]
    way = math.hypot(block[-1]["x"] - block[0]["x"], block[-1]["y"] - block[0]["y"])
    exact = 0.5*10*(math.sin(math.pi/6) - 0.3*math.cos(math.pi/6))*block[-1]["time"]**2
    return good & check(abs(way/exact - 1) < 0.1, f"the block slid {way:.4f} (exact {exact:.4f})")


def strangers(executable, scratch):
    """A third body without a card for it is warned of, by name; none where every pair has one."""
    third = BARS.replace("velocity left", "body third block material=one lower=1 upper=1.5\nvelocity left").replace("end=3", "end=0.1")
    good = True
    for name, deck, said in (("uncarded", third, True), ("all", third.replace("contact left right", "contact all"), False),
                             ("pair", BARS.replace("end=3", "end=0.1"), False)):
        folder = os.path.join(scratch, "strangers_" + name)
        run(executable, folder, deck)
        with open(os.path.join(folder, "run.log"), encoding="utf-8") as file:
            log = file.read()
        good &= check(("'left' and 'third' (2 such" in log) == said, f"{name}: {'a' if said else 'no'} warning of bodies without a card")
    return good


def main():
    """Runs all checks."""
    executable, _, scratch = sys.argv[1:4]
    good = bars(executable, scratch)
    good &= sliding(executable, scratch)
    good &= strangers(executable, scratch)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
