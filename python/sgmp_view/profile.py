"""A field along an axis: means of layers, of one or several runs.

    sgmp-view profile tnt_slab.out --field pressure
    sgmp-view profile a.out b.out --field stress_zz --along z --near x=0 --near y=0 --within 1

Each point is the mean over the particles of one layer across --along (--layers of them, else one for each spacing),
weighted by their mass where the dump has it; --near and --within keep only the particles about a line.
"""

import csv
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from .files import SgmpFileError, field_label, folder_of, label, plot_style, read_dump, read_units, run_name
from .picture import estimate_spacing, field_of
from .slice_ import plane


def about_line(points, near, within, spacing):
    """Which particles are about a line; all where none is named."""
    chosen = np.ones(len(points), bool)
    for text in near:
        k, place = plane(text)
        chosen &= np.abs(points[:, k] - place) <= (within or spacing)
    return chosen


def layers(places, values, weights, count):
    """Centres and means of the layers that hold particles."""
    edges = np.linspace(places.min(), places.max(), count + 1)
    layer = np.clip(np.searchsorted(edges, places, side="right") - 1, 0, count - 1)
    weight = np.bincount(layer, weights, count)
    filled = weight > 0
    mean = np.bincount(layer, weights * values, count)[filled] / weight[filled]
    return (0.5 * (edges[1:] + edges[:-1]))[filled], mean


def profile(particles, options):
    """Places and means along the axis."""
    _, values = field_of(particles, options.field)
    k = "xyz".index(options.along)
    spacing = estimate_spacing(particles.points, particles.fields.get("volume"))
    chosen = about_line(particles.points, options.near, options.within, spacing)
    if not chosen.any():
        raise SgmpFileError(f"{particles.path}: no particle near {' '.join(options.near)}; widen with --within")
    places = particles.points[chosen, k]
    count = options.layers or max(1, int(round(np.ptp(places) / spacing)))
    weights = particles.fields.get("mass", np.ones(len(values)))[chosen]
    return layers(places, values[chosen], weights, count)


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "sources", nargs="+", type=Path, metavar="OUT_DIR|FILE",
        help="output folder(s), .vtu files, particles CSV or checkpoints",
    )
    parser.add_argument(
        "--field", help="field, component, vector or tensor (default: plastic strain, else pressure, else speed)"
    )
    parser.add_argument("--along", choices="xyz", default="x", help="axis of the profile (default: x)")
    parser.add_argument(
        "--near", action="append", default=[], metavar="AXIS=PLACE", help="only particles near; may be repeated"
    )
    parser.add_argument("--within", type=float, help="how near (default: one spacing)")
    parser.add_argument("--layers", type=int, help="number of layers (default: one for each spacing)")
    parser.add_argument(
        "--step", default="last", metavar="last|N", help="which dump of a folder, counted from 0 (default: last)"
    )
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write the points, too")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="picture (default: beside the data of the first)"
    )


def run(options):
    """Draws the figure and prints its name."""
    units = read_units(folder_of(options.sources[0]))
    rows = []
    with plt.rc_context(plot_style()):
        figure, axis = plt.subplots(figsize=(7.5, 4.2), layout="constrained")
        for source in options.sources:
            particles = read_dump(source, options.step)
            name, _ = field_of(particles, options.field)
            places, means = profile(particles, options)
            axis.plot(places, means, ".-", markersize=3, label=run_name(source))
            rows += [(run_name(source), float(place), float(mean)) for place, mean in zip(places, means)]
        axis.set(xlabel=label(options.along, units["length"]), ylabel=field_label(name, units))
        if len(options.sources) > 1:
            axis.legend()
        output = options.output or folder_of(options.sources[0]) / f"profile_{name}_{options.along}.png"
        figure.savefig(output)
        plt.close(figure)
    if options.csv:
        with open(options.csv, "w", newline="") as stream:
            csv.writer(stream).writerows([("run", options.along, name), *rows])
    print(output)
