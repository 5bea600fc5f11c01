#!/usr/bin/env python3
"""Does `sgmp-view error` tell the truth? Its intervals on five decks beside references that it does not know.

    build/venv/bin/python verification/errors/check.py [--budget 10m] [--only rings] [--publish]

Runs are kept in build/verification/errors and gone on with. --publish writes doc/error-estimates.md and its figure.
References: references.py.
"""

import argparse
import json
import os
import subprocess
import sys
import textwrap
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE.parent), str(ROOT / "python")]
import matplotlib.pyplot as plt  # noqa: E402
from common import BUILD, SOLVER  # noqa: E402
from sgmp_view.error_estimate import rounded, shortly  # noqa: E402
from sgmp_view.files import plot_style, read_summary  # noqa: E402

REFERENCES = json.loads((HERE / "references.json").read_text())
DECKS = {  # deck, values of its parameters
    "taylor": ("input/taylor_bar_axisymmetric.inp", ("cfl=0.8",)),
    "ball": ("input/gallery/ball_plate.inp", ()),
    "blast": ("verification/errors/blast.inp", ()),
    "rings": ("input/rings.inp", ()),
    "beam": ("verification/surfaces/beam.inp", ("omega=0.100247", "periods=1.125")),
}
WORDS = {
    "taylor": ("Taylor bar", "an independent code, refined"),
    "ball": ("Ball through a plate", "this program, no measured one was found: mean of gimp and bspline, h = 0.1 mm"),
    "blast": ("Blast on a wall", "shells in one dimension, a second implementation"),
    "rings": ("Rings that bounce", "finite elements"),
    "beam": ("Oblique beam", "finite elements"),
}
# times the true error, in half of the numbers at most; share that hold the reference
WIDE, HELD = 10.0, 0.9


def study(name, options):
    """The estimates of a deck, and what they took: command, wall minutes of this call, CPU minutes of all runs."""
    deck, settings = DECKS[name]
    folder = BUILD / "errors" / name
    words = [
        "error", deck, *(word for setting in settings for word in ("--set", setting)), "--budget", options.budget,
        "--threads", "1", *(word for quantity in REFERENCES[name] for word in ("--quantity", quantity)),
    ]
    begun = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-m", "sgmp_view", *words, "--sgmp", str(options.program), "--output", str(folder)],
        check=False, cwd=ROOT, env={**options.environment, "PYTHONPATH": str(ROOT / "python")}, capture_output=True,
        text=True,
    )
    if done.returncode != 0:
        sys.exit(done.stdout + done.stderr)
    print(done.stdout, flush=True)
    cpu = sum(float(read_summary(path.parent)["cpu_seconds"]) for path in folder.glob("*/summary.json"))
    return (
        json.loads((folder / "error.json").read_text()), "sgmp-view " + " ".join(words),
        (time.monotonic() - begun) / 60, cpu / 60,
    )


def judged(name, estimates):
    """Rows: estimate, reference, its band, whether the interval holds it, the width over the true error."""
    for estimate in estimates:
        reference, band = REFERENCES[name][estimate["quantity"]]
        error, width = abs(estimate["value"] - reference), estimate["half_width"]
        yield estimate, reference, band, error <= width + band, width / max(error, band, 1e-300)


def line_of(name, row):
    """A line of the table of the document."""
    estimate, reference, band, held, ratio = row
    value, width = rounded(estimate["value"], estimate["half_width"])
    parts = ", ".join(f"{part} {shortly(size)}" for part, size in estimate["parts"].items() if size is not None)
    return (
        f"| {WORDS[name][0]} | `{estimate['quantity']}` | {value} ± {width} {estimate['unit']} | "
        f"{rounded(reference, band)[0]} ± {shortly(band)} | "
        f"{'yes' if held else '**no**'} | {ratio:.1f} | {parts} |"
    )


