"""More classes of tests/fuzz/_truths.py: bodies that hit, rub, burst and slosh."""
import math

from _lagrange import Layer, Row
from _truths import Truth, body_end, vibration
from _truths_layers import Shell, gas


def turned(angle, along, across):
    """A vector of the plane whose components along a line and across it are given."""
    c, s = math.cos(angle), math.sin(angle)
    return along*c - across*s, along*s + across*c


def moments(rows, number, name):
    """Mass, velocity and spin of the rows of a body (particles_end.csv), in the plane or in space."""
    axes = [axis for axis in "xyz" if axis in rows[0]]
    rows = [row for row in rows if row["body"] in (number, name)]
    mass = sum(row["mass"] for row in rows)
    mean = {key: sum(row["mass"]*row[key] for row in rows)/mass for axis in axes for key in (axis, f"velocity_{axis}")}
    arms = [([row[axis] - mean[axis] for axis in axes], [row[f"velocity_{axis}"] - mean[f"velocity_{axis}"]
                                                          for axis in axes], row["mass"]) for row in rows]
    turn = sum(m*(x[0]*v[1] - x[1]*v[0]) for x, v, m in arms)
    inertia = sum(m*(x[0]**2 + x[1]**2) for x, v, m in arms)
    return mass, [mean[f"velocity_{axis}"] for axis in axes], turn/inertia


class Mallet(Truth):
    """A rigid body strikes an elastic bar along it: its velocity falls by exp(-t rho c A/M) until the wave comes back
    from the other end (Saint-Venant)."""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((8, 16, 32))
        h, space = 1/self.cells, luck.choice(("1", "1", "2", "axisymmetric", "3"))
        wide, self.v = luck.choice((2, 4))*h, 0.01
        heavy, gap = luck.choice((0.3, 1.0, 3.0)), luck.choice((0.0, 0.3, 2.0))*h
        wait = luck.uniform(0.4, 1.7)
        self.axis = "z" if space == "axisymmetric" else "x"
        area = {"1": 1.0, "2": wide, "axisymmetric": math.pi*wide**2, "3": wide**2}[space]
        self.truth = self.v*math.exp(-wait/heavy)
        corner = {"1": "{}", "2": "({},{})", "axisymmetric": "({1},{0})", "3": "({0},{1},{1})"}[space]
        grid = {"1": "", "2": f" y=0:{wide}", "axisymmetric": f" r=0:{wide}", "3": f" y=0:{wide} z=0:{wide}"}[space]
        wall = {"1": "", "2": "wall y-=slip y+=slip\n", "axisymmetric": "wall r+=slip\n",
                "3": "wall y-=slip y+=slip z-=slip z+=slip\n"}[space]
        self.decks = [f"""dimension {space}
grid cell={h}{grid}
{wall}METHOD
time end={gap/self.v + wait} cfl={luck.choice((0.3, 0.5))}
material m elastic density=1 young=1 poisson=0
body hammer block material=m lower={corner.format(-0.5 - gap, 0)} upper={corner.format(-gap, wide)} ppc=2
rigid hammer free=yes mass={heavy*area}
velocity hammer {self.axis}={self.v}
body bar block material=m lower={corner.format(0, 0)} upper={corner.format(1, wide)} ppc=2
contact all
history steps=20
"""]

    def errors(self, results):
        found = body_end(results[0], "hammer", f"velocity_{self.axis}")
        return [("velocity of what strikes", (found - self.truth)/self.v, 0.05)]


