#!/usr/bin/env python3
"""A second implementation of the one-dimensional bar, by another route than the solver's, for its reference numbers.

It shares no line and no data structure with the solver: particles scatter straight to nodes with the effective
three-node stencil of SGMP (the solver goes through cell centres), and there are no walls: the bar is continued by its
mirror image to a ring of length 2 L, on which the odd velocity keeps the ends at rest (the solver folds). numpy only.

    python3 independent.py            writes errors.csv beside this file (ten minutes)
"""

import csv
import sys
from pathlib import Path

import numpy as np

LENGTH, V0, YOUNG, DENSITY = 1.0, 0.1, 50.0, 25.0


def positions(cells, layout):
    """Two particles per cell."""
    offset = 0.5 / np.sqrt(3) if layout == "gauss" else 0.25
    centres = (np.arange(cells) + 0.5) / cells
    return np.sort(np.concatenate([centres - offset / cells, centres + offset / cells]))


def weights(method, x, h, half):
    """Node left-most in the stencil, weights and gradients, (3, n) each."""
    if method == "mpm":
        first = np.floor(x / h)
        r = x / h - first
        zero = np.zeros_like(r)
        return first, np.array([1 - r, r, zero]), np.array([zero - 1, zero + 1, zero]) / h
    nearest = np.floor(x / h + 0.5)
    r = x / h - nearest
    if method == "sgmp":
        w0, w1 = 0.5 - r, 0.5 + r
        return nearest - 1, np.array([0.5 * w0, 0.5 + 0 * r, 0.5 * w1]), np.array([-w0, w0 - w1, w1]) / h
    if method == "bspline":  # third difference of the truncated square (de Boor)
        ramps = [np.clip(np.array([r + 1, r, r - 1]) + 1.5 - k, 0, None) for k in range(4)]
        factors = (1, -3, 3, -1)
        return (nearest - 1, 0.5 * sum(c * ramp**2 for c, ramp in zip(factors, ramps)),
                sum(c * ramp for c, ramp in zip(factors, ramps)) / h)
    # GIMP: the hat function averaged over the particle, as a difference of its second integral
    xi = np.array([r + 1, r, r - 1])
    l = half / h

    def first_integral(s):
        s = np.clip(s, -1, 1)
        return s - 0.5 * s * np.abs(s)

    def hat(s):
        return np.clip(1 - np.abs(s), 0, None)

    return (
        nearest - 1, (first_integral(xi + l) - first_integral(xi - l)) / (2 * l),
        (hat(xi + l) - hat(xi - l)) / (2 * l * h),
    )


