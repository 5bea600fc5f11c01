"""A cantilever in plane strain by finite elements of nine nodes: the reference of beam.inp. Shares nothing with the
solver."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "hard"))
from finite_elements import GAUSS, WEIGHTS, shape  # noqa: E402


def cantilever(length, poisson, load, n, young=1.0):
    """Mean deflection of the end of a strip of height 1, clamped at x = 0, uniform shear traction of the resultant
    `load` at x = length; n elements over the height, as long as they are high."""
    columns = round(n*length)
    wide, high = 2*columns + 1, 2*n + 1
    lame, shear = young*poisson/((1 + poisson)*(1 - 2*poisson)), young/(2*(1 + poisson))
    elastic = np.array([[lame + 2*shear, lame, 0], [lame, lame + 2*shear, 0], [0, 0, shear]])
    local = np.zeros((18, 18))
    for s, ws in zip(GAUSS, WEIGHTS):
        for t, wt in zip(GAUSS, WEIGHTS):
            _, ds, dt = shape(s, t)
            strain = np.zeros((3, 18))
            strain[0, ::2], strain[1, 1::2] = 2*n*ds, 2*n*dt
            strain[2, ::2], strain[2, 1::2] = 2*n*dt, 2*n*ds
            local += ws*wt/(4*n*n)*strain.T @ elastic @ strain
    stiffness, force = np.zeros((2*wide*high, 2*wide*high)), np.zeros(2*wide*high)
    for column in range(columns):  # nodes are counted up each column, which keeps the matrix narrow
        for row in range(n):
            nodes = np.add.outer(np.arange(2*row, 2*row + 3), high*np.arange(2*column, 2*column + 3)).ravel()
            degrees = np.ravel(np.column_stack([2*nodes, 2*nodes + 1]))
            stiffness[np.ix_(degrees, degrees)] += local
    end = high*(wide - 1) + np.arange(high)
    weights = np.zeros(high)
    for row in range(n):
        weights[2*row:2*row + 3] += np.array([1, 4, 1])/(6*n)
    force[2*end + 1] = load*weights
    found = np.linalg.solve(stiffness[2*high:, 2*high:], force[2*high:])  # the first column is held
    return weights @ found[2*(end - high) + 1]
