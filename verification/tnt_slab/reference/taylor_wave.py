#!/usr/bin/env python3
"""Exact solution of the detonation from a rigid wall: Chapman-Jouguet state of the JWL Hugoniot, and the self-similar
Taylor wave along the isentrope, by quadrature; numpy only. GPa, g/cm^3, km/s, mm, us.

On the isentrope p(V) = A e^(-R1 V) + B e^(-R2 V) + C V^-(1+w); du = -(c/V) dV towards the wall, x/t = u + c; where u =
0 the plateau begins.

    python3 taylor_wave.py            writes profile.csv beside this file: x/(D t), pressure, density, velocity
"""

from pathlib import Path

import numpy as np

A, B, R1, R2, W, ENERGY, DENSITY = 371.2, 3.21, 4.15, 0.95, 0.30, 6.993, 1.63


def hugoniot(v):
    """Pressure on E = ENERGY + p (1 - v)/2."""
    cold = A * (1 - W / (R1 * v)) * np.exp(-R1 * v) + B * (1 - W / (R2 * v)) * np.exp(-R2 * v)
    return (cold + W * ENERGY / v) / (1 - 0.5 * W / v * (1 - v))


def chapman_jouguet():
    """Volume, pressure, detonation speed: the slowest Rayleigh line that touches the Hugoniot, by golden section."""
    def speed(v):
        return np.sqrt(hugoniot(v) / (DENSITY * (1 - v)))
    low, high, ratio = 0.6, 0.9, 0.5 * (np.sqrt(5) - 1)
    for _ in range(80):
        a, b = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, b) if speed(a) < speed(b) else (a, high)
    v = 0.5 * (low + high)
    return v, hugoniot(v), speed(v)


class TaylorWave:
    """Pressure, density and velocity over xi = x/(D t)."""

    def __init__(self, points=400001):
        v0, self.peak, self.speed = chapman_jouguet()
        self.particle_speed, self.peak_density = self.speed * (1 - v0), DENSITY / v0
        v = np.linspace(v0, 1.6, points)
        rest = (self.peak - A * np.exp(-R1 * v0) - B * np.exp(-R2 * v0)) * v0**(1 + W)
        pressure = A * np.exp(-R1 * v) + B * np.exp(-R2 * v) + rest * v**(-1 - W)
        slope = A * R1 * np.exp(-R1 * v) + B * R2 * np.exp(-R2 * v) + (1 + W) * rest * v**(-2 - W)
        sound = v * np.sqrt(slope / DENSITY)
        rate = sound / v
        velocity = self.particle_speed - np.concatenate([[0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(v))])
        n = int(np.argmax(velocity < 0))
        self.xi = ((velocity + sound) / self.speed)[:n + 1][::-1]
        self.table = np.array([pressure, DENSITY / v, velocity])[:, :n + 1][:, ::-1]
        self.plateau, self.plateau_density, self.plateau_end = pressure[n], DENSITY / v[n], self.xi[0]

    def at(self, x, time):
        """(pressure, density, velocity) at positions x (mm) and a time (us)."""
        xi = np.asarray(x) / (self.speed * time)
        ahead = np.array([0.0, DENSITY, 0.0])
        return np.array([np.where(xi > 1, out, np.interp(xi, self.xi, row)) for row, out in zip(self.table, ahead)])


if __name__ == "__main__":
    wave = TaylorWave()
    print(
        f"D {1e3 * wave.speed:.1f} m/s, p {wave.peak:.3f} GPa, rho {1e3 * wave.peak_density:.1f}, u "
        f"{1e3 * wave.particle_speed:.1f} m/s, "
        f"plateau {wave.plateau:.3f} GPa, {1e3 * wave.plateau_density:.1f} up to {wave.plateau_end:.4f} D t"
    )
    xi = np.linspace(0, 1, 501)
    with open(Path(__file__).with_name("profile.csv"), "w") as stream:
        stream.write("x/(D t),pressure_gpa,density_g_cm3,velocity_km_s\n")
        for row in np.column_stack([xi, wave.at(xi * wave.speed, 1.0).T]):
            stream.write(",".join(f"{value:.6f}" for value in row) + "\n")
