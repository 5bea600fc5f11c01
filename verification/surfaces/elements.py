"""Total Lagrangian finite elements in plane strain, and about an axis: the reference for bodies that bounce and bend.

Four-node quadrilaterals, two by two Gauss points, lumped mass, central differences in time; the compressible
neo-Hookean law P = mu (F - F^-T) + lambda ln J F^-T (METHOD.md, section 5). Rigid frictionless wall at x = 0,
by a penalty on the nodes. Nothing here comes from sgmp. Units are the caller's.
"""

import numpy as np

GAUSS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / np.sqrt(3)
CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])


def ring(centre, outer, inner, radial, around):
    """Upper half of a ring: nodes and quadrilaterals; `around` elements over 180 degrees."""
    r, t = np.meshgrid(np.linspace(inner, outer, radial + 1), np.linspace(np.pi, 0, around + 1), indexing="ij")
    return block_nodes(centre + r * np.cos(t), r * np.sin(t))


def disk(centre, radius, divisions, core=0.5):
    """Upper half of a disk: a half square in the middle, three blocks around it (the middle one over 90 degrees)."""
    n, a = divisions, core * radius
    ramp = np.linspace(0, 1, n + 1)
    x, y = np.meshgrid(a * np.linspace(-1, 1, 2 * n + 1), a * ramp, indexing="ij")
    bulge = 1 - 0.1 * ((x / a) ** 2 * (y / a) ** 2)
    blocks = [block_nodes(x * bulge, y * bulge)]
    edges = [
        (np.column_stack([np.full(n + 1, a), a * ramp]), ramp * np.pi / 4),
        (
            np.column_stack([a * np.linspace(1, -1, 2 * n + 1), np.full(2 * n + 1, a)]),
            np.linspace(1, 3, 2 * n + 1) * np.pi / 4,
        ),
        (np.column_stack([np.full(n + 1, -a), a * ramp[::-1]]), np.pi - ramp[::-1] * np.pi / 4),
    ]
    for inside, angle in edges:
        b = 1 - 0.1 * ((inside[:, 0] / a) ** 2 * (inside[:, 1] / a) ** 2)
        inside, rim = inside * b[:, None], radius * np.column_stack([np.cos(angle), np.sin(angle)])
        p = (1 - ramp)[:, None, None] * inside + ramp[:, None, None] * rim
        blocks.append(block_nodes(p[:, :, 0], p[:, :, 1]))
    nodes, quads = merge(blocks, 1e-6 * radius)
    return nodes + [centre, 0.0], quads


def block_nodes(x, y):
    """Nodes and quadrilaterals of a structured block."""
    number = np.arange(x.size).reshape(x.shape)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.column_stack([x.ravel(), y.ravel()]), quads


def merge(blocks, tolerance):
    """One mesh of several blocks whose common nodes coincide."""
    nodes, quads, shift = [], [], 0
    for points, elements in blocks:
        nodes.append(points)
        quads.append(elements + shift)
        shift += len(points)
    nodes = np.concatenate(nodes)
    _, first, number = np.unique(
        np.round(nodes / tolerance).astype(np.int64), axis=0, return_index=True, return_inverse=True
    )
    return nodes[first], number.ravel()[np.concatenate(quads)]


