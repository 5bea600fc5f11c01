"""A sphere pressed between two rigid, frictionless plates: linear elasticity without Hertz's half-space.

Hertz takes the sphere near the contact for a half-space. In a sphere of finite size the centre follows the plate a
little, and the force at a given approach of plate and centre is larger: by 5 % at 1 % of the radius, 8 % at 2 %. Here
the sphere's surface displacement under a normal traction is summed over Legendre polynomials (Lurie's solution for the
sphere), and the pressure on N rings of the contact circle is found that keeps the surface in the plane of the plate.
The pressure vanishes at the circle's edge, which ties approach to radius.
"""
import math

import numpy as np


def compliance(n, poisson, shear):
    """Radial and tangential displacement (the latter times dP_n/d theta) at the surface of a unit sphere for the
    traction sigma_rr = P_n, sigma_r_theta = 0."""
    radial = 2*shear*(n + 1)*(n*n - n - 2 - 2*poisson)
    radial_2 = 2*shear*n*(n - 1)
    ratio = -(n*n + 2*n - 1 + 2*poisson)/(n - 1) if n > 0 else 0.0
    amplitude = 1/(radial + ratio*radial_2)
    return amplitude*((n + 1)*(n - 2 + 4*poisson) + ratio*n), amplitude*((n + 5 - 4*poisson) + ratio)


def influence(angles, poisson, young, modes):
    """Displacement along the axis at the middle of each ring per unit pressure on each ring and its mirror image."""
    shear = young/2/(1 + poisson)
    middle = 0.5*(angles[1:] + angles[:-1])
    edge, x = np.cos(angles), np.cos(middle)
    radial = np.full((len(x), len(x)), compliance(0, poisson, shear)[0])*(edge[:-1] - edge[1:])
    tangential = np.zeros_like(radial)
    edges, middles = [np.ones_like(edge), edge], [np.ones_like(x), x]
    for n in range(2, modes + 2):
        edges.append(((2*n - 1)*edge*edges[-1] - (n - 1)*edges[-2])/n)
        middles.append(((2*n - 1)*x*middles[-1] - (n - 1)*middles[-2])/n)
        k = n - 1
        if k % 2 == 0:  # odd ones cancel: the other plate presses as much
            along, across = compliance(k, poisson, shear)
            integral = edges[-3] - edges[-1]
            pressure = integral[1:] - integral[:-1]
            slope = k*(x*middles[-2] - middles[-3])/np.sin(middle)
            radial += along*np.outer(middles[-2], pressure)
            tangential += across*np.outer(slope, pressure)
        edges, middles = edges[-2:], middles[-2:]
    return middle, edge, radial*np.cos(middle)[:, None] - tangential*np.sin(middle)[:, None]


def contact(radius, poisson=0.3, young=1.0, rings=30, modes=6000):
    """Approach of plate and centre, and force, for a contact circle of a given radius; all for a unit sphere."""
    middle, edge, matrix = influence(np.linspace(0, radius, rings + 1), poisson, young, modes)
    ones, gap = np.linalg.solve(matrix, np.ones(rings)), np.linalg.solve(matrix, 1 - np.cos(middle))
    fall = math.sqrt((radius**2 - middle[-1]**2)/(radius**2 - middle[-3]**2))  # of a pressure that ends like Hertz's
    low, high = 0.3*radius**2, 3*radius**2
    for _ in range(60):
        depth = 0.5*(low + high)
        pressure = depth*ones - gap
        if pressure[-3] <= 0 or pressure[-1] < fall*pressure[-3]:
            low = depth
        else:
            high = depth
    return depth, 2*math.pi*float(np.sum(pressure*np.cos(middle)*(edge[:-1] - edge[1:])))


def hertz(depth, poisson=0.3, young=1.0):
    """Hertz's force on a unit sphere."""
    return 4/3*young/(1 - poisson**2)*depth**1.5


def curve(poisson=0.3, young=1.0):
    """Radius, approach and force, ascending."""
    radii = np.linspace(0.03, 0.16, 8)
    return np.array([(a, *contact(a, poisson, young)) for a in radii])


if __name__ == "__main__":
    for a, d, f in curve():
        print(f"a = {a:.4f}  d = {d:.6f}  a/sqrt(d) = {a/math.sqrt(d):.4f}  F/Hertz = {f/hertz(d):.4f}")
