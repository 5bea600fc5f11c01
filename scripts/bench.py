#!/usr/bin/env python3
"""Nanoseconds per particle and step of the solver on this machine, beside the targets.

usage: bench.py SGMP [--quick] [--runs N] [--output DIR]

Each case is run several times; the median of the solver's own solve_seconds counts (reading the deck and writing files do
not). Writes results.json and prints a table. Speeds on shared machines scatter: compare medians of two builds in one
sitting (scripts/compare_bench.py).
"""
import argparse
import json
import os
import pathlib
import platform
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
BLOCK = ("block.inp", {"cells": 64, "steps": 12})

# name, deck, parameters, {threads: target in ns per particle-step}
CASES = [
    ("block sgmp elastic", *BLOCK, {}, {1: 60.0, 2: 33.0}),
    ("block mpm elastic", *BLOCK, {"method": "mpm"}, {}),
    ("block gimp elastic", *BLOCK, {"method": "gimp", "steps": 6}, {}),
    ("block sgmp j2", *BLOCK, {"material": "j2"}, {}),
    ("block sgmp johnson_cook", *BLOCK, {"material": "johnson_cook"}, {}),
    ("block sgmp normalised", *BLOCK, {"stress": "normalised"}, {}),
    ("block sgmp, cells changed", *BLOCK, {"drift": 0.05}, {}),
    ("taylor bar", "taylor_bar.inp", {}, {"cfl": 1.8}, {1: 557.0/6.0}),
    ("two blocks in contact", "two_blocks.inp", {"steps": 40}, {}, {}),
    ("two blocks that stick", "two_blocks.inp", {"steps": 40}, {"without": "contact"}, {}),
    ("bar 1D, 2 per cell", "bar.inp", {"cells": 4096, "steps": 200}, {}, {}),
    ("beam 2D, 4 per cell", "beam.inp", {"t_end": 0.005}, {}, {}),
]


def run(sgmp, deck, parameters, threads, scratch):
    """One run of a deck without its outputs (and the cards named by `without`); its summary."""
    text = (ROOT/"input"/deck).read_text()
    parameters = dict(parameters)
    without = parameters.pop("without", "output")
    bare = pathlib.Path(scratch)/deck
    bare.write_text(re.sub(rf"^(output|gauge|{without})[^\n]*", "", text, flags=re.M))
    folder = pathlib.Path(scratch)/"out"
    command = [sgmp, str(bare), "--quiet", "--threads", str(threads), "--output", str(folder)]
    for name, value in parameters.items():
        command += ["--set", f"{name}={value}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"bench: {' '.join(command)}\n{done.stderr}")
    summary = json.loads((folder/"summary.json").read_text())
    shutil.rmtree(folder)
    return summary


def measure(sgmp, case, threads, runs, scratch):
    """Median over several runs of one case."""
    name, deck, base, more, targets = case
    summaries = [run(sgmp, deck, {**base, **more}, threads, scratch) for _ in range(runs)]
    costs = [summary["ns_per_particle_step"] for summary in summaries]
    best = min(summaries, key=lambda summary: summary["ns_per_particle_step"])
    total = sum(best["phase_seconds"].values())
    return {
        "case": name, "threads": threads, "particles": best["particles"], "steps": best["steps"],
        "ns_median": statistics.median(costs), "ns_min": min(costs), "ns_max": max(costs),
        "target": targets.get(threads), "peak_memory_bytes": best["peak_memory_bytes"],
        "phases_percent": {phase: 100.0*seconds/total for phase, seconds in best["phase_seconds"].items()},
        "checksum": best["checksum"],
    }


def processor():
    """The processor's name, where the system tells."""
    try:
        for line in open("/proc/cpuinfo"):
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor()


def show(row):
    """One line of the table."""
    target = f"{row['target']:8.0f}" if row["target"] else "        "
    phases = " ".join(f"{percent:3.0f}" for percent in row["phases_percent"].values())
    print(f"{row['case']:28s} {row['threads']:2d} {row['ns_median']:8.1f} {row['ns_min']:8.1f} {row['ns_max']:8.1f}"
          f" {target}   {phases}", flush=True)


def main():
    """Runs all cases on one and two threads."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sgmp", help="path of the executable")
    parser.add_argument("--runs", type=int, default=3, help="runs per case (default 3)")
    parser.add_argument("--quick", action="store_true", help="one run per case")
    parser.add_argument("--threads", type=int, nargs="*", default=[1, 2], help="numbers of threads (default 1 2)")
    parser.add_argument("--output", default=str(ROOT/"build"/"bench"), help="folder of results.json")
    options = parser.parse_args()
    runs = 1 if options.quick else options.runs
    print(f"{processor()}, {os.cpu_count()} processors; ns per particle and step; phases in percent:"
          " momentum sweep, stress sweep, grid, re-binning, output")
    print(f"{'case':28s} th   median      min      max   target")
    rows = []
    with tempfile.TemporaryDirectory() as scratch:
        for case in CASES:
            for threads in options.threads:
                if case[1] == "bar.inp" and threads > 1:
                    continue  # one row of cells is one thread's work
                rows.append(measure(str(pathlib.Path(options.sgmp).resolve()), case, threads, runs, scratch))
                show(rows[-1])
    folder = pathlib.Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    (folder/"results.json").write_text(json.dumps({"processor": processor(), "rows": rows}, indent=1))
    print(f"written: {folder/'results.json'}")


if __name__ == "__main__":
    main()
