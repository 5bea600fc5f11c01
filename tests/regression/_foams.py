"""Deshpande and Fleck's foam along a path of uniaxial strain, as a second implementation: rates of stress and of the
plastic strain, by Runge and Kutta's method in short steps; where the program solves for the end of a step.
"""
import math


def crushed(c, volumes, substeps):
    """Pressure, von Mises stress and plastic strain at volumes over the initial one; in between the logarithm is
    linear."""
    bulk, shear3 = c["young"]/(3*(1 - 2*c["poisson"])), 1.5*c["young"]/(1 + c["poisson"])
    sideways = c.get("plastic_poisson", 0.0)
    shape = 4.5*(1 - 2*sideways)/(1 + sideways)

    def curve(e):
        r = e/c["densification_strain"]
        late = (
            c["densification"] * math.log(1 / (1 - r ** c.get("densification_exponent", 1.0)))
            if "densification" in c
            else 0.0
        )
        return c["plateau"] + c.get("linear_hardening", 0.0)*r + late

    def equivalent(mean, q):
        return math.sqrt((q*q + shape*mean*mean)/(1 + shape/9))

    def rates(s, strain, yields):
        """Of mean stress, signed deviator and plastic strain by that of the axial strain."""
        mean, q, e = s
        size = equivalent(mean, q)
        along_mean, along_q = shape*mean/((1 + shape/9)*size), q/((1 + shape/9)*size)
        push = bulk*along_mean*strain + shear3*along_q*2/3*strain
        hardening = (curve(e + 1e-7) - curve(e - min(e, 1e-7)))/(1e-7 + min(e, 1e-7))
        flow = push/(bulk*along_mean**2 + shear3*along_q**2 + hardening) if yields else 0.0
        return [bulk*(strain - flow*along_mean), shear3*(2/3*strain - flow*along_q), flow], push

    def advance(state, strain, halvings):
        """State after an axial strain; a step in which it begins to yield is halved down to that point."""
        if equivalent(*state[:2]) == 0:
            elastic, yields = [bulk*strain, 2/3*shear3*strain, 0.0], False
            new = [s + k for s, k in zip(state, elastic)]
        else:
            yields = equivalent(*state[:2]) >= curve(state[2])*(1 - 1e-9) and rates(state, strain, True)[1] > 0
            k1, _ = rates(state, strain, yields)
            k2, _ = rates([s + k/2 for s, k in zip(state, k1)], strain, yields)
            k3, _ = rates([s + k/2 for s, k in zip(state, k2)], strain, yields)
            k4, _ = rates([s + k for s, k in zip(state, k3)], strain, yields)
            new = [s + (a + 2*b + 2*d + e)/6 for s, a, b, d, e in zip(state, k1, k2, k3, k4)]
        if not yields and halvings and equivalent(*new[:2]) > curve(new[2]):
            return advance(advance(state, strain/2, halvings - 1), strain/2, halvings - 1)
        if yields:  # what the steps have left beside the ellipsoid
            scale = curve(new[2])/equivalent(*new[:2])
            new = [scale*new[0], scale*new[1], new[2]]
        return new

    state = [0.0, 0.0, 0.0]
    found = [(0.0, 0.0, 0.0)]
    for before, after in zip(volumes, volumes[1:]):
        for _ in range(substeps):
            state = advance(state, math.log(after/before)/substeps, 20)
        found.append((-state[0], abs(state[1]), state[2]))
    return found
