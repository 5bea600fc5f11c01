"""Classes of random scenes whose truth is known without the program: closed forms, and scenes that are the same seen in
another way.

Each class makes one or two decks from a seed and a `method` card, and says how far their ends are from the truth, as
parts of what is asked for. Lengths, masses and times have no units but where `units` says so.
"""
import math

SMALL = 1e-3  # of scenes that are the same but for round-off, which contact may make larger


def minima(rows, key):
    """Times of the minima of a column that come after and before a value above half of its largest: by parabolas
    through three rows."""
    values, times = [row[key] for row in rows], [row["time"] for row in rows]
    high, found, i = 0.4*max(values), [], 0
    while i < len(values):
        while i < len(values) and values[i] < high:
            i += 1
        start = i
        while i < len(values) and values[i] >= high:
            i += 1
        begin = i
        while i < len(values) and values[i] < high:
            i += 1
        if start >= len(values) or i >= len(values) or begin == i:
            break
        low = min(range(begin, i), key=values.__getitem__)
        before, here, after = values[low - 1:low + 2]
        bend = before - 2*here + after
        found.append(times[low] + (0.5*(before - after)/bend*(times[low + 1] - times[low]) if bend > 0 else 0.0))
    return found


def zero(function, low, high):
    """Where a function changes its sign."""
    for _ in range(80):
        middle = 0.5*(low + high)
        if (function(middle) > 0) == (function(high) > 0):
            high = middle
        else:
            low = middle
    return 0.5*(low + high)


def bessel(order, x):
    """J0 or J1, by its series."""
    total, term, k = 0.0, (0.5*x)**order, 0
    while abs(term) > 1e-18:
        total += term
        k += 1
        term *= -(0.5*x)**2/(k*(k + order))
    return total


def vibration(result, period):
    """Errors of a vibration whose kinetic energy is that of one mode: its frequency, and what is lost of its
    amplitude."""
    energies = [row["kinetic_energy"] for row in result.history]
    floor = min(energies)  # of a rigid motion that is not part of the mode
    times = minima(
        [{**row, "kinetic_energy": row["kinetic_energy"] - floor} for row in result.history], "kinetic_energy"
    )
    if len(times) < 4:
        return [("frequency", 1.0, 0.05)]
    first = energies[0] - floor
    last = max(row["kinetic_energy"] for row in result.history if times[2] < row["time"] < times[3]) - floor
    return [("frequency", 1.5*period/(times[3] - times[0]) - 1, 0.05), ("amplitude", math.sqrt(last/first) - 1, 0.25)]


def body_end(result, name, key):
    """A column of bodies.csv at the end."""
    return [row for row in result.bodies if row["name"] == name][-1][key]


class Truth:
    """A scene of one class. `decks`: texts with METHOD in the place of the card; `cells`: over the thinnest part."""

    cells = 99
    card = ""  # of the method, where not all can have the scene

    def __init__(self, luck):
        self.luck = luck
        self.decks = []
        self.make()

    def make(self):
        """Draws a scene."""
        raise NotImplementedError

    def errors(self, results):
        """(What, its error, what is allowed) of the ends."""
        raise NotImplementedError


