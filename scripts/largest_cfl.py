#!/usr/bin/env python3
"""Largest stable Courant number of a deck by bisection, and what `cfl=auto` takes.

usage: largest_cfl.py DECK [--growth 2] [--lower 0.1] [--upper 3.2] [--sgmp build/release/sgmp] [NAME=VALUE ...]

The deck must have the parameter `cfl`. A run is stable if it ends by itself and its total energy never exceeds `growth`
times its first (usual: 2 for a vibration, 5 with usf, whose energy swings, 1.1 for an impact).
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile


def run(options, cfl, folder):
    """Growth of the energy, and the Courant number of the run; an aborted run has grown without bounds."""
    command = [options.sgmp, options.deck, "--quiet", "--output", folder, "--set", f"cfl={cfl}"]
    for setting in options.settings:
        command += ["--set", setting]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode in (2, 3):
        sys.exit(done.stdout.decode())
    if done.returncode:
        return float("inf"), None
    with open(os.path.join(folder, "history.csv"), encoding="utf-8") as file:
        energy = [
            float(row["total_energy"]) for row in csv.DictReader(line for line in file if not line.startswith("#"))
        ]
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    return max(energy) / abs(energy[0]), summary["cfl"]


def main():
    """Bisects between the bounds to 0.05."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("deck")
    parser.add_argument("settings", nargs="*", metavar="NAME=VALUE")
    parser.add_argument("--growth", type=float, default=2.0)
    parser.add_argument("--lower", type=float, default=0.1)
    parser.add_argument("--upper", type=float, default=3.2)
    parser.add_argument("--sgmp", default="build/release/sgmp")
    options = parser.parse_intermixed_args()  # settings may stand behind options, as the usage says
    with tempfile.TemporaryDirectory() as folder:
        lower, upper = options.lower, options.upper
        while upper - lower > 0.05:
            middle = 0.5 * (lower + upper)
            if run(options, middle, folder)[0] < options.growth:
                lower = middle
            else:
                upper = middle
        grown, cfl = run(options, "auto", folder)
    print(f"{os.path.basename(options.deck)} {' '.join(options.settings)}: largest {lower:.2f}", end="")
    print(f", auto {cfl:.3f} ({cfl / lower:.2f} of it), energy at auto {grown:.3f}" if cfl else ", auto fails")


if __name__ == "__main__":
    main()
