"""The pieces into which bodies have come apart: how many, how heavy, how fast, how large.

    sgmp-view fragments perforation.out
    sgmp-view fragments perforation.out --body plate --json fragments.json -o fragments.png

A piece is matter of one body that has not failed and holds together: particles at most a cell apart (--reach) are
connected. Pieces with fewer particles than a cell are counted apart: the cells are too coarse for them. Failed matter
is no piece. In axisymmetric scenes a piece is a ring or lies on the axis; into how many parts a ring breaks round the
axis cannot be seen. Masses are those of the model. The picture shows pieces, each in a colour, and the distribution
of their masses.
"""

import argparse
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.ticker import MaxNLocator, NullFormatter

from .files import SgmpFileError, dumps_of, folder_of, label, plot_style, read_dump, read_units
from .impact import number
from .matter import matter_of
from .picture import draw_cloud, unfolded_points
from .pieces import pieces_of
from .wall import resolved

FEW = 5  # pieces of a body from which on their masses have a distribution
FAILED, SMALL = -1, 0  # colours of what is no piece; pieces are 1, 2, … by mass
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C564B", "#7F3C8D", "#117733", "#882255")


def broken(matter, bodies=None, reach=None):
    """The pieces of each body as a dict that goes into JSON, and the rank of the piece of each particle."""
    rank = np.full(len(matter.mass), FAILED)
    least, result, count = resolved(matter), {}, 0
    for name in bodies or matter.solids:
        own = matter.of(name)
        if not own.any():
            continue
        whole = np.flatnonzero(own & ~matter.failed)
        piece = pieces_of(matter.points[whole], reach or matter.cell * (1 + 1e-9))
        size = np.bincount(piece) if len(piece) else np.zeros(0, int)
        mass = np.bincount(piece, matter.mass[whole]) if len(piece) else np.zeros(0)
        order = [k for k in np.argsort(-mass, kind="stable") if size[k] >= least]
        ranks = np.full(len(size), SMALL)
        ranks[order] = count + 1 + np.arange(len(order))
        rank[whole] = ranks[piece]
        count += len(order)
        small = size < least
        result[name] = {
            "mass": float(matter.mass[own].sum()),
            "failed_mass": float(matter.mass[own & matter.failed].sum()),
            "pieces": [described(matter, whole[piece == k]) for k in order],
            "small_pieces": int(small.sum()),
            "small_mass": float(mass[small].sum()),
        }
    return {
        "time": matter.time,
        "reach": float(reach or matter.cell),
        "least_particles": least,
        "bodies": result,
        "notes": matter.notes,
    }, rank


def described(matter, own):
    """Mass, centre, velocity and size of a piece."""
    mass = matter.mass[own]
    velocity = mass @ matter.velocity[own] / mass.sum()
    centre = mass @ matter.points[own] / mass.sum()
    if matter.is_round:
        velocity[0], centre[0] = 0.0, 0.0
    extent = np.ptp(matter.points[own], axis=0)[matter.axes] + matter.spacing
    return {
        "mass": float(mass.sum()),
        "particles": len(own),
        "position": [float(v) for v in centre],
        "velocity": [float(v) for v in velocity],
        "speed": float(np.linalg.norm(velocity)),
        "kinetic_energy": float(0.5 * mass @ (matter.velocity[own] ** 2).sum(axis=1)),
        "extent": [float(v) for v in extent],
    }


def rows_of(result, most):
    """Rows of a table of the heaviest pieces: body, mass, particles, speed, velocity, extent."""
    rows = [(name, piece) for name, body in result["bodies"].items() for piece in body["pieces"]]
    rows.sort(key=lambda row: -row[1]["mass"])
    for name, piece in rows[:most]:
        yield (
            name,
            f"{piece['mass']:.4g}",
            str(piece["particles"]),
            f"{piece['speed']:.4g}",
            f"({', '.join(f'{v:.4g}' for v in piece['velocity'])})",
            " x ".join(f"{v:.3g}" for v in piece["extent"]),
        )


def body_line(body, units):
    """What became of one body, in words."""
    masses = [piece["mass"] for piece in body["pieces"]]
    words = [
        f"{len(masses)} piece{'s' * (len(masses) != 1)}"
        + (
            f" of {number(masses[-1], units['mass'])} to {number(masses[0], units['mass'])}"
            if len(masses) > 1
            else f" of {number(masses[0], units['mass'])}" if masses else ""
        )
    ]
    if body["small_pieces"]:
        words.append(f"{body['small_pieces']} smaller than a cell ({number(body['small_mass'], units['mass'])} in all)")
    if body["failed_mass"]:
        words.append(f"{number(body['failed_mass'], units['mass'])} failed")
    return ", ".join(words)


