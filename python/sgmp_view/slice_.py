"""The particles next to a plane, coloured by a field.

    sgmp-view slice rod_plate.out --plane x=0 --field plastic_strain
    sgmp-view slice quarter.out --plane z=1.5 --mirror xy

Takes what lies within half the thickness (--thickness, else two spacings) of a plane x=…, y=… or z=…. --mirror
completes models of a half or a quarter: each letter adds the image behind the plane where that coordinate is zero.
"""

import dataclasses
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from .coarse import divided
from .files import SgmpFileError, folder_of, plot_style, read_dump
from .picture import draw, drawing_arguments, estimate_spacing, field_of


def mirrored(particles, letters):
    """The particles and their images behind the planes through the origin."""
    for letter in letters:
        k = "xyz".index(letter)
        sign = np.ones(3)
        sign[k] = -1.0
        image = {name: values.copy() for name, values in particles.fields.items()}
        for name, parts in particles.components.items():
            odd = [i for i, part in enumerate(parts) if part.count(letter) == 1]  # of vectors x, of tensors xy and xz
            image[name][:, odd] *= -1
        particles = dataclasses.replace(
            particles,
            points=np.vstack([particles.points, particles.points * sign]),
            fields={name: np.concatenate([values, image[name]]) for name, values in particles.fields.items()},
        )
    return particles


def cut(particles, k, place, thickness):
    """The particles within half a thickness of a plane, moved onto it."""
    near = np.abs(particles.points[:, k] - place) <= 0.5 * thickness
    if near.sum() < 2:
        low, high = particles.points[:, k].min(), particles.points[:, k].max()
        raise SgmpFileError(
            f"{particles.path}: fewer than two particles at {'xyz'[k]} = {place:g}; they go from {low:g} to {high:g}"
        )
    points = particles.points[near].copy()
    points[:, k] = place
    return dataclasses.replace(
        particles, points=points, fields={name: values[near] for name, values in particles.fields.items()}
    )


def plane(text):
    """Axis and place of a plane written x=1.5."""
    axis, _, place = text.partition("=")
    if axis not in ("x", "y", "z"):
        raise ValueError(f"--plane {text}: expected x=PLACE, y=PLACE or z=PLACE")
    return "xyz".index(axis), float(place or "nan")


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "source", type=Path, metavar="OUT_DIR|FILE", help="output folder, .vtu file, particles CSV or checkpoint"
    )
    parser.add_argument("--plane", required=True, metavar="AXIS=PLACE", help="x=…, y=… or z=…")
    parser.add_argument("--thickness", type=float, help="width of what is shown (default: two spacings)")
    parser.add_argument("--mirror", default="", metavar="LETTERS", help="complete a half or quarter model: x, y, xy, …")
    parser.add_argument(
        "--step", default="last", metavar="last|N", help="which dump of a folder, counted from 0 (default: last)"
    )
    drawing_arguments(parser)


def run(options):
    """Draws the picture and prints its name."""
    k, place = plane(options.plane)
    if set(options.mirror) - set("xyz"):
        raise ValueError(f"--mirror {options.mirror}: expected letters of xyz")
    particles = divided(folder_of(options.source), read_dump(options.source, options.step))
    name, _ = field_of(particles, options.field)
    thickness = options.thickness or 2 * estimate_spacing(particles.points, particles.fields.get("volume"))
    options.no_outline = True
    with plt.rc_context(plot_style()):
        figure = draw(cut(mirrored(particles, options.mirror), k, place, thickness), options.source, options)
        output = options.output or folder_of(options.source) / f"{particles.path.stem}_{'xyz'[k]}_{name}.png"
        figure.savefig(output)
        plt.close(figure)
    print(output)
