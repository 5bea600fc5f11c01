#!/usr/bin/env python3
"""Shapes of Taylor bars by finite elements: a second, Lagrangian implementation, without particles and without a grid.

    build/venv/bin/python verification/taylor_metals/reference/lagrange.py           writes shapes.csv beside it (some
    minutes)

Quadrilaterals of revolution with one point of integration (Flanagan and Belytschko, Int. J. Num. Meth. Engng 17 (1981),
679-706: uniform strain, stiffness against hourglasses), Jaumann's rate, Johnson and Cook's or Zerilli and Armstrong's
law by radial return (rate of plastic strain of the step, temperature of the step before), Mie and Grueneisen's equation
on the Hugoniot, von Neumann and Richtmyer's viscosity with the linear term. Constants are read from input/materials.
Units mm, g, ms.
"""

import csv
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "scripts/dev"))
from material_library import constants  # noqa: E402

SCALE = {"density": 1e-6, "young": 1e-6, "yield": 1e-6, "hardening_modulus": 1e-6, "reference_rate": 1e-3,
         "thermal_stress": 1e-6, "thermal_hardening": 1e-6}  # SI to mm, g, ms
BARS = (
    ("copper", 3.81, 25.4, 190), ("iron", 3.81, 25.4, 221), ("iron", 3.81, 25.4, 279), ("steel_4340", 3.81, 25.4, 208),
    ("steel_4340", 3.81, 25.4, 343), ("copper_zerilli", 3.81, 25.4, 190), ("iron_zerilli", 3.81, 25.4, 221),
)
T_END, ROOM, TAYLOR_QUINNEY, HOURGLASS = 0.09, 293.0, 0.9, 0.05


class Metal:
    """The law and the equation of state of a file of the library."""

    thermal_stress = thermal_hardening = hardening_modulus = 0.0
    hardening_exponent = 1.0

    def __init__(self, name):
        cards = constants(str(HERE.parents[2] / "input/materials" / f"{name}.inp"))
        for key, value in cards["material"].items():
            if isinstance(value, float):
                setattr(self, key, value * SCALE.get(key, 1.0))
        self.c0, self.s, self.gamma = (cards["eos"][key] for key in ("c0", "s", "gamma0"))
        self.thermal = cards["material"]["words"][1] == "zerilli_armstrong"
        self.shear = self.young / (2 * (1 + self.poisson))

    def flow(self, plastic, rate, temperature):
        if self.thermal:
            activated = np.exp(
                (-self.thermal_softening + self.thermal_rate * np.log(np.maximum(rate / self.reference_rate, 1)))
                * temperature
            )
            return (self.__dict__["yield"] + self.hardening_modulus * plastic**self.hardening_exponent
                    + (self.thermal_stress + self.thermal_hardening * np.sqrt(plastic)) * activated)
        warm = np.clip((temperature - ROOM) / (self.melt_temperature - ROOM), 0, 1)
        return (
            (self.__dict__["yield"] + self.hardening_modulus * plastic**self.hardening_exponent)
            * (1 + self.rate_coefficient * np.log(np.maximum(rate / self.reference_rate, 1)))
            * (1 - warm**self.thermal_exponent)
        )

    def pressure(self, v, energy):
        eta = 1 - v
        bulk = self.density * self.c0**2
        squeezed = bulk * eta / (1 - self.s * eta)**2 * (1 - 0.5 * self.gamma * eta)
        return np.where(eta > 0, squeezed, bulk * (1 / v - 1)) + self.gamma * energy


