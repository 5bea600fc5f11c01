"""Plane strain by finite elements of nine nodes: the reference of Cook's membrane. Shares nothing with the solver."""
import numpy as np

GAUSS = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)])
WEIGHTS = np.array([5, 8, 5])/9


def lagrange(s):
    """Quadratic functions of -1, 0, 1 and their slopes at s."""
    return np.array([s*(s - 1)/2, 1 - s*s, s*(s + 1)/2]), np.array([s - 0.5, -2*s, s + 0.5])


def shape(s, t):
    """The nine functions and their two slopes, nodes in rows along s."""
    (a, da), (b, db) = lagrange(s), lagrange(t)
    return np.outer(b, a).ravel(), np.outer(b, da).ravel(), np.outer(db, a).ravel()


def membrane(poisson, load, n, young=1.0):
    """Displacements of Cook's membrane under its own weight `load` along y, n x n elements: the field as a function of
    a point."""
    side = 2*n + 1
    u, v = np.meshgrid(np.linspace(0, 1, side), np.linspace(0, 1, side))
    x = 48*u
    y = 44/48*x + v*(44 + 16/48*x - 44/48*x)
    lame, shear = young*poisson/((1 + poisson)*(1 - 2*poisson)), young/(2*(1 + poisson))
    elastic = np.array([[lame + 2*shear, lame, 0], [lame, lame + 2*shear, 0], [0, 0, shear]])
    stiffness, force = np.zeros((2*side*side, 2*side*side)), np.zeros(2*side*side)
    for row in range(n):
        for column in range(n):
            nodes = np.add.outer(side*np.arange(2*row, 2*row + 3), np.arange(2*column, 2*column + 3)).ravel()
            places = np.column_stack([x.ravel()[nodes], y.ravel()[nodes]])
            degrees = np.ravel(np.column_stack([2*nodes, 2*nodes + 1]))
            local = np.zeros((18, 18))
            for s, ws in zip(GAUSS, WEIGHTS):
                for t, wt in zip(GAUSS, WEIGHTS):
                    values, ds, dt = shape(s, t)
                    jacobian = np.array([ds @ places, dt @ places])
                    slope = np.linalg.solve(jacobian, np.array([ds, dt]))
                    area = np.linalg.det(jacobian)*ws*wt
                    strain = np.zeros((3, 18))
                    strain[0, ::2], strain[1, 1::2] = slope[0], slope[1]
                    strain[2, ::2], strain[2, 1::2] = slope[1], slope[0]
                    local += area*strain.T @ elastic @ strain
                    force[2*nodes + 1] += area*load*values
            stiffness[np.ix_(degrees, degrees)] += local
    held = np.arange(side)*side
    free = np.setdiff1d(np.arange(2*side*side), np.concatenate([2*held, 2*held + 1]))
    found = np.zeros(2*side*side)
    found[free] = np.linalg.solve(stiffness[np.ix_(free, free)], force[free])

    def at(px, py):
        """Displacement at a point."""
        a = px/48*n
        b = (py - 44/48*px)/(44 - 28/48*px)*n
        i, j = min(int(a), n - 1), min(int(b), n - 1)
        nodes = np.add.outer(side*np.arange(2*j, 2*j + 3), np.arange(2*i, 2*i + 3)).ravel()
        values, _, _ = shape(2*(a - i) - 1, 2*(b - j) - 1)
        return values @ found[2*nodes], values @ found[2*nodes + 1]

    return at
