"""More classes of tests/fuzz/_truths.py: gas, explosives and metals in layers. The truth is a Lagrangian code in one
dimension of its own (_lagrange.py), on cells four times finer and more."""
import math

from _lagrange import Gas, Jwl, Layer, Metal, Row
from _truths import Truth, body_end

METALS = {  # density, c0, s, gamma0, Young's modulus, Poisson's ratio, yield stress; mm g ms
    "steel": (7.83e-3, 4569, 1.49, 1.93, 207000, 0.29, 500),
    "copper": (8.93e-3, 3940, 1.49, 2.0, 120000, 0.34, 200),
    "aluminium": (2.7e-3, 5328, 1.34, 2.0, 70000, 0.33, 300),
}
TNT = (1.63e-3, 6930, 371200, 3210, 4.15, 0.95, 0.30, 6993)


class Matter:
    """A material of both codes."""

    def __init__(self, name, text, law, loud):
        self.name, self.text, self.law, self.loud = name, text, law, loud  # loud: speed of its waves


def metal(name):
    """One of METALS."""
    density, c0, s, gamma0, young, poisson, strength = METALS[name]
    return Matter(
        name,
        f"material {name} johnson_cook density={density} young={young} poisson={poisson} yield={strength}\n"
        f"eos {name} gruneisen c0={c0} s={s} gamma0={gamma0}\n",
        Metal(density, c0, s, gamma0, 0.5*young/(1 + poisson), strength), c0,
    )


def gas(name, density, pressure, gamma=1.4):
    """An ideal gas."""
    return Matter(
        name, f"material {name} fluid density={density}\neos {name} ideal_gas gamma={gamma} pressure0={pressure}\n",
        Gas(density, gamma, pressure), math.sqrt(gamma*pressure/density),
    )


def tnt():
    """TNT."""
    density, speed, a, b, r1, r2, omega, energy = TNT
    return Matter(
        "tnt",
        f"material tnt explosive density={density} detonation_speed={speed}\n"
        f"eos tnt jwl a={a} b={b} r1={r1} r2={r2} omega={omega} energy0={energy}\n", Jwl(*TNT), speed,
    )


