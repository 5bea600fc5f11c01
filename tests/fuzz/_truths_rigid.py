"""More classes of tests/fuzz/_truths.py: rigid bodies and gas, rows of bars, long vibrations, shear."""
import math

from _lagrange import Layer, Row
from _truths import Truth, body_end
from _truths_layers import gas


def tube(space, h, luck):
    """The sides of a tube in a space: its grid and walls, corners of blocks along it, its section, its axis."""
    wide = luck.choice((3, 4))*h
    return {
        "1": ("", "", "{}", 1.0, "x"),
        "2": (f" y=0:{wide}", " y-=slip y+=slip", "({},{})", wide, "x"),
        "axisymmetric": (f" r=0:{wide}", " r+=slip", "({1},{0})", math.pi*wide**2, "z"),
        "3": (f" y=0:{wide} z=0:{wide}", " y-=slip y+=slip z-=slip z+=slip", "({0},{1},{1})", wide**2, "x"),
    }[space] + (wide,)


class Piston(Truth):
    """A rigid piston moves into a gas or draws back from it: momentum of the gas by the pressure on it, that behind a
    shock or a fan."""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((20, 40, 80))
        h, space, sound = 1/self.cells, luck.choice(("1", "1", "2", "axisymmetric", "3")), math.sqrt(1.4)
        u = luck.choice((-0.8, -0.3, 0.1, 0.5, 1.5, 3.0))*sound
        grid, walls, corner, area, axis, wide = tube(space, h, luck)
        if u > 0:
            front = 0.6*u + math.sqrt((0.6*u)**2 + 1.4)
            self.push, end = front*u, luck.uniform(0.3, 0.9)/front
        else:
            self.push = (1 + 0.2*u/sound)**7 - 1
            end = luck.uniform(0.3, 0.9)/sound
        self.push *= end  # over the mass
        self.axis, fast = axis, abs(u)*end + 0.5
        contact = luck.choice(("", "contact all\n"))
        self.decks = [f"""dimension {space}
grid cell={h} {axis}=open:1{grid}
wall {axis}+=slip{walls}
METHOD
time end={end} cfl={luck.choice((0.2, 0.4))}
material g fluid density=1
eos g ideal_gas gamma=1.4 pressure0=1
viscosity g
material s elastic density=10 young=1e4 poisson=0.3
body gas block material=g lower={corner.format(0, 0)} upper={corner.format(1, wide)} ppc=2
body piston block material=s lower={corner.format(-0.2 - fast*0, 0)} upper={corner.format(0, wide)} ppc=2
rigid piston {axis}={u}
{contact}history steps=50
"""]

    def errors(self, results):
        return [("velocity of the gas", body_end(results[0], "gas", f"velocity_{self.axis}")/self.push - 1, 0.05)]


class Gun(Truth):
    """Gas between a wall and a rigid body that is free to fly: its velocity, by a code in one dimension."""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((10, 20, 40))
        h, space, heavy = 1/self.cells, luck.choice(("1", "1", "2", "axisymmetric", "3")), luck.choice((0.5, 2.0, 10.0))
        grid, walls, corner, area, axis, wide = tube(space, h, luck)
        self.end, self.axis, self.heavy = luck.uniform(2, 6)/math.sqrt(1.4), axis, heavy
        contact = luck.choice(("", "contact all\n"))
        self.decks = [f"""dimension {space}
grid cell={h} {axis}=0:open{grid}
wall {axis}-=slip{walls}
METHOD
time end={self.end} cfl={luck.choice((0.2, 0.4))}
material g fluid density=1
eos g ideal_gas gamma=1.4 pressure0=1
viscosity g
material s elastic density=10 young=1e4 poisson=0.3
body gas block material=g lower={corner.format(0, 0)} upper={corner.format(1, wide)} ppc=2
body shot block material=s lower={corner.format(1, 0)} upper={corner.format(1.3, wide)} ppc=2
rigid shot free=yes mass={heavy*area}
{contact}history steps=50
"""]

    def errors(self, results):
        row = Row([Layer(gas("g", 1.0, 1.0).law, 0, 1, 200)], left=0.0)
        row.node_mass[-1] += self.heavy
        row.run(self.end)
        found = body_end(results[0], "shot", f"velocity_{self.axis}")
        return [("velocity of the shot", found/float(row.v[-1]) - 1, 0.05)]


class Cradle(Truth):
    """Elastic bars in a row, of which the first flies at the others: the last takes its velocity."""

    def make(self):
        luck = self.luck
        self.cells, space = luck.choice((8, 16, 32)), luck.choice(("1", "2"))
        h, number, self.v = 1/self.cells, luck.choice((3, 4)), luck.choice((0.001, 0.01))
        self.number = number
        grid, walls, corner, _, _, wide = tube(space, h, luck)
        gaps = [luck.choice((0.0, 0.4, 1.7))*h for _ in range(number - 1)]
        bodies, low = "", 0.0
        for i in range(number):
            bodies += (
                f"body b{i} block material=m lower={corner.format(low, 0)} upper={corner.format(low + 1, wide)} ppc=2\n"
            )
            low += 1 + (gaps[i] if i < number - 1 else 0)
        self.decks = [f"""dimension {space}
grid cell={h}{grid}
{f'wall{walls}' if walls else ''}
METHOD
time end={1.6*sum(gaps)/self.v + 2*number + 1} cfl={luck.choice((0.3, 0.5))}
material m elastic density=1 young=1 poisson=0
{bodies}velocity b0 x={self.v}
contact all
history steps=50
"""]

    def errors(self, results):
        return [("velocity of the last", body_end(results[0], f"b{self.number - 1}", "velocity_x")/self.v - 1, 0.05)]


class Endure(Truth):
    """A bar between a wall and nothing that vibrates twelve times: what is left of its energy, and its frequency."""

    def make(self):
        luck = self.luck
        self.cells, space, nu = luck.choice((8, 16, 32)), luck.choice(("1", "2", "3")), 0
        h = 1/self.cells
        wide = luck.choice((3, 4.5))*h
        grid, upper = {
            "1": ("", "1"), "2": (" y=open", f"(1,{wide})"), "3": (" y=open z=open", f"(1,{wide},{wide})"),
        }[space]
        lower = {"1": "0", "2": "(0,0)", "3": "(0,0,0)"}[space]
        self.decks = [f"""dimension {space}
grid cell={h} x=0:open{grid}
wall x-=fixed
METHOD
time end=48.5 cfl={luck.choice((0.3, 0.5))}
material m elastic density=1 young=1 poisson={nu}
body m block material=m lower={lower} upper={upper} ppc=2
velocity m x="1e-3*sin(pi*x/2)"
history steps=2
"""]

    def errors(self, results):
        history = results[0].history
        first = history[0]["kinetic_energy"]
        peak = max((row for row in history if 46.6 < row["time"] < 49), key=lambda row: row["kinetic_energy"])
        return [("frequency", 48/peak["time"] - 1, 0.05),
                ("energy", math.sqrt(peak["kinetic_energy"]/first) - 1, 0.25)]


CLASSES = (Piston, Gun, Cradle, Endure)
