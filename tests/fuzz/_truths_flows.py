"""More classes of tests/fuzz/_truths.py: gases, liquids, explosives, and what flies."""
import math

from _truths import Truth, zero


def star(left, right, gamma):
    """Pressure and velocity between the waves of Riemann's problem of an ideal gas, and the speeds of its outermost
    ones; a state is (density, velocity, pressure)."""
    def branch(state, p):
        """Velocity that a wave from the pressure of a state to p gives, and the speed of the wave relative to the gas
        before it."""
        rho, _, p0 = state
        c = math.sqrt(gamma*p0/rho)
        if p > p0:
            a, b = 2/((gamma + 1)*rho), (gamma - 1)/(gamma + 1)*p0
            return (p - p0)*math.sqrt(a/(p + b)), c*math.sqrt((gamma + 1)/(2*gamma)*p/p0 + (gamma - 1)/(2*gamma))
        return 2*c/(gamma - 1)*((p/p0)**((gamma - 1)/(2*gamma)) - 1), c

    p = zero(lambda p: branch(left, p)[0] + branch(right, p)[0] + right[1] - left[1], 1e-9, 1e3)
    u = 0.5*(left[1] + right[1] + branch(right, p)[0] - branch(left, p)[0])
    return p, u, branch(left, p)[1], branch(right, p)[1]


class Riemann(Truth):
    """Two ideal gases of any pressures and densities that are let go: velocity and pressure between the waves."""

    def make(self):
        self.cells, gamma = self.luck.choice((100, 200)), self.luck.choice((1.4, 5/3))
        ratio, density = self.luck.choice((2, 4, 20, 60)), self.luck.choice((0.25, 0.5, 1))
        left, right = (1.0, 0.0, 1.0), (density, 0.0, 1/ratio)
        self.p, self.u, fan, shock = star(left, right, gamma)
        end = 0.42/max(fan, shock)
        tail = self.u - math.sqrt(gamma*self.p/(left[0]*self.p**(1/gamma)))  # speed of the inner end of the fan
        low, high = tail*end, shock*end
        self.window = [0.5 + low + 0.12*(high - low), 0.5 + high - 0.15*(high - low)]
        self.decks = [f"""dimension 1
grid cell={1/self.cells} x=0:1
wall x-=slip x+=slip
METHOD
time end={end} cfl={self.luck.choice((0.2, 0.4))}
material a fluid density=1
eos a ideal_gas gamma={gamma} pressure0=1
material b fluid density={density}
eos b ideal_gas gamma={gamma} pressure0={1/ratio}
viscosity all
body a block material=a lower=0 upper=0.5 ppc=2
body b block material=b lower=0.5 upper=1 ppc=2
history steps=20
output csv at=end fields=velocity,pressure
"""]

    def errors(self, results):
        rows = [row for row in results[0].rows if self.window[0] < row["x"] < self.window[1]]
        return [("velocity", sum(row["velocity_x"] for row in rows)/max(1, len(rows))/self.u - 1, 0.05),
                ("pressure", sum(row["pressure"] for row in rows)/max(1, len(rows))/self.p - 1, 0.05)]


class Rest(Truth):
    """Gas that fills a part of a box and comes to rest in all of it: pressure by its energy."""

    def make(self):
        self.cells = self.luck.choice((4, 8))
        height, self.fill = 2*self.cells, self.luck.choice((1, 1.25, 2))
        self.room = self.cells*height
        self.filled = self.room/self.fill
        self.decks = [f"""dimension 2
grid cell=1 x=0:{self.cells} y=0:{height}
wall x-=slip x+=slip y-=slip y+=slip
METHOD
time end={10*height} cfl={self.luck.choice((0.2, 0.4))}
material m fluid density=1
eos m ideal_gas gamma=1.4 energy0=2.5
viscosity m
body m block material=m lower=(0,0) upper=({self.cells},{height/self.fill}) ppc=2
history steps=50
output csv at=end fields=pressure,mass
"""]

    def errors(self, results):
        rows, end = results[0].rows, results[0].history[-1]
        mean = sum(row["pressure"]*row["mass"] for row in rows)/sum(row["mass"] for row in rows)
        return [("pressure", mean/(0.4*(2.5*self.filled - end["kinetic_energy"])/self.room) - 1, 0.1)]


