"""Von Neumann and Richtmyer's scheme for the flyer plate: a second implementation, one-dimensional, Lagrangian, mesh
instead of particles."""
import numpy as np

RHO, C0, S, GAMMA = 8.93e-3, 3940.0, 1.489, 1.99  # copper: mm, g, ms, MPa


def mie_gruneisen(density, sound, slope, gamma):
    """p = a + b e, e per initial volume, as a function of the volume."""
    c1 = density*sound**2

    def state(v):
        mu = 1/v - 1
        cubic = mu*(c1 + mu*(c1*(2*slope - 1) + mu*c1*(slope - 1)*(3*slope - 1)))*(1 - gamma*(1 - v)/2)
        return np.where(mu > 0, cubic, c1*mu), gamma
    return state


gruneisen = mie_gruneisen(RHO, C0, S, GAMMA)  # copper


def logarithmic(bulk):
    """p = -K ln v, what the rate form of Hooke's law adds up to."""
    return lambda v: (-bulk*np.log(v), 0.0)


def free_surface(
    lower, upper, velocity, state, young, poisson, yield_stress, pmin, end, h, quadratic=1.5, linear=0.06, start=RHO,
    sound=C0,
):
    """Time and velocity of the free surface at `upper`; `velocity` and `state` are functions of position and volume,
    `start` and `sound` density and bulk sound speed at the start."""
    shear, bulk = young/(2*(1 + poisson)), young/(3*(1 - 2*poisson))
    n = round((upper - lower)/h)
    x = np.linspace(lower, upper, n + 1)
    u = velocity(x)
    node = np.full(n + 1, start*h)
    node[[0, -1]] *= 0.5
    v, e, p, s, q = np.ones(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    failed = np.zeros(n, bool)
    t, times, speeds = 0.0, [0.0], [u[-1]]
    while t < end:
        c = np.sqrt((max(bulk, start*sound**2)*(1 + 4*np.maximum(1/v - 1, 0)) + 4/3*shear)/start)
        dt = 0.25*np.min(np.diff(x)/c)
        force = np.zeros(n + 1)
        force[:-1] += s - p - q
        force[1:] -= s - p - q
        u += dt*force/node
        du = np.diff(u)
        x += dt*u
        new = np.diff(x)/h
        density = start/new
        q = np.where(du < 0, density*du*(quadratic*du - linear*c), 0.0)
        # along x; the others -s/2
        s_new = np.clip(s + 4/3*shear*dt*du/(0.5*(new + v)*h), -2/3*yield_stress, 2/3*yield_stress)
        s_new[failed] = 0.0
        a, b = state(new)
        dv = new - v
        energy = (e + (0.5*(s + s_new) - q)*dv - 0.5*dv*(p + a))/(1 + 0.5*dv*b)
        p_new = a + b*energy
        open_ = failed & (p_new < 0)
        energy[open_] += 0.5*(dv*p_new)[open_]
        p_new[open_] = 0.0
        failed |= p_new < pmin
        v, e, p, s = new, energy, p_new, s_new
        t += dt
        times.append(t)
        speeds.append(u[-1])
    return np.array(times), np.array(speeds)
