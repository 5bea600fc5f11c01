"""Order of convergence and the value at vanishing cell size of a quantity, from runs with different cells.

    sgmp-view convergence h_0.8.out h_0.4.out h_0.2.out --quantity energy.internal
    sgmp-view convergence study/*/ --quantity bodies.projectile.velocity_z --exact 312

Quantities: a dotted name of summary.json, or FILE.NAME.COLUMN for the last row of a body in bodies.csv (bodies.bar.z) or of a
gauge in gauges.csv (gauges.foot.pressure), or history.COLUMN. The cell is h of summary.json. With three sizes and more the
order p solves q(h) = q0 + C h^p for the three finest (Richardson; any ratios), where they converge; q0 is printed with it.
"""

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from .compare import flat
from .files import SgmpFileError, folder_of, label, plot_style, read_history, read_summary, read_table, read_units


def last_of(folder, file, name, column):
    """The last value of a column of a body or a gauge."""
    table = read_table(folder / f"{file}.csv")
    key = "body" if file == "bodies" else "gauge"
    rows = np.ones(len(table["time"]), bool) if name is None else (
        table["name"] == name if "name" in table and not name.isdigit() else table[key] == float(name) if name.isdigit() else
        np.zeros(len(table["time"]), bool))
    if column not in table or not rows.any():
        raise SgmpFileError(f"{folder}: {file}.csv has no '{name}' with a column '{column}'")
    return float(table[column][rows][-1])


def quantity_of(folder, quantity):
    """Its value at the end of a run."""
    folder = folder_of(folder)
    file, _, rest = quantity.partition(".")
    if file in ("bodies", "gauges"):
        name, _, column = rest.rpartition(".")
        return last_of(folder, file, name, column)
    if file == "history":
        history = read_history(folder)
        if rest not in history:
            raise SgmpFileError(f"{folder}: history.csv has no column '{rest}'; there are: {', '.join(history)}")
        return float(history[rest][-1])
    values = flat(read_summary(folder))
    if not isinstance(values.get(quantity), (int, float)):
        numbers = ", ".join(name for name, value in values.items() if isinstance(value, (int, float)) and not name.startswith("phase"))
        raise SgmpFileError(f"{folder}: summary.json has no number '{quantity}'; there are: {numbers}")
    return float(values[quantity])


def richardson(sizes, values):
    """Order and limit of the three finest of a converging series, or None: q(h) = q0 + C h^p."""
    (fine, middle, coarse), (q1, q2, q3) = sizes[:3], values[:3]
    if q1 == q2 or (q3 - q2) / (q2 - q1) <= 0:
        return None

    def excess(p):
        return (q3 - q2) / (q2 - q1) - (coarse**p - middle**p) / (middle**p - fine**p)
    low, high = 1e-3, 20.0
    if excess(low) * excess(high) > 0:
        return None
    for _ in range(200):
        p = 0.5 * (low + high)
        low, high = (p, high) if excess(low) * excess(p) > 0 else (low, p)
    return p, q1 - (q2 - q1) * fine**p / (middle**p - fine**p)


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folders of runs that differ in the cell")
    parser.add_argument("--quantity", default="energy.internal", help="what to look at (default: energy.internal)")
    parser.add_argument("--exact", type=float, help="the exact value: errors and their order are shown")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="picture; default: convergence.png in the first folder")


def run(options):
    """Prints the series and its order, draws the figure and prints its name."""
    series = sorted((float(read_summary(folder_of(folder))["h"]), quantity_of(folder, options.quantity)) for folder in options.folders)
    sizes, values = zip(*series)
    if len(set(sizes)) < len(sizes) or len(sizes) < 2:
        raise SgmpFileError(f"{options.folders[0]}: convergence needs runs with different h; these have {', '.join(f'{h:g}' for h in sizes)}")
    limit = richardson(sizes, values) if len(sizes) > 2 else None
    print(f"{'h':>12} {options.quantity:>24}" + (f" {'error':>12} {'order':>6}" if options.exact is not None else ""))
    for k, (h, value) in enumerate(series):
        line = f"{h:12g} {value:24.10g}"
        if options.exact is not None:
            line += f" {value - options.exact:12.3e}"
            if k + 1 < len(series) and value != options.exact and values[k + 1] != options.exact:
                line += f" {math.log(abs((values[k + 1] - options.exact) / (value - options.exact))) / math.log(sizes[k + 1] / h):6.2f}"
        print(line)
    if limit:
        print(f"order {limit[0]:.2f}, value at h = 0: {limit[1]:.8g} (Richardson, three finest)")
    elif len(sizes) > 2:
        print("the three finest do not converge: no order")
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
