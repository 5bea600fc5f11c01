"""A second implementation: a sphere (or slab) of TNT in air by Lagrangian hydrodynamics in one dimension: compatible
differences (the work of the forces is the change of the energies), predictor and corrector, quadratic and linear
viscosity. Nothing of it comes from the solver."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "volumes"))
import numpy as np  # noqa: E402
from tube import DENSITY, ENERGY, SPEED, jwl, sound  # noqa: E402

AIR, GAMMA, AMBIENT = 1.225e-6, 1.4, 0.101325  # g/mm^3, MPa


def merge(k, x, u, energy, start, density, matter, tnt, lit, arrived):
    """Makes one of the shells k and k + 1: mass, momentum and energy stay, the kinetic energy that goes becomes
    heat."""
    mass = 0.5*(np.concatenate([[0], matter]) + np.concatenate([matter, [0]]))
    before, joined = 0.5*mass[k:k + 3] @ u[k:k + 3]**2, matter[k] + matter[k + 1]
    u, heat = u.copy(), start[k:k + 2] @ energy[k:k + 2]
    below, above = mass[k] + 0.5*matter[k + 1], mass[k + 2] + 0.5*matter[k]
    u[k] = (mass[k]*u[k] + 0.5*matter[k + 1]*u[k + 1])/below
    u[k + 2] = (mass[k + 2]*u[k + 2] + 0.5*matter[k]*u[k + 1])/above
    heat += before - 0.5*(below*u[k]**2 + above*u[k + 2]**2)
    volume = start[k] + start[k + 1]
    start, energy, matter = (np.delete(a, k + 1) for a in (start, energy, matter))
    start[k], energy[k], matter[k] = volume, heat/volume, joined
    return (
        np.delete(x, k + 1), np.delete(u, k + 1), energy, start, *(np.delete(a, k + 1) for a in (density,)), matter,
        *(np.delete(a, k + 1) for a in (tnt, lit, arrived)),
    )


def blast(cells, radius, outer, t_end, stations, sphere=True, cfl=0.4, stretch=1.0, burns=(0.0, 1.0)):
    """The charge, of `cells` shells, lit at its centre, in air to `outer`. Times, pressures at the stations and of the
    air that was there at the start, the outer radius of the products, and the shells at the end. Shells of air widen by
    the factor `stretch` from one to the next; those that the expansion makes thinner than a tenth of the charge's are
    merged. `burns`: afterburn, energy per initial volume, given evenly in a time after lighting."""
    width = [radius/cells]
    while sum(width) < outer - radius:
        width.append(width[-1]*stretch)
    x = np.concatenate([np.linspace(0, radius, cells + 1), radius + np.cumsum(width)])
    n, power = len(x) - 1, 3 if sphere else 1
    tnt = np.arange(n) < cells

    def volumes(x):
        return np.diff(x**power)/power

    def areas(x):
        return x**(power - 1)

    start = volumes(x)
    density = np.where(tnt, DENSITY, AIR)
    matter = density*start
    mass = 0.5*(np.concatenate([[0], matter]) + np.concatenate([matter, [0]]))
    energy, u = np.where(tnt, ENERGY, AMBIENT/(GAMMA - 1)), np.zeros(n + 1)  # per initial volume
    arrived = 0.5*(x[1:] + x[:-1])/SPEED
    lit = np.where(tnt, 0.0, 1.0)
    out, rows, edges = [], [], []
    marked = np.interp(stations, x, np.concatenate([[0], np.cumsum(matter)]))  # the mass inside: it stays

    def state(v, energy):
        products, air = v[:cells], v[cells:]
        pressure = np.concatenate([jwl(products, energy[:cells])*lit[:cells], (GAMMA - 1)*energy[cells:]/air])
        speed = np.concatenate([sound(products, energy[:cells]), np.sqrt(GAMMA*(GAMMA - 1)*energy[cells:]/AIR)])
        return pressure, speed

    def force(x, u, energy):
        v, jump = volumes(x)/start, np.diff(u)
        p, c = state(v, energy)
        # The divergence, not the jump alone, says whether a shell is compressed.
        shrinks = (jump < 0) & (np.diff(areas(x)*u) < 0)
        return p + np.where(shrinks, density/v*(2*jump**2 + 0.2*c*abs(jump)), 0)

    def move(x0, u0, e0, f, xm, dt):
        area = areas(xm)
        push = np.concatenate([[0], f]) - np.concatenate([f, [AMBIENT]])
        new = u0 + dt*area*push/mass
        new[0] = 0
        mean = 0.5*(u0 + new)
        return x0 + dt*mean, new, e0 - dt*f*np.diff(area*mean)/start

    time, step = 0.0, 1e-7
    while time < t_end:
        if lit.min() < 1:
            width0 = radius/cells
            lit = np.where(tnt, np.clip(np.maximum(lit, (time - arrived)*SPEED/(2*width0)), 0, 1), 1.0)
        p, c = state(volumes(x)/start, energy)
        out.append(time)
        inside = np.cumsum(matter) - 0.5*matter
        rows.append([np.interp(stations, 0.5*(x[1:] + x[:-1]), p), np.interp(marked, inside, p)])
        edges.append(x[cells])
        step = min(cfl*np.min(np.diff(x)/(c + 4*abs(np.diff(u)))), 1.05*step)
        f = force(x, u, energy)
        xh, uh, eh = move(x, u, energy, f, x, 0.5*step)
        f = force(xh, uh, eh)
        x, u, energy = move(x, u, energy, f, xh, step)
        given = np.diff([np.clip((t - arrived)/burns[1], 0, 1) for t in (time, time + step)], axis=0)[0]
        energy = energy + np.where(tnt, burns[0]*given, 0.0)
        time += step
        thin = cells + np.argmin(np.diff(x)[cells:-1])
        if x[thin + 1] - x[thin] < 0.1*radius/cells:
            x, u, energy, start, density, matter, tnt, lit, arrived = merge(
                thin, x, u, energy, start, density, matter, tnt, lit, arrived
            )
            mass = 0.5*(np.concatenate([[0], matter]) + np.concatenate([matter, [0]]))
    return np.array(out), np.array(rows), np.array(edges), (x, u, energy, volumes(x)/start)
