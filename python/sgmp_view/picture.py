"""Particles of one dump, coloured by a field.

    sgmp-view picture taylor_bar.out --field plastic_strain
    sgmp-view picture taylor_bar.out --step 3 --field pressure --axis x --cut
    sgmp-view picture taylor_bar.out/particles_0000120.vtu -o picture.png

Input: an output folder (particles.pvd, or particles_end.csv), a .vtu file, a particles CSV, or a checkpoint.
3D: side view along --axis as a shaded surface, hidden particles hidden; --cut removes the half that faces the viewer
and shows the section; of a half model (a slip wall in the plane of the picture) it shows the cut face. 2D: the plane;
with --revolve what a scene about an axis stands for in space, as a shaded surface, its front half taken away. 1D: field
over x. A dashed line is the undeformed outline, where it is known (first dump or initial positions). A field may be a
component (stress_xx), a vector (its size) or a tensor (von Mises); without --field: plastic strain, else pressure, else
speed.
"""

import argparse
import itertools
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, Normalize, TwoSlopeNorm

from .coarse import divided
from .files import (
    PLASTIC_STRAIN, SgmpFileError, field_label, first_dump, folder_of, label, plot_style, read_dump, read_units,
    run_name,
)
from .matter import planes_of, space_of

# horizontal, vertical, depth, towards the viewer
VIEWS = {"x": (1, 2, 0, 1.0), "y": (0, 2, 1, -1.0), "z": (0, 1, 2, 1.0)}
LIGHT = np.array([-0.45, 0.55, 0.70]) / np.linalg.norm([-0.45, 0.55, 0.70])
SEQUENTIAL = ListedColormap(plt.get_cmap("viridis")(np.linspace(0.1, 1.0, 256)))  # its dark end would hide the shading
# Grey in the middle: with white, as in RdBu, what is at rest could not be seen on the page.
DIVERGING = LinearSegmentedColormap.from_list("blue_grey_red", ["#08306b", "#3a7fbd", "#c4c4c4", "#d65f4a", "#67000d"])
LEAST_BALL = 0.006  # radius of a particle that flies alone, over the longer side of the picture
SEEN = 3  # balls of a circle at each end of its half that a cut shows
GOLDEN = 0.6180339887498949  # part of a turn between one circle and the next
OUTLINE = dict(colors="0.35", linewidths=1.0, linestyles=[(0, (5, 3))])


# ---------------------------------------------------------------- geometry

def dimension_of(points):
    """1, 2 or 3: coordinates that vary."""
    return max(1, int(np.count_nonzero(np.ptp(points, axis=0) > 0)))


def estimate_spacing(points, volume=None):
    """Lattice constant: from the particles' volume, else the median distance to the nearest neighbour."""
    dimension = dimension_of(points)
    if volume is not None and dimension == 3:
        return float(np.median(volume) ** (1 / 3))
    sample = points[np.linspace(0, len(points) - 1, min(len(points), 100)).astype(int)]
    nearest = []
    for point in sample:
        distance = np.sum((points - point) ** 2, axis=1)
        distance = distance[distance > 0]
        if len(distance):
            nearest.append(np.sqrt(distance.min()))
    if not nearest:
        raise SgmpFileError("one particle only: nothing to draw")
    return float(np.median(nearest))


def initial_points(particles, source):
    """Positions at the start, or None."""
    if "initial_position" in particles.fields:
        return particles.fields["initial_position"]
    dump = first_dump(source)
    return divided(folder_of(source), dump, dump).points if dump is not None and dump.path != particles.path else None


# ---------------------------------------------------------------- rasters