class Stack(Truth):
    """Layers in a row, at rest or thrown, in a line, a strip, a column about the axis or in space: velocities of the
    metals."""

    kinds = ("gun", "drive", "sandwich", "blast", "plates", "cushion")
    parting = ("plates",)  # bounces
    allowed = 0.05

    def make(self):
        luck = self.luck
        self.kind = luck.choice(self.kinds)
        self.cells = luck.choice((4, 6, 8))  # of the thinnest metal
        self.h = 1/self.cells
        walls, layers, wait = getattr(self, self.kind)()
        self.layers, self.lower_wall = layers, walls
        self.end = wait
        self.metals = [i for i, layer in enumerate(layers) if layer[0].name in METALS]
        self.decks = [self.deck(luck.choice(("1", "1", "2", "axisymmetric", "3")))]

    def gun(self):
        """Gas between a wall and a plate."""
        plate, long = metal(self.luck.choice(list(METALS))), self.luck.choice((4, 8))
        push = gas("gas", self.luck.choice((0.1e-3, 0.5e-3)), self.luck.choice((50.0, 500.0)))
        return True, [(push, 0, long, 0.0), (plate, long, long + 1, 0.0)], self.luck.uniform(0.5, 1.5)*long/push.loud

    def drive(self):
        """Explosive before a wall, a plate on it."""
        plate, long = metal(self.luck.choice(list(METALS))), self.luck.choice((4, 8))
        wide = self.luck.choice((1, 2))
        return (
            self.luck.random() < 0.5, [(tnt(), 0, long, 0.0), (plate, long, long + wide, 0.0)],
            self.luck.uniform(1.5, 3)*long/6930,
        )

    def sandwich(self):
        """Explosive between plates."""
        one, two = (metal(name) for name in self.luck.sample(list(METALS), 2))
        long = self.luck.choice((4, 8))
        return (
            False, [(one, 0, 1, 0.0), (tnt(), 1, 1 + long, 0.0), (two, 1 + long, 3 + long, 0.0)],
            self.luck.uniform(1.5, 3)*long/6930,
        )

    def blast(self):
        """Explosive, dense gas, a plate."""
        plate, long = metal(self.luck.choice(list(METALS))), self.luck.choice((2, 4))
        gap = self.luck.choice((2, 4))
        air = gas("air", self.luck.choice((5e-6, 5e-5)), 0.1)
        return (
            True,
            [(tnt(), 0, long, 0.0), (air, long, long + gap, 0.0), (plate, long + gap, long + gap + 1, 0.0)],
            (long + gap)/6930*self.luck.uniform(2, 4),
        )

    def plates(self):
        """A plate that flies at one or two."""
        names = self.luck.sample(list(METALS), 3)
        v, gap = self.luck.choice((100.0, 500.0, 1500.0, 3000.0)), self.luck.choice((0.0, 0.4, 1.3))
        wide = self.luck.choice((1, 2))
        layers = [(metal(names[0]), 0, 1, v), (metal(names[1]), 1 + gap, 1 + gap + wide, 0.0)]
        if self.luck.random() < 0.5:
            layers.append((metal(names[2]), 1 + gap + wide, 3 + gap + wide, 0.0))
        return False, layers, gap/v + self.luck.uniform(1, 3)*(1 + wide)/4500

    def cushion(self):
        """A plate that flies at another, and a gas between them."""
        one, two = (metal(name) for name in self.luck.sample(list(METALS), 2))
        v, gap = self.luck.choice((100.0, 300.0)), self.luck.choice((2, 4))
        air = gas("air", 0.5e-3, self.luck.choice((1.0, 20.0)))
        return (
            False, [(one, 0, 1, v), (air, 1, 1 + gap, 0.0), (two, 1 + gap, 2 + gap, 0.0)],
            gap/v*self.luck.uniform(0.4, 0.7),
        )

    def deck(self, space):
        """The scene in a space."""
        luck, h = self.luck, self.h
        wide = luck.choice((3, 4))*h
        axis = "z" if space == "axisymmetric" else "x"
        self.axis = axis
        lower = f"{axis}=0:open" if self.lower_wall else f"{axis}=open"
        wall = [f"{axis}-=slip"] if self.lower_wall else []
        grid, corner = {
            "1": (lower, "{}"),
            "2": (f"{lower} y=0:{wide}", "({},{})"),
            "axisymmetric": (f"r=0:{wide} {lower}", "({1},{0})"),
            "3": (f"{lower} y=0:{wide} z=0:{wide}", "({0},{1},{1})"),
        }[space]
        wall += {"1": [], "2": ["y-=slip", "y+=slip"], "axisymmetric": ["r+=slip"],
                 "3": ["y-=slip", "y+=slip", "z-=slip", "z+=slip"]}[space]
        names, text, bodies = set(), "", ""
        for i, (matter, low, high, v) in enumerate(self.layers):
            if matter.name not in names:
                names.add(matter.name)
                text += matter.text
            bodies += (
                f"body b{i} block material={matter.name} lower={corner.format(low, 0)} "
                f"upper={corner.format(high, wide)} ppc=2\n"
            )
            bodies += f"velocity b{i} {axis}={v}\n" if v else ""
            if isinstance(matter.law, Jwl):
                place = self.light(low, high)
                at = {"1": "{}", "2": "({},0)", "axisymmetric": "(0,{})", "3": "({},0,0)"}[space].format(place)
                bodies += f"detonation point={at}\n" if space == "1" else f"detonation {self.plane(space, place)}\n"
        contact = "contact all\n" if self.kind in self.parting else luck.choice(("", "contact all\n"))
        return f"""units mm g ms
dimension {space}
grid cell={h} {grid}
{'wall ' + ' '.join(wall) if wall else ''}
METHOD
time end={self.end} cfl={luck.choice((0.2, 0.4))}
{text}viscosity all
{bodies}{contact}history steps=50
"""

    def light(self, low, high):
        """Where the explosive begins to burn."""
        self.lit = self.luck.choice((low, high)) if self.kind != "blast" else low
        return self.lit

    @staticmethod
    def plane(space, place):
        """A wave from a plane."""
        return {
            "2": f"point=({place},0) normal=(1,0)", "axisymmetric": f"point=(0,{place}) normal=(0,1)",
            "3": f"point=({place},0,0) normal=(1,0,0)",
        }[space]

    def row(self):
        """The scene of the other code."""
        return Row(
            [Layer(matter.law, low, high, max(40, math.ceil((high - low)*4*self.cells)), v,
                   self.lit if isinstance(matter.law, Jwl) else None) for matter, low, high, v in self.layers],
            left=0.0 if self.lower_wall else None,
        )

    def truth(self):
        """Least and largest velocities by the other code, a wave's time through a cell before and after the end."""
        row, ends = self.row(), []
        for time in (-1, 0, 1):
            row.run(self.end + time*self.h/4500)
            ends.append([row.velocity(i) for i in self.metals])
        return [(min(of), max(of)) for of in zip(*ends)]

    def found(self, result):
        """The same of a run."""
        return [body_end(result, f"b{i}", f"velocity_{self.axis}") for i in self.metals]

    def errors(self, results):
        truth = self.truth()
        scale = max([abs(v) for pair in truth for v in pair] + [abs(v) for *_, v in self.layers])
        return [
            (f"{self.kind}: velocity of {self.layers[i][0].name}", (v - min(max(v, low), high))/scale,
             self.allowed)
            for i, v, (low, high) in zip(self.metals, self.found(results[0]), truth)
        ]


