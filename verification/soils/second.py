"""A second implementation: a column of sand (Drucker and Prager's, without cohesion and dilatancy) that collapses over
a rough floor, plane or round, by the material point method with the functions of mpm or gimp, plainly or with the
change of volume and the mean stress averaged over the particles of a cell.

Sand that flows without dilatancy keeps its volume. Plain mpm and gimp ask that of each particle, which are more than
the nodes can take: the heap locks, the more the more particles there are in a cell. Averaged, a cell asks it once.

    python3 verification/soils/second.py

prints a table of both; needs numpy alone. Lengths in half widths (radii), times in roots of them over gravity, stresses
in density times gravity times them.
"""
import numpy as np

YOUNG, POISSON, END, COURANT = 500.0, 0.3, 6.0, 0.4
BULK, SHEAR = YOUNG/3/(1 - 2*POISSON), YOUNG/2/(1 + POISSON)
BEHIND = 1  # rows of nodes behind the walls


def functions(place, half):
    """Weights of three nodes along an axis, and their slopes (per cell): linear functions averaged over a particle of
    half size `half` (cells)."""
    base = np.floor(place - 0.5).astype(int)
    weights, slopes = [], []
    for k in range(3):
        d = place - base - k
        far, sign = np.abs(d), np.sign(d)
        weights.append(
            np.select(
                [far < half, far < 1 - half, far < 1 + half],
                [1 - (d * d + half * half) / (2 * half), 1 - far, (1 + half - far) ** 2 / (4 * half)], 0.0,
            )
        )
        slopes.append(
            np.select(
                [far < half, far < 1 - half, far < 1 + half], [-d / half, -sign, -sign * (1 + half - far) / (2 * half)],
                0.0,
            )
        )
    return base, weights, slopes


def yielded(stress, ratio):
    """Stress returned to q = ratio p; none where there is no pressure."""
    mean = stress[:3].mean(axis=0)
    pressure = np.maximum(-mean, 0)
    deviator = stress.copy()
    deviator[:3] -= mean
    norm = np.sqrt(1.5*((deviator[:3]**2).sum(axis=0) + 2*deviator[3]**2))
    stress = deviator*np.where(norm > ratio*pressure, ratio*pressure/np.maximum(norm, 1e-300), 1.0)
    stress[:3] -= pressure
    return stress