class Mesh:
    """Shape function gradients at the Gauss points, lumped masses."""

    def __init__(self, nodes, quads, density, young, poisson):
        area = shoelace(nodes[quads])
        quads = np.where((area < 0)[:, None], quads[:, ::-1], quads)
        self.X, self.quads = nodes, quads
        self.mu, self.lam = young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        self.speed = np.sqrt((self.lam + 2 * self.mu) / density)
        corner, self.B, self.w = nodes[quads], [], []
        mass = np.zeros(quads.shape)
        for xi, eta in GAUSS:
            shape = 0.25 * (1 + CORNERS[:, 0] * xi) * (1 + CORNERS[:, 1] * eta)
            slope = 0.25 * np.column_stack(
                [CORNERS[:, 0] * (1 + CORNERS[:, 1] * eta), CORNERS[:, 1] * (1 + CORNERS[:, 0] * xi)]
            )
            J = np.einsum("eai,aj->eij", corner, slope)
            det = np.linalg.det(J)
            assert det.min() > 0
            self.B.append(np.einsum("aj,eji->eai", slope, np.linalg.inv(J)))
            self.w.append(det)
            mass += density * det[:, None] * shape
        self.B, self.w = np.stack(self.B), np.stack(self.w)          # (4, elements, 4, 2) and (4, elements)
        self.m = np.bincount(quads.ravel(), mass.ravel(), len(nodes))
        side = np.min(
            [np.linalg.norm(corner[:, a] - corner[:, b], axis=1) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))], axis=0
        )
        self.side = side.min()
        self.dt = 0.5 * self.side / self.speed

    def force(self, x):
        """Internal forces of the nodes at places x, and the elastic energy."""
        e = x[self.quads]
        F = np.matmul(e.transpose(0, 2, 1)[None], self.B)            # F_ij = sum_a x_ai B_aj
        J = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
        log = np.log(J)
        inverse = np.empty_like(F)                                   # F^-T
        inverse[..., 0, 0], inverse[..., 1, 1] = F[..., 1, 1] / J, F[..., 0, 0] / J
        inverse[..., 0, 1], inverse[..., 1, 0] = -F[..., 1, 0] / J, -F[..., 0, 1] / J
        P = self.mu * F + (self.lam * log - self.mu)[..., None, None] * inverse
        f = -np.matmul(self.B, (P * self.w[..., None, None]).transpose(0, 1, 3, 2)).sum(0)
        energy = self.w * (0.5 * self.mu * ((F * F).sum((2, 3)) - 2 - 2 * log) + 0.5 * self.lam * log**2)
        flat, f = self.quads.ravel(), f.reshape(-1, 2)
        return np.column_stack([np.bincount(flat, f[:, k], len(x)) for k in range(2)]), energy.sum()


