"""Error of a quantity against what the runs cost: which method gets there for the least.

    sgmp-view work-precision study/*/ --quantity bodies.bar.z --exact 7.31
    sgmp-view work-precision sgmp_*.out gimp_*.out --quantity energy.internal --exact 12.5 --cost wall_seconds

Quantities are those of `sgmp-view convergence`; the cost is a number of summary.json. Runs of one method and update
make a line, from coarse to fine cells.
"""

from pathlib import Path

import matplotlib.pyplot as plt

from .files import folder_of, label, plot_style, read_summary
from .quantities import quantity_of

MARKERS = "osD^vP"


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "folders", nargs="+", type=Path, metavar="OUT_DIR",
        help="output folders of runs that differ in method, cell or step",
    )
    parser.add_argument("--quantity", required=True, help="what to look at")
    parser.add_argument("--exact", type=float, required=True, help="its exact value")
    parser.add_argument(
        "--cost", default="cpu_seconds", help="cpu_seconds (default), solve_seconds, wall_seconds, steps, …"
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="picture; default: work-precision.png in the first folder"
    )


def lines_of(options):
    """By method and update: cell, cost and error of each run, coarse ones first."""
    lines = {}
    for folder in options.folders:
        summary = read_summary(folder_of(folder))
        point = (
            float(summary["h"]), quantity_of(folder, options.cost),
            abs(quantity_of(folder, options.quantity) - options.exact),
        )
        lines.setdefault(f"{summary['method']} {summary['update']}", []).append(point)
    return {name: sorted(points, reverse=True) for name, points in lines.items()}


def run(options):
    """Prints the runs, draws the figure and prints its name."""
    lines = lines_of(options)
    print(f"{'method':>16} {'h':>12} {options.cost:>14} {'error':>12}")
    for name, points in lines.items():
        for cell, cost, error in points:
            print(f"{name:>16} {cell:12g} {cost:14.4g} {error:12.3e}")
    output = options.output or folder_of(options.folders[0]) / "work-precision.png"
    with plt.rc_context(plot_style()):
        figure, axis = plt.subplots(figsize=(6, 4.2), layout="constrained")
        for number, (name, points) in enumerate(lines.items()):
            axis.loglog(
                [cost for _, cost, _ in points], [error for _, _, error in points],
                MARKERS[number % len(MARKERS)] + "-", label=name,
            )
        words, seconds, _ = options.cost.partition("_seconds")
        axis.set(
            xlabel=label(
                {"cpu": "CPU time", "solve": "time of the solution", "wall": "wall time"}.get(words, words),
                "s" if seconds else "",
            ),
            ylabel=f"error of {options.quantity}",
        )
        axis.legend()
        figure.savefig(output)
        plt.close(figure)
    print(output)