class Canvas:
    """Pixels over a rectangle of the view plane."""

    def __init__(self, lower, upper, spacing, pixels_per_spacing, most=2200):
        longest = max(upper - lower)
        self.size = max(spacing / pixels_per_spacing, longest / most)  # side of a pixel
        self.lower = lower
        self.shape = tuple(int(n) + 1 for n in np.ceil((upper - lower) / self.size))[::-1]
        self.extent = (lower[0], lower[0] + self.shape[1] * self.size, lower[1], lower[1] + self.shape[0] * self.size)

    def splat(self, plane, depth, values, radius, square):
        """Depth and value of the foremost particle in every pixel (NaN: none); particles as balls or squares."""
        order = np.argsort(depth, kind="stable")  # of several in one pixel the last one written, the foremost, stays
        column, row = (np.floor((plane[order] - self.lower) / self.size).astype(int)).T
        depth, values = depth[order], values[order]
        front = np.full(self.shape, -np.inf)
        colour = np.full(self.shape, np.nan)
        reach = max(1, int(round(radius / self.size)))
        for i in range(-reach, reach + 1):
            for j in range(-reach, reach + 1):
                bulge = 0.0
                if not square:
                    bulge = radius**2 - (i * self.size) ** 2 - (j * self.size) ** 2
                    if bulge < 0:
                        continue
                    bulge = np.sqrt(bulge)
                r, c = row + i, column + j
                inside = (r >= 0) & (r < self.shape[0]) & (c >= 0) & (c < self.shape[1])
                r, c, d, v = r[inside], c[inside], depth[inside] + bulge, values[inside]
                wins = d > front[r, c]
                front[r[wins], c[wins]] = d[wins]
                colour[r[wins], c[wins]] = v[wins]
        front[np.isinf(front)] = np.nan
        return front, colour


def close_gaps(filled, reach):
    """Mask with gaps narrower than 2 reach + 1 pixels filled, outer edges unchanged: dilation, then erosion."""
    closed = np.pad(filled, reach)
    for grow in (np.logical_or, np.logical_and):
        for axis in (0, 1):
            result = closed.copy()
            for shift in range(1, reach + 1):
                for step in (-shift, shift):
                    grow(result, np.roll(closed, step, axis), out=result)
            closed = result
    return closed[reach:-reach, reach:-reach] if reach else closed


def smooth(image, width, keep=None):
    """Gaussian blur that ignores empty (NaN) pixels; result in the pixels `keep` (default: those filled before)."""
    filled = np.isfinite(image)
    keep = filled if keep is None else keep
    width = max(width, 0.4)
    reach = int(np.ceil(3 * width))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    kernel /= kernel.sum()
    weight, total = filled.astype(float), np.where(filled, image, 0.0)
    for axis in (0, 1):
        pad = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
        n = image.shape[axis]
        weight, total = (sum(k * np.take(padded, range(i, i + n), axis=axis) for i, k in enumerate(kernel))
                         for padded in (np.pad(weight, pad), np.pad(total, pad)))
    return np.where(keep & (weight > 1e-9), total / np.maximum(weight, 1e-9), np.nan)


def shade(front, size):
    """Brightness of the surface of a depth map, lit from the upper left."""
    dy, dx = np.gradient(np.where(np.isfinite(front), front, np.nanmin(front)), size)
    light = (-dx * LIGHT[0] - dy * LIGHT[1] + LIGHT[2]) / np.sqrt(dx**2 + dy**2 + 1)
    return 0.62 + 0.52 * np.clip(light, 0, 1)


# ---------------------------------------------------------------- drawing

def choose_norm(values, limits=None):
    """Colour scale: symmetric about zero for fields of both signs, else from the 0.2nd to the 99.8th percentile."""
    values = values[np.isfinite(values)]
    if values.size == 0:
        raise SgmpFileError("the field is NaN everywhere")
    if limits:
        return Normalize(*limits), DIVERGING if limits[0] == -limits[1] else SEQUENTIAL
    low, high = np.percentile(values, [0.2, 99.8])
    if low < 0 < high and min(-low, high) > 0.05 * max(-low, high):
        top = max(-low, high)
        return TwoSlopeNorm(0.0, -top, top), DIVERGING
    if high <= low:
        low, high = low - 0.5, high + 0.5
    if 0 <= low < 0.1 * high:
        low = 0.0
    return Normalize(low, high), SEQUENTIAL


