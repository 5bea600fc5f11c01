"""Connected pieces of a cloud: points at most a given distance apart belong together, directly or by others."""

import itertools

import numpy as np

MOST_PAIRS = 4000000  # looked at together: bounds the memory


def pieces_of(points, reach):
    """Number of the piece of every point, 0, 1, … in the order of their first points.

    Points are sorted into cubes of the side `reach`; of cubes that touch, all pairs of points are compared, unless
    they are of one piece already.
    """
    if len(points) == 0:
        return np.zeros(0, int)
    points = points[:, np.ptp(points, axis=0) > 0] if np.any(np.ptp(points, axis=0) > 0) else points[:, :1]
    cubes = np.floor((points - points.min(axis=0)) / reach).astype(np.int64) + 1
    strides = np.cumprod(np.concatenate([[1], (cubes.max(axis=0) + 2)[:-1]]))
    keys = cubes @ strides
    order = np.argsort(keys, kind="stable")
    sorted_points = points[order]
    cubes_there, first, count = np.unique(keys[order], return_index=True, return_counts=True)
    root = np.arange(len(points))
    for offset in half_stencil(points.shape[1]):
        beside = np.searchsorted(cubes_there, cubes_there + np.dot(offset, strides))
        beside = np.minimum(beside, len(cubes_there) - 1)
        own = np.flatnonzero(cubes_there[beside] == cubes_there + np.dot(offset, strides))
        beside = beside[own]
        low, high = np.minimum.reduceat(root, first), np.maximum.reduceat(root, first)
        undecided = np.minimum(low[own], low[beside]) != np.maximum(high[own], high[beside])
        for a, b in pairs_between(first, count, own[undecided], beside[undecided]):
            near = np.sum((sorted_points[a] - sorted_points[b]) ** 2, axis=1) <= reach**2
            root = joined(root, a[near], b[near])
    by_point = np.empty(len(points), int)
    by_point[order] = order[root]
    _, first_seen, number = np.unique(by_point, return_index=True, return_inverse=True)
    rank = np.empty(len(first_seen), int)
    rank[np.argsort(first_seen)] = np.arange(len(first_seen))
    return rank[number.ravel()]


def half_stencil(width):
    """Offsets of a cube itself and of half of its neighbours, those that share a face first: they join most."""
    offsets = [offset for offset in itertools.product((-1, 0, 1), repeat=width) if offset >= (0,) * width]
    return sorted(offsets, key=lambda offset: sum(map(abs, offset)))


def pairs_between(first, count, own, beside):
    """All pairs of points of pairs of cubes, some of the cubes at a time."""
    sizes = count[own] * count[beside]
    portion = np.cumsum(sizes) // MOST_PAIRS
    for k in np.unique(portion):
        i, j, size = own[portion == k], beside[portion == k], sizes[portion == k]
        pair = np.repeat(np.arange(len(i)), size)
        place = np.arange(len(pair)) - np.repeat(np.cumsum(size) - size, size)
        yield first[i][pair] + place // count[j][pair], first[j][pair] + place % count[j][pair]


def joined(root, a, b):
    """The lowest member of each piece, for all members, once a and b have been joined."""
    while True:
        of_a, of_b = root[a], root[b]
        apart = of_a != of_b
        if not apart.any():
            return root
        a, b = a[apart], b[apart]
        root = root.copy()
        np.minimum.at(root, np.maximum(of_a, of_b)[apart], np.minimum(of_a, of_b)[apart])
        while True:
            further = root[root]
            if np.array_equal(further, root):
                break
            root = further
