"""What runs with different cells say of the error of one of them: grid convergence index with safety factors.

Roache, Perspective: a method for uniform reporting of grid refinement studies, J. Fluids Eng. 116 (1994) 405-413:
1.25 |f - f0| where three sizes show an order, f0 by Richardson's extrapolation; 3 |f2 - f1|/(r^p - 1) where they show
none, here with p = 1. An order above that of the methods is no sign of small errors: it counts as 2, with the factor 3
(Oberkampf and Roy, Verification and Validation in Scientific Computing, Cambridge 2010, section 8.3.4; Eça and Hoekstra
below do the same beyond 2.1). Four sizes and more are fitted by least squares (Eça and Hoekstra, J. Comput. Phys. 262
(2014) 104-130): the last digits of fine runs need not follow the order that all of them show, and what they miss it by
is added.
"""

import math
from dataclasses import dataclass
from typing import Optional

import numpy as np

# claimed; what is steeper is counted as 2, the order of the methods,
LEAST_ORDER, LARGEST_ORDER = 0.5, 2.0
RELIABLE_ORDER = 2.1                                    # up to here the small safety factor is enough
ABSURD_ORDER = 3.0                                      # and beyond this one is none: the finest are alike by chance
REGULAR, IRREGULAR = 1.25, 3.0                         # safety factors
ROUND_OFF = 1e-12                                       # of a value: no difference
SCATTER = 0.05                                          # about the fit, of all that the values span: more is no order
ORDERS = np.linspace(0.25, 3.5, 66)                     # tried in a fit


@dataclass
class Convergence:
    """What a series says: half-width of the interval of one run, and how it was found."""

    half_width: float                                  # nan: one size only
    words: str
    order: Optional[float] = None
    limit: Optional[float] = None                      # value at vanishing cell size


def richardson(sizes, values):
    """Order and limit of the three finest of a converging series, or None: q(h) = q0 + C h^p."""
    (fine, middle, coarse), (q1, q2, q3) = sizes[:3], values[:3]
    if q1 == q2 or (q3 - q2) / (q2 - q1) <= 0:
        return None

    def excess(p):
        return (q3 - q2) / (q2 - q1) - (coarse**p - middle**p) / (middle**p - fine**p)
    low, high = 1e-3, 20.0
    if excess(low) * excess(high) > 0:
        return None
    for _ in range(200):
        p = 0.5 * (low + high)
        low, high = (p, high) if excess(low) * excess(p) > 0 else (low, p)
    return p, q1 - (q2 - q1) * fine**p / (middle**p - fine**p)


def limit_of(sizes, values, order):
    """Value at vanishing cell size with a given order, from the two finest."""
    fine, middle = sizes[0]**order, sizes[1]**order
    return values[0] - (values[1] - values[0]) * fine / (middle - fine)


def monotonic(values):
    """Whether they rise or fall throughout."""
    steps = [b - a for a, b in zip(values, values[1:])]
    return all(step > 0 for step in steps) or all(step < 0 for step in steps)


def fit(sizes, values, order):
    """Limit, what is missed in the mean, and the fit at the sizes, of q0 + C h^p with a given order by least
    squares."""
    matrix = np.column_stack([np.ones(len(sizes)), np.array(sizes) ** order])
    found, *_ = np.linalg.lstsq(matrix, np.array(values), rcond=None)
    misses = matrix @ found - values
    return float(found[0]), float(np.sqrt(np.sum(misses**2) / (len(sizes) - 2))), matrix @ found


def fitted(series, cell):
    """Error of the run with this cell by a fit of all sizes, or all but some of the coarsest, four at least; None where
    they show no order."""
    for count in range(len(series), 3, -1):
        sizes, values = zip(*series[:count])
        order = min(ORDERS, key=lambda trial: fit(sizes, values, trial)[1])
        if cell not in sizes or not LEAST_ORDER <= order <= ABSURD_ORDER:
            continue
        counted = min(order, LARGEST_ORDER)
        limit, scatter, smooth = fit(sizes, values, counted)
        if scatter <= SCATTER * (max(values) - min(values)):
            own = sizes.index(cell)
            width = factor_of(order) * abs(smooth[own] - limit) + scatter + abs(values[own] - smooth[own])
            return Convergence(float(width), order_words(order), float(counted), limit)
    return None


def factor_of(order):
    """Safety factor of an order that was observed."""
    return REGULAR if order <= RELIABLE_ORDER else IRREGULAR


def order_words(order):
    """An order in words."""
    return f"order {order:.1f}" + (" (counted as 2)" if order > LARGEST_ORDER else "")


def convergence_of(series, cell):
    """Error of the run with this cell, from pairs (cell, value) of all runs."""
    series = sorted(series)
    sizes, values = [h for h, _ in series], [value for _, value in series]
    value = dict(series)[cell]
    spread = max(values) - min(values)
    if len(series) < 2:
        return Convergence(math.nan, "one size only")
    if spread <= ROUND_OFF * max(abs(each) for each in values):
        return Convergence(0.0, "all sizes give the same")
    if len(series) > 3 and (found := fitted(series, cell)):
        return found
    found = richardson(sizes, values) if len(series) > 2 and monotonic(values) else None
    if found and found[0] > ABSURD_ORDER:
        index = IRREGULAR * abs(values[1] - values[0]) / (sizes[1] / sizes[0] - 1)
        return Convergence(index + abs(value - values[0]), f"no order: {found[0]:.1f} is more than a method has")
    if found and found[0] >= LEAST_ORDER:
        order = min(found[0], LARGEST_ORDER)
        limit = limit_of(sizes, values, order)
        return Convergence(factor_of(found[0]) * abs(value - limit), order_words(found[0]), order, limit)
    words = ("two sizes, no order" if len(series) < 3 else "no order: slower than h^0.5" if found else
             "no order: away from each other as cells shrink" if monotonic(values) else "no order: up and down")
    finer = max(abs(value - each) for h, each in series if h <= cell)  # what finer cells give must lie within
    return Convergence(max(IRREGULAR * spread / (sizes[-1] / sizes[0] - 1), finer), words)
