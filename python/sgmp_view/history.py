"""Energies, energy drift and momentum of one or several runs; accelerations of bodies, filtered.

    sgmp-view history taylor_bar.out
    sgmp-view history mpm.out sgmp.out -o comparison.png
    sgmp-view history cushion.out --cfc 180 --body head

Reads history.csv of each output folder. Energies: kinetic, internal, total. Drift: what the energy balance leaves
unexplained `energy_remainder` and the change of the total less external work and dissipation, relative to the largest
energy.

--acceleration draws the accelerations of bodies instead and prints their peaks, --cfc filters them first as SAE J211
and ISO 6487 have it: channel frequency class 60, 180, 600, 1000 or another; it needs units and rows of bodies.csv
(`history every=…`) ten times as dense as the class, in hertz. --contact does so with the forces of pairs in contact and
the friction in them, --walls with the reactions of walls, --sections with the forces through planes. --energies draws
and prints the energies of bodies and of materials.
"""

import itertools
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import MaxNLocator

from .acceleration import AXES, accelerations, contact_forces, peaks_of, section_forces, wall_forces
from .energies import draw_energies
from .files import SgmpFileError, folder_of, label, plot_style, read_history, read_table, read_units, run_name

ENERGIES = (
    ("kinetic_energy", "kinetic", "#1f77b4"),
    ("internal_energy", "internal", "#d62728"),
    ("total_energy", "total", "#222222"),
)
LINES = ("-", "--", ":", "-.")


def drift(history):
    """Change of total energy that neither work nor recorded dissipation explains, relative to the largest energy."""
    total = history["total_energy"]
    scale = max(np.max(np.abs(total)), np.max(np.abs(history["kinetic_energy"])), np.finfo(float).tiny)
    explained = sum(
        sign * history.get(name, 0.0)
        for name, sign in (("external_work", 1.0), ("contact_dissipation", -1.0), ("damping_dissipation", -1.0))
    )
    change = total - total[0] - (explained - np.atleast_1d(explained)[0])
    return change / scale, history.get("energy_remainder", np.zeros_like(total)) / scale


def plot_energies(axis, histories, names, units):
    for run, history in enumerate(histories):
        for key, text, colour in ENERGIES:
            axis.plot(history["time"], history[key], LINES[run % 4], color=colour, label=text if run == 0 else None)
    if len(histories) > 1:
        for run, name in enumerate(names):
            axis.plot([], [], LINES[run % 4], color="0.4", label=name)
    axis.set(xlabel=label("time", units["time"]), ylabel=label("energy", units["energy"]))
    if len(histories) == 1:
        axis.legend()
        return
    low, high = axis.get_ylim()
    axis.set_ylim(low, high + 0.1 * max(3, len(histories)) * (high - low))  # room for the legend
    axis.legend(ncol=2, loc="upper right", fontsize=8)


def figure(folders, axes=None):
    """The figure of one or several runs, or its three parts on axes that are given; the caller closes it."""
    histories = [read_history(folder) for folder in folders]
    for folder, history in zip(folders, histories):
        if len(history.get("time", ())) < 2:
            raise SgmpFileError(f"{folder}: history.csv has fewer than two rows")
        missing = [key for key, _, _ in ENERGIES if key not in history]
        if missing:
            raise SgmpFileError(f"{folder}: history.csv has no column {', '.join(missing)}")
    names = [run_name(folder) for folder in folders]
    units = read_units(folder_of(folders[0]))
    drawing, axes = (None, axes) if axes is not None else plt.subplots(1, 3, figsize=(13, 3.9), layout="constrained")
    plot_energies(axes[0], histories, names, units)
    for run, (history, name) in enumerate(zip(histories, names)):
        change, remainder = drift(history)
        prefix = f"{name}: " if len(histories) > 1 else ""
        axes[1].plot(history["time"], change, LINES[run % 4], color="#222222", label=prefix + "total less work")
        axes[1].plot(
            history["time"], remainder, LINES[run % 4], color="#2ca02c", label=prefix + "round-off (energy_remainder)"
        )
        for axis_name, colour in zip("xyz", ("#1f77b4", "#ff7f0e", "#9467bd")):
            momentum = history.get(f"momentum_{axis_name}")
            if momentum is not None and np.any(momentum != 0):
                axes[2].plot(history["time"], momentum, LINES[run % 4], color=colour, label=prefix + axis_name)
    axes[1].axhline(0, color="0.7", linewidth=0.8, zorder=0)
    axes[1].set(xlabel=label("time", units["time"]), ylabel="energy change / largest energy")
    axes[2].set(xlabel=label("time", units["time"]), ylabel=label("momentum", units["momentum"]))
    for axis, title in zip(axes, ("Energies", "Energy drift", "Momentum")):
        axis.set_title(title, loc="left", fontweight="bold")
        axis.xaxis.set_major_locator(MaxNLocator(5))
        axis.set_xlim(min(h["time"][0] for h in histories), max(h["time"][-1] for h in histories))
    low, high = axes[1].get_ylim()
    axes[1].set_ylim(low, high + 0.12 * (1 + len(folders)) * (high - low))  # room for the legend
    for axis in axes[1:]:
        if axis.get_legend_handles_labels()[0]:
            axis.legend(loc="upper right" if axis is axes[1] else "best", fontsize=8 if len(histories) > 1 else 9)
    return drawing