class Ring:
    """The bar and its mirror image, MUSL."""

    def __init__(self, method, cells, layout="gauss", v0=V0, young=YOUNG, density=DENSITY, large=False):
        x = positions(cells, layout)
        self.method, self.h, self.nodes, self.young, self.density, self.large = (
            method, 1 / cells, 2 * cells, young, density, large,
        )
        self.start = np.concatenate([x, 2 * LENGTH - x[::-1]])
        self.x = self.start.copy()
        self.mass = np.full(self.x.size, 0.5 * density / cells)
        self.volume0 = self.mass / density
        self.stretch = np.ones_like(self.x)
        self.stress = np.zeros_like(self.x)
        self.v = v0 * np.sin(np.pi * self.x / LENGTH)
        self.v0, self.time, self.dt_before, self.internal = v0, 0.0, 0.0, 0.0
        self.omega = np.pi / LENGTH * np.sqrt(young / density)

    def body_force(self):
        """Eq. 98 with mu for nu, Poisson's ratio 0."""
        amplitude = self.v0 / self.omega * np.sin(self.omega * self.time)
        u = amplitude * np.sin(np.pi * self.start)
        f = 1 + amplitude * np.pi * np.cos(np.pi * self.start)
        return np.pi**2 * u / self.density * (0.5 * self.young * (1 + 1 / f**2) - self.young)

    def scatter(self, values):
        return sum(np.bincount(self.node[a], self.s[a] * values, self.nodes) for a in range(3))

    def gather(self, field, table):
        return sum(table[a] * field[self.node[a]] for a in range(3))

    def step(self, dt):
        kick = 0.5 * (self.dt_before + dt)
        half = 0.25 * self.h * (self.stretch if self.method == "cpgimp" else 1.0)
        first, self.s, self.g = weights(self.method, self.x, self.h, half)
        self.node = [np.mod(first + a, self.nodes).astype(int) for a in range(3)]
        m = self.scatter(self.mass)
        p = self.scatter(self.mass * self.v)
        force = -sum(
            np.bincount(self.node[a], self.g[a] * self.stress * self.stretch * self.volume0, self.nodes)
            for a in range(3)
        )
        if self.large:
            force += self.scatter(self.mass * self.body_force())
        active = m > 1e-12 * self.mass[0]
        inverse = np.where(active, 1 / np.where(active, m, 1), 0)
        a = force * inverse
        v = p * inverse + a * kick
        ap = self.gather(a, self.s)
        self.v += ap * kick
        self.x += self.gather(v, self.s) * dt
        remapped = self.scatter(self.mass * self.v) * inverse
        strain = self.gather(remapped, self.g) * dt
        old, volume = self.stress.copy(), self.stretch * self.volume0
        self.stretch = self.stretch * (1 + strain)
        if self.large:
            self.stress = 0.5 * self.young * (self.stretch - 1 / self.stretch)
        else:
            self.stress = self.stress + self.young * strain
        self.internal += 0.5 * np.sum((self.stress + old) * strain * volume)
        self.time += dt
        self.dt_before = dt
        return kick, np.sum(m * a * a), np.sum(self.mass * ap * ap), strain, volume

    def energy(self):
        """Of the bar alone: half of the ring's."""
        return 0.5 * (0.5 * np.sum(self.mass * self.v**2) + self.internal)

    def fastest(self):
        return np.max(np.sqrt(self.young * self.stretch / self.density) + np.abs(self.v))

    def error(self):
        exact = self.v0 / self.omega * np.sin(self.omega * self.time) * np.sin(np.pi * self.start)
        return np.sqrt(np.mean((self.x - self.start - exact)**2))


def run(method, cells, end, dt=1e-5, **options):
    ring = Ring(method, cells, **options)
    for _ in range(int(round(end / dt))):
        ring.step(dt)
    return ring.error()


def growth(method, cells, cfl, layout, end=0.02):
    """Largest total energy of the stability bar over its initial energy, at most 100."""
    ring = Ring(method, cells, layout=layout, v0=100.0, young=110e9, density=8900.0)
    start = largest = ring.energy()
    while ring.time < end and largest < 100 * start:
        ring.step(min(cfl * ring.h / ring.fastest(), end - ring.time))
        largest = max(largest, ring.energy())
    return largest / start


def main():
    rows = []
    for method in ("mpm", "sgmp"):
        rows += [("one step", method, cells, run(method, cells, 1e-5)) for cells in (8, 64, 512, 8192)]
    for method, sizes in (("sgmp", (8, 16, 32, 64, 128, 256, 512, 1024)), ("mpm", (8, 16, 32, 64, 128, 256, 512, 1024)),
                          ("cpgimp", (8, 64, 512)), ("bspline", (8, 64, 512))):
        rows += [("short time", method, cells, run(method, cells, 0.02)) for cells in sizes]
    for method, layout in (("sgmp", "gauss"), ("cpgimp", "uniform"), ("mpm", "gauss"), ("bspline", "gauss")):
        for cells in (8, 16, 32, 64, 128, 256):
            rows.append(("large deformation", method, cells, run(method, cells, 0.3536, large=True, layout=layout)))
            print(rows[-1], flush=True)
    for layout in ("uniform", "gauss"):
        for cells in (32, 50):
            for method, cfls in (
                ("mpm", (0.3, 0.8, 1.0)), ("gimp", (1.5, 1.8, 2.0)), ("sgmp", (2.0, 2.3, 2.4, 2.5, 2.6, 3.0)),
            ):
                for cfl in cfls:
                    rows.append((f"stability {layout} cfl {cfl}", method, cells, growth(method, cells, cfl, layout)))
                    print(rows[-1], flush=True)
    with open(Path(__file__).with_name("errors.csv"), "w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["case", "method", "cells", "value"])
        writer.writerows((case, method, cells, f"{value:.6e}") for case, method, cells, value in rows)


if __name__ == "__main__":
    sys.exit(main())
