"""Order of convergence and the value at vanishing cell size of a quantity, from runs with different cells.

    sgmp-view convergence h_0.8.out h_0.4.out h_0.2.out --quantity energy.internal
    sgmp-view convergence study/*/ --quantity bodies.projectile.velocity_z --exact 312

For runs that are there; `sgmp-view error` makes them and looks at step, place of the grid and method, too. Quantities:
a dotted name of summary.json, or FILE.NAME.COLUMN for the last row of a body in bodies.csv (bodies.bar.z) or of a gauge
in gauges.csv (gauges.foot.pressure), or history.COLUMN, or extent.BODY.x_max. The cell is h of summary.json. With three
sizes and more the order p solves q(h) = q0 + C h^p for the three finest (Richardson; any ratios), where they converge;
the finest value is printed with its grid convergence index (Roache 1994).
"""

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from .error_estimate import rounded
from .files import SgmpFileError, folder_of, label, plot_style, read_summary, read_units
from .grid_convergence import convergence_of
from .quantities import quantity_of


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folders of runs that differ in the cell"
    )
    parser.add_argument("--quantity", default="energy.internal", help="what to look at (default: energy.internal)")
    parser.add_argument("--exact", type=float, help="the exact value: errors and their order are shown")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="picture; default: convergence.png in the first folder"
    )


def run(options):
    """Prints the series and its order, draws the figure and prints its name."""
    series = sorted(
        (float(read_summary(folder_of(folder))["h"]), quantity_of(folder, options.quantity))
        for folder in options.folders
    )
    sizes, values = zip(*series)
    if len(set(sizes)) < len(sizes) or len(sizes) < 2:
        raise SgmpFileError(
            f"{options.folders[0]}: convergence needs runs with different h; these have "
            f"{', '.join(f'{h:g}' for h in sizes)}"
        )
    found = convergence_of(series, sizes[0])
    limit = None if found.limit is None else (found.order, found.limit)
    print(f"{'h':>12} {options.quantity:>24}" + (f" {'error':>12} {'order':>6}" if options.exact is not None else ""))
    for k, (h, value) in enumerate(series):
        line = f"{h:12g} {value:24.10g}"
        if options.exact is not None:
            line += f" {value - options.exact:12.3e}"
            if k + 1 < len(series) and value != options.exact and values[k + 1] != options.exact:
                ratio = abs((values[k + 1] - options.exact) / (value - options.exact))
                line += f" {math.log(ratio) / math.log(sizes[k + 1] / h):6.2f}"
        print(line)
    print(
        f"{found.words}; {options.quantity} = {' ± '.join(rounded(values[0], found.half_width))} at h = "
        f"{sizes[0]:g} (grid convergence index)"
    )
    draw(sizes, values, limit, options)


def draw(sizes, values, limit, options):
    """The figure: the quantity over h, or its error where the exact value is known."""
    units = read_units(folder_of(options.folders[0]))
    output = options.output or folder_of(options.folders[0]) / "convergence.png"
    with plt.rc_context(plot_style()):
        figure, axis = plt.subplots(figsize=(6, 4.2), layout="constrained")
        if options.exact is not None:
            axis.loglog(sizes, np.abs(np.array(values) - options.exact), "o-")
            axis.set_ylabel(f"error of {options.quantity}")
        else:
            axis.plot(sizes, values, "o-")
            if limit:
                axis.axhline(limit[1], color="0.5", linestyle="--", label=f"h = 0, order {limit[0]:.2f}")
                axis.legend()
            axis.set_xlim(left=0)
            axis.set_ylabel(options.quantity)
        axis.set_xlabel(label("h", units["length"]))
        figure.savefig(output)
        plt.close(figure)
    print(output)
