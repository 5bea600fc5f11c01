"""A thin neo-Hookean strip in plane strain, clamped at one end, held level and in its place along x at the other, as an
extensible elastic line: the reference of membrane.inp. Shares nothing with the solver."""
import numpy as np


def stretch(poisson, young=1.0):
    """Stretch under a nominal tension, thickness free of stress, as a function."""
    shear, lame = young/(2*(1 + poisson)), young*poisson/((1 + poisson)*(1 - 2*poisson))
    along = np.linspace(0.9, 1.3, 4001)
    low, high = np.full_like(along, 0.5), np.full_like(along, 1.5)
    for _ in range(60):
        across = 0.5*(low + high)
        too_much = shear*(across**2 - 1) + lame*np.log(along*across) > 0
        low, high = np.where(too_much, low, across), np.where(too_much, across, high)
    tension = (shear*(along**2 - 1) + lame*np.log(along*across))/along
    return lambda force: np.interp(force, tension, along)


def pulled(length, pull, load, pressure, poisson, n):
    """Places x, y of the line at n + 1 equal parts of its length at the start: force `pull` along x at its end, whose
    angle is 0 and which no force holds along y; dead load along y and pressure from below, per length of the line at
    the start and as it is.

    Reissner's line without shear: B theta'' = lambda (R_x sin theta - R_y cos theta), B = E/(12 (1 - nu^2)), theta = 0
    at both ends, the force R is that at the end less the loads beyond. Central differences; R of the last iterate,
    Newton's method for theta.
    """
    longer, bending, step = stretch(poisson), 1/(12*(1 - poisson**2)), length/n
    theta, factor = np.zeros(n + 1), np.ones(n)
    inner = slice(1, n)
    for _ in range(300):
        middle = 0.5*(theta[1:] + theta[:-1])
        for _ in range(3):  # the pressure acts on the length that the line has
            across = pull + np.append(np.cumsum((-step*pressure*factor*np.sin(middle))[::-1])[::-1], 0)
            up = np.append(np.cumsum((step*(load + pressure*factor*np.cos(middle)))[::-1])[::-1], 0)
            factor = longer(0.5*(across[1:] + across[:-1])*np.cos(middle) + 0.5*(up[1:] + up[:-1])*np.sin(middle))
        at_nodes = 0.5*(factor[1:] + factor[:-1])
        sine, cosine = np.sin(theta[inner]), np.cos(theta[inner])
        rest = bending * (theta[2:] - 2 * theta[inner] + theta[:-2]) / step**2 - at_nodes * (
            across[inner] * sine - up[inner] * cosine
        )
        change = three(bending/step**2, -2*bending/step**2 - at_nodes*(across[inner]*cosine + up[inner]*sine), -rest)
        theta[inner] += change
        if abs(change).max() < 1e-12:
            break
    return tuple(np.append(0, np.cumsum(step*factor*part)) for part in (np.cos(middle), np.sin(middle)))


def three(beside, diagonal, right):
    """Solution of a tridiagonal system with one number beside its diagonal (Thomas)."""
    n = len(right)
    c, d = np.zeros(n), np.zeros(n)
    c[0], d[0] = beside/diagonal[0], right[0]/diagonal[0]
    for i in range(1, n):
        pivot = diagonal[i] - beside*c[i - 1]
        c[i], d[i] = beside/pivot, (right[i] - beside*d[i - 1])/pivot
    for i in range(n - 2, -1, -1):
        d[i] -= c[i]*d[i + 1]
    return d


def held(length, load, pressure, poisson, n=1000):
    """The line whose end stays at x = length, by bisection of the pull; (n + 1) places at the start, x, y."""
    low, high = 1e-3, 0.1
    for _ in range(40):
        pull = 0.5*(low + high)
        x, y = pulled(length, pull, load, pressure, poisson, n)
        low, high = (pull, high) if x[-1] < length else (low, pull)
    return np.linspace(0, length, n + 1), x, y