def draw_particles(
    axis, points, values, spacing, view="y", cut=False, outline=None, limits=None, cmap=None, most=2200,
    whole_numbers=False,
):
    """Draw a 2D or 3D cloud on `axis` in data units; returns a mappable for the colour bar. `whole_numbers`: names of
    things, which have no mean."""
    flat = dimension_of(points) == 2
    across, up, along, sign = VIEWS[normal_of(points, view)]
    plane, depth = points[:, [across, up]], sign * points[:, along]
    clouds = [plane] + ([outline[:, [across, up]]] if outline is not None else [])
    margin = 1.5 * spacing
    lower = np.min([cloud.min(axis=0) for cloud in clouds], axis=0) - margin
    upper = np.max([cloud.max(axis=0) for cloud in clouds], axis=0) + margin
    norm, standard = choose_norm(values, limits)
    mappable = plt.cm.ScalarMappable(norm, plt.get_cmap(cmap or standard))
    keep = np.ones(len(points), bool)
    if cut is not False and not flat:
        keep = depth <= (0.5 * (depth.min() + depth.max()) if cut is True else sign * cut)
    canvas = Canvas(lower, upper, spacing, 12 if len(points) < 200000 else 6, most)
    loose = loose_of(points[keep], spacing)
    image, front = surface_of(
        canvas, plane[keep][~loose], depth[keep][~loose], values[keep][~loose], mappable, spacing, flat, whole_numbers
    )
    draw_balls(
        canvas, plane[keep][loose], depth[keep][loose], values[keep][loose], mappable, spacing, flat, image, front
    )
    axis.imshow(image, origin="lower", extent=canvas.extent, interpolation="bilinear", zorder=2)
    if outline is not None:
        first = clouds[1][np.unique(np.floor(clouds[1] / canvas.size).astype(np.int64), axis=0, return_index=True)[1]]
        mask, _ = canvas.splat(first, np.zeros(len(first)), np.ones(len(first)), 0.5 * spacing, square=True)
        x, y = (np.linspace(*canvas.extent[k:k + 2], n, endpoint=False) + canvas.size / 2
                for k, n in ((0, canvas.shape[1]), (2, canvas.shape[0])))
        filled = close_gaps(np.isfinite(mask), int(round(0.5 * spacing / canvas.size))).astype(float)
        axis.contour(x, y, smooth(filled, 0.8), levels=[0.5], zorder=3, **OUTLINE)
    axis.set(xlim=canvas.extent[:2], ylim=canvas.extent[2:], aspect="equal")
    axis.grid(False)
    return mappable


def loose_of(points, spacing):
    """Which particles fly with few others: at most 5 in a cube (3 in a square) of three spacings, wherever that
    lies."""
    if len(points) == 0:
        return np.zeros(0, bool)
    wide = np.ptp(points, axis=0) > 0
    most = np.zeros(len(points), int)
    for shift in itertools.product((0.0, 0.5), repeat=int(wide.sum())):
        cells = np.floor(points[:, wide] / (3 * spacing) + shift).astype(np.int64)
        cells -= cells.min(axis=0)
        keys = cells @ np.cumprod(np.concatenate([[1], (cells.max(axis=0) + 1)[:-1]]))
        _, place, count = np.unique(keys, return_inverse=True, return_counts=True)
        most = np.maximum(most, count[place.ravel()])
    return most <= {1: 1, 2: 3}.get(int(wide.sum()), 5)


def in_sight(plane, depth, spacing):
    """Which particles may be seen: those less than three spacings behind the foremost ones in all columns around
    theirs."""
    column = np.floor((plane - plane.min(axis=0)) / (1.5 * spacing)).astype(int) + 1
    foremost = np.full(column.max(axis=0) + 2, -np.inf)
    np.maximum.at(foremost, tuple(column.T), depth)
    nearby = foremost.copy()
    for shift in itertools.product((-1, 0, 1), repeat=2):
        np.minimum(nearby, np.roll(foremost, shift, axis=(0, 1)), out=nearby)
    return depth >= nearby[tuple(column.T)] - 3 * spacing


