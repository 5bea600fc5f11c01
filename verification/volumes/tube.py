"""Detonation products in a tube that they half fill, by Lagrangian hydrodynamics of its own: compatible differences
(the work of the forces is the change of the energies), predictor and corrector, quadratic and linear viscosity. Nothing
of it comes from the solver."""
import numpy as np

# TNT: MPa, g/mm^3, mm/ms
A, B, R1, R2, OMEGA, ENERGY, DENSITY, SPEED = 371200, 3210, 4.15, 0.95, 0.30, 6993, 1.63e-3, 6930


def cold(v):
    """Pressure without energy at the volume v over the initial one."""
    return A*(1 - OMEGA/(R1*v))*np.exp(-R1*v) + B*(1 - OMEGA/(R2*v))*np.exp(-R2*v)


def jwl(v, energy):
    """Pressure (MPa), energy per initial volume."""
    return cold(v) + OMEGA*energy/v


def sound(v, energy):
    """Speed of sound."""
    slope = sum(k*np.exp(-r*v)*(OMEGA/(r*v*v) - r*(1 - OMEGA/(r*v))) for k, r in ((A, R1), (B, R2)))
    return np.sqrt(np.maximum((OMEGA*(jwl(v, energy) + energy/v) - v*slope)*v/DENSITY, 1.0))


def tube(cells, t_end, length=12.0, fill=6.0, cfl=0.3):
    """The charge, lit at the closed end, fills the tube and comes to rest: mean pressure over JWL of the whole, inner
    energy over that at the start, least and largest volume over the initial one."""
    x, u, energy = np.linspace(0, fill, cells + 1), np.zeros(cells + 1), np.full(cells, float(ENERGY))
    size = fill/cells
    mass = np.full(cells + 1, DENSITY*size)
    mass[[0, -1]] /= 2
    lit, arrived = np.zeros(cells), (np.arange(cells) + 0.5)*size/SPEED
    time, step, full = 0.0, 1e-7, False

    def force(x, u, energy):
        v, jump = np.diff(x)/size, np.diff(u)
        return jwl(v, energy)*lit + np.where(jump < 0, DENSITY/v*(2*jump**2 + 0.1*sound(v, energy)*abs(jump)), 0)

    def move(f, dt):
        new = u - dt*np.diff(np.concatenate([[0], f, [0]]))/mass
        new[0] = 0
        if full:
            new[-1] = 0
        mean = (u + new)/2
        return x + dt*mean, new, energy - f*np.diff(mean)*dt/size

    while time < t_end:
        if lit.min() < 1:
            lit = np.clip(np.maximum(lit, (time - arrived)*SPEED/(2*size)), 0, 1)
        step = min(cfl*np.min(np.diff(x)/(sound(np.diff(x)/size, energy) + 4*abs(np.diff(u)))), 1.1*step)
        x, u, energy = move(force(*move(force(x, u, energy), step/2)), step)
        if x[-1] >= length and not full:
            x[-1], u[-1], full = length, 0.0, True
        time += step
    v = np.diff(x)/size
    mean = (jwl(v, energy)*v).mean()*fill/x[-1]
    return mean/jwl(x[-1]/fill, energy.mean()), energy.mean()/ENERGY, v.min(), v.max()
