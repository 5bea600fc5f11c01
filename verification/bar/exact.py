"""Closed form of the vibrating bar (Eqs. 95-97) and the error norm, for all bar examples."""

import numpy as np

LENGTH, V0, YOUNG, DENSITY = 1.0, 0.1, 50.0, 25.0
OMEGA = np.pi / LENGTH * np.sqrt(YOUNG / DENSITY)


def displacement(position, time):
    """u at the material point that was at `position`."""
    return V0 / OMEGA * np.sin(OMEGA * time) * np.sin(np.pi * position / LENGTH)


def error(run, time):
    """L2 error of the displacement over the particles (Eq. 97)."""
    particles = run.particles()
    start = particles.fields["initial_position"][:, 0]
    return float(np.sqrt(np.mean((particles.points[:, 0] - start - displacement(start, time))**2)))


def error_along(run, time, angle=45.0):
    """The same for the bar turned by `angle`, over 0 <= x' <= L."""
    particles = run.particles()
    start = particles.fields["initial_position"][:, :2]
    moved = particles.points[:, :2] - start
    axis = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    along = start @ axis
    inside = (along >= 0) & (along <= LENGTH)
    exact = displacement(along, time)[:, None] * axis
    return float(np.sqrt(np.mean(np.sum((moved - exact)[inside]**2, axis=1))))
