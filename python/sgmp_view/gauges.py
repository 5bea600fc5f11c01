"""What the gauges of a run read, over time: a figure, and for each gauge the largest, its time, the least, the impulse.

    sgmp-view gauges tnt_slab.out --column pressure
    sgmp-view gauges tnt_slab.out --json gauges.json

Reads gauges.csv of each output folder; one line for each gauge of each run. The impulse is the integral of the column
over time, of a pressure the momentum per area.
"""

import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from .files import (
    SgmpFileError,
    field_label,
    field_unit,
    folder_of,
    label,
    plot_style,
    read_table,
    read_units,
    run_name,
)

KEYS = ("step", "time", "gauge", "particle", "name")


def series(folder):
    """Name and rows of each gauge of a run, in the order of the deck."""
    table = read_table(folder_of(folder) / "gauges.csv")
    for number in np.unique(table["gauge"]):
        rows = table["gauge"] == number
        name = str(table["name"][rows][0]) if "name" in table else f"gauge {number:.0f}"
        yield name, {column: values[rows] for column, values in table.items()}


def summary_of(time, values):
    """Largest and least with their times, integral over time."""
    high, low = int(np.argmax(values)), int(np.argmin(values))
    return {
        "largest": float(values[high]),
        "time_of_largest": float(time[high]),
        "least": float(values[low]),
        "time_of_least": float(time[low]),
        "impulse": float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(time))),
    }


def table_of(results, column, units):
    """Lines of a table of gauges."""
    unit = field_unit(column, units)
    heads = (
        label("largest", unit),
        label("at", units["time"]),
        label("least", unit),
        label("impulse", f"{unit} {units['time']}".strip()),
    )
    width = max([5, *map(len, results)])
    wide = [max(20, len(head) + 2) for head in heads]
    yield f"{'gauge':{width}}" + "".join(f"{head:>{size}}" for head, size in zip(heads, wide))
    for name, found in results.items():
        numbers = (found["largest"], found["time_of_largest"], found["least"], found["impulse"])
        yield f"{name:{width}}" + "".join(f"{number:>{size}.5g}" for number, size in zip(numbers, wide))


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folder(s) of sgmp")
    parser.add_argument("--column", default="pressure", help="column of gauges.csv (default: pressure)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the table")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="picture; default: gauges_COLUMN.png in the first folder"
    )


def run(options):
    """Draws the figure, prints the table and its name."""
    results = {}
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
                results[text] = summary_of(rows["time"], rows[options.column])
        axis.set(xlabel=label("time", units["time"]), ylabel=field_label(options.column, units))
        if not results:
            raise SgmpFileError(
                f"{options.folders[0]}: gauges.csv has no rows: the run took no step that one was due at"
            )
        axis.legend()
        figure.savefig(output)
        plt.close(figure)
    print("\n".join(table_of(results, options.column, units)))
    if options.json:
        options.json.write_text(
            json.dumps({"column": options.column, "gauges": results}, indent=1) + "\n", encoding="utf-8"
        )
    print(output)
