"""More classes of tests/fuzz/_truths.py: explosives of the library that drive metals, and plates that spall. The truth
is the Lagrangian code of _lagrange.py."""
import math
from pathlib import Path

from _lagrange import Jwl, Layer, Metal, Row
from _truths_layers import METALS, Matter, Stack, metal

LIBRARY = Path(__file__).resolve().parents[2]/"input/materials"
# Dobratz and Crawford 1985, as in input/materials: density, detonation speed, A, B, R1, R2, omega, energy.
EXPLOSIVES = {
    "anfo": (931, 4160, 49.46e9, 1.891e9, 3.907, 1.118, 0.333, 2.484e9),
    "c4": (1601, 8193, 609.77e9, 12.95e9, 4.5, 1.4, 0.25, 9.0e9),
    "pbx_9404": (1840, 8800, 852.4e9, 18.02e9, 4.6, 1.3, 0.38, 10.2e9),
    "petn": (1770, 8300, 617.1e9, 16.926e9, 4.4, 1.2, 0.25, 10.1e9),
    "tnt": (1630, 6930, 371.2e9, 3.231e9, 4.15, 0.95, 0.3, 7.0e9),
}


def explosive(name):
    """One of them, from the library; mm g ms."""
    density, speed, a, b, r1, r2, omega, energy = EXPLOSIVES[name]
    return Matter(
        name, f'include "{LIBRARY}/{name}.inp"\n',
        Jwl(density*1e-6, speed, a*1e-6, b*1e-6, r1, r2, omega, energy*1e-6), speed,
    )


class Charge(Stack):
    """An explosive of the library drives a plate, or two: velocities."""

    kinds = ("drive", "sandwich")

    def drive(self):
        """Before a wall, a plate on it."""
        burns, plate = explosive(self.luck.choice(list(EXPLOSIVES))), metal(self.luck.choice(list(METALS)))
        long, wide = self.luck.choice((4, 8)), self.luck.choice((1, 2))
        return (
            self.luck.random() < 0.5, [(burns, 0, long, 0.0), (plate, long, long + wide, 0.0)],
            self.luck.uniform(1.5, 3)*long/burns.loud,
        )

    def sandwich(self):
        """Between plates."""
        burns = explosive(self.luck.choice(list(EXPLOSIVES)))
        one, two = (metal(name) for name in self.luck.sample(list(METALS), 2))
        long = self.luck.choice((4, 8))
        return (
            False, [(one, 0, 1, 0.0), (burns, 1, 1 + long, 0.0), (two, 1 + long, 3 + long, 0.0)],
            self.luck.uniform(1.5, 3)*long/burns.loud,
        )


class Spall(Stack):
    """A plate hits a thicker one of the same metal, which spalls: velocity of what flies off it."""

    kinds = ("spall",)
    allowed = 0.1

    def spall(self):
        """Plate on plate."""
        luck = self.luck
        name = luck.choice(list(METALS))
        density, c0, s, gamma0, young, poisson, strength = METALS[name]
        v = luck.choice((200.0, 400.0, 700.0))
        self.limit = -luck.uniform(0.1, 0.75)*0.5*density*c0*v
        self.cells = luck.choice((8, 12, 20))
        self.h = 1/self.cells
        law = Metal(density, c0, s, gamma0, 0.5*young/(1 + poisson), strength)
        law.spall = self.limit
        self.speed = v
        text = metal(name).text + f"failure {name} pmin={self.limit}\n"
        self.part = 0.2
        matter = Matter(name, text, law, c0)
        return False, [(matter, 0, 1, v), (matter, 1, 3, 0.0)], luck.uniform(4.5, 8)/c0

    parting = ("spall",)

    def deck(self, space):
        return super().deck(space) + "output csv at=end fields=velocity,mass,body,initial_position\n"

    def truth(self):
        row, ends = self.row(), []
        for time in (-1, 0, 1):
            row.run(self.end + time*self.h/4500)
            ends.append(row.outer(1, self.part))
        return [(min(ends), max(ends))]

    def row(self):
        return Row([Layer(matter.law, low, high, math.ceil((high - low)*4*self.cells), v)
                    for matter, low, high, v in self.layers])

    def found(self, result):
        first = {"x": "x0", "z": "z0"}[self.axis]
        rows = [row for row in result.rows if row["body"] in (2, "b1") and row[first] > 3 - 2*self.part]
        mass = sum(row["mass"] for row in rows)
        return [sum(row["mass"]*row[f"velocity_{self.axis}"] for row in rows)/mass]

    def errors(self, results):
        (low, high), = self.truth()
        v, = self.found(results[0])
        return [("velocity of the spall", (v - min(max(v, low), high))/self.speed, self.allowed)]


CLASSES = (Charge, Spall)