class Beam(Truth):
    """A free beam in its first mode of bending, at any angle: frequency by ASTM E1876, plane strain."""

    def make(self):
        self.cells = self.luck.choice((3, 4, 6, 8))
        angle, slim, h = self.luck.choice((0, self.luck.uniform(0, 90))), 12.0, 1/self.cells
        stiff, nu = 1/(1 - 0.3**2), 0.3/0.7
        part = 1/slim
        t1 = (1 + 6.585*(1 + 0.0752*nu + 0.8109*nu**2)*part**2 - 0.868*part**4
              - 8.340*(1 + 0.2023*nu + 2.173*nu**2)*part**4/(1 + 6.338*(1 + 0.1408*nu + 1.536*nu**2)*part**2))
        self.period = slim**2*math.sqrt(0.9465*t1/stiff)
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        b = 4.730040745/slim
        place = f"({b}*((x-cx)*{c}+(y-cy)*{s})+2.3650203725)"
        mode = f"(cosh({place})+cos({place})-0.9825022158*(sinh({place})+sin({place})))"
        u, w = self.luck.uniform(0, h), self.luck.uniform(0, h)  # bodies are turned about the origin
        self.decks = [f"""parameter cx = {u*c - w*s}
parameter cy = {u*s + w*c}
dimension 2
grid cell={h}
METHOD
time end={2.4*self.period} cfl=0.5
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=({u - slim/2},{w - 0.5}) upper=({u + slim/2},{w + 0.5}) ppc=2 rotation={angle}
velocity m x="{-1e-3*s}*{mode}" y="{1e-3*c}*{mode}"
history steps=5
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Cantilever(Truth):
    """A cantilever under a shear traction on its end, damped to rest: deflection by beam theory with shear."""

    def make(self):
        self.cells = self.luck.choice((3, 4, 6, 8))
        h, slim = 1/self.cells, self.luck.choice((5, 8))
        self.slim, lift = slim, self.luck.choice((0, 0.25, 0.5))
        omega = 3.516*math.sqrt(1/(12*(1 - 0.3**2)))/slim**2
        self.load = 1e-6
        self.exact = self.load*(4*slim**3*(1 - 0.3**2) + 1.2*slim*2*1.3)
        self.decks = [f"""dimension 2
grid cell={h} x=0:open
wall x-=fixed
METHOD
time end={14/omega} cfl=0.5
damping rate={2*omega}
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=(0,{lift*h}) upper=({slim},{1 + lift*h}) ppc=2
traction m face=x+ y="{-self.load}*min(t*{omega},1)"
history steps=50
output csv at=end fields=displacement,initial_position
"""]

    def errors(self, results):
        end = [row["displacement_y"] for row in results[0].rows if row["x0"] > self.slim - 0.8/self.cells]
        return [("deflection", -sum(end)/len(end)/(self.exact*(1 - 1.5*0.4/self.cells/self.slim)) - 1, 0.05)]


class Strip(Truth):
    """A strip at any angle that is pulled along itself, damped to rest: its stretch."""

    def make(self):
        self.cells = self.luck.choice((2, 4, 8))
        self.angle, h = self.luck.choice((0, self.luck.uniform(0, 90))), 1/self.cells
        self.c, self.s = math.cos(math.radians(self.angle)), math.sin(math.radians(self.angle))
        length, self.pull, ramp, up = 12, 1e-3, 240, self.luck.uniform(0, h)
        along = f"(x*{self.c}+y*{self.s})"
        self.decks = [
            f"""dimension 2
grid cell={h}
METHOD
time end={2 * ramp} cfl=0.5
damping rate=0.15
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=({-length / 2},{up}) upper=({length / 2},{1 + up}) ppc=2 rotation={self.angle}
load m where="{along}>{length / 2 - 0.6 * h}" x="{self.pull * self.c}*min(t/{ramp},1)" &
  y="{self.pull * self.s}*min(t/{ramp},1)"
load m where="{along}<{0.6 * h - length / 2}" x="{-self.pull * self.c}*min(t/{ramp},1)" &
  y="{-self.pull * self.s}*min(t/{ramp},1)"
history steps=50
output csv at=end fields=displacement,initial_position,mass
"""
        ]

    def errors(self, results):
        rows = results[0].rows
        thick = sum(row["mass"] for row in rows)/12
        inner = [
            (row["x0"] * self.c + row["y0"] * self.s, row["displacement_x"] * self.c + row["displacement_y"] * self.s)
            for row in rows
        ]
        inner = [pair for pair in inner if abs(pair[0]) < 4]
        mean = [sum(pair[i] for pair in inner)/len(inner) for i in (0, 1)]
        slope = sum((u - mean[0])*(v - mean[1]) for u, v in inner)/sum((u - mean[0])**2 for u, _ in inner)
        return [("stretch", slope/(self.pull/thick*(1 - 0.3**2)) - 1, 0.05)]


class Pressed(Truth):
    """A body of any shape, at any angle, under a pressure on all faces, damped to rest: mean stress and energy."""

    SHAPES = {
        "2": (
            "block lower=(0,0) upper=({wide},{n})", "sphere centre=(0,0) radius={half}",
            "block lower=(0,0) upper=({wide},{n}) ADD block lower=(0,{n}) upper=({n},{wide})",
        ),
        "3": (
            "block lower=(0,0,0) upper=({wide},{n},{n})", "cylinder radius={half} length={n}",
            "sphere centre=(0,0,0) radius={half}",
        ),
        "axisymmetric": ("block lower=(0,0) upper=({n},{n})", "sphere centre=(0,0) radius={half}"),
    }

    def make(self):
        self.space = self.luck.choice(("2", "2", "3", "axisymmetric"))
        self.cells = self.luck.choice((3, 4, 6) if self.space != "3" else (3, 4))
        angle, self.nu = self.luck.choice((0, self.luck.uniform(0, 90))), self.luck.choice((0, 0.3))
        shape, self.p = self.luck.choice(self.SHAPES[self.space]), 1e-3
        shape = shape.format(n=self.cells, wide=2*self.cells, half=0.5*self.cells)
        first, _, more = shape.partition(" ADD ")
        ramp = f'p="{self.p}*min(t/60,1)"'
        cards = f"pressure m {ramp}\n"
        if self.luck.random() < 0.3 and "block" in shape:
            axes = "rz" if self.space == "axisymmetric" else "xyz"[:int(self.space)]
            cards = "".join(f"pressure m face={axis}{side} {ramp}\n" for axis in axes for side in "-+"
                            if axis + side != "r-")
        turn = ""
        if self.space != "axisymmetric":
            turn = f" rotation={angle} pivot=({','.join(str(self.luck.random()) for _ in range(int(self.space)))})"
            if self.space == "3":
                turn += f" rotation_axis=(1,{self.luck.random()},{self.luck.random()})"
        self.decks = [
            f"""dimension {self.space}
grid cell=1
METHOD
time end=150 cfl=0.5
damping rate=0.15
material m elastic density=1 young=1 poisson={self.nu}
body m {first} material=m ppc=2{turn}
{f"add m {more}" if more else ""}
{cards}history steps=20
output csv at=end fields=stress,mass
"""
        ]

    def errors(self, results):
        rows = results[0].rows
        volume = sum(row["mass"] for row in rows)
        keys = ("xx", "yy") if self.space == "2" else ("xx", "yy", "zz")
        mean = [sum(row[f"stress_{a}"]*row["mass"] for row in rows)/volume/self.p + 1 for a in keys]
        if self.space == "2":
            energy = self.p**2*(1 + self.nu)*(1 - 2*self.nu)*volume
        else:
            energy = self.p**2*1.5*(1 - 2*self.nu)*volume
        return [
            ("mean stress", max(mean, key=abs), 0.05),
            ("energy", results[0].history[-1]["internal_energy"] / energy - 1, 0.1),
        ]


class Spin(Truth):
    """A disk that spins freely: kinetic energy after two turns."""

    def make(self):
        self.cells = self.luck.choice((4, 6, 8, 12))
        omega, x, y = 0.05, self.luck.random(), self.luck.random()
        self.decks = [f"""dimension 2
grid cell={1/self.cells}
METHOD
time end={4*math.pi/omega} cfl={self.luck.choice((0.3, 0.5))}
material m elastic density=1 young=1 poisson=0.3
body m sphere material=m centre=({x},{y}) radius=1 ppc=2
velocity m omega_z={omega}
history steps=20
"""]

    def errors(self, results):
        rows = results[0].history
        return [("kinetic energy", rows[-1]["kinetic_energy"]/rows[0]["kinetic_energy"] - 1, 0.05)]


class Bars(Truth):
    """Two equal bars that collide: they exchange their velocities."""

    def make(self):
        cells, v = self.luck.choice((10, 20, 40)), self.luck.choice((0.001, 0.01))
        self.v, gap = v, self.luck.choice((0.5, 2.3))/cells
        self.cells = cells
        self.decks = [f"""dimension 1
grid cell={1/cells}
METHOD
time end={gap/v + 3.5} cfl={self.luck.choice((0.3, 0.5))}
material m elastic density=1 young=1 poisson=0
body a block material=m lower=0 upper=1 ppc=2
body b block material=m lower={1 + gap} upper={2 + gap} ppc=2
velocity a x={v}
contact all
history steps=10
"""]

    def errors(self, results):
        return [("velocity of the first", body_end(results[0], "a", "velocity_x")/self.v, 0.05),
                ("velocity of the second", body_end(results[0], "b", "velocity_x")/self.v - 1, 0.05)]


class Breathing(Truth):
    """A ball or a cylinder in its first radial mode: frequency by the theory of elasticity."""

    def make(self):
        space = self.luck.choice(("2", "axisymmetric", "3"))
        self.cells = self.luck.choice((4, 6, 8)) if space == "3" else self.luck.choice((6, 8, 12))
        nu = self.luck.choice((0.2, 0.3))
        fast = math.sqrt((1 - nu)/((1 + nu)*(1 - 2*nu)))
        slow = math.sqrt(0.5/(1 + nu))
        if space == "2":
            x = zero(lambda x: x*bessel(0, x) - 2*(slow/fast)**2*bessel(1, x), 1.0, 3.0)
        else:
            x = zero(lambda x: math.sin(x)*(1 - (0.5*fast/slow*x)**2) - x*math.cos(x), 1.6, 4.0)
        self.period = 2*math.pi/(x*fast)
        if space == "axisymmetric":
            place, centre, at = "r=0:open", f"(0,{self.luck.random()})", ("r", "z")
        elif space == "2":
            place, centre, at = "", f"({self.luck.random()},{self.luck.random()})", ("x", "y")
        else:
            place, centre, at = "", f"({self.luck.random()},{self.luck.random()},{self.luck.random()})", ("x", "y", "z")
        mean = [float(part) for part in centre.strip("()").split(",")]
        motion = " ".join(f'{a}="1e-3*({a}-{m})"' for a, m in zip(at, mean))
        self.decks = [f"""dimension {space}
grid cell={1/self.cells} {place}
METHOD
time end={2.4*self.period} cfl=0.4
material m elastic density=1 young=1 poisson={nu}
body m sphere material=m centre={centre} radius=1 ppc=2
velocity m {motion}
history steps=1
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Tube(Truth):
    """A tube under pressure from inside, in plane strain about its axis, damped to rest: its bore, by Lamé."""

    def make(self):
        self.cells = self.luck.choice((4, 8, 16))
        self.h, self.p = 1/self.cells, 1e-3
        height = 3*self.h
        self.exact = 1.3*self.p/3*(0.4*1 + 4/1)
        self.exact_at = lambda r: 1.3*self.p/3*(0.4*r + 4/r)
        self.decks = [f"""dimension axisymmetric
grid cell={self.h} r=0:open z=0:{height}
wall z-=slip z+=slip
METHOD
time end=60 cfl=0.5
damping rate=0.8
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=(1,0) upper=(2,{height}) ppc=2
pressure m face=r- p="{self.p}*min(t/20,1)"
history steps=20
output csv at=end fields=displacement,initial_position
"""]

    def errors(self, results):
        rows = results[0].rows
        key = "r0" if "r0" in rows[0] else "x0"
        least = min(row[key] for row in rows)
        inner = [row[f"displacement_{key[0]}"] for row in rows if row[key] < least + 0.1*self.h]
        return [("bore", sum(inner)/len(inner)/self.exact_at(least) - 1, 0.05)]


class Sod(Truth):
    """A shock tube of ideal gas, ten to one: velocity between the tail of the fan and the shock."""

    def make(self):
        self.cells = self.luck.choice((100, 200))
        self.decks = [f"""dimension 1
grid cell={1/self.cells} x=0:1
wall x-=slip x+=slip
METHOD
time end=0.2 cfl={self.luck.choice((0.2, 0.4))}
material a fluid density=1
eos a ideal_gas gamma=1.4 energy0=2.5
material b fluid density=0.125
eos b ideal_gas gamma=1.4 energy0=0.25
viscosity all
body a block material=a lower=0 upper=0.5 ppc=2
body b block material=b lower=0.5 upper=1 ppc=2
history steps=20
output csv at=end fields=velocity,pressure
"""]

    def errors(self, results):
        rows = [row for row in results[0].rows if 0.54 < row["x"] < 0.8]
        return [("velocity", sum(row["velocity_x"] for row in rows)/max(1, len(rows))/0.92745 - 1, 0.05),
                ("pressure", sum(row["pressure"] for row in rows)/max(1, len(rows))/0.30313 - 1, 0.05)]


class Flyer(Truth):
    """Plates of copper that meet, in plane strain of one direction: pressure by the Hugoniot curve."""

    def make(self):
        v, self.cells = self.luck.choice((400, 1000, 2500)), self.luck.choice((40, 80))
        space = self.luck.choice(("1", "2"))
        grid, walls, box = (
            ("", "", ("{}", "{}"))
            if space == "1"
            else (f"y=0:{4 / self.cells}", "wall y-=slip y+=slip\n", ("({},0)", f"({{}},{4 / self.cells})"))
        )
        u = 0.5*v
        self.exact = 8.93e-3*(3940 + 1.49*u)*u
        self.time = 0.5/(3940 + 1.49*u)
        self.decks = [f"""units mm g ms
dimension {space}
grid cell={1/self.cells} {grid}
{walls}METHOD
time end={self.time} cfl={self.luck.choice((0.2, 0.4))}
material m johnson_cook density=8.93e-3 young=120000 poisson=0.34 yield=1
eos m gruneisen c0=3940 s=1.49 gamma0=2
viscosity m
body a block material=m lower={box[0].format(-1)} upper={box[1].format(0)} ppc=2
body b block material=m lower={box[0].format(0)} upper={box[1].format(1)} ppc=2
velocity a x={v}
history steps=20
output csv at=end fields=pressure,initial_position
"""]

    def errors(self, results):
        rows = [row["pressure"] for row in results[0].rows if abs(row["x0"]) < 0.3]
        return [("mean pressure", sum(rows)/len(rows)/self.exact - 1, 0.05)]


class Slide(Truth):
    """A block that slides down a rigid plane with friction: its way."""

    def make(self):
        self.cells = self.luck.choice((4, 6))
        slope, mu = math.radians(self.luck.choice((20, 30))), self.luck.choice((0.1, 0.2))
        self.end = 2.0
        self.way = 0.5*(math.sin(slope) - mu*math.cos(slope))*self.end**2
        h = 1/self.cells
        self.decks = [f"""dimension 2
grid cell={h} y=0:open
wall y-=slip
wallfriction y- friction={mu}
METHOD
time end={self.end} cfl=0.5
gravity ({math.sin(slope)},{-math.cos(slope)})
material m elastic density=1 young=1e4 poisson=0.3
initial_stress m surface=1
body m block material=m lower=(0,0) upper=(2,1) ppc=2
history steps=50
"""]

    def errors(self, results):
        first, last = results[0].bodies[0], results[0].bodies[-1]
        return [("way", (last["x"] - first["x"])/self.way - 1, 0.05)]


class Crash(Truth):
    """A ball that hits a block, seen in two ways."""

    allowed, seen = SMALL, ""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((4, 6))
        self.h = 1/self.cells
        self.v = (luck.uniform(-0.05, 0.05), -luck.uniform(0.05, 0.15))
        self.matter = luck.choice(("elastic density=1 young=1 poisson=0.3", "neo_hookean density=1 young=1 poisson=0.3",
                                   "j2 density=1 young=1 poisson=0.3 yield=0.03"))
        self.contact = luck.choice(("contact all", "contact all", "")) if self.allowed == SMALL else "contact all"
        self.ball = (luck.randrange(-2, 3)*self.h, 2 + 2*self.h)
        self.radius = luck.choice((0.75, 1.0))
        self.cfl = luck.choice((0.3, 0.5))
        self.decks = [self.text(), self.other()]

    def text(
        self, place=lambda x, y: (x, y), turn=lambda x, y: (x, y), boost=(0.0, 0.0), rotation=0.0, swapped=False,
        scale=(1.0, 1.0, 1.0),
    ):
        """The deck: places and vectors are mapped; `scale` are the units of length, mass and time."""
        length, mass, time = scale
        centre = place(self.ball[0], self.ball[1] + self.radius)
        middle = place(0.0, 1.0) if rotation == 0 else (0.0, 1.0)  # turned about the origin
        v = turn(*self.v)
        bodies = [
            f"body ball sphere material=m centre=({centre[0] * length},{centre[1] * length}) "
            f"radius={self.radius * length} spacing={0.5 * self.h * length}\n",
            f"body block block material=m lower=({(middle[0] - 2) * length},{(middle[1] - 1) * length}) "
            f"upper=({(middle[0] + 2) * length},{(middle[1] + 1) * length}) "
            f"spacing={0.5 * self.h * length} rotation={rotation}\n",
        ]
        if swapped:
            bodies.reverse()
        words = self.matter.split()
        kind, numbers = words[0], dict(word.split("=") for word in words[1:])
        stress = mass/(length*time**2)
        numbers = {
            name: float(value) * {"density": mass / length**3, "young": stress, "yield": stress}.get(name, 1.0)
            for name, value in numbers.items()
        }
        matter = kind + "".join(f" {name}={value!r}" for name, value in numbers.items())
        speed = length/time
        return f"""dimension 2
grid cell={self.h*length}
METHOD
time end={22*time} cfl={self.cfl}
material m {matter}
{''.join(bodies)}velocity ball x={(v[0] + boost[0])*speed!r} y={(v[1] + boost[1])*speed!r}
velocity block x={boost[0]*speed!r} y={boost[1]*speed!r}
{self.contact}
history steps=20
"""

    def other(self):
        """The same, seen otherwise."""
        return self.text()

    def back(self, x, y):
        """A velocity of the second scene as the first one sees it."""
        return x, y

    def errors(self, results):
        worst = 0.0
        for name in ("ball", "block"):
            ends = [(body_end(result, name, "velocity_x"), body_end(result, name, "velocity_y")) for result in results]
            worst = max(worst, math.dist(ends[0], self.back(*ends[1]))/math.hypot(*self.v))
        return [("velocities", worst, self.allowed)]


class Mirror(Crash):
    """In a mirror."""

    def other(self):
        return self.text(lambda x, y: (-x, y), lambda x, y: (-x, y))

    def back(self, x, y):
        return -x, y


class Quarter(Crash):
    """Turned by a right angle."""

    def other(self):
        return self.text(lambda x, y: (-y, x), lambda x, y: (-y, x), rotation=90)

    def back(self, x, y):
        return y, -x


class Shift(Crash):
    """Some cells further."""

    def other(self):
        step = (self.luck.randrange(-9, 9)*self.h, self.luck.randrange(-9, 9)*self.h)
        return self.text(lambda x, y: (x + step[0], y + step[1]))


class Order(Crash):
    """With the bodies in another order."""

    def other(self):
        return self.text(swapped=True)


class Units(Crash):
    """In other units."""

    def make(self):
        self.scale = [self.luck.choice((1e-3, 0.5, 1e3)) for _ in range(3)]
        super().make()

    def other(self):
        return self.text(scale=self.scale)

    def back(self, x, y):
        return x*self.scale[2]/self.scale[0], y*self.scale[2]/self.scale[0]


class Boost(Crash):
    """From a frame that moves."""

    allowed = 0.05

    def make(self):
        self.boost = (self.luck.uniform(-0.2, 0.2), self.luck.uniform(-0.2, 0.2))
        super().make()

    def other(self):
        return self.text(boost=self.boost)

    def back(self, x, y):
        return x - self.boost[0], y - self.boost[1]


class Place(Crash):
    """Some part of a cell further."""

    allowed = 0.05

    def other(self):
        step = (self.luck.random()*self.h, self.luck.random()*self.h)
        return self.text(lambda x, y: (x + step[0], y + step[1]))


class Angle(Crash):
    """Turned by any angle."""

    allowed = 0.05

    def make(self):
        self.angle = self.luck.uniform(5, 85)
        self.c, self.s = math.cos(math.radians(self.angle)), math.sin(math.radians(self.angle))
        super().make()

    def other(self):
        def turn(x, y):
            return self.c*x - self.s*y, self.s*x + self.c*y
        return self.text(turn, turn, rotation=self.angle)

    def back(self, x, y):
        return self.c*x + self.s*y, self.c*y - self.s*x


class Slab(Crash):
    """As a slice of space between walls."""

    def other(self):
        lines = (
            self.text()
            .replace("dimension 2", "dimension 3")
            .replace(f"grid cell={self.h * 1.0}", f"grid cell={self.h * 1.0} z=0:{2 * self.h}\nwall z-=slip z+=slip")
        )
        out = []
        for line in lines.splitlines():
            if line.startswith("body ball"):
                head, _, tail = line.partition("centre=(")
                centre, _, tail = tail.partition(")")
                line = f"{head.replace('sphere', 'cylinder')}centre=({centre},0) axis=(0,0,1) length={2*self.h}{tail}"
            if line.startswith("body block"):
                line = (
                    line.replace(") upper=(", ",0) upper=(")
                    .replace(") spacing", f",{2 * self.h}) spacing")
                    .replace("rotation=0.0", "")
                )
            out.append(line)
        return "\n".join(out) + "\n"


class Halves(Truth):
    """A block that is thrown flat, whole and made of two bodies without contact: energies."""

    def make(self):
        self.cells = self.luck.choice((4, 8))
        h, cut = 1/self.cells, self.luck.choice((1, 2))
        head = f"""dimension 2
grid cell={h}
METHOD
time end=8 cfl=0.4
material m {self.luck.choice(('elastic', 'neo_hookean'))} density=1 young=1 poisson=0.3
"""
        motion = " x=\"0.05*sin(2*x+y)\" y=\"0.05*cos(x-y)\"\n"
        one = "body a block material=m lower=(0,0) upper=(3,1) ppc=2\nvelocity a" + motion
        two = (
            f"body a block material=m lower=(0,0) upper=({cut},1) ppc=2\nbody b block material=m "
            f"lower=({cut},0) upper=(3,1) ppc=2\nvelocity a{motion}velocity b{motion}"
        )
        self.decks = [head + one + "history steps=10\n", head + two + "history steps=10\n"]

    def errors(self, results):
        ends = [result.history[-1]["internal_energy"] for result in results]
        return [("internal energy", ends[1]/ends[0] - 1, SMALL)]


CLASSES = (
    Beam, Cantilever, Strip, Pressed, Spin, Bars, Breathing, Tube, Sod, Flyer, Slide, Mirror, Quarter, Shift, Order,
    Units, Boost, Place, Angle, Slab, Halves,
)
