"""Distance of the surfaces of two shapes that are given by particles.

The surface of a cloud is where its filling, smoothed over twice the wider spacing of the two, is one half: flat
surfaces are then exactly where the outer faces of the particles are, whatever their spacing. Distances are from points
of each surface, where it cuts the lines of a lattice, to the nearest point of the other and its tangent plane.
"""

import itertools

import numpy as np

WIDTH = 2.0                                             # of the smoothing, in spacings
LATTICE = 3                                             # points of the lattice to a width
SAMPLE, PORTION = 3000, 2000000                         # points whose distance is taken; pairs at a time


class Shape:
    """Particles of a body: places along the axes of its space, sizes (length, area or volume), whether it is round
    about its first axis."""

    def __init__(self, points, sizes, is_round=False):
        self.spacing = float(np.median(sizes)) ** (1 / points.shape[1])
        self.points, self.sizes = points, sizes
        if is_round:                                    # the axis is no surface
            self.points, self.sizes = np.concatenate([points, points * [-1, 1]]), np.concatenate([sizes, sizes])
        self.is_round = is_round


def spline(x):
    """Quadratic B-spline of width 1."""
    x = np.abs(x)
    return np.where(x < 0.5, 0.75 - x**2, np.where(x < 1.5, 0.5 * (1.5 - x) ** 2, 0.0))


def filling(shape, width, low, step, counts):
    """Share of space that is filled, on a lattice."""
    values = np.zeros(int(np.prod(counts)))
    first = np.floor((shape.points - 1.5 * width - low) / step).astype(int) + 1
    strides = np.cumprod([1, *counts[:0:-1]])[::-1]
    reach = range(int(np.ceil(3 * width / step)))
    weights = [
        [spline((low[k] + (first[:, k] + i) * step - shape.points[:, k]) / width) / width for i in reach]
        for k in range(len(low))
    ]
    for offsets in itertools.product(reach, repeat=len(low)):
        weight = shape.sizes.copy()
        for k, i in enumerate(offsets):
            weight *= weights[k][i]
        values += np.bincount((first + offsets) @ strides, weight, len(values))
    return values.reshape(counts)


def surface(values, low, step):
    """Points where the filling is one half, and normals."""
    slopes = np.gradient(values, step) if values.ndim > 1 else [np.gradient(values, step)]
    places, normals = [], []
    for axis in range(values.ndim):
        a, b = np.moveaxis(values, axis, -1)[..., :-1] - 0.5, np.moveaxis(values, axis, -1)[..., 1:] - 0.5
        cut = np.nonzero(np.moveaxis((a < 0) != (b < 0), -1, axis))
        part = np.moveaxis(np.divide(a, a - b, where=a != b, out=np.zeros_like(a)), -1, axis)[cut]
        place = np.stack(cut, axis=1).astype(float)
        place[:, axis] += part
        after = tuple(index + (k == axis) for k, index in enumerate(cut))
        normals.append(np.stack([slope[cut] * (1 - part) + slope[after] * part for slope in slopes], axis=1))
        places.append(low + step * place)
    normals = np.concatenate(normals)
    return np.concatenate(places), normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


def distances(points, others, normals, step):
    """From each point to the surface that `others` lie on."""
    found = np.empty(len(points))
    portion = max(1, PORTION // len(others))
    for start in range(0, len(points), portion):
        part = points[start:start + portion]
        squares = (part**2).sum(1)[:, None] - 2 * part @ others.T + (others**2).sum(1)
        near = squares.argmin(axis=1)
        away = part - others[near]
        across = np.abs((away * normals[near]).sum(1))
        along = np.sqrt(np.maximum((away**2).sum(1) - across**2, 0))
        # between the points of the other it is flat
        found[start:start + portion] = np.hypot(across, np.maximum(along - step, 0))
    return found


def distance(first, second):
    """Root mean square and largest distance of two surfaces."""
    width = WIDTH * max(first.spacing, second.spacing)
    step = width / LATTICE
    both = np.concatenate([first.points, second.points])
    low = np.floor(both.min(axis=0) / step - 2 * LATTICE) * step
    counts = (np.ceil((both.max(axis=0) - low) / step) + 2 * LATTICE).astype(int)
    surfaces = [surface(filling(shape, width, low, step, counts), low, step) for shape in (first, second)]
    if first.is_round:
        surfaces = [(points[points[:, 0] >= 0], normals[points[:, 0] >= 0]) for points, normals in surfaces]
    found = [
        distances(a[:: max(1, len(a) // SAMPLE)], b, normals, step)
        for (a, _), (b, normals) in (surfaces, surfaces[::-1])
    ]
    squares = np.mean([np.mean(each**2) for each in found])
    return float(np.sqrt(squares)), float(max(each.max() for each in found))
