"""Several runs beside each other: a table of their summaries, and columns of their histories.

    sgmp-view compare mpm.out gimp.out sgmp.out
    sgmp-view compare *.out --column kinetic_energy --column energy_remainder

The table lists what differs in summary.json, first of all the verdict, energy drift and cost. Numbers whose error
`sgmp-view error` has estimated stand below with it, and as bars in the figure.
"""

from pathlib import Path

import matplotlib.pyplot as plt

from .files import (
    SgmpFileError, field_label, folder_of, label, plot_style, read_history, read_summary, read_units, run_name,
)

ROWS = (
    "exit_status", "verdict", "verdict_error", "method", "update", "dimension", "cfl", "h", "particles",
    "particles_lost", "steps", "time", "energy.kinetic", "energy.internal", "energy.total", "energy.drift",
    "energy.contact_dissipation", "solve_seconds", "ns_per_particle_step", "threads", "ranks", "checksum",
)


def flat(summary, prefix=""):
    """Nested dictionaries as one with dotted names."""
    values = {}
    for name, value in summary.items():
        if isinstance(value, dict):
            values.update(flat(value, f"{prefix}{name}."))
        else:
            values[prefix + name] = value
    return values


def text_of(value):
    """A number with six digits, or the word itself."""
    return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)


def table(names, summaries):
    """Lines of the table: rows whose values differ or that always matter."""
    lines = [["", *names]]
    for row in ROWS:
        values = [text_of(summary.get(row)) for summary in summaries]
        if len(set(values)) > 1 or row in ("verdict", "energy.drift", "solve_seconds"):
            lines.append([row, *values])
    widths = [max(len(line[k]) for line in lines) for k in range(len(names) + 1)]
    return [
        "  ".join(
            word.ljust(width) if k == 0 else word.rjust(width) for k, (word, width) in enumerate(zip(line, widths))
        )
        for line in lines
    ]


def estimates_of(summaries):
    """By quantity, the estimates of the runs, None of those that have none."""
    names = dict.fromkeys(name for summary in summaries for name in summary.get("error_estimate", {}))
    return {name: [summary.get("error_estimate", {}).get(name) for summary in summaries] for name in names}


def draw_bars(axis, names, estimates):
    """Values of a quantity with their errors."""
    shown = [(place, estimate) for place, estimate in enumerate(estimates) if estimate]
    axis.errorbar(
        [place for place, _ in shown], [estimate["value"] for _, estimate in shown],
        yerr=[estimate["half_width"] for _, estimate in shown], fmt="o", capsize=5,
    )
    axis.set_xticks(range(len(names)), names)
    axis.set_xlim(-0.5, len(names) - 0.5)
    axis.set_ylabel(label(shown[0][1]["quantity"], shown[0][1]["unit"]))


def shape_lines(options, names):
    """How far surfaces at the end are from those of the first run."""
    from .quantities import quantity_of                # here: it needs names of this file
    unit = read_units(folder_of(options.folders[0]))["length"]
    for body in options.shape:
        for name, folder in zip(names[1:], options.folders[1:]):
            mean, largest = (
                quantity_of(folder, f"shape.{body}.{how}", options.folders[0]) for how in ("mean", "largest")
            )
            yield (
                f"{name}: surface of {body} {mean:.3g} {unit} from that of {names[0]} (root mean square), at "
                f"most {largest:.3g} {unit}"
            )


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folders of sgmp")
    parser.add_argument(
        "--column", action="append", help="column of history.csv; may be repeated (default: total_energy)"
    )
    parser.add_argument(
        "--shape", action="append", default=[], metavar="BODY",
        help="distance of this body's surface at the end to that of the first run; may be repeated",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="picture; default: compare.png in the folder of the first"
    )


def run(options):
    """Prints the table, draws the figure and prints its name."""
    names = [run_name(folder) for folder in options.folders]
    summaries = [read_summary(folder) for folder in options.folders]
    estimates = estimates_of(summaries)
    print("\n".join(table(names, [flat(summary) for summary in summaries])))
    for run, estimate in (
        (run, estimate) for row in estimates.values() for run, estimate in zip(names, row) if estimate
    ):
        print(f"{run}: {estimate['line']}")
    for line in shape_lines(options, names):
        print(line)
    columns = options.column or ["total_energy"]
    units = read_units(folder_of(options.folders[0]))
    output = options.output or folder_of(options.folders[0]) / "compare.png"
    with plt.rc_context(plot_style()):
        panels = len(columns) + len(estimates)
        figure, axes = plt.subplots(1, panels, figsize=(6 * panels, 4), layout="constrained", squeeze=False)
        for axis, row in zip(axes[0][len(columns):], estimates.values()):
            draw_bars(axis, names, row)
        for axis, column in zip(axes[0], columns):
            for name, folder in zip(names, options.folders):
                history = read_history(folder)
                if column not in history:
                    raise SgmpFileError(
                        f"{folder}: history.csv has no column '{column}'; there are: {', '.join(history)}"
                    )
                axis.plot(history["time"], history[column], label=name)
            axis.set(xlabel=label("time", units["time"]), ylabel=field_label(column, units))
        axes[0][0].legend()
        figure.savefig(output)
        plt.close(figure)
    print(output)