class Glance(Truth):
    """Two balls that meet without friction, aside of their middles or about the axis: no spin, and next to no loss of
    the velocity between them."""

    def make(self):
        luck = self.luck
        self.flat = luck.random() < 0.3
        radius = luck.choice((4, 5, 6, 8)) if not self.flat else luck.choice((6, 8, 12, 18))
        self.cells, h = 2*radius, 1/radius
        aside, self.v = luck.uniform(0.3, 1.4), luck.choice((0.01, 0.02, 0.05))
        gap, angle = luck.uniform(0.3, 2.0)*h, luck.uniform(0, 2*math.pi)
        if self.flat:
            aside, angle = 0.0, 0.5*math.pi
        away = math.sqrt(4 - aside**2) + gap
        place = turned(angle, away, aside)
        one, two = turned(angle, 0.5*self.v, 0), turned(angle, -0.5*self.v, 0)
        heavy, lift = luck.choice((1, 1, 3)), luck.uniform(0, h)
        axes, start = ("xy", f"({lift},0,0)") if not self.flat else ("rz", f"(0,{lift})")
        end = f"({place[0] + lift},{place[1]},{luck.uniform(0, h)})" if not self.flat else f"(0,{place[1] + lift})"
        self.decks = [f"""dimension {'axisymmetric' if self.flat else 3}
grid cell={h}{' r=0:open' if self.flat else ''}
METHOD
time end={gap/self.v + 6/self.v**0.2 + 0.5/self.v} cfl=0.5
material a elastic density=1 young=1 poisson=0.3
material b elastic density={heavy} young={heavy} poisson=0.3
body a sphere material=a centre={start} radius=1 ppc=2
body b sphere material=b centre={end} radius=1 ppc=2
velocity a {axes[0]}={one[0] if not self.flat else 0} {axes[1]}={one[1]}
velocity b {axes[0]}={two[0] if not self.flat else 0} {axes[1]}={two[1]}
contact all
history steps=50
output csv at=end fields=velocity,mass,body
"""]

    def errors(self, results):
        if self.flat:
            u, w = (body_end(results[0], name, "velocity_z") for name in "ab")
            return [("velocity between the balls", abs(u - w)/self.v - 1, 0.05)]
        (_, u, spin), (_, w, turn) = (moments(results[0].rows, i + 1, name) for i, name in enumerate("ab"))
        return [("velocity between the balls", math.dist(u, w)/self.v - 1, 0.05), ("spin", spin/self.v, 0.05),
                ("spin of the other", turn/self.v, 0.05)]


class Rub(Truth):
    """A disk or a ball that hits a rigid plate with friction at a flat angle and slides throughout: what it loses along
    the plate is the coefficient of friction times what it gets across, and its spin follows."""

    def make(self):
        luck = self.luck
        radius, space = luck.choice((6, 8, 12)), luck.choice(("2", "2", "3"))
        radius = min(radius, 6) if space == "3" else radius
        self.cells, h, self.mu = 2*radius, 1/radius, luck.choice((0.1, 0.3))
        self.fall = luck.choice((0.003, 0.01))
        self.part = 2.0 if space == "2" else 2.5
        slide = luck.uniform(1.2, 1.6)*2*self.mu*self.fall*(1 + self.part)
        gap, self.angle = luck.uniform(0.3, 2.0)*h, luck.choice((0.0, luck.uniform(0, 2*math.pi)))
        self.slide, walls = slide, self.angle == 0.0 and luck.random() < 0.6
        gap += 1.5*h if walls else 0.0
        wait = gap/self.fall + 6/self.fall**0.2
        if walls:
            floor, ground = f" y={-1 - gap}:open", f"wall y-=slip\nwallfriction y- friction={self.mu}"
        else:
            x, y = turned(self.angle, 0, -1 - gap)
            deep = "" if space == "2" else ",-2"
            floor = ""
            ground = (
                f"body plate block material=m lower=({x - 4},{y - 4*h}{deep}) "
                f"upper=({x + 4 + 2*slide*wait},{y}{deep.replace('-', '')}) ppc=2 rotation={math.degrees(self.angle)} "
                f"pivot=({x},{y})\nrigid plate\ncontact ball plate friction={self.mu}"
            )
        velocity = turned(self.angle, slide, -self.fall)
        self.decks = [f"""dimension {space}
grid cell={h}{floor}
METHOD
time end={wait + 0.3/self.fall} cfl=0.5
material m elastic density=1 young=1 poisson=0.3
body ball sphere material=m radius=1 ppc=2
velocity ball x={velocity[0]} y={velocity[1]}
{ground}
history steps=50
output csv at=end fields=velocity,mass,body
"""]

    def errors(self, results):
        _, v, spin = moments(results[0].rows, 1, "ball")
        along, up = turned(-self.angle, v[0], v[1])
        kick = up + self.fall
        return [("velocity along the plate", (self.slide - along)/(self.mu*kick) - 1, 0.1),
                ("spin", -spin/(self.part*self.mu*kick) - 1, 0.1)]