class Bar:
    """A cylinder of elements; its foot is on the wall z = 0."""

    def __init__(self, metal, radius, length, cells, speed):
        self.metal = metal
        rows = round(length / radius * cells)
        r, z = np.meshgrid(np.linspace(0, radius, cells + 1), np.linspace(0, length, rows + 1))
        self.r, self.z = r.ravel(), z.ravel()
        first = (np.arange(rows)[:, None] * (cells + 1) + np.arange(cells)).ravel()
        self.corners = np.stack([first, first + 1, first + cells + 2, first + cells + 1])
        self.columns, self.rows = cells, rows
        inner, outer = self.r[self.corners[0]], self.r[self.corners[1]]
        height = length / rows
        # integrals of r^2 and of r over the width
        part = {0: outer**3 / 3 - inner**3 / 3, 1: 0.5 * (outer**2 - inner**2)}
        # of r times the shape function of the outer corners
        weight = (part[0] - inner * part[1]) / (outer - inner)
        self.mass = np.zeros_like(self.r)
        for corner, share in zip(self.corners, (part[1] - weight, weight, weight, part[1] - weight)):
            np.add.at(self.mass, corner, metal.density * np.pi * height * share)
        count = self.corners.shape[1]
        self.vr, self.vz = np.zeros_like(self.r), np.full_like(self.z, -speed)
        self.stress = np.zeros((4, count))                                       # deviator: rr, zz, tt, rz
        self.volume, self.energy, self.plastic = np.ones(count), np.zeros(count), np.zeros(count)
        self.temperature, self.glass, self.p = np.full(count, ROOM), np.zeros((2, count)), np.zeros(count)

    def geometry(self):
        r, z = self.r[self.corners], self.z[self.corners]
        area = 0.5 * ((r[2] - r[0]) * (z[3] - z[1]) + (r[1] - r[3]) * (z[2] - z[0]))
        by_r = 0.5 * np.stack([z[1] - z[3], z[2] - z[0], z[3] - z[1], z[0] - z[2]]) / area
        by_z = 0.5 * np.stack([r[3] - r[1], r[0] - r[2], r[1] - r[3], r[2] - r[0]]) / area
        sign = np.array([1.0, -1.0, 1.0, -1.0])[:, None]
        gamma = sign - np.sum(sign * r, 0) * by_r - np.sum(sign * z, 0) * by_z
        return r.mean(0), area, by_r, by_z, gamma

    def step(self, dt):
        metal = self.metal
        middle, area, by_r, by_z, gamma = self.geometry()
        vr, vz = self.vr[self.corners], self.vz[self.corners]
        rate = np.stack(
            [np.sum(by_r * vr, 0), np.sum(by_z * vz, 0), vr.mean(0) / middle, 0.5 * np.sum(by_z * vr + by_r * vz, 0)]
        )
        spin = 0.5 * np.sum(by_z * vr - by_r * vz, 0)
        growth = rate[0] + rate[1] + rate[2]
        old = self.stress
        turned = np.stack([2 * spin * old[3], -2 * spin * old[3], 0 * spin, spin * (old[1] - old[0])])
        trial = old + dt * turned + 2 * metal.shear * dt * (rate - np.stack([growth / 3] * 3 + [0 * growth]))
        mises = np.sqrt(1.5 * (trial[0]**2 + trial[1]**2 + trial[2]**2 + 2 * trial[3]**2))
        more = np.zeros_like(mises)
        yields = np.flatnonzero(mises > metal.flow(self.plastic, 0, self.temperature))
        stress, plastic, temperature = mises[yields], self.plastic[yields], self.temperature[yields]
        low, high = np.zeros_like(stress), stress / (3 * metal.shear)
        for _ in range(30):
            guess = 0.5 * (low + high)
            above = stress - 3 * metal.shear * guess > metal.flow(plastic + guess, guess / dt, temperature)
            low, high = np.where(above, guess, low), np.where(above, high, guess)
        more[yields] = low
        final = mises - 3 * metal.shear * more
        self.stress = trial * (final / np.maximum(mises, 1e-30))
        self.plastic = self.plastic + more
        self.temperature = self.temperature + TAYLOR_QUINNEY * final * more / (metal.density * metal.specific_heat)
        before = self.volume
        self.volume = before * (1 + 0.5 * dt * growth) / (1 - 0.5 * dt * growth)
        size = np.sqrt(area)
        closing = np.minimum(growth, 0) * size
        density = metal.density / self.volume
        q = density * (1.5**2 * closing**2 - 0.06 * metal.c0 * closing)
        mean = 0.5 * (old + self.stress)
        work = (
            0.5
            * (before + self.volume)
            * dt
            * (mean[0] * rate[0] + mean[1] * rate[1] + mean[2] * rate[2] + 2 * mean[3] * rate[3])
        )
        change = self.volume - before
        energy = self.energy + work - change * (0.5 * self.p + q)
        base = metal.pressure(self.volume, 0)
        self.p = (base + metal.gamma * energy) / (1 + 0.5 * metal.gamma * change)
        self.energy = energy - 0.5 * change * self.p
        stiff = HOURGLASS * 2 * metal.shear * np.sum(by_r**2 + by_z**2, 0) * dt
        self.glass = self.glass + stiff * np.stack([np.sum(gamma * vr, 0), np.sum(gamma * vz, 0)])
        total = self.stress - np.stack([self.p + q] * 3 + [0 * q])
        ring = 2 * np.pi * middle * area
        fr, fz = np.zeros_like(self.r), np.zeros_like(self.z)
        for i, corner in enumerate(self.corners):
            np.add.at(
                fr, corner,
                -ring * (total[0] * by_r[i] + total[3] * by_z[i] + 0.25 * total[2] / middle + self.glass[0] * gamma[i]),
            )
            np.add.at(fz, corner, -ring * (total[1] * by_z[i] + total[3] * by_r[i] + self.glass[1] * gamma[i]))
        self.vr += dt * fr / self.mass
        self.vz += dt * fz / self.mass
        self.vr[self.r == 0] = 0
        touching = self.z + dt * self.vz < 0
        self.vz[touching] = -self.z[touching] / dt
        self.r += dt * self.vr
        self.z += dt * self.vz
        speed = np.sqrt(metal.c0**2 + 4 / 3 * metal.shear / metal.density) + metal.s * np.abs(closing)
        side = area / np.sqrt(
            np.maximum(
                (self.r[self.corners[2]] - self.r[self.corners[0]]) ** 2
                + (self.z[self.corners[2]] - self.z[self.corners[0]]) ** 2,
                (self.r[self.corners[3]] - self.r[self.corners[1]]) ** 2
                + (self.z[self.corners[3]] - self.z[self.corners[1]]) ** 2,
            )
        )
        return 0.6 * float(np.min(side / speed))

    def shape(self, length):
        """L, D at the foot, W at 0.2 of the initial length above the foot, and the largest diameter."""
        outer = np.arange(self.rows + 1) * (self.columns + 1) + self.columns
        foot = self.z.min()
        return (
            self.z.max() - foot, 2 * self.r[outer[0]],
            2 * float(np.interp(0.2 * length, self.z[outer] - foot, self.r[outer])), 2 * self.r.max(),
        )


def compute(metal, radius, length, speed, cells):
    bar, time, dt = Bar(Metal(metal), radius, length, cells, speed), 0.0, 1e-6
    while time < T_END:
        limit = bar.step(dt)
        time += dt
        dt = min(limit, 1.05 * dt)
    return bar.shape(length)


def main():
    with open(HERE / "shapes.csv", "w", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["metal", "speed", "cells", "L", "D", "W", "widest"])
        for metal, radius, length, speed in BARS:
            for cells in (12, 24):
                found = compute(metal, radius, length, speed, cells)
                table.writerow([metal, speed, cells, *(f"{value:.3f}" for value in found)])
                print(metal, speed, cells, *(f"{value:.3f}" for value in found), flush=True)


if __name__ == "__main__":
    main()