# ---------------------------------------------------------------- pictures


def colours_of(count):
    """Grey for failed matter, black for what is smaller than a cell, then a colour for each piece."""
    return ListedColormap(["#c8c8c8", "#222222", *(COLOURS[k % len(COLOURS)] for k in range(count))])


def figure_of_pieces(folder, matter, rank, view="y", shrink=1.0):
    """Every piece in a colour of its own."""
    points, values = matter.points, rank.astype(float)
    if matter.is_round:
        points, values = unfolded_points(points), np.concatenate([values, values])
    drawing = argparse.Namespace(
        axis=view,
        cut=False,
        limits=(FAILED - 0.5, rank.max(initial=0) + 0.5),
        cmap=colours_of(int(rank.max(initial=0))),
        most_pixels=1100,
        whole_numbers=True,
        shrink=shrink,
    )
    figure, axis = draw_cloud(
        points, values, None, read_units(folder), matter.spacing, None, drawing, "ryz" if matter.is_round else "xyz"
    )
    axis.set_title("Pieces, a colour each\n", loc="left", fontweight="bold")
    axis.text(0, 1.02, "grey: failed; black: smaller than a cell", transform=axis.transAxes, fontsize=8)
    return figure


def figure_of_masses(folder, result):
    """How many pieces are heavier than a mass, for each body in many pieces; None where none is."""
    bodies = {
        name: [piece["mass"] for piece in body["pieces"]]
        for name, body in result["bodies"].items()
        if len(body["pieces"]) >= FEW
    }
    if not bodies:
        return None
    figure, axis = plt.subplots(figsize=(5.4, 3.6), layout="constrained")
    for name, masses in bodies.items():
        axis.step(masses, np.arange(1, len(masses) + 1), where="pre", marker=".", label=name)
    axis.set(xlabel=label("mass", read_units(folder)["mass"]), ylabel="pieces that are as heavy")
    if max(masses[0] / masses[-1] for masses in bodies.values()) > 10:
        axis.set_xscale("log")
        axis.xaxis.set_minor_formatter(NullFormatter())
    if max(map(len, bodies.values())) > 30:
        axis.set_yscale("log")
    else:
        axis.yaxis.set_major_locator(MaxNLocator(integer=True))
    axis.set_title("Distribution of masses", loc="left", fontweight="bold")
    axis.legend()
    return figure


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("source", type=Path, metavar="OUT_DIR|FILE", help="output folder, or a dump in it")
    parser.add_argument(
        "--step", default="last", metavar="last|N", help="which dump of a folder, counted from 0 (default: last)"
    )
    parser.add_argument(
        "--body", action="append", metavar="NAME", help="this body alone; may be repeated (default: all solids)"
    )
    parser.add_argument(
        "--reach", type=float, metavar="LENGTH", help="how near connected particles are (default: a cell)"
    )
    parser.add_argument("--axis", choices="xyz", default="y", help="3D: direction of view of the picture (default: y)")
    parser.add_argument("--rows", type=int, default=10, metavar="N", help="how many pieces are printed (default: 10)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all pieces")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="write the picture; the distribution goes beside it as …_masses",
    )


def run(options):
    """Prints the pieces, writes what is asked for."""
    folder = folder_of(options.source)
    dumps = dumps_of(folder)
    matter = matter_of(folder, read_dump(options.source, options.step), dumps[0].read() if dumps else None)
    units = read_units(folder)
    result, rank = broken(matter, options.body, options.reach)
    if not result["bodies"]:
        raise SgmpFileError(f"{folder}: no solid body; --body names others, which are: {', '.join(matter.names)}")
    for name, body in result["bodies"].items():
        print(f"{name}: {body_line(body, units)}")
    print(
        f"{'body':12}{label('mass', units['mass']):>14}{'particles':>11}{label('speed', units['velocity']):>14}"
        "   velocity; extent"
    )
    for row in rows_of(result, options.rows):
        print(f"{row[0]:12}{row[1]:>14}{row[2]:>11}{row[3]:>14}   {row[4]}; {row[5]}")
    for note in result["notes"]:
        print(f"note: {note}")
    if options.json:
        options.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
        print(options.json)
    if options.output:
        with plt.rc_context(plot_style()):
            masses = figure_of_masses(folder, result)
            if masses is not None:
                masses.savefig(options.output.with_name(f"{options.output.stem}_masses{options.output.suffix}"))
                plt.close(masses)
            figure = figure_of_pieces(folder, matter, rank, options.axis)
            figure.savefig(options.output)
            plt.close(figure)
        print(options.output)
