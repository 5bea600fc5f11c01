#!/usr/bin/env python3
"""threads.py SGMP [--runs N] [--threads T]: from which size on threads pay.

Small scenes in turns with one thread and with T (2), all of them taken (SGMP_THREADS=exact): the least time of a step
of each, their ratio, and what a step costs with T beyond its T-th part. `src/run/thread_choice.f90` rests on this
table. Only a machine without other work gives figures that mean something: threads that wait for one without a
processor wait long."""
import argparse
import json
import os
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENES = [
    ("block, 3D", "input/block.inp", ["cells=8", "steps=300"]),
    ("block, 3D", "input/block.inp", ["cells=12", "steps=150"]),
    ("block, 3D", "input/block.inp", ["cells=16", "steps=60"]),
    ("Taylor bar, 3D", "input/taylor_bar.inp", ["h=1.52", "cfl=0.8", "t_end=0.02"]),
    ("Taylor bar, 3D", "input/taylor_bar.inp", ["cfl=1.8", "t_end=0.02"]),
]
SCENES += [("section, plane", "scripts/bench/section.inp", [f"cells={n}", f"steps={steps}", "space=2"])
           for n, steps in ((16, 1500), (32, 600), (64, 200), (96, 80))]
SCENES += [
    ("rings, contact", "input/rings.inp", ["h=2", "spacing=h/2", "t_end=0.3"]),
    ("rings, contact", "input/rings.inp", ["spacing=h/2", "t_end=0.15"]),
]


def step_seconds(sgmp, deck, sets, threads):
    """Seconds of a step, and the number of particles."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sgmp, os.path.join(ROOT, deck), "--quiet", "--threads", str(threads), "--output", folder]
        subprocess.run(
            words + [word for text in sets for word in ("--set", text)], check=True, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL, env={**os.environ, "SGMP_THREADS": "exact"},
        )
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
    return summary["solve_seconds"]/summary["steps"], summary["particles"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("sgmp")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    asked = parser.parse_args()
    print(
        f"| scene | particles | step, 1 thread (us) | {asked.threads} threads | gain | beyond its part (us) "
        f"|\n|---|---|---|---|---|---|"
    )
    for name, deck, sets in SCENES:
        least = {1: float("inf"), asked.threads: float("inf")}
        for _ in range(asked.runs):
            for threads in least:
                seconds, particles = step_seconds(asked.sgmp, deck, sets, threads)
                least[threads] = min(least[threads], 1e6*seconds)
        one, many = least[1], least[asked.threads]
        print(
            f"| {name} | {particles} | {one:.0f} | {many:.0f} | {one / many:.2f} | {many - one / asked.threads:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
