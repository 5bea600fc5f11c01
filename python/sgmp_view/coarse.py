"""Large particles of grids with unequal cells (doc/grids.md), drawn and measured as the lattice of small ones that they
stand for."""

from dataclasses import replace

import numpy as np

from .files import first_dump

PART = "part"                                           # field of what has been divided
SHARED = ("mass", "volume")                             # of which each part has its share
MOST = 64                                               # parts along an axis


def divided(folder, cloud, first=None):
    """The cloud with particles that are larger than the smallest of their body, along any axis at the start, as several
    beside each other; the cloud itself where the run has equal cells, no first dump, or no ids. `first`: the first
    dump, where it is known."""
    if PART in cloud.fields or "id" not in cloud.fields or not is_graded(folder):
        return cloud
    first = first or first_dump(folder)
    if first is None or "id" not in first.fields:
        return cloud
    widths, counts = sizes_of(first)
    place = np.full(int(max(first.fields["id"].max(), cloud.fields["id"].max())) + 1, -1)
    place[first.fields["id"].astype(int)] = np.arange(len(first.points))
    rows = place[cloud.fields["id"].astype(int)]
    widths, counts = widths[rows] * (rows >= 0)[:, None], np.where(rows[:, None] >= 0, counts[rows], 1)
    total = counts.prod(axis=1)
    source = np.repeat(np.arange(len(rows)), total)
    part = np.arange(len(source)) - np.repeat(np.cumsum(total) - total, total)
    away, rest = np.zeros((len(source), 3)), part.copy()
    for axis in range(3):
        n = counts[source, axis]
        away[:, axis] = ((rest % n + 0.5) / n - 0.5) * widths[source, axis] * (n > 1)
        rest //= n
    fields = {name: values[source] for name, values in cloud.fields.items()}
    if "initial_position" in fields:
        fields["initial_position"] = fields["initial_position"] + away
    for name in SHARED:
        if name in fields:
            fields[name] = fields[name] / total[source]
    return replace(cloud, points=cloud.points[source] + away, fields={**fields, PART: part})


def is_graded(folder):
    """Whether the deck in the log of a run asks for fine intervals."""
    log = folder / "run.log"
    if not log.exists():
        return False
    return any(line.split("!")[0].startswith("grid ") and " fine_" in line
               for line in log.read_text(errors="replace").replace("&\n", " ").splitlines())


def sizes_of(first):
    """Widths of particles along the axes, and how many of the smallest of their body they are, by the planes of the
    lattice on which a body begins."""
    widths, counts = np.zeros(first.points.shape), np.ones(first.points.shape, int)
    bodies = first.fields.get("body", np.ones(len(first.points)))
    for body in np.unique(bodies):
        own = np.flatnonzero(bodies == body)
        for axis in range(3):
            places = first.points[own, axis]
            tolerance = 1e-6 * max(np.ptp(places), 1e-300)
            planes = np.unique(np.round(places / tolerance)) * tolerance
            if len(planes) < 3 or len(planes) ** 3 > 1e3 * len(own):  # no lattice
                continue
            middle = 0.5 * (planes[1:] + planes[:-1])
            edges = np.concatenate(([2 * planes[0] - middle[0]], middle, [2 * planes[-1] - middle[-1]]))
            width = np.diff(edges)[np.searchsorted(middle, places)]
            widths[own, axis] = width
            counts[own, axis] = np.clip(np.rint(width / width.min()), 1, MOST)
    return widths, counts
