#!/usr/bin/env python3
"""The ballistic limit of a deck: the impact velocity below which the projectile no longer passes, by bisection.

    python scripts/ballistic_limit.py input/gallery/ball_plate.inp --body ball --low 200 --high 800 --tolerance 10

The deck has a parameter for the impact velocity. A body has passed when at the end it is faster than --passing in the
direction in which it came; the run has to last until it is stopped or through. A body that is stuck in a plate that
nothing holds drifts on with it, so a hundredth of the impact velocity counts as stopped. The residual velocity jumps or
rises like a root at the limit, so halves are taken and no slopes. Runs are kept in --folder: a search that is repeated
or refined takes what is there. Needs scipy.
"""
import argparse
import pathlib
import sys

from scipy.optimize import bisect

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "python"))
import sgmp_view as sv  # noqa: E402


def residual(options, speed):
    """Velocity with which the body goes on in its first direction; not above 0 where it is stopped or thrown back."""
    run = sv.run(options.deck, options.folder / f"{speed:g}", threads=options.threads, **{options.parameter: speed})
    body = run.bodies[options.body]
    column = f"velocity_{options.direction}"
    forward = 1 if body.start[column] > 0 else -1
    value = forward * getattr(body, column)
    print(f"{speed:10.5g} {value:12.5g}   {run.verdict}", flush=True)
    return value


def beyond(options, speed):
    """Residual velocity over that of a body which counts as stopped."""
    if speed not in options.known:
        stopped = 0.01 * speed if options.passing is None else options.passing
        options.known[speed] = residual(options, speed) - stopped
    return options.known[speed]


def main():
    """Searches and prints the limit."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", type=pathlib.Path)
    parser.add_argument("--body", required=True, help="projectile")
    parser.add_argument("--parameter", default="speed", help="of the deck: impact velocity (default: speed)")
    parser.add_argument("--direction", choices="xyz", default="z", help="axis along which it flies (default: z)")
    parser.add_argument("--low", type=float, required=True, help="velocity at which it is stopped")
    parser.add_argument("--high", type=float, required=True, help="velocity at which it passes")
    parser.add_argument(
        "--passing", type=float, metavar="V",
        help="residual velocity above which it has passed (default: a hundredth of the impact velocity)",
    )
    parser.add_argument("--tolerance", type=float, required=True, help="of the limit")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--folder", type=pathlib.Path, help="of the runs (default: DECK.limit)")
    options = parser.parse_args()
    options.folder = options.folder or options.deck.with_suffix(".limit")
    options.known = {}
    print("     speed     residual   verdict")
    if beyond(options, options.low) > 0 or beyond(options, options.high) <= 0:
        sys.exit(f"--low {options.low:g} must be stopped and --high {options.high:g} must pass")
    limit = bisect(lambda speed: beyond(options, speed), options.low, options.high, xtol=options.tolerance)
    print(f"ballistic limit {limit:.5g}, to {options.tolerance:g}")


if __name__ == "__main__":
    main()
