"""What the gauges of a run read, over time.

    sgmp-view gauges tnt_slab.out --column pressure

Reads gauges.csv of each output folder; one line for each gauge of each run.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from .files import SgmpFileError, field_label, folder_of, label, plot_style, read_table, read_units, run_name

KEYS = ("step", "time", "gauge", "particle", "name")


def series(folder):
    """Name and rows of each gauge of a run, in the order of the deck."""
    table = read_table(folder_of(folder) / "gauges.csv")
    for number in np.unique(table["gauge"]):
        rows = table["gauge"] == number
        name = str(table["name"][rows][0]) if "name" in table else f"gauge {number:.0f}"
        yield name, {column: values[rows] for column, values in table.items()}


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folder(s) of sgmp")
    parser.add_argument("--column", default="pressure", help="column of gauges.csv (default: pressure)")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="picture; default: gauges_COLUMN.png in the first folder")


def run(options):
    """Draws the figure and prints its name."""
    units = read_units(folder_of(options.folders[0]))
    output = options.output or folder_of(options.folders[0]) / f"gauges_{options.column}.png"
    with plt.rc_context(plot_style()):
        figure, axis = plt.subplots(figsize=(7.5, 4.2), layout="constrained")
        for folder in options.folders:
            for name, rows in series(folder):
                if options.column not in rows or options.column in KEYS:
                    there = ", ".join(column for column in rows if column not in KEYS)
                    raise SgmpFileError(f"{folder}: gauges.csv has no column '{options.column}'; there are: {there}")
                text = name if len(options.folders) == 1 else f"{run_name(folder)}: {name}"
                axis.plot(rows["time"], rows[options.column], label=text)
        axis.set(xlabel=label("time", units["time"]), ylabel=field_label(options.column, units))
        axis.legend()
        figure.savefig(output)
        plt.close(figure)
    print(output)
