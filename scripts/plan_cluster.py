#!/usr/bin/env python3
"""What a large impact would cost on many ranks: imbalance, halo, re-balancing, checkpoints; a simulation, nothing is
run.

usage: plan_cluster.py [--particles 1e9] [--ranks 64,256,1000,…] [--csv FILE]

A steel ball of a fifth of the target's width goes through a block of cells, 8 particles each. The cells of the scene
are dealt to the ranks as slabs (what sgmp does), as columns (two axes) or as blocks (three axes), all cut so that the
parts weigh the same when they are cut, and cut again when the heaviest part exceeds the mean by the threshold. While
the ball advances it pushes the material of its channel into a rim, so cells fill up, empty and change hands. Rates are
those measured on two cores (doc/cluster.md); the network's and the file system's are assumptions, options all of them.
"""
import argparse
import csv
import sys

import numpy

AXES = {"slabs": 1, "columns": 2, "blocks": 3}


def scene(n, depth):
    """Particles per coarse cell (n^3) with the ball's nose at `depth` of the block's thickness; the block lies in the
    upper two thirds."""
    x, y, z = numpy.meshgrid(*[(numpy.arange(n, dtype=numpy.float32) + 0.5) / n] * 3, indexing="ij", sparse=True)
    radius = 0.1
    nose = 0.25 + depth * 0.75
    distance = numpy.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2)
    block = ((z > 0.25) & (z < 0.95)).astype(numpy.float32) * numpy.ones_like(distance)
    channel = (distance < radius) & (z < nose) & (z > 0.25)
    rim = (distance >= radius) & (distance < 1.42 * radius) & (z < nose) & (z > 0.25)
    load = numpy.where(channel, 0.0, block) + rim * block  # the rim holds the channel's material, twice as dense
    ball = distance ** 2 + (z - (nose - radius)) ** 2 < radius ** 2
    return numpy.where(ball, 1.0, load).astype(numpy.float32)


def sums(load):
    """Sums of the load over everything below each corner of the coarse cells."""
    table = numpy.zeros(tuple(s + 1 for s in load.shape))
    table[1:, 1:, 1:] = load
    for axis in range(3):
        numpy.cumsum(table, axis=axis, out=table)
    return table


def below(table, place):
    """Load below the points `place` (3, m), which may lie inside coarse cells: their load is spread evenly."""
    cell = numpy.minimum(place.astype(int), numpy.array(table.shape)[:, None] - 2)
    part = place - cell
    total = 0.0
    for corner in range(8):
        bits = [corner >> a & 1 for a in range(3)]
        weight = numpy.prod([part[a] if bits[a] else 1 - part[a] for a in range(3)], axis=0)
        total = total + weight * table[tuple(cell[a] + bits[a] for a in range(3))]
    return total


def weigh(table, lower, upper):
    """Load of boxes (3, m)."""
    weight = 0.0
    for corner in range(8):
        bits = [corner >> a & 1 for a in range(3)]
        place = numpy.array([upper[a] if bits[a] else lower[a] for a in range(3)])
        weight = weight + (-1) ** (3 - sum(bits)) * below(table, place)
    return weight


def cut(table, parts, axes, cells):
    """Boxes of nearly the same load: the longest of the allowed axes is cut in proportion, at a plane of cells, again
    and again."""
    lower = numpy.zeros((3, 1))
    upper = numpy.array(table.shape, dtype=float)[:, None] - 1
    count = numpy.array([parts])
    while count.max() > 1:
        size = upper - lower
        axis = numpy.array(axes)[numpy.argmax(size[axes], axis=0)]
        column = numpy.arange(count.size)
        first = count // 2
        target = weigh(table, lower, upper) * first / count
        low, high = lower[axis, column], upper[axis, column]
        ends = low.copy(), high.copy()
        for _ in range(20):
            middle = 0.5 * (low + high)
            trial = upper.copy()
            trial[axis, column] = middle
            less = weigh(table, lower, trial) < target
            low, high = numpy.where(less, middle, low), numpy.where(less, high, middle)
        place = numpy.clip(numpy.round(low * cells) / cells, *ends)
        place = numpy.where(count > 1, place, ends[1])
        left, right = upper.copy(), lower.copy()
        left[axis, column] = place
        right[axis, column] = place
        keep = count > 1
        lower = numpy.concatenate([lower, right[:, keep]], axis=1)
        upper = numpy.concatenate([left, upper[:, keep]], axis=1)
        count = numpy.concatenate([numpy.where(keep, first, count), (count - first)[keep]])
    return lower, upper


