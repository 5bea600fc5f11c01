"""Shape of the Taylor bar by its surface, axisymmetric and in 3D, and the shape to which it converges."""
import numpy as np

LENGTH = 25.4
# mm, and how well it is known: an independent code, SGMP to h = 0.0475, GIMP to 0.095, surfaces extrapolated.
REFERENCE = {"L": (16.34, 0.02), "D": (13.43, 0.02), "W": (10.135, 0.01)}
SECTORS = 36


def of_rings(run, spacing, length=LENGTH):
    """L, D at the foot and W at 0.2 of the initial length, from the outermost lines of rings and half a particle in
    their stretched spacing."""
    particles = run.particles()
    x, z = particles.points[:, 0], particles.points[:, 2]
    x0, z0 = (particles.fields["initial_position"][:, axis] for axis in (0, 2))
    columns = [z[np.abs(x0 - place) < 0.1 * spacing] for place in np.unique(np.round(x0, 9))]
    tops = [np.sort(column)[-2:] for column in columns]
    rows = np.unique(np.round(z0 / spacing - 0.5).astype(int))
    rim = []
    for row in rows:
        inside = np.abs(z0 / spacing - 0.5 - row) < 0.1
        order = np.argsort(x0[inside])[-2:]
        radius, height = x[inside][order], z[inside][order]
        rim.append((height[1], radius[1] + 0.5 * (radius[1] - radius[0])))
    rim = np.array(rim)
    # the outer line, taken on to the wall
    foot = rim[0, 1] + (rim[0, 1] - rim[1, 1]) * rim[0, 0] / (rim[1, 0] - rim[0, 0])
    return (
        max(top[1] + 0.5 * (top[1] - top[0]) for top in tops), 2 * foot,
        2 * float(np.interp(0.2 * length, rim[:, 0], rim[:, 1])),
    )


def of_cubes(run, length=LENGTH):
    """The same of a bar of cubes, whose surface is a flight of stairs: the largest radius of each sector, mean over the
    sectors, with half a spacing."""
    points, spacing, h = run.particles().points, run.summary["spacing"], run.summary["h"]
    radius, sector = (
        np.hypot(points[:, 0], points[:, 1]),
        np.floor((np.arctan2(points[:, 1], points[:, 0]) / np.pi + 1) * SECTORS / 2).astype(int) % SECTORS,
    )

    def diameter(chosen):
        return 2 * float(np.mean([radius[chosen & (sector == s)].max() for s in range(SECTORS)])) + spacing

    return (
        points[:, 2].max() + 0.5 * spacing, diameter(points[:, 2] <= h),
        diameter(np.abs(points[:, 2] - 0.2 * length) <= 0.5 * h),
    )


def error(shape):
    """Mean of the relative errors of L, D, W against the converged shape."""
    return float(np.mean([abs(found / want - 1) for found, (want, _) in zip(shape, REFERENCE.values())]))