class Expand(Truth):
    """A thin ring of perfectly plastic metal that is thrown outwards: v^2 falls by 2 Y/rho ln(R/R0), in plane strain
    with 2/sqrt(3) Y."""

    def make(self):
        luck = self.luck
        self.cells, thin = luck.choice((3, 4, 6)), luck.choice((6, 10))
        h, flat = 1/self.cells, luck.random() < 0.5
        strength, self.radius = 0.002, thin + 0.5
        drag = strength*(2/math.sqrt(3) if flat else 1.0)
        last, self.part = luck.choice((0.05, 0.15, 0.3)), luck.uniform(0.3, 0.8)
        self.v = math.sqrt(2*drag*last)  # comes to rest at a strain of `last`
        self.end, self.left = self.travel(drag)
        if flat:
            x, y = luck.random(), luck.random()
            place, body = "", f"ring material=m centre=({x},{y}) radius={thin + 1} inner={thin}"
            away = f"sqrt((x-{x})^2+(y-{y})^2)"
            motion = f"x=\"{self.v}*(x-{x})/{away}\" y=\"{self.v}*(y-{y})/{away}\""
        else:
            shift, up = luck.uniform(0, h), luck.uniform(0, h)
            place = " r=0:open"
            body = f"block material=m lower=({thin + shift},{up}) upper=({thin + 1 + shift},{1 + up})"
            motion = f"r={self.v}"
        self.decks = [f"""dimension {'2' if flat else 'axisymmetric'}
grid cell={h}{place}
METHOD
time end={self.end} cfl=0.5
material m {luck.choice(('j2', 'johnson_cook'))} density=1 young=1 poisson=0.3 yield={strength}
body m {body} ppc=2
velocity m {motion}
history steps=50
"""]

    def travel(self, drag):
        """Time at which a part of the energy is gone, and the velocity then."""
        time, radius, v, dt = 0.0, self.radius, self.v, 1e-3*self.radius/self.v/100
        while v**2 > (1 - self.part)*self.v**2:
            v -= dt*drag/radius
            radius += dt*v
            time += dt
        return time, v

    def errors(self, results):
        first, last = results[0].history[0], results[0].history[-1]
        found = math.sqrt(last["kinetic_energy"]/first["kinetic_energy"])
        return [("velocity", found - self.left/self.v, 0.05)]


class Burst(Shell):
    """A ball or a cylinder of compressed gas bursts in a thinner one: radial velocity of that one."""

    kinds = ("ball",)
    allowed = 0.05

    def ball(self):
        """Gas in gas."""
        luck, inner = self.luck, self.luck.choice((1, 2))
        self.cells = luck.choice((6, 8, 12))
        self.h = 1/self.cells
        pressure, density = luck.choice((3.0, 10.0, 100.0)), luck.choice((1.0, 4.0))
        hot, cold = gas("hot", density, pressure), gas("cold", 1.0, 1.0)
        hot.loud = math.sqrt(1.4*pressure/density)
        return (
            True, [(hot, 0, inner, 0.0), (cold, inner, 4*inner, 0.0)], luck.uniform(0.7, 1.5)*inner/hot.loud,
        )

    def deck(self, space):
        """A quarter or an eighth of the scene; every other one fills a box."""
        text = super().deck(space)
        if self.luck.random() < 0.5:
            return text
        wide = 4*self.layers[0][2]
        corner, axes = {"2": (f"({wide},{wide})", "xy"), "axisymmetric": (f"({wide},{wide})", "rz"),
                        "3": (f"({wide},{wide},{wide})", "xyz")}[self.space]
        zero = corner.replace(f"{wide}", "0")
        lines = []
        for line in text.splitlines():
            if line.startswith("body b1 sphere"):
                line = f"body b1 block material=cold lower={zero} upper={corner} ppc=2"
            if line.startswith("grid"):
                line = line.replace(":open", f":{wide}")
            if line.startswith("wall"):
                line += "".join(f" {axis}+=slip" for axis in axes)
            lines.append(line)
        left = [line for line in lines if not line.startswith("intersect b1") and line != "contact all"]
        return "\n".join(left) + "\n"

    def boxed(self):
        """Whether the outer gas is a block."""
        return "body b1 block" in self.decks[0]

    def found(self, result):
        """Mean radial velocity of the outer gas; of a block's, that within the ball."""
        if not self.boxed():
            return super().found(result)
        axes = {"2": "xy", "axisymmetric": "rz", "3": "xyz"}[self.space]
        keys = axes if axes[0] in result.rows[0] else "xz"
        push = sum(
            row["mass"]*sum(row[key]*row[f"velocity_{key}"] for key in keys)/math.hypot(*(row[key] for key in keys))
            for row in result.rows if row["body"] in (2, "b1")
        )
        _, low, high, _ = self.layers[1]
        part = {"2": math.pi/4*(high**2 - low**2), "axisymmetric": 2*math.pi/3*(high**3 - low**3),
                "3": math.pi/6*(high**3 - low**3)}[self.space]
        return [push/part]

    def row(self):
        return Row(
            [Layer(matter.law, low, high, max(100, math.ceil((high - low)*6*self.cells)))
             for matter, low, high, _ in self.layers], order=2 if self.space != "2" else 1,
            right=self.layers[1][2] if self.boxed() else None,
        )

    def truth(self):
        self.metals = [1]
        return super().truth()