def surface(boxes, axes, cells, weight):
    """Largest halo of a box in grid points: its faces, less where it is partly empty."""
    size = (boxes[1] - boxes[0]) * cells
    volume = numpy.maximum(numpy.prod(size, axis=0), 1e-9)
    filled = numpy.clip(weight * cells ** 3 / volume, 0.0, 1.0)
    area = sum(2 * numpy.prod(numpy.delete(size, axis, axis=0), axis=0) for axis in axes)
    return (area * filled ** (2 / 3)).max()


def plan(options, kind, ranks):
    """One decomposition on so many ranks, over the ball's way through the block."""
    n = options.grid
    axes = list(range(3))[-AXES[kind]:]
    cells = (options.particles / 8 / scene(n, 0.0).sum()) ** (1 / 3)  # fine cells per coarse cell and axis
    if kind == "slabs" and ranks > n * cells:
        return None
    scale = options.particles / scene(n, 0.0).sum()
    boxes, cuts, rows = None, 0, []
    for depth in numpy.linspace(0.0, 1.0, options.stages):
        table = sums(scene(n, depth))
        if boxes is not None:
            weight = weigh(table, *boxes)
        if boxes is None or weight.max() > (1 + options.threshold) * weight.mean():
            boxes = cut(table, ranks, axes, cells)
            weight = weigh(table, *boxes)
            cuts += 1
        halo = surface(boxes, axes, cells, weight) * options.halo_bytes
        compute = weight.max() * scale * options.ns * 1e-9
        messages = options.messages * 2 * len(axes)
        talk = (
            halo / (options.network * 1e9)
            + messages * options.latency * 1e-6
            + 2 * options.latency * 1e-6 * numpy.log2(ranks)
        )
        rows.append((weight.max() / weight.mean(), halo, compute, talk))
    imbalance, halo, compute, talk = (numpy.array(column) for column in zip(*rows))
    ideal = options.particles / ranks * options.ns * 1e-9
    written = options.particles * options.checkpoint_bytes / 1e9
    return {
        "ranks": ranks,
        "decomposition": kind,
        "particles per rank": round(options.particles / ranks),
        "imbalance, mean": round(imbalance.mean(), 2),
        "worst": round(imbalance.max(), 2),
        "cuts": cuts,
        "halo (MB per step)": round(halo.mean() / 1e6, 2),
        "messages per step": options.messages * 2 * len(axes),
        "step (ms)": round(1e3 * (compute + talk).mean(), 2),
        "halo share (%)": round(100 * (talk / (compute + talk)).mean(), 1),
        "efficiency (%)": round(100 * (ideal / (compute + talk)).mean(), 1),
        "checkpoint (s)": round(written / min(options.file_system, ranks * options.rank_write), 1),
    }


def main():
    """All ranks and decompositions as a table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--particles", type=float, default=1e9)
    parser.add_argument("--ranks", default="64,256,1000,10000,100000")
    parser.add_argument("--ns", type=float, default=54.0, help="per particle and step on one core (make bench)")
    parser.add_argument("--halo-bytes", type=float, default=208.0, help="per grid point of a face and step")
    parser.add_argument("--messages", type=int, default=3, help="per neighbour and step")
    parser.add_argument("--checkpoint-bytes", type=float, default=133.0, help="per particle")
    parser.add_argument("--network", type=float, default=1.0, help="GB/s of one rank, all talking")
    parser.add_argument("--latency", type=float, default=2.0, help="microseconds of a message")
    parser.add_argument("--file-system", type=float, default=100.0, help="GB/s of all ranks together")
    parser.add_argument("--rank-write", type=float, default=0.5, help="GB/s of one rank")
    parser.add_argument("--threshold", type=float, default=0.1, help="cut anew beyond this imbalance")
    parser.add_argument("--grid", type=int, default=96, help="coarse cells per axis of the simulation")
    parser.add_argument("--stages", type=int, default=5, help="positions of the ball")
    parser.add_argument("--csv")
    options = parser.parse_args()
    rows = [row for ranks in options.ranks.split(",") for kind in AXES if (row := plan(options, kind, int(ranks)))]
    for file in [sys.stdout] + ([open(options.csv, "w", encoding="utf-8", newline="")] if options.csv else []):
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
