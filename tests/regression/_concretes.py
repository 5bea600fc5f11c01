"""Holmquist, Johnson and Cook's concrete along a path of uniaxial strain, as a second implementation: damage, strength
and pressure of a step agree with each other at its end, in shorter steps; compaction is what is kept, not the greatest
compression."""
import math

from _ceramics import flow_of


def dense_curve(c, mu):
    x = (mu - c["lock_compression"])/(1 + c["lock_compression"])
    return c["k1"]*x + (c.get("k2", 0.0)*x**2 + c.get("k3", 0.0)*x**3 if x > 0 else 0.0)


def locked(c):
    """Compression at which dense material bears the pressure that closes the pores."""
    low, high = c["lock_compression"], c["lock_compression"] + 1
    for _ in range(100):
        middle = (low + high)/2
        low, high = (middle, high) if dense_curve(c, middle) < c["lock_pressure"] else (low, middle)
    return high


class Pores:
    """What is left of the compression without pressure, and the pressure with it."""

    def __init__(self, c):
        self.c, self.end = c, locked(c)
        self.stiff = c["crush_pressure"]/c["crush_compression"]
        self.last = c["lock_pressure"]/(self.end - c["lock_compression"])

    def bound(self, part):
        """Compression and pressure after this part of the crushing, and the modulus of what is let go there."""
        c = self.c
        return (c["crush_compression"] + part*(self.end - c["crush_compression"]),
                c["crush_pressure"] + part*(c["lock_pressure"] - c["crush_pressure"]),
                self.stiff + part*(self.last - self.stiff))

    def left(self, part):
        mu, pressure, modulus = self.bound(part)
        return mu - pressure/modulus

    def part_of(self, mu, part):
        """Part that is crushed after mu, where it was `part` before."""
        first, last = self.bound(0.0)[0], self.end
        return min(1.0, max(part, (mu - first)/(last - first)))

    def pressure(self, mu, part):
        if part >= 1:
            return dense_curve(self.c, mu)
        return self.bound(part)[2]*(mu - self.left(part))


def strength(c, pressure, rate, damage):
    over = pressure/c["compressive_strength"]
    if over > 0:
        value = c["cohesive_strength"]*(1 - damage) + c["pressure_hardening"]*over**c["pressure_exponent"]
    else:
        part = pressure/c["tension_limit"] if c["tension_limit"] > 0 else 0.0
        value = c["cohesive_strength"]*max(0.0, 1 - damage + part)
    value *= 1 + c.get("rate_coefficient", 0.0)*math.log(max(1.0, rate/c.get("reference_rate", 1.0)))
    return c["compressive_strength"]*min(value, c.get("strength_limit", math.inf))


def between(times, volumes, i, part):
    """The cubic through the volumes at four times, between the times i - 1 and i: strength goes with the rate, which is
    nothing where the path turns."""
    first = max(0, min(i - 2, len(times) - 4))
    known = range(first, min(first + 4, len(times)))
    time = times[i - 1] + part*(times[i] - times[i - 1])
    return sum(volumes[k]*math.prod((time - times[j])/(times[k] - times[j]) for j in known if j != k) for k in known)


def crushed(c, times, volumes, substeps):
    """Pressure, von Mises stress, plastic strain, damage and compression at times when the volume is known."""
    pores, shear = Pores(c), c["shear_modulus"]
    axial = plastic = damage = pressure = part = greatest = 0.0
    found = [(0.0,)*5]
    for i in range(1, len(times)):
        dt = (times[i] - times[i - 1])/substeps
        for n in range(substeps):
            first, v = (between(times, volumes, i, (n + later)/substeps) for later in (0, 1))
            strain, mu = math.log(v/first), 1/v - 1
            axial += 4/3*shear*strain
            trial, rate = 1.5*abs(axial), 2/3*abs(strain)/dt
            now = pores.part_of(mu, part)
            closed = pores.left(now) - pores.left(part)
            curve, part, greatest = pores.pressure(mu, now), now, max(greatest, mu)

            def after(flow):
                """Strength and damage if this is the plastic strain of the step."""
                grown = damage
                for _ in range(4 if flow + closed > 0 else 0):
                    bears = max(curve, -c["tension_limit"]*(1 - grown))
                    base = (bears + c["tension_limit"])/c["compressive_strength"]
                    fatal = max(c.get("least_damage_strain", 0.0),
                                c["damage_strain"]*max(base, 0.0)**c.get("damage_exponent", 1.0))
                    grown = min(1.0, damage + (flow + closed)/fatal)
                return strength(c, max(curve, -c["tension_limit"]*(1 - grown)), rate, grown), grown
            flow = 0.0
            if trial > after(0.0)[0]:
                flow = flow_of(trial, 3*shear, lambda strain: after(strain)[0])
                axial *= (trial - 3*shear*flow)/trial
                plastic += flow
            damage = after(flow)[1]
            pressure = max(curve, -c["tension_limit"]*(1 - damage))
        found.append((pressure, 1.5*abs(axial), plastic, damage, greatest))
    return found