def collapse(cells, per_cell, friction, height=2.0, ring=False, averaged=False, half=None):
    """Places, masses and volumes of the particles in the end; `half` is the half size of a particle in cells, by
    default gimp's (mpm: 1e-9)."""
    h = 1/cells
    half = 0.5/per_cell if half is None else half
    spacing = h/per_cell
    x, y = (
        a.ravel()
        for a in np.meshgrid(
            (np.arange(cells * per_cell) + 0.5) * spacing,
            (np.arange(round(height * cells * per_cell)) + 0.5) * spacing, indexing="ij",
        )
    )
    mass = (x if ring else np.ones_like(x))*spacing**2
    volume, u, v, stress = mass.copy(), np.zeros_like(x), np.zeros_like(x), np.zeros((4, len(x)))
    ratio = 6*np.sin(np.radians(friction))/(3 - np.sin(np.radians(friction)))
    wide, tall = 8*cells + 3, int(height + 1)*cells + 3
    column, row = np.divmod(np.arange(wide*tall), tall)
    middle, floor = column <= BEHIND, row <= BEHIND
    dt = COURANT*h/np.sqrt(BULK + 4/3*SHEAR)
    for _ in range(int(np.ceil(END/dt))):
        (i, wx, sx), (j, wy, sy) = functions(x/h, half), functions(y/h, half)
        nodes = np.array([(i + a + BEHIND)*tall + j + b + BEHIND for a in range(3) for b in range(3)])
        w = np.array([wx[a]*wy[b] for a in range(3) for b in range(3)])
        gx = np.array([sx[a]*wy[b] for a in range(3) for b in range(3)])/h
        gy = np.array([wx[a]*sy[b] for a in range(3) for b in range(3)])/h
        cell = np.floor(x/h).astype(int)*tall + np.floor(y/h).astype(int)

        def gather(values, nodes=nodes):
            return np.bincount(nodes.ravel(), weights=values.ravel(), minlength=wide*tall)

        def mean_of_cell(values, cell=cell):
            return (
                np.bincount(cell, weights=volume * values, minlength=wide * tall)
                / np.maximum(np.bincount(cell, weights=volume, minlength=wide * tall), 1e-300)
            )[cell]

        load = stress.copy()
        if averaged:
            mean = load[:3].mean(axis=0)
            load[:3] += mean_of_cell(mean) - mean
        nodal = gather(w*mass)
        inverse = np.where(nodal > 1e-12*mass.max(), 1/np.maximum(nodal, 1e-300), 0.0)
        across = w*(load[2]*volume/x) if ring else 0*w
        ax = -gather(volume*(gx*load[0] + gy*load[3]) + across)*inverse
        ay = -gather(volume*(gx*load[3] + gy*load[1]))*inverse - 1
        vx, vy = gather(w*mass*u)*inverse, gather(w*mass*v)*inverse
        for held in (ax, vx):
            held[middle | floor] = 0
        for held in (ay, vy):
            held[floor] = 0
        u, v = u + dt*(w*ax[nodes]).sum(axis=0), v + dt*(w*ay[nodes]).sum(axis=0)
        x, y = x + dt*(w*(vx + dt*ax)[nodes]).sum(axis=0), y + dt*(w*(vy + dt*ay)[nodes]).sum(axis=0)
        vx, vy = gather(w*mass*u)*inverse, gather(w*mass*v)*inverse
        vx[middle | floor] = 0
        vy[floor] = 0
        xx, xy, yx, yy = (dt*(g*c[nodes]).sum(axis=0) for c in (vx, vy) for g in (gx, gy))
        zz = dt*(w*vx[nodes]).sum(axis=0)/x if ring else 0*xx
        trace = xx + yy + zz
        if averaged:
            shift = mean_of_cell(trace) - trace
            xx, yy, zz = (xx + shift/3, yy + shift/3, zz + shift/3) if ring else (xx + shift/2, yy + shift/2, zz)
            trace = trace + shift
        turn, shear = 0.5*(xy - yx), xy + yx
        lame = (BULK - 2/3*SHEAR)*trace
        a, b, c, d = stress
        stress = yielded(
            np.array(
                [
                    a + 2 * turn * d + lame + 2 * SHEAR * xx, b - 2 * turn * d + lame + 2 * SHEAR * yy,
                    c + lame + 2 * SHEAR * zz, d + turn * (b - a) + SHEAR * shear,
                ]
            ),
            ratio,
        )
        volume = volume*((1 + xx)*(1 + yy) - xy*yx)*(1 + zz)
        x, y = np.clip(x, 1e-6, (wide - 4)*h), np.clip(y, 1e-6, (tall - 4)*h)
    return x, y, mass, volume


def within(x, mass, ring):
    """Mean height of what lies within half of the half width (radius), and the front of 99 % of the mass."""
    order = np.argsort(x)
    return mass[x < 0.5].sum() / (0.125 if ring else 0.5), x[order][
        np.searchsorted(np.cumsum(mass[order]) / mass.sum(), 0.99)
    ]


def main():
    print(
        "column of height   functions  particles    plain: top, within half, front       averaged: top, within "
        "half, front"
    )
    for ring, height in ((False, 2.0), (True, 1.0)):
        for name, half in (("mpm", 1e-9), ("gimp", None)):
            for per_cell in (2, 3, 4):
                line = f"{'round' if ring else 'plane'} {height:g}            {name:5}      {per_cell}         "
                for averaged in (False, True):
                    x, y, mass, _ = collapse(8, per_cell, 26.3, height, ring, averaged, half)
                    line += "{:.3f} {:.3f} {:.2f}                 ".format(y.max(), *within(x, mass, ring))
                print(line, flush=True)


if __name__ == "__main__":
    main()