def surface_of(canvas, plane, depth, values, mappable, spacing, flat, whole_numbers):
    """Picture of particles that lie close, as one surface, and its depth."""
    pixels = spacing / canvas.size
    if len(plane) == 0:
        return np.zeros((*canvas.shape, 4)), np.full(canvas.shape, -np.inf)
    if flat:
        front, colour = canvas.splat(plane, np.zeros(len(plane)), values, 0.55 * spacing, square=True)
        solid = close_gaps(np.isfinite(colour), int(0.6 * pixels))  # closer than about a cell of two particles
        if not whole_numbers:                          # round outlines in place of steps of particles
            solid = smooth(solid.astype(float), 0.35 * pixels) > 0.5
            colour = smooth(colour, 0.4 * pixels, solid)
        image = mappable.to_rgba(colour)
        image[~np.isfinite(colour), 3] = 0.0
        return image, np.where(np.isfinite(colour), 0.0, -np.inf)
    seen = in_sight(plane, depth, spacing)
    front, colour = canvas.splat(
        plane[seen], depth[seen], values[seen], (0.75 if whole_numbers else 0.6) * spacing, square=False
    )
    solid = np.isfinite(colour) if whole_numbers else close_gaps(np.isfinite(colour), int(round(0.8 * pixels)))
    # depth beyond the edge too, so that its slope is right at the edge
    everywhere = np.ones_like(solid)
    image = mappable.to_rgba(colour if whole_numbers else smooth(colour, 0.4 * pixels, solid))
    front = smooth(front, 1.1 * pixels, everywhere)
    image[..., :3] = np.clip(image[..., :3] * shade(front, canvas.size)[..., None], 0, 1)
    image[~solid, 3] = 0.0
    return image, np.where(solid, front, -np.inf)


def draw_balls(canvas, plane, depth, values, mappable, spacing, flat, image, front):
    """Particles that fly alone, as shaded balls in front of a surface (in the plane beside it), into its picture."""
    if len(plane) == 0:
        return
    radius = max(0.6 * spacing, max(2.5, LEAST_BALL * max(canvas.shape)) * canvas.size)
    nearest, which = canvas.splat(
        plane, np.zeros(len(plane)) if flat else depth, np.arange(len(plane)), radius, square=False
    )
    row, column = np.nonzero(np.isfinite(which) & (np.isinf(front) if flat else ~(nearest < front)))
    own = which[row, column].astype(int)
    colours = mappable.to_rgba(values[own])
    offset = (canvas.lower + (np.column_stack([column, row]) + 0.5) * canvas.size - plane[own]) / radius
    normal = np.column_stack([offset, np.sqrt(np.maximum(0, 1 - (offset**2).sum(axis=1)))])
    colours[:, :3] = np.clip(colours[:, :3] * (0.62 + 0.52 * np.clip(normal @ LIGHT, 0, 1))[:, None], 0, 1)
    image[row, column] = colours


def normal_of(points, axis):
    """Direction of view: of a plane cloud the coordinate that does not vary, else `axis`."""
    flat = [name for name, width in zip("xyz", np.ptp(points, axis=0)) if width == 0]
    return flat[-1] if flat else axis


def unfolded_points(points):
    """The whole section of a scene about an axis: both sides of it."""
    return None if points is None else np.vstack([points, points * (-1, 1, 1)])


def unfolded(particles, values, outline):
    """The same with a field and an outline."""
    return unfolded_points(particles.points), np.concatenate([values, values]), unfolded_points(outline)


def revolved(points, values, outline, spacing):
    """Half of the body of revolution, open towards -y: points on the circles of the rings, with the values of the
    rings, as far apart on a circle as rings are from each other there, each circle begun at another angle."""
    apart = distances_of_rings(points[:, [0, 2]], spacing)
    copies = np.maximum(np.ceil(np.pi * points[:, 0] / apart), 2).astype(int)
    shown = np.where(surrounded(points[:, [0, 2]], spacing), np.minimum(copies, 2 * SEEN), copies)
    ring = np.repeat(np.arange(len(points)), shown)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(shown) - shown, shown)
    place += (copies - shown)[ring] * (place >= SEEN)   # of what is within matter, the two ends
    begin = np.where(apart > spacing, np.modf(GOLDEN * np.arange(len(points)))[0], 0.5)
    angle = np.pi * (place + begin[ring]) / copies[ring]
    radius = points[ring, 0]
    solid = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), points[ring, 2]])
    return solid, values[ring], unfolded_points(outline)


