#!/usr/bin/env python3
"""Measure a Taylor bar against the experiment and draw it.

    build/release/sgmp input/taylor_bar.inp
    python3 scripts/taylor_bar_report.py taylor_bar.out

Reads particles_end.csv (else the last .vtu) and summary.json of the output folder. The bar stands on a wall at
coordinate 0 of its axis (z unless --axis says otherwise). Prints length L, foot diameter D and diameter W at 0.2 L0
with the error e (Eq. 99), the rule they were measured by, and what the run cost; draws taylor_bar.png (side view,
section, dimensions) and history.png. The lattice spacing comes from --spacing, else summary.json, else the particles
themselves. Needs numpy and matplotlib. Exit code 1 if an input is missing.
"""

import argparse
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "python"))
from sgmp_view.files import (PLASTIC_STRAIN, SgmpFileError, field_label, lookup, plot_style, read_dump,  # noqa: E402
                             read_particles_csv, read_summary, read_units)
from sgmp_view.history import plot as plot_history  # noqa: E402
from sgmp_view.picture import draw_particles, estimate_spacing, initial_points  # noqa: E402

EXPERIMENT = {"L": 16.2, "D": 13.5, "W": 10.1}  # mm; OFHC copper, 190 m/s (Kan et al. 2021, section 6.4)
MEANING = {"L": "length", "D": "diameter of the foot", "W": "diameter at 0.2 L0"}
MM_PER = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "um": 1.0e-3, "": 1.0}
RULE = """Rule: L = highest particle + half a spacing, from the wall. D = 2 (largest radius of the particles within one
cell of the foot + half a spacing). W = the same for the particles within half a cell of the height 0.2 L0. Radii are
taken about the bar's axis in all directions, not along x only, which would change the ranking of methods. e is the mean
of the three relative errors against the experiment (Eq. 99)."""


def upright(points, axis):
    """Coordinates as (across, across, height above the wall)."""
    order = {"x": (1, 2, 0), "y": (0, 2, 1), "z": (0, 1, 2)}[axis]
    turned = points[:, order].copy()
    if np.median(turned[:, 2]) < 0:  # the bar came from the other side
        turned[:, 2] *= -1
    return turned


def bar_axis(initial, spacing):
    """Centre line: where the bar began, or the symmetry plane at 0 if only a half or quarter is modelled."""
    centre = np.zeros(2)
    for k in range(2):
        if initial[:, k].min() < -spacing:
            centre[k] = 0.5 * (initial[:, k].min() + initial[:, k].max())
    return centre


def measure(points, centre, spacing, cell, length):
    """L, D, W by the rule above, all in mm."""
    radius = np.hypot(points[:, 0] - centre[0], points[:, 1] - centre[1])
    height = points[:, 2]

    def diameter(chosen, where):
        if not np.any(chosen):
            raise SgmpFileError(f"no particle {where}: is the bar's axis right (--axis), and the wall at 0?")
        return 2 * (radius[chosen].max() + 0.5 * spacing)

    return {"L": height.max() + 0.5 * spacing,
            "D": diameter(height <= cell, "within one cell of the wall"),
            "W": diameter(np.abs(height - 0.2 * length) <= 0.5 * cell, "near the height 0.2 L0")}


def print_table(found):
    print(f"{'':24}{'run':>9}{'experiment':>12}{'difference':>12}")
    errors = []
    for key, experiment in EXPERIMENT.items():
        errors.append(abs(found[key] - experiment) / experiment)
        print(
            f"{key}  {MEANING[key]:<21}{found[key]:9.2f}{experiment:9.1f} "
            f"mm{100 * (found[key] / experiment - 1):+10.1f} %"
        )
    error = sum(errors) / 3
    print(f"e  mean relative error{100 * error:32.2f} %\n\n{RULE}\n")
    return error


def print_cost(summary):
    words = [
        ("method", lookup(summary, "method.kind", "method")), ("update", lookup(summary, "method.update", "update")),
        ("CFL", lookup(summary, "time.cfl", "cfl")), ("particles", lookup(summary, "particles")),
        ("steps", lookup(summary, "steps")), ("particle steps", lookup(summary, "particle_steps")),
        ("ns per particle-step", lookup(summary, "ns_per_particle_step")),
        ("wall seconds", lookup(summary, "wall_seconds")),
        ("ranks x threads", f"{lookup(summary, 'ranks', default='?')} x {lookup(summary, 'threads', default='?')}"),
        ("exit status", lookup(summary, "exit_status")),
    ]
    for name, value in words:
        if isinstance(value, float):
            value = f"{value:.4g}"
        if not isinstance(value, dict):
            print(f"{name:<22}{'not in summary.json' if value is None else value}")
    print()


