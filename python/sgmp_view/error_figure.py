"""The figure of an error estimate: values over the cell with the interval of the deck's run, and error against CPU
time."""

import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from .files import label, plot_style
from .quantities import short_name

MARKS = {
    "deck": ("o", "the deck"),
    "cells": ("o", "other cells"),
    "step": ("v", "half the step"),
    "grid's place": ("s", "grid's place"),
    "method": ("D", "method"),
    "particles": ("^", "more particles"),
}


def figure_of(estimates):
    """A row for each quantity."""
    figure, axes = plt.subplots(
        len(estimates), 2, figsize=(10.5, 4.2 * len(estimates)), layout="constrained", squeeze=False
    )
    for (left, right), estimate in zip(axes, estimates):
        draw_values(left, estimate)
        draw_work(right, estimate)
        left.set_title(estimate["verdict"], fontsize=10, loc="left")
    return figure


def draw(estimates, path):
    """The figure as a file."""
    with plt.rc_context(plot_style()):
        figure = figure_of(estimates)
        figure.savefig(path)
        plt.close(figure)


def by_part(estimate):
    """Parts in the order of the legend, with their colours, marks and runs."""
    for number, (part, (mark, words)) in enumerate(MARKS.items()):
        runs = [run for run in estimate["runs"] if run["part"] == part]
        if runs:
            yield f"C{number}" if part != "deck" else "black", mark, words, runs


def draw_values(axis, estimate):
    """Values over the cell."""
    cell = next(run["cell"] for run in estimate["runs"] if run["part"] == "deck")
    axis.axhspan(
        estimate["value"] - estimate["half_width"], estimate["value"] + estimate["half_width"], color="0.90",
        label="interval of the deck's value",
    )
    axis.errorbar([cell], [estimate["value"]], yerr=[estimate["half_width"]], color="black", capsize=4, zorder=3)
    for number, (colour, mark, words, runs) in enumerate(by_part(estimate)):
        # Beside each other where they have the cell of the deck, or of its coarse stand-in.
        sides = [run["cell"] * (1 if isinstance(run["setting"], (int, float)) else 1 + 0.03 * number) for run in runs]
        axis.plot(sides, [run["value"] for run in runs], mark, color=colour, label=words, zorder=4)
    if estimate["limit"] is not None:
        axis.axhline(estimate["limit"], color="0.5", linestyle="--", label=f"h = 0, {estimate['cells']}")
    axis.set_xlim(left=0)
    axis.set(
        xlabel=label("cell", estimate["cell_unit"]), ylabel=label(short_name(estimate["quantity"]), estimate["unit"])
    )
    axis.legend(fontsize=8, frameon=True, framealpha=1)


def plain_decades(side):
    """Ticks of a logarithmic axis at 1, 2, 5 of each decade, as plain numbers."""
    side.set_major_locator(LogLocator(subs=(1, 2, 5)))
    side.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    side.set_minor_formatter(NullFormatter())


def draw_work(axis, estimate):
    """Expected error of each run against its CPU time, with the tolerance."""
    for colour, mark, words, runs in by_part(estimate):
        shown = [(run["cpu_seconds"], run["expected_error"]) for run in runs if run["expected_error"]]
        axis.plot(*zip(*shown) if shown else ([], []), mark, color=colour, label=words)
    axis.axhline(estimate["tolerance"], color="0.5", linestyle="--", label="tolerance")
    axis.set(xscale="log", xlabel=label("CPU time", "s"), ylabel=label("expected error", estimate["unit"]))
    plain_decades(axis.xaxis)
    if any(run["expected_error"] for run in estimate["runs"]) and estimate["tolerance"] > 0:
        axis.set_yscale("log")
        plain_decades(axis.yaxis)
    axis.legend(fontsize=8)