def surrounded(plane, spacing):
    """Which points of a plane have others all around them: of those a cut alone shows something."""
    boxes = np.floor(plane / (2 * spacing)).astype(np.int64)
    boxes -= boxes.min(axis=0) - 1
    width = boxes[:, 1].max() + 2
    filled, box = np.unique(boxes @ (width, 1), return_inverse=True)
    around = np.logical_and.reduce([np.isin(filled + step, filled) for step in (width, -width, 1, -1)])
    return around[box.ravel()]


def distances_of_rings(plane, spacing):
    """About how far apart the points of a plane are around each of them; at least a spacing."""
    apart = np.zeros(len(plane))
    for side in spacing * 4.0 * 2.0 ** np.arange(4):
        alone = np.flatnonzero((apart == 0) | (apart > side / 4))  # fewer than four in the boxes before
        boxes = np.floor(plane / side).astype(np.int64)
        _, box, number = np.unique(boxes, axis=0, return_inverse=True, return_counts=True)
        apart[alone] = side / np.sqrt(number[box.ravel()[alone]])
    return np.maximum(spacing, apart)


def field_of(particles, name=None):
    """Name and values of the field to colour by."""
    name = name or particles.first_of(*PLASTIC_STRAIN, "pressure", "velocity")
    if name is None:
        raise SgmpFileError(f"{particles.path}: no field to colour by")
    return name, particles.column(name).astype(float)


def draw_line(points, values, name, units):
    """A figure of a field over x: scenes of one dimension."""
    figure, axis = plt.subplots(figsize=(7, 4), layout="constrained")
    order = np.argsort(points[:, 0])
    axis.plot(points[order, 0], values[order], ".-", markersize=3, linewidth=0.8)
    axis.set(xlabel=label("x", units["length"]), ylabel=field_label(name, units))
    return figure, axis


def draw_cloud(points, values, name, units, spacing, outline, options, axes="xyz", box=None):
    """A figure of a plane or solid cloud with its colour bar; `box`: corners of what it shows instead of all."""
    view = normal_of(points, options.axis)
    across, up = VIEWS[view][:2]
    shown = np.vstack([cloud for cloud in ((points, outline) if box is None else box) if cloud is not None])
    extent = np.ptp(shown[:, [across, up]], axis=0) + 3 * spacing
    size = getattr(options, "shrink", 1.0) * extent * min(7.5 / extent[0], 6.5 / extent[1])
    figure, axis = plt.subplots(figsize=(max(size[0], 1.8) + 1.9, max(size[1], 1.8) + 0.9), layout="constrained")
    if box is not None:                                # what lies beyond would only make pixels large
        low, high = shown.min(axis=0) - 3 * spacing, shown.max(axis=0) + 3 * spacing
        inside = np.all((points >= low) & (points <= high), axis=1)
        points, values = (points[inside], values[inside]) if inside.sum() > 1 else (points, values)
    mappable = draw_particles(
        axis, points, values, spacing, view, options.cut, outline, options.limits, options.cmap,
        getattr(options, "most_pixels", 2200), getattr(options, "whole_numbers", False),
    )
    if name is not None:
        bar = figure.colorbar(mappable, ax=axis, shrink=0.9, pad=0.03, aspect=28)
        bar.set_label(field_label(name, units))
        bar.outline.set_visible(False)
    if box is not None:
        axis.set(xlim=(shown[:, across].min() - spacing, shown[:, across].max() + spacing),
                 ylim=(shown[:, up].min() - spacing, shown[:, up].max() + spacing))
    axis.set(xlabel=label(axes[across], units["length"]), ylabel=label(axes[up], units["length"]))
    return figure, axis