def shoelace(corner):
    x, y = corner[..., 0], corner[..., 1]
    return 0.5 * (x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(1)


def bounce(nodes, quads, density, young, poisson, speed, end, samples=200, stiffness=1.0):
    """A body (upper half; symmetric about y = 0) that flies along x into the rigid wall x = 0.

    Returns rows of time, kinetic energy over the first, mean velocity over the first, total energy over the first.
    `stiffness` of the wall's springs, in units of (lambda + 2 mu)/side times the node's face.
    """
    mesh = Mesh(nodes, quads, density, young, poisson)
    x, v = nodes.copy(), np.zeros_like(nodes)
    v[:, 0] = speed
    axis = np.abs(nodes[:, 1]) < 1e-9 * np.ptp(nodes[:, 0])
    # springs in proportion to mass: a node's own frequency against the wall stays below that of an element
    spring = stiffness * mesh.m * (mesh.speed / mesh.side) ** 2
    steps = int(np.ceil(end / mesh.dt))
    dt, keep, rows = end / steps, max(1, steps // samples), []
    first, total = 0.5 * (mesh.m[:, None] * v**2).sum(), mesh.m.sum() * speed
    for step in range(steps + 1):
        f, elastic = mesh.force(x)
        depth = np.maximum(x[:, 0], 0)
        f[:, 0] -= spring * depth
        a = f / mesh.m[:, None]
        a[axis, 1] = 0
        half = v + 0.5 * dt * a if step else v
        if step % keep == 0 or step == steps:
            kinetic = 0.5 * (mesh.m[:, None] * half**2).sum()
            held = 0.5 * (spring * depth**2).sum()
            rows.append((step * dt, kinetic / first, mesh.m @ half[:, 0] / total, (kinetic + elastic + held) / first))
        v = v + (dt if step else 0.5 * dt) * a
        x = x + dt * v
    return np.array(rows)


class Round(Mesh):
    """The same about the axis y = 0: y is the radius, and hoops stretch, too."""

    def __init__(self, nodes, quads, density, young, poisson):
        super().__init__(nodes, quads, density, young, poisson)
        self.N = np.stack([0.25 * (1 + CORNERS[:, 0] * xi) * (1 + CORNERS[:, 1] * eta) for xi, eta in GAUSS])
        self.R = np.einsum("ga,ea->ge", self.N, nodes[self.quads][..., 1])
        self.w = self.w * 2 * np.pi * self.R
        mass = density * np.einsum("ge,ga->ea", self.w, self.N)
        self.m = np.bincount(self.quads.ravel(), mass.ravel(), len(nodes))

    def force(self, x):
        """Internal forces of the nodes at places x, and the elastic energy."""
        e = x[self.quads]
        F = np.matmul(e.transpose(0, 2, 1)[None], self.B)
        hoop = np.einsum("ga,ea->ge", self.N, e[..., 1]) / self.R
        area = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
        log = np.log(area * hoop)
        inverse = np.empty_like(F)                                   # F^-T in the plane
        inverse[..., 0, 0], inverse[..., 1, 1] = F[..., 1, 1] / area, F[..., 0, 0] / area
        inverse[..., 0, 1], inverse[..., 1, 0] = -F[..., 1, 0] / area, -F[..., 0, 1] / area
        pressed = self.lam * log - self.mu
        P = self.mu * F + pressed[..., None, None] * inverse
        f = -np.matmul(self.B, (P * self.w[..., None, None]).transpose(0, 1, 3, 2)).sum(0)
        around = (self.mu * hoop + pressed / hoop) * self.w / self.R
        f[..., 1] -= np.einsum("ga,ge->ea", self.N, around)
        square = (F * F).sum((2, 3)) + hoop**2 - 3
        energy = self.w * (0.5 * self.mu * (square - 2 * log) + 0.5 * self.lam * log**2)
        flat, f = self.quads.ravel(), f.reshape(-1, 2)
        return np.column_stack([np.bincount(flat, f[:, k], len(x)) for k in range(2)]), energy.sum()


def ball_depth(divisions, poisson, speed, stiffness=9.0):
    """How far the centre of mass of a ball (radius, density and Young's modulus 1) goes on after it has touched a rigid
    frictionless wall, and how deep it has got into the wall's springs by then."""
    nodes, quads = disk(-1.0, 1.0, divisions)
    mesh = Round(nodes, quads, 1.0, 1.0, poisson)
    x, v = nodes.copy(), np.zeros_like(nodes)
    v[:, 0] = speed
    axis = np.abs(nodes[:, 1]) < 1e-9
    spring = stiffness * mesh.m * (mesh.speed / mesh.side) ** 2
    total = mesh.m.sum()
    start, depth, into = mesh.m @ x[:, 0] / total, 0.0, 0.0
    while True:
        f, _ = mesh.force(x)
        sunk = np.maximum(x[:, 0], 0)
        f[:, 0] -= spring * sunk
        a = f / mesh.m[:, None]
        a[axis, 1] = 0
        v = v + mesh.dt * a
        x = x + mesh.dt * v
        now = mesh.m @ x[:, 0] / total - start
        if now < depth:
            return depth, into
        depth, into = now, sunk.max()


class Yielding(Mesh):
    """Elements of an elastic and ideally plastic solid (von Mises): stresses follow the rate of deformation with
    Jaumann's rate, volume changes are the same all over an element (no locking)."""

    def __init__(self, nodes, quads, density, young, poisson, strength):
        super().__init__(nodes, quads, density, young, poisson)
        self.strength = strength
        self.slopes = np.stack([
            0.25 * np.column_stack(
                [CORNERS[:, 0] * (1 + CORNERS[:, 1] * eta), CORNERS[:, 1] * (1 + CORNERS[:, 0] * xi)]
            )
            for xi, eta in GAUSS
        ])
        self.stress = np.zeros((4, len(self.quads), 4))              # xx, yy, zz, xy at each Gauss point

    def gradients(self, x):
        """Gradients of the shape functions at places x, volumes of the Gauss points."""
        corner = x[self.quads]
        jacobian = np.einsum("eai,gaj->geij", corner, self.slopes)
        det = jacobian[..., 0, 0] * jacobian[..., 1, 1] - jacobian[..., 0, 1] * jacobian[..., 1, 0]
        inverse = np.empty_like(jacobian)
        inverse[..., 0, 0], inverse[..., 1, 1] = jacobian[..., 1, 1] / det, jacobian[..., 0, 0] / det
        inverse[..., 0, 1], inverse[..., 1, 0] = -jacobian[..., 0, 1] / det, -jacobian[..., 1, 0] / det
        return np.einsum("gaj,geji->geai", self.slopes, inverse), det

    def strain(self, x, v, dt):
        """Stresses after a step with the velocity v, x the places in its middle."""
        B, w = self.gradients(x)
        L = np.einsum("eai,geaj->geij", v[self.quads], B)
        volume = L[..., 0, 0] + L[..., 1, 1]
        same = (w * volume).sum(0) / w.sum(0)
        change = (same - volume) / 3
        dxx, dyy, dzz = L[..., 0, 0] + change, L[..., 1, 1] + change, change
        dxy, spin = 0.5 * (L[..., 0, 1] + L[..., 1, 0]), 0.5 * (L[..., 0, 1] - L[..., 1, 0])
        s = self.stress
        xx, yy, xy = s[..., 0], s[..., 1], s[..., 3]
        turn = np.stack([2 * spin * xy, -2 * spin * xy, 0 * spin, spin * (yy - xx)], axis=-1)
        rate = np.stack([dxx, dyy, dzz, dxy], axis=-1) * 2 * self.mu
        rate[..., :3] += self.lam * (dxx + dyy + dzz)[..., None]
        s = s + dt * (turn + rate)
        mean = s[..., :3].mean(-1)
        s[..., :3] -= mean[..., None]
        mises = np.sqrt(1.5 * ((s[..., :3] ** 2).sum(-1) + 2 * s[..., 3] ** 2))
        s *= np.minimum(1, self.strength / np.maximum(mises, 1e-300))[..., None]
        s[..., :3] += mean[..., None]
        self.stress = s

    def force(self, x):
        """Internal forces of the nodes at places x; the transpose of the strains that `strain` takes."""
        B, w = self.gradients(x)
        s = self.stress
        mean = s[..., :3].mean(-1)
        same = (w * mean).sum(0) / w.sum(0)
        shift = same - mean                                          # what the common volume change does
        P = np.empty(s.shape[:2] + (2, 2))
        P[..., 0, 0], P[..., 1, 1] = s[..., 0] + shift, s[..., 1] + shift
        P[..., 0, 1] = P[..., 1, 0] = s[..., 3]
        f = -(np.matmul(B, P) * w[..., None, None]).sum(0)
        flat, f = self.quads.ravel(), f.reshape(-1, 2)
        return np.column_stack([np.bincount(flat, f[:, k], len(x)) for k in range(2)])


def bounce_yielding(nodes, quads, density, young, poisson, strength, speed, end, stiffness=1.0):
    """The same flight of a body that yields: its mean velocity at the end over the first, and the least place of its
    centre of mass over its place at rest on the wall."""
    mesh = Yielding(nodes, quads, density, young, poisson, strength)
    x, v = nodes.copy(), np.zeros_like(nodes)
    v[:, 0] = speed
    axis = np.abs(nodes[:, 1]) < 1e-9 * np.ptp(nodes[:, 0])
    spring = stiffness * mesh.m * (mesh.speed / mesh.side) ** 2
    steps = int(np.ceil(end / (0.6 * mesh.dt)))
    dt, total, deepest = end / steps, mesh.m.sum() * speed, -np.inf
    for step in range(steps):
        f = mesh.force(x)
        f[:, 0] -= spring * np.maximum(x[:, 0], 0)
        a = f / mesh.m[:, None]
        a[axis, 1] = 0
        v = v + (dt if step else 0.5 * dt) * a
        mesh.strain(x + 0.5 * dt * v, v, dt)
        x = x + dt * v
        deepest = max(deepest, mesh.m @ x[:, 0] / mesh.m.sum())
    return mesh.m @ v[:, 0] / total, deepest
