#!/usr/bin/env python3
"""Overpressure and arrival at the nearest station with 5 to 20 cells to the radius of the charge, in a scene that ends
soon after; minutes of one core.

usage: verification/blast/finer.py
"""
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]
from check import METHODS, RADIUS, SPHERE, STATIONS, VARIANTS, measure, reference  # noqa: E402
from common import Case, solve  # noqa: E402

NEAR, SIZES = STATIONS[:1], (5, 10, 15, 20)


def main():
    """A row per method and size."""
    exact = reference(40, STATIONS, 0.24)[0]
    print(f"one dimension: {exact[0]:.2f} MPa after {1e3*exact[1]:.1f} us")
    for name, variant in {**METHODS, "sgmp, volumes=plain": VARIANTS["sgmp"]}.items():
        for n in SIZES:
            run = solve([Case(SPHERE, keep_dumps=True, n=n, reach=8, t_end=0.085, every=0.0025, **variant)], workers=1)[
                0
            ]
            peak, arrival, _ = measure(run, RADIUS/n, NEAR)[0]
            print(
                f"{name}, {n} cells: {peak:.2f} MPa ({100 * (peak / exact[0] - 1):+.1f} %) after "
                f"{1e3 * arrival:.1f} us, {run.cpu_seconds:.0f} s",
                flush=True,
            )


if __name__ == "__main__":
    main()