def section_of(folder, points, initial, values, name, options, spacing):
    """Points, values and place of the section along the view: the middle of the scene at its start. A half model is
    turned so that its plane of symmetry faces the viewer, and nothing of it is taken away."""
    view = normal_of(points, options.axis)
    k, sign = VIEWS[view][2:]
    first = points if initial is None else initial
    plane = planes_of(folder, first, spacing).get(k)
    if plane is None:
        return points, values, 0.5 * float(first[:, k].min() + first[:, k].max())
    place, side = plane
    if side != sign:                                   # its face looks away
        points = points.copy()
        points[:, k] = 2 * place - points[:, k]
        if name.rpartition("_")[2].count("xyz"[k]) == 1 and name.startswith(("velocity_", "stress_")):
            values = -values
    return points, values, sign * np.inf


def draw(particles, source, options, box=None):
    """The figure of one dump; the caller closes it. `box`: two corners of what a series of figures shows."""
    if len(particles.points) < 2:
        raise SgmpFileError(f"{particles.path}: fewer than two particles")
    units = read_units(folder_of(source))
    particles = divided(folder_of(source), particles)
    name, values = field_of(particles, options.field)
    if dimension_of(particles.points) == 1:
        figure, axis = draw_line(particles.points, values, name, units)
    else:
        initial = initial_points(particles, source)
        points, outline = particles.points, None if options.no_outline else initial
        spacing = estimate_spacing(points if initial is None else initial, particles.fields.get("volume"))
        cut = argparse.Namespace(**vars(options))
        if options.cut and dimension_of(points) == 3:
            points, values, cut.cut = section_of(folder_of(source), points, initial, values, name, options, spacing)
        about_axis = space_of(folder_of(source), points) == "axisymmetric"
        revolve = about_axis and getattr(options, "revolve", False)
        if revolve:
            cut.axis = "y"
            points, values, outline = revolved(points, values, outline, spacing)
        elif about_axis:
            points, values, outline = unfolded(particles, values, outline)
        if about_axis:
            box = box and (np.array(box[1]) * (-1, 1, 1), np.array(box[1]) * (1, 1, 1), box[0], box[1])
        figure, axis = draw_cloud(
            points, values, name, units, spacing, outline, cut, "ryz" if about_axis and not revolve else "xyz", box
        )
    title = options.title or run_name(source).replace("_", " ")
    if particles.time is not None:
        title += f"   t = {particles.time:.4g} {units['time']}".rstrip()
    axis.set_title(title, loc="left", fontweight="bold")
    return figure


def drawing_arguments(parser):
    """How a cloud is drawn: what pictures and films share."""
    parser.add_argument("--field", help="field, component, vector or tensor to colour by")
    parser.add_argument(
        "--axis", choices="xyz", default="y", help="3D: direction of view (default: y, that is x to the right, z up)"
    )
    parser.add_argument("--cut", action="store_true", help="3D: the section; of a half model the cut face")
    parser.add_argument(
        "--revolve", action="store_true",
        help="a scene about an axis: the body of revolution, its front half taken away",
    )
    parser.add_argument("--limits", nargs=2, type=float, metavar=("LOW", "HIGH"), help="ends of the colour scale")
    parser.add_argument("--cmap", help="matplotlib colour map")
    parser.add_argument("--title", help="title (default: the folder's name)")
    parser.add_argument("--no-outline", action="store_true", help="without the undeformed outline")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="file (default: beside the data)")


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "source", type=Path, metavar="OUT_DIR|FILE", help="output folder, .vtu file, particles CSV or checkpoint"
    )
    parser.add_argument(
        "--step", default="last", metavar="last|N", help="which dump of a folder, counted from 0 (default: last)"
    )
    drawing_arguments(parser)


def run(options):
    """Draws the picture and prints its name."""
    particles = read_dump(options.source, options.step)
    with plt.rc_context(plot_style()):
        figure = draw(particles, options.source, options)
        name, _ = field_of(particles, options.field)
        output = options.output or folder_of(options.source) / f"{particles.path.stem}_{name}.png"
        figure.savefig(output)
        plt.close(figure)
    print(output)