def energies_of_bodies(axis, folder):
    """Kinetic and internal energy of each body over time; where there are two bodies or more."""
    table, units = read_table(folder / "bodies.csv"), read_units(folder)
    for number, colour in zip(
        np.unique(table["body"]), itertools.cycle(plt.rcParams["axes.prop_cycle"].by_key()["color"])
    ):
        rows = table["body"] == number
        axis.plot(table["time"][rows], table["kinetic_energy"][rows], color=colour, label=str(table["name"][rows][0]))
        axis.plot(table["time"][rows], table["internal_energy"][rows], "--", color=colour)
    axis.set(xlabel=label("time", units["time"]), ylabel=label("energy", units["energy"]))
    axis.set_title("Bodies: kinetic, - - internal", loc="left", fontweight="bold")
    axis.xaxis.set_major_locator(MaxNLocator(5))
    axis.legend(fontsize=8)


def plot(folders, output):
    """Writes the figure of one or several runs."""
    with plt.rc_context(plot_style()):
        drawing = figure(folders)
        drawing.savefig(output)
        plt.close(drawing)


def draw_signals(folders, options, output):
    """Accelerations of bodies, or forces of contact, over time, and a line for each with its peaks; all as a dict."""
    result, read = {}, reader_of(options)
    force = read is not accelerations
    style, units = plot_style(), read_units(folder_of(folders[0]))
    filtered = f", CFC {options.cfc:g}" if options.cfc else ", not filtered"
    with plt.rc_context(style):
        drawing, axis = plt.subplots(figsize=(7.5, 4.2), layout="constrained")
        for folder in map(folder_of, folders):
            raw = dict((name, (time, values)) for name, time, values, _ in read(folder, None, options.body))
            for name, time, values, mass in read(folder, options.cfc, options.body):
                words = name if len(folders) == 1 else f"{run_name(folder)}: {name}"
                result[words] = peaks_of(time, values, mass)
                along = max(AXES, key=lambda k: abs(result[words]["along"][k]))
                line = axis.plot(time, values[:, AXES.index(along)], label=f"{words}, {along}")[0]
                if options.cfc:
                    faint = {"color": line.get_color(), "alpha": 0.25, "linewidth": 0.6, "zorder": 1}
                    axis.plot(*shown(raw[name], AXES.index(along)), **faint)
        what = "force (N" if force else "acceleration (m/s²"
        axis.set(xlabel=label("time", units["time"]), ylabel=f"{what}{filtered})")
        axis.legend()
        drawing.savefig(output)
        plt.close(drawing)
    for words, peak in result.items():
        print(f"{words}: {line_of(peak, units['time'], force)}{filtered}")
    kind = "walls" if options.walls else "sections" if options.sections else "pairs" if options.contact else "bodies"
    return {"cfc": options.cfc, kind: result}


def reader_of(options):
    """What gives the signals that are asked for."""
    if options.walls:
        return wall_forces
    if options.sections:
        return section_forces
    return contact_forces if options.contact else accelerations


def line_of(peak, time, force):
    """Peaks in words."""
    along = ", ".join(f"{k} {peak['along'][k]:.5g}" for k in AXES if peak["along"][k]) or "none"
    if force:
        impulse = ", ".join(f"{v:.5g}" for v in peak["impulse"])
        return f"peak {peak['peak']:.5g} N at {peak['time']:.5g} {time}; along {along}; impulse ({impulse}) N {time}"
    return (
        f"peak {peak['peak']:.5g} m/s² ({peak['peak_g']:.4g} g) at {peak['time']:.5g} {time}; along {along};"
        f" force {peak['force']:.5g} N"
    )


def shown(raw, k):
    """Times and one component of what was not filtered."""
    return raw[0], raw[1][:, k]


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folder(s) of sgmp")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="picture (.png, .pdf, .svg); default: history.png or acceleration.png in the first folder",
    )
    parser.add_argument(
        "--acceleration", action="store_true", help="accelerations of bodies and their peaks instead of energies"
    )
    parser.add_argument(
        "--cfc",
        type=float,
        metavar="CLASS",
        help="accelerations filtered by a channel frequency class: 60, 180, 600, 1000",
    )
    parser.add_argument(
        "--body", action="append", metavar="NAME", help="of this body, wall or section; may be repeated (default: all)"
    )
    parser.add_argument("--contact", action="store_true", help="forces of the pairs in contact, as accelerations are")
    parser.add_argument(
        "--walls", action="store_true", help="reactions of walls (`wall … reactions=yes`), as accelerations are"
    )
    parser.add_argument(
        "--sections", action="store_true", help="forces through planes (card `section`), as accelerations are"
    )
    parser.add_argument(
        "--energies", action="store_true", help="energies of bodies and materials over time, and a table"
    )
    parser.add_argument("--csv", type=Path, metavar="FILE", help="with --energies: write them, a column for each")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the peaks of accelerations")


def run(options):
    """Draws the figure and prints its name."""
    wants = (
        options.acceleration
        or options.cfc is not None
        or options.body
        or options.json
        or options.contact
        or options.walls
        or options.sections
    )
    if options.cfc is not None and not options.cfc > 0:
        raise ValueError(f"--cfc {options.cfc:g} is not positive")
    output = options.output or folder_of(options.folders[0]) / (
        "energies.png"
        if options.energies
        else "walls.png"
        if options.walls
        else "sections.png"
        if options.sections
        else "contact.png"
        if options.contact
        else "acceleration.png"
        if wants
        else "history.png"
    )
    if options.energies:
        draw_energies(options, output)
        print(output)
        return
    if wants:
        result = draw_signals(options.folders, options, output)
        if options.json:
            options.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    else:
        plot(options.folders, output)
    print(output)