class Burn(Truth):
    """TNT that fills a box and has burnt: mean pressure by its equation of state at the energy that is left."""

    def make(self):
        self.cells = self.luck.choice((6, 10))
        height = 2*self.cells
        self.room = self.cells*height
        self.decks = [f"""units mm g ms
dimension 2
grid cell=1 x=0:{self.cells} y=0:{height}
wall x-=slip x+=slip y-=slip y+=slip
METHOD
time end={self.luck.choice((2, 4))*height/6930} cfl={self.luck.choice((0.2, 0.4))}
material m explosive density=1.63e-3 detonation_speed=6930
eos m jwl a=371200 b=3210 r1=4.15 r2=0.95 omega=0.30 energy0=6993
viscosity m
body m block material=m lower=(0,0) upper=({self.cells},{height}) ppc=2
detonation point=(0,0)
history steps=20
output csv at=end fields=pressure,mass
"""]

    def errors(self, results):
        rows, end = results[0].rows, results[0].history[-1]
        mean = sum(row["pressure"]*row["mass"] for row in rows)/sum(row["mass"] for row in rows)
        at_one = 371200*(1 - 0.3/4.15)*math.exp(-4.15) + 3210*(1 - 0.3/0.95)*math.exp(-0.95)
        return [("mean pressure", mean/(at_one + 0.3*(6993 - end["kinetic_energy"]/self.room)) - 1, 0.1)]


class Column(Truth):
    """Water that stands in a vessel, from rest or damped to it: pressure over depth."""

    def make(self):
        self.cells = self.luck.choice((4, 8, 12))
        h, at_rest = 1/self.cells, self.luck.random() < 0.5
        start = "initial_stress m surface=1" if at_rest else "damping rate=4"
        self.decks = [f"""dimension 2
grid cell={h} x=0:{4*h} y=0:open
wall x-=slip x+=slip y-=slip
METHOD
time end={2 if at_rest else 4} cfl=0.4
gravity (0,-1)
material m fluid density=1
eos m tait c0=20
{start}
body m block material=m lower=(0,0) upper=({4*h},1) ppc=2
history steps=50
output csv at=end fields=pressure
"""]

    def errors(self, results):
        rows = results[0].rows
        mean = [sum(row[key] for row in rows)/len(rows) for key in ("y", "pressure")]
        slope = sum((row["y"] - mean[0]) * (row["pressure"] - mean[1]) for row in rows) / sum(
            (row["y"] - mean[0]) ** 2 for row in rows
        )
        return [("slope of the pressure", -slope - 1, 0.05), ("mean pressure", mean[1]/0.5 - 1, 0.05)]


class Fall(Truth):
    """A body that is thrown and falls: its place, and that nothing strains it."""

    def make(self):
        space, self.cells = self.luck.choice((2, 3)), self.luck.choice((2, 4))
        h, end = 1/self.cells, 20
        self.v = [self.luck.uniform(-0.2, 0.2) for _ in range(space)]
        g = [self.luck.uniform(-0.02, 0.02) for _ in range(space)]
        place = [self.luck.random() for _ in range(space)]
        pull, self.way = (
            ("gravity (" + ",".join(map(str, g)) + ")", [v * end + 0.5 * a * end**2 for v, a in zip(self.v, g)])
            if self.luck.random() < 0.5
            else (
                "bodyforce " + " ".join(f'{axis}="{a}*t"' for axis, a in zip("xyz", g)),
                [v * end + a * end**3 / 6 for v, a in zip(self.v, g)],
            )
        )
        self.decks = [f"""dimension {space}
grid cell={h}
METHOD
time end={end} cfl=0.5
material m {self.luck.choice(('elastic', 'neo_hookean'))} density=1 young=1 poisson=0.3
body m sphere material=m centre=({','.join(map(str, place))}) radius=0.5 ppc=2
velocity m {' '.join(f'{axis}={v}' for axis, v in zip('xyz', self.v))}
{pull}
history steps=50
"""]

    def errors(self, results):
        first, last, end = results[0].bodies[0], results[0].bodies[-1], results[0].history[-1]
        gone = [last[axis] - first[axis] - way for axis, way in zip("xyz", self.way)]
        return [
            ("place", math.hypot(*gone) / math.hypot(*self.way), 0.01),
            ("strain", end["internal_energy"] / end["kinetic_energy"], 0.01),
        ]


class Brake(Truth):
    """A body that flies and is damped: its way."""

    def make(self):
        rate, v, end, self.cells = (
            self.luck.choice((0.05, 0.2)), self.luck.uniform(0.05, 0.3), 15, self.luck.choice((2, 4)),
        )
        self.way = v/rate*(1 - math.exp(-rate*end))
        self.decks = [f"""dimension 2
grid cell={1/self.cells}
METHOD
time end={end} cfl=0.5
damping rate={rate}
material m elastic density=1 young=1 poisson=0.3
body m sphere material=m centre=({self.luck.random()},{self.luck.random()}) radius=0.5 ppc=2
velocity m x={v}
history steps=50
"""]

    def errors(self, results):
        first, last = results[0].bodies[0], results[0].bodies[-1]
        return [("way", (last["x"] - first["x"])/self.way - 1, 0.05)]


CLASSES = (Riemann, Rest, Burn, Column, Fall, Brake)