class Shell(Stack):
    """Layers about an axis or a point: explosive or gas, in a part of them air, in a tube or a hollow ball of metal."""

    kinds = ("vessel", "bomb", "chamber")
    allowed = 0.08  # it still speeds up at the end

    def vessel(self):
        """Gas under pressure in metal."""
        shell, inner = metal(self.luck.choice(list(METALS))), self.luck.choice((2, 4))
        push = gas("gas", self.luck.choice((0.1e-3, 0.5e-3)), self.luck.choice((100.0, 1000.0)))
        return True, [(push, 0, inner, 0.0), (shell, inner, inner + 1, 0.0)], self.luck.uniform(1, 3)*inner/4500

    def bomb(self):
        """Explosive in metal."""
        shell, inner = metal(self.luck.choice(list(METALS))), self.luck.choice((2, 4))
        return True, [(tnt(), 0, inner, 0.0), (shell, inner, inner + 1, 0.0)], self.luck.uniform(1.5, 3)*inner/6930

    def chamber(self):
        """Explosive in dense gas in metal."""
        shell, inner = metal(self.luck.choice(list(METALS))), self.luck.choice((1, 2))
        gap = self.luck.choice((1, 2))
        air = gas("air", self.luck.choice((5e-6, 5e-5)), 0.1)
        return (
            True, [(tnt(), 0, inner, 0.0), (air, inner, inner + gap, 0.0), (shell, inner + gap, inner + gap + 1, 0.0)],
            (inner + gap)/6930*self.luck.uniform(2.5, 4),
        )

    def light(self, low, high):
        self.lit = 0.0
        return 0.0

    def row(self):
        return Row(
            [Layer(matter.law, low, high, max(40, math.ceil((high - low)*4*self.cells)), 0.0,
                   0.0 if isinstance(matter.law, Jwl) else None) for matter, low, high, _ in self.layers],
            order=2 if self.space != "2" else 1,
        )

    def deck(self, space):
        """A quarter or an eighth of the scene between walls."""
        luck, h = self.luck, self.h
        self.space = space = luck.choice(("2", "2", "axisymmetric", "axisymmetric", "3") if self.cells < 6 else (
            "2", "axisymmetric"))
        grid, wall = {
            "2": ("x=0:open y=0:open", "x-=slip y-=slip"), "axisymmetric": ("r=0:open z=0:open", "z-=slip"),
            "3": ("x=0:open y=0:open z=0:open", "x-=slip y-=slip z-=slip"),
        }[space]
        text, bodies = "", ""
        corner = "(9,9)" if space != "3" else "(9,9,9)"
        origin = "(0,0)" if space != "3" else "(0,0,0)"
        for i, (matter, low, high, _) in enumerate(self.layers):
            text += matter.text
            bodies += f"body b{i} sphere material={matter.name} radius={high} ppc=2\n"
            bodies += f"subtract b{i} sphere radius={low}\n" if low else ""
            bodies += f"intersect b{i} block lower={origin} upper={corner}\n"
            bodies += f"detonation point={origin}\n" if isinstance(matter.law, Jwl) else ""
        return f"""units mm g ms
dimension {space}
grid cell={h} {grid}
wall {wall}
METHOD
time end={self.end} cfl={luck.choice((0.2, 0.4))}
{text}viscosity all
{bodies}{luck.choice(("", "contact all") if self.kind != "chamber" else ("",))}
history steps=50
output csv at=end fields=velocity,mass,body
"""

    def found(self, result):
        """Mean radial velocity of the metal."""
        axes = {"2": "xy", "axisymmetric": "rz", "3": "xyz"}[self.space]
        keys = axes if axes[0] in result.rows[0] else "xz"
        mass = push = 0.0
        for row in result.rows:
            if row["body"] != len(self.layers) and row["body"] != f"b{len(self.layers) - 1}":
                continue
            radius = math.sqrt(sum(row[key]**2 for key in keys))
            mass += row["mass"]
            push += row["mass"]*sum(row[key]*row[f"velocity_{key}"] for key in keys)/radius
        return [push/mass]


CLASSES = (Stack, Shell)