def draw(points, initial, values, spacing, centre, found, error, length, field, title, output):
    """Side view and section, with the measured dimensions and the experiment's."""
    red, black = "#c0182a", "0.1"
    with plt.rc_context(plot_style()):
        figure, axes = plt.subplots(1, 2, figsize=(11.5, 6.6), layout="constrained", sharey=True)
        for axis, cut in zip(axes, (False, True)):
            shown = draw_particles(axis, points, values, spacing, "y", cut, initial)
            axis.axhline(0, color="0.25", linewidth=2.2, zorder=1)
            axis.axhspan(-1.2, 0, color="0.85", zorder=0)
            axis.set(
                xlim=(centre[0] - 12.5, centre[0] + 12.5), ylim=(-1.2, max(length, found["L"]) + 1.2), xlabel="x (mm)"
            )
        axes[0].set_ylabel("height above the wall (mm)")
        axes[0].set_title("Side view", loc="left", fontweight="bold")
        axes[1].set_title("Section", loc="left", fontweight="bold")

        left = axes[0]
        for x, top, colour, text in ((centre[0] - 10.6, found["L"], black, f"L = {found['L']:.2f}"),
                                     (centre[0] + 10.6, EXPERIMENT["L"], red, f"L = {EXPERIMENT['L']:.1f}")):
            left.annotate("", (x, 0), (x, top), arrowprops=dict(arrowstyle="<->", color=colour, shrinkA=0, shrinkB=0))
            left.plot(
                [x, centre[0] + np.sign(x - centre[0]) * 1.2], [top, top], color=colour, linewidth=0.7, linestyle=":",
                zorder=5,
            )
            left.text(x + (-0.9 if x < centre[0] else 0.9), 0.5 * top, text, color=colour, ha="center", va="center",
                      fontsize=9, rotation=90)
        for key, height in (("D", 0.0), ("W", 0.2 * length)):
            for value, colour, side in ((found[key], black, -1), (EXPERIMENT[key], red, 1)):
                half = 0.5 * value
                x = centre[0] + side * half
                left.plot([x, x], [max(height - 0.55, 0.0), height + 0.55], color=colour, linewidth=2.0, zorder=6)
                left.text(
                    x + side * 0.35, height + (0.35 if key == "D" else 0.0),
                    f"{key} = {value:.2f}" if side < 0 else f"{key} = {value:.1f}", color=colour, fontsize=9, zorder=6,
                    va="bottom" if key == "D" else "center", ha="right" if side < 0 else "left",
                    bbox=dict(facecolor="white", edgecolor="none", alpha=0.75, pad=0.6),
                )
        left.plot([], [], color=black, linewidth=2, label="this run (mm)")
        left.plot([], [], color=red, linewidth=2, label="experiment (mm)")
        left.plot([], [], color="0.35", linewidth=1, linestyle=(0, (5, 3)), label="undeformed")
        left.legend(loc="upper left", fontsize=9)
        axes[1].text(
            0.98, 0.97, f"mean error e = {100 * error:.1f} %", transform=axes[1].transAxes, ha="right", va="top"
        )
        bar = figure.colorbar(shown, ax=axes, shrink=0.85, pad=0.015, aspect=32)
        bar.set_label(field)
        bar.outline.set_visible(False)
        figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
        figure.savefig(output)
        plt.close(figure)


def report(arguments):
    folder = arguments.folder
    summary = read_summary(folder)
    units = read_units(folder)
    particles = read_particles_csv(folder) if (folder / "particles_end.csv").exists() else read_dump(folder)
    if units["length"] not in MM_PER:
        raise SgmpFileError(f"{folder}: unknown unit of length '{units['length']}'")
    scale = MM_PER[units["length"]]
    notes = [] if units["length"] else ["the deck declares no units: lengths are taken as millimetres"]
    points = upright(particles.points, arguments.axis) * scale
    initial = initial_points(particles, folder)
    start = points if initial is None else upright(initial, arguments.axis) * scale
    spacing = arguments.spacing or lookup(
        summary, "spacing", "parameters.spacing", "deck.spacing", "bodies.bar.spacing"
    )
    if spacing is None:
        spacing = estimate_spacing(start) / scale
        notes.append(f"spacing estimated from the particles: {spacing:.4g}")
    spacing *= scale
    cell = arguments.cell or lookup(summary, "h", "cell", "parameters.h", "deck.h", "grid.cell")
    if cell is None:
        notes.append("cell taken as two spacings")
    cell = 2 * spacing if cell is None else cell * scale
    centre = bar_axis(start, spacing)
    found = measure(points, centre, spacing, cell, arguments.length)
    if points[:, 2].min() > cell:
        notes.append("the bar has left the wall: no particle within one cell of it")
    print(f"Taylor bar: {folder}   ({len(points)} particles, spacing {spacing:.4g} mm, cell {cell:.4g} mm)\n")
    error = print_table(found)
    print_cost(summary)
    for note in notes:
        print(f"note: {note}")
    name = particles.first_of(*PLASTIC_STRAIN, "pressure", "velocity")
    if name is None:
        raise SgmpFileError(f"{particles.path}: no field to colour by (add plastic_strain to the output card)")
    picture = (arguments.output or folder) / "taylor_bar.png"
    picture.parent.mkdir(parents=True, exist_ok=True)
    words = [
        str(lookup(summary, *keys, default="")) for keys in (("method.kind", "method"), ("method.update", "update"))
    ]
    title = "Taylor bar, OFHC copper" + "".join(f", {word.upper()}" for word in words if word and word[0] != "{")
    draw(
        points, None if initial is None else start, particles.column(name).astype(float), spacing, centre, found, error,
        arguments.length, field_label(name, units), title, picture,
    )
    print(f"picture: {picture.resolve()}")
    history = picture.parent / "history.png"
    plot_history([folder], history)
    print(f"picture: {history.resolve()}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="OUT_DIR", help="output folder of the run")
    parser.add_argument("--axis", choices="xyz", default="z", help="axis of the bar (default: z)")
    parser.add_argument("--spacing", type=float, help="lattice spacing, in the deck's unit of length")
    parser.add_argument(
        "--cell", type=float, help="cell side, in the deck's unit of length (default: summary.json, else 2 spacings)"
    )
    parser.add_argument(
        "--length", type=float, default=25.4, metavar="MM", help="initial length L0 in mm (default: 25.4)"
    )
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="folder for the pictures (default: OUT_DIR)")
    arguments = parser.parse_args()
    try:
        report(arguments)
    except (SgmpFileError, OSError, ValueError) as problem:
        sys.exit(f"taylor_bar_report: {problem}")


if __name__ == "__main__":
    main()
