"""Modified Cam-clay along a path of uniaxial strain, as a second implementation: rates of stress and of the
preconsolidation, by Runge and Kutta's method in short steps; where the program solves for the end of a step.
"""
import math


def consolidated(c, times, volumes, substeps):
    """Pressure, von Mises stress, plastic shear strain and preconsolidation at times when the volume over the initial
    one is known, which is linear in between."""
    ratio, slope, kappa, start = c["critical_ratio"], c["compression_slope"], c["swelling_slope"], 1 + c["void_ratio"]
    stiff = 3*(1 - 2*c["poisson"])/(2*(1 + c["poisson"]))
    least = c.get("least_pressure", c["pressure0"]/1000)
    p, q, plastic = c["pressure0"], 0.0, 0.0
    hardened = c.get("preconsolidation", p*c.get("overconsolidation", 1.0))

    def ellipse(p, q):
        """Preconsolidation of a stress that yields."""
        return p + (q/ratio)**2/p

    def rates(s, v, rate, yields):
        """Of pressure, deviator and plastic strain by that of the specific volume. The deviator is positive where
        compressed."""
        p, q, _ = s
        volume_rate = -rate/v                # compression positive
        shear_rate = 2/3*volume_rate
        bulk = v*max(p, least)/kappa
        shear3 = 3*stiff*bulk
        pc = ellipse(p, q)
        along_p, along_q = 2*p - pc, 2*q/ratio**2
        push = along_p*bulk*volume_rate + along_q*shear3*shear_rate
        flow = push/(bulk*along_p**2 + shear3*along_q**2 + p*pc*v/(slope - kappa)*along_p) if yields else 0.0
        return [bulk*(volume_rate - flow*along_p), shear3*(shear_rate - flow*along_q), flow*abs(along_q)], push

    def advance(p, q, plastic, hardened, v, change, halvings):
        """State when the specific volume has changed; a step in which it begins to yield is halved down to that
        point."""
        state = [p, q, plastic]
        yields = ellipse(p, q) >= hardened*(1 - 1e-9) and rates(state, v, change, True)[1] > 0
        k1, _ = rates(state, v, change, yields)
        k2, _ = rates([s + k/2 for s, k in zip(state, k1)], v + change/2, change, yields)
        k3, _ = rates([s + k/2 for s, k in zip(state, k2)], v + change/2, change, yields)
        k4, _ = rates([s + k for s, k in zip(state, k3)], v + change, change, yields)
        new = [s + (a + 2*b + 2*d + e)/6 for s, a, b, d, e in zip(state, k1, k2, k3, k4)]
        if not yields and halvings and ellipse(*new[:2]) > hardened:
            middle = advance(p, q, plastic, hardened, v, change/2, halvings - 1)
            return advance(*middle, v + change/2, change/2, halvings - 1)
        new[0] = max(new[0], least)
        return *new, ellipse(*new[:2]) if yields else hardened

    state = (p, q, plastic, hardened)
    found = [state]
    for i in range(1, len(times)):
        change = start*(volumes[i] - volumes[i - 1])/substeps
        for part in range(substeps):
            state = advance(*state, start*volumes[i - 1] + change*part, change, 20)
        found.append((state[0], abs(state[1]), *state[2:]))
    return found
