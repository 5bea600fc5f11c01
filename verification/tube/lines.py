"""A second implementation: gas in an elastic tube in one dimension, Lagrangian, staggered in space and time, linear in
the tube."""
import numpy as np


def breathe(cells, end, samples, courant=0.25):
    """Times, and the displacement of the outer radius at them; `cells` to the radius 1 of the bore, the tube reaches to
    2."""
    pressure0, gamma, density = 1e-3, 1.4, np.where(np.arange(2 * cells) < cells, 1e-3, 1.0)
    lame, shear = 0.3 / (1.3 * 0.4), 1 / 2.6
    start = np.arange(2 * cells + 1) / cells
    area = (start[1:] ** 2 - start[:-1] ** 2) / 2            # of the rings, over 2 pi
    mass = np.zeros(2 * cells + 1)
    mass[:-1] += 0.5 * density * area
    mass[1:] += 0.5 * density * area
    centre, width = 0.5 * (start[1:] + start[:-1]), 1 / cells
    way, velocity = np.zeros_like(start), np.zeros_like(start)
    steps = int(np.ceil(end / (courant * width / 1.2)))
    step = end / steps
    rows = np.zeros(steps + 1)
    for k in range(steps):
        radius = start + way
        swollen = (radius[1:] ** 2 - radius[:-1] ** 2) / 2
        radial, hoop = (way[1:] - way[:-1]) / width, 0.5 * (way[1:] + way[:-1]) / centre
        sigma = (lame + 2 * shear) * radial + lame * hoop
        around = (lame + 2 * shear) * hoop + lame * radial
        gas = density < 0.5
        sigma[gas] = around[gas] = -pressure0 * (area[gas] / swollen[gas]) ** gamma
        force = np.zeros_like(start)
        # work of the cells over a change of each of their radii
        for side, sign in ((slice(None, -1), 1), (slice(1, None), -1)):
            force[side] += sign * sigma * centre - 0.5 * around * width
        acceleration = force / mass
        acceleration[0] = 0
        velocity += (0.5 * step if k == 0 else step) * acceleration
        way += step * velocity
        rows[k + 1] = way[-1]
    times = np.linspace(0, end, samples + 1)
    return times, np.interp(times, np.linspace(0, end, steps + 1), rows)