def figure(rows, path):
    """Errors over half-widths."""
    with plt.rc_context(plot_style()):
        drawn, axis = plt.subplots(figsize=(8, 0.34 * len(rows) + 1.2), layout="constrained")
        for place, (name, (estimate, reference, band, held, _)) in enumerate(rows):
            width = estimate["half_width"]
            axis.barh(place, 2, left=-1, color="0.88", height=0.7)
            axis.errorbar(
                [(reference - estimate["value"]) / width], [place], xerr=[band / width], fmt="o",
                color="C0" if held else "C1", capsize=3,
            )
        axis.set_yticks(range(len(rows)), [f"{WORDS[name][0]}: {row[0]['quantity']}" for name, row in rows], fontsize=8)
        axis.invert_yaxis()
        axis.axvline(0, color="0.4", linewidth=0.8)
        axis.set_xlabel("(reference less value) over half-width; grey: the interval")
        axis.grid(axis="y", visible=False)
        drawn.savefig(path)
        plt.close(drawn)


def wrapped(text, indent=""):
    """Lines of at most 120 letters."""
    return textwrap.wrap(text, 120, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)


def as_typed(command, cpu):
    """A command over as many lines as it needs, with what it takes."""
    lines = textwrap.wrap(
        command, 110, initial_indent="    ", subsequent_indent="        ", break_long_words=False,
        break_on_hyphens=False,
    )
    return [*(f"{line} \\" for line in lines[:-1]), lines[-1], f"    # {cpu:.1f} minutes"]


def document(rows, told, held, wide, budget):
    """The page with table, commands and figure."""
    lines = [
        "# How good the error estimates are",
        "",
        *wrapped(
            f"`sgmp-view error` ([how](user-guide.md#how-wrong-is-my-number)) on five decks, with the default "
            f"`method sgmp`: {held} of {len(rows)} "
            f"intervals hold the reference, {wide} of {len(rows)} are wider than ten times the true error."
        ),
        "",
        "![Reference less value over the half-width of the interval, for each number](images/error_estimates.png)",
        "",
        "| deck | number | value with its error | reference | held | width over error | parts of the half-width |",
        "|---|---|---|---|---|---|---|",
        *(line_of(name, row) for name, row in rows),
        "",
        *wrapped(
            "Width over error: half-width over the distance from the reference, or over what the reference is good "
            "to where that is more. "
            "What the references are:"
        ),
        "",
    ]
    lines += [f"* {WORDS[name][0]}: {WORDS[name][1]}." for name in told]
    lines += ["", "Commands, with the CPU time of all runs (one thread each):", ""]
    lines += [line for command, cpu in told.values() for line in as_typed(command, cpu)]
    lines += [
        "",
        *wrapped(
            f"All of it: `build/venv/bin/python verification/errors/check.py --budget {budget} --publish`; "
            f"references: `verification/errors/references.py`."
        ),
    ]
    return "\n".join(lines) + "\n"


def main():
    """Runs the studies, prints the table, says whether the rates are kept."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--budget", default="10m", help="wall time of each study")
    parser.add_argument("--only", choices=DECKS, help="one deck")
    parser.add_argument("--program", type=Path, default=SOLVER, help="another build of sgmp")
    parser.add_argument("--publish", action="store_true", help="write doc/error-estimates.md")
    options = parser.parse_args()

    options.environment = dict(os.environ)
    rows, told = [], {}
    for name in [options.only] if options.only else DECKS:
        estimates, command, minutes, cpu = study(name, options)
        told[name] = command, cpu
        print(f"{WORDS[name][0]}: {minutes:.1f} minutes, {cpu:.1f} of CPU time")
        rows += [(name, row) for row in judged(name, estimates)]
    held, wide = sum(row[3] for _, row in rows), sum(row[4] > WIDE for _, row in rows)
    print("\n".join(line_of(name, row) for name, row in rows))
    print(f"{held} of {len(rows)} intervals hold the reference, {wide} are wider than {WIDE:g} times the error")
    if options.publish:
        figure(rows, ROOT / "doc/images/error_estimates.png")
        (ROOT / "doc/error-estimates.md").write_text(document(rows, told, held, wide, options.budget))
    return 0 if held >= HELD * len(rows) and 2 * wide <= len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
