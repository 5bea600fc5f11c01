#!/usr/bin/env python3
"""Cook's membrane at rest by SGMP's quadrature, without the program: linear, particles where they start; as it is, and
with F-bar.

    python3 verification/hard/at_rest.py

Prints deflection of the tip over that of finite elements and roughness of the pressure, as doc/hard-cases.md measures
them. F-bar takes the volumetric strain as a mean, of the particles around a centre or of the centres around a node, and
the transposed force, so that the work is that of one energy.
"""
import numpy as np
from finite_elements import membrane as membrane_by_elements

LOAD, H, SPACING = 2e-7, 2.0, 1.0
COLUMNS, ROWS = 26, 33  # nodes from x = 0 on, and from y = -h on


def particles():
    """A lattice in the middle of equal squares, what lies within the membrane."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(SPACING/2, 48, SPACING), np.arange(SPACING/2, 60, SPACING)))
    inside = (y <= 44 + x/3) & (y >= 44/48*x)
    return x[inside], y[inside]


def interpolation(x, y):
    """Hat functions of the centres at the particles; what lies behind the clamped end is its mirror image."""
    weights = np.zeros((len(x), COLUMNS - 1, ROWS - 1))
    s, t = x/H - 0.5, y/H + 0.5
    i, j = np.floor(s).astype(int), np.floor(t).astype(int)
    for a in (0, 1):
        for b in (0, 1):
            np.add.at(
                weights, (np.arange(len(x)), np.maximum(i + a, 0), j + b), np.abs(1 - a - s + i) * np.abs(1 - b - t + j)
            )
    return weights.reshape(len(x), -1)


def corners():
    """Means and both derivatives at the centres of what their four nodes have."""
    mean, along, across = (np.zeros((COLUMNS - 1, ROWS - 1, COLUMNS, ROWS)) for _ in range(3))
    i, j = np.indices((COLUMNS - 1, ROWS - 1))
    for a in (0, 1):
        for b in (0, 1):
            mean[i, j, i + a, j + b], along[i, j, i + a, j + b], across[i, j, i + a, j + b] = (
                0.25, (2 * a - 1) / (2 * H), (2 * b - 1) / (2 * H),
            )
    return [matrix.reshape((COLUMNS - 1)*(ROWS - 1), -1) for matrix in (mean, along, across)]


def rows_of_one(matrix):
    """Rows that are not empty scaled to a sum of 1."""
    total = matrix.sum(axis=1, keepdims=True)
    return np.divide(matrix, total, out=np.zeros_like(matrix), where=total > 1e-9)


def solve(poisson, averaged=""):
    """Deflection of the tip and roughness of the pressure; averaged: '', 'particles' or 'nodes'."""
    x, y = particles()
    weights, volume = interpolation(x, y), SPACING**2
    mean, along, across = corners()
    filled = volume*weights.sum(axis=0)
    slope_x, slope_y = weights @ along, weights @ across
    volumetric = np.hstack([slope_x, slope_y])
    if averaged == "particles":
        volumetric = weights @ rows_of_one(weights.T) @ volumetric
    if averaged == "nodes":
        volumetric = weights @ rows_of_one(mean @ rows_of_one(mean.T*filled)) @ np.hstack([along, across])
    lame, shear = poisson/((1 + poisson)*(1 - 2*poisson)), 0.5/(1 + poisson)
    stretch, slide = np.hstack([slope_x, -slope_y])/2, np.hstack([slope_y, slope_x])
    stiffness = volume*((lame + shear)*volumetric.T @ volumetric + 4*shear*stretch.T @ stretch + shear*slide.T @ slide)
    mass = mean.T @ filled
    force = np.concatenate([np.zeros_like(mass), LOAD*mass])
    free = np.tile((mass > 1e-9) & (np.arange(len(mass)) >= ROWS), 2)
    found = np.zeros(len(force))
    found[free] = np.linalg.solve(stiffness[np.ix_(free, free)], force[free])
    tip = (weights @ mean @ found[len(mass):])[np.argmin(np.hypot(x - 47.5, y - 59.5))]
    pressure = -(lame + 2/3*shear)*volumetric @ found
    square = [(1, i, j, pressure[np.argmin(np.hypot(x - 20.5 - i, y - 30.5 - j))]) for i in range(4) for j in range(4)]
    plane, values = np.array(square)[:, :3], np.array(square)[:, 3]
    rest = values - plane @ np.linalg.lstsq(plane, values, rcond=None)[0]
    return tip, np.sqrt(np.mean(rest**2)/np.mean(values**2))


def main():
    """All of Poisson's ratios of the suite."""
    for poisson in (0.3, 0.49, 0.499, 0.4999):
        reference = membrane_by_elements(poisson, LOAD, 20)(47.5, 59.5)[1]
        for averaged in ("", "particles", "nodes"):
            tip, roughness = solve(poisson, averaged)
            print(
                f"nu = {poisson}, {'F-bar of ' + averaged if averaged else 'as it is'}: deflection "
                f"{tip / reference:.4f}, roughness {roughness:.3f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