class Slosh(Truth):
    """Small standing waves of water in a box: frequency, omega^2 = g k tanh(k H)."""

    def make(self):
        luck = self.luck
        self.cells, long, number = luck.choice((8, 12, 16)), luck.choice((1, 2)), luck.choice((1, 1, 2))
        h, k = 1/self.cells, math.pi*number/long
        omega = math.sqrt(k*math.tanh(k))
        self.period = 2*math.pi/omega
        high = luck.choice((0.02, 0.05))
        size = high*omega/math.sinh(k)  # of the velocities
        self.decks = [f"""dimension 2
grid cell={h} x=0:{long} y=0:open
wall x-=slip x+=slip y-=slip
METHOD
time end={4*self.period} cfl=0.4
gravity (0,-1)
material m fluid density=1
eos m tait c0=15
initial_stress m surface=1
body m block material=m lower=(0,0) upper=({long},1) ppc=2
velocity m x="{-size}*sin({k}*x)*cosh({k}*y)" y="{size}*cos({k}*x)*sinh({k}*y)"
history steps=10
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Lid(Truth):
    """A circular plate that is held at its rim, under pressure, damped to rest: deflection in the middle with shear."""

    def make(self):
        luck = self.luck
        self.cells, slim, nu = luck.choice((3, 4, 6, 8)), luck.choice((6, 10)), luck.choice((0.0, 0.3))
        h, load, lift = 1/self.cells, 1e-7, luck.choice((0, 0.25, 0.5))
        stiff = 1/(12*(1 - nu**2))
        self.exact = load*(slim**4/(64*stiff) + slim**2*2*(1 + nu)/4*1.2)
        omega = 10.22*math.sqrt(stiff)/slim**2
        self.decks = [f"""dimension axisymmetric
grid cell={h} r=0:{slim} z=open
wall r+=fixed
METHOD
time end={14/omega} cfl=0.5
damping rate={2*omega}
material m elastic density=1 young=1 poisson={nu}
body m block material=m lower=(0,{lift*h}) upper=({slim},{1 + lift*h}) ppc=2
pressure m face=z+ p={load}
history steps=50
output csv at=end fields=displacement,initial_position
"""]

    def errors(self, results):
        rows = results[0].rows
        keys = ("r0", "displacement_z") if "r0" in rows[0] else ("x0", "displacement_z")
        middle = [row[keys[1]] for row in rows if row[keys[0]] < 0.6/self.cells]
        return [("deflection", -sum(middle)/len(middle)/self.exact - 1, 0.05)]


class Push(Truth):
    """A pressure on one face of a block at any angle that flies freely: its momentum."""

    def make(self):
        luck = self.luck
        self.cells, space = luck.choice((3, 4, 6)), luck.choice(("2", "2", "3"))
        h, load, end = 1/self.cells, 1e-3, luck.uniform(5, 30)
        angle = luck.choice((0.0, luck.uniform(0, 2*math.pi)))
        self.wide = luck.choice((1, 2))
        self.gain = 0.5*load*end
        self.way = turned(angle, 1, 0)
        low = [luck.uniform(0, h) for _ in range(int(space))]
        high = [low[0] + 1] + [one + self.wide for one in low[1:]]
        self.decks = [f"""dimension {space}
grid cell={h}
METHOD
time end={end} cfl=0.5
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=({','.join(map(str, low))}) upper=({','.join(map(str, high))}) ppc=2 &
  rotation={math.degrees(angle)}
pressure m face=x- p="{load}*t/{end}"
history steps=50
"""]

    def errors(self, results):
        v = [body_end(results[0], "m", f"velocity_{axis}") for axis in "xy"]
        along = v[0]*self.way[0] + v[1]*self.way[1]
        return [("velocity", along/self.gain - 1, 0.03), ("across", math.hypot(*v)/self.gain - 1, 0.03)]


CLASSES = (Mallet, Glance, Rub, Expand, Burst, Slosh, Lid, Push)
