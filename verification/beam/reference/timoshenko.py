#!/usr/bin/env python3
"""First bending mode of a free-free Timoshenko beam in plane strain, by transfer matrix; numpy only.

State (W, psi, M, Q): deflection, rotation, moment, shear force, with
  W' = psi + Q/(k G H),  psi' = M/(E' I),  M' = -Q - rho I w^2 psi,  Q' = -rho H w^2 W,
E' = E/(1-nu^2), I = H^3/12, k = 5/6, per unit thickness. Free ends: M = Q = 0. The initial velocity of the example is
projected on the mode, which gives the bending stress at mid-span over time.

    python3 timoshenko.py             writes mode.csv beside this file: period and stress at the surface
"""

from pathlib import Path

import numpy as np

LENGTH, HEIGHT, YOUNG, DENSITY, POISSON, Y_MAX = 0.06, 0.01, 318e9, 1845.0, 0.054, 5e-4
PLANE = YOUNG / (1 - POISSON**2)
SHEAR = 5 / 6 * YOUNG / (2 * (1 + POISSON)) * HEIGHT
INERTIA = HEIGHT**3 / 12
BETA = 4.7300407448627 / LENGTH
OMEGA_EULER = BETA**2 * np.sqrt(PLANE * HEIGHT**2 / (12 * DENSITY))


def matrix(omega, length):
    """Transfer matrix over a length, by scaling and squaring. Moments and forces in units that keep it well scaled."""
    unit = PLANE * INERTIA / LENGTH**2
    a = np.array([[0, 1 / LENGTH, 0, unit / (SHEAR * LENGTH)],
                  [0, 0, unit * LENGTH / (PLANE * INERTIA), 0],
                  [0, -DENSITY * INERTIA * omega**2 / (unit * LENGTH), 0, -1 / LENGTH],
                  [-DENSITY * HEIGHT * omega**2 * LENGTH / unit, 0, 0, 0]])  # of (W/L, psi, M/(unit L), Q/unit)
    step, total, term = a * length / 1024, np.eye(4), np.eye(4)
    for n in range(1, 12):
        term = term @ step / n
        total = total + term
    return np.linalg.matrix_power(total, 1024)


def frequency():
    """Lowest frequency other than 0, by bisection of the determinant."""
    def determinant(omega):
        return np.linalg.det(matrix(omega, LENGTH)[2:, :2])
    low, high = 0.6 * OMEGA_EULER, 1.02 * OMEGA_EULER
    sign = np.sign(determinant(low))
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.sign(determinant(middle)) == sign else (low, middle)
    return 0.5 * (low + high)


def initial_velocity(x):
    """Eqs. 89-93."""
    bl = BETA * LENGTH
    c1, c2 = np.cosh(bl) - np.cos(bl), np.sin(bl) - np.sinh(bl)
    return (
        Y_MAX
        / (2 * c2)
        * OMEGA_EULER
        * (c1 * (np.sin(BETA * x) + np.sinh(BETA * x)) + c2 * (np.cos(BETA * x) + np.cosh(BETA * x)))
    )


def mid_span():
    """Circular frequency and amplitude of the surface stress at mid-span."""
    omega = frequency()
    block = matrix(omega, LENGTH)[2:, :2]
    _, _, vectors = np.linalg.svd(block)
    start = np.concatenate([vectors[-1], [0, 0]])
    x = np.linspace(0, LENGTH, 241)
    step = matrix(omega, x[1])
    states = [start]
    for _ in x[1:]:
        states.append(step @ states[-1])
    w, psi, moment = np.array(states)[:, :3].T * np.array([[LENGTH], [1], [PLANE * INERTIA / LENGTH]])
    mass = DENSITY * (HEIGHT * w**2 + INERTIA * psi**2)
    rule = np.full(x.size, x[1])
    rule[[0, -1]] *= 0.5
    speed = np.sum(rule * DENSITY * HEIGHT * w * initial_velocity(x)) / np.sum(rule * mass)
    return omega, -0.5 * HEIGHT * moment[120] / INERTIA * speed / omega


if __name__ == "__main__":
    omega, stress = mid_span()
    with open(Path(__file__).with_name("mode.csv"), "w") as stream:
        stream.write("quantity,value\n")
        stream.write(
            f"period_timoshenko_us,{2e6 * np.pi / omega:.4f}\n"
            f"period_euler_bernoulli_us,{2e6 * np.pi / OMEGA_EULER:.4f}\n"
        )
        stream.write(f"surface_stress_mid_span_mpa,{1e-6 * stress:.3f}\n")
    print(2e6 * np.pi / omega, 2e6 * np.pi / OMEGA_EULER, 1e-6 * stress)
