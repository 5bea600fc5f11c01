"""More classes of tests/fuzz/_truths.py: what turns, rolls and is pressed; gas that flies off, blasts of a point."""
import math

from _lagrange import Gas, Layer, Row
from _truths import Truth
from _truths_impacts import moments, turned


class Whirl(Truth):
    """A disc that turns about its axis on a rough plane, a rigid plate or another disc that slips, under its weight:
    its rate by Coulomb's law. Without Poisson's ratio it is pressed on evenly."""

    def make(self):
        luck = self.luck
        self.card = f"method sgmp update={luck.choice(('musl', 'musl', 'usf', 'usl', 'usavg'))}"
        self.cells, mu, below = luck.choice((4, 6, 8)), luck.choice((0.1, 0.3)), luck.choice((True, False))
        h, radius, start = 0.5/self.cells, luck.choice((0.5, 1.0, 2.0)), luck.uniform(0.3, 0.6)
        young, begin, self.kind = luck.choice((250, 1000)), 0.3, luck.choice(("wall", "wall", "plate", "disc"))
        end = begin/2 + start*radius/(4/3*mu)*luck.uniform(0.5, 0.8)
        end = max(end, 1.5*begin)
        start = max(start, 1.4*(4/3*mu*(end - begin/2)/radius))
        self.truth = start - 4/3*mu*(end - begin/2)/radius
        self.allowed = 0.05
        if self.kind == "disc" and self.truth < 0.5*start:  # both turn alike in the end, and twist: waves of friction
            self.truth = 0.5*start
            self.allowed = max(0.05, mu/math.sqrt(0.5*young)/(0.5*start*radius))
        self.scale = start
        up = 1 if below else -1
        def block(name, low, high):
            low, high = (low, high) if below else (-high, -low)
            return f"body {name} block material=m lower=(0,{low}) upper=({radius},{high}) ppc=2"
        face, grid = ("z-", "z=0:open") if below else ("z+", "z=open:0")
        if self.kind == "plate":
            ground = f"{block('plate', -2*h, 0)}\nrigid plate\ncontact b plate friction={mu}"
            grid, wall = "", ""
        elif self.kind == "disc":
            ground = f"{block('a', -0.5, 0)}\ncontact a b friction={mu}"
            grid = "z=-0.5:open" if below else "z=open:0.5"
            wall = f"wall {face}=slip"
        else:
            ground, wall = f"wallfriction {face} friction={mu}", f"wall {face}=slip"
        self.decks = [f"""dimension axisymmetric swirl=yes
grid cell={h} r=0:open {grid}
{wall}
METHOD
time end={end} cfl=0.4
material m elastic density=1 young={young} poisson=0
{block('b', 0, 0.5)}
{ground}
velocity b spin={start}
bodyforce all z="{-up}*sin(pi/2*min(t/{begin},1))^2"
history steps=50
output csv at=end fields=velocity,mass,body
"""]

    def errors(self, results):
        rows = [row for row in results[0].rows if row["body"] in (1, "b")]
        rate = sum(row["mass"]*row["x"]*row["velocity_y"] for row in rows)/sum(
            row["mass"]*row["x"]**2 for row in rows)
        return [("rate", (rate - self.truth)/(self.scale - self.truth), self.allowed)]


class Twist(Truth):
    """A rod that is twisted slowly between two grips: torque by its shear modulus, or by its yield stress where all of
    it yields."""

    def make(self):
        luck = self.luck
        self.card = f"method sgmp update={luck.choice(('musl', 'musl', 'usf', 'usl', 'usavg'))}"
        radius, slim = luck.choice((4, 6, 8)), luck.choice((3, 4))
        self.cells, h, z = 2*radius, 1/radius, luck.random()
        plastic, nu = luck.choice((True, False)), luck.choice((0.25, 0.3))
        shear, end = 1/(2*(1 + nu)), 80.0*slim
        grip, yields = 2*h, 1e-3
        angle = slim*(yields/math.sqrt(3)/shear)*12 if plastic else luck.choice((1e-3, 1e-2))*slim
        self.truth = 2*math.pi/3*yields/math.sqrt(3) if plastic else shear*math.pi/2*angle/slim
        rate = angle/(0.8*end)
        matter = (f"j2 density=1 young=1 poisson={nu} yield={yields}" if plastic else
                  f"elastic density=1 young=1 poisson={nu}")
        self.decks = [f"""dimension axisymmetric swirl=yes
grid cell={h} r=0:open
METHOD
time end={end} cfl=0.5
damping rate=0.5
material m {matter}
body m block material=m lower=(0,{z - grip}) upper=(1,{z + slim + grip}) ppc=2
motion m where="z<{z}" z=0 spin=0
motion m where="z>{z + slim}" z=0 spin="{rate}*min(t/{0.1*end},1)*min(max({0.9*end}-t,0)/{0.1*end},1)"
history every={0.02*end}
"""]

    def errors(self, results):
        return [("torque", results[0].motions[-1]["torque_z"]/self.truth - 1, 0.05)]


class Roll(Truth):
    """A disk or a ball that gravity draws down a rough incline at any angle, or down the floor of a grid along the
    incline: it rolls, or slides and turns."""

    def make(self):
        luck = self.luck
        radius, space = luck.choice((6, 8, 12)), luck.choice(("2", "2", "3"))
        radius = min(radius, 6) if space == "3" else radius
        self.cells, h, slope = 2*radius, 1/radius, math.radians(luck.choice((5, 10, 20, 30)))
        inertia = 0.5 if space == "2" else 0.4
        sticks = math.tan(slope)/(1 + 1/inertia)
        mu = luck.choice((0.4*sticks, 0.6*sticks, 2*sticks, 4*sticks))
        self.angle = luck.choice((0.0, luck.uniform(0, 2*math.pi)))
        g, young, begin = 1e-3, 1.0, 10.0
        end = luck.uniform(60, 100)
        self.pull = g*(end - begin/2)
        held = min(mu*math.cos(slope), math.sin(slope)/(1 + 1/inertia))
        self.way = self.pull*(math.sin(slope) - held)
        self.turn = self.pull*held/inertia
        down = turned(self.angle, g*math.sin(slope), -g*math.cos(slope))
        x, y = turned(self.angle, 0, -1)
        deep = "" if space == "2" else ",-2"
        long = 4 + 0.5*g*math.sin(slope)*end**2
        ramp = f"sin(pi/2*min(t/{begin},1))^2"
        shape, floor = luck.choice(("sphere", "cylinder" if space == "2" else "sphere")), ""
        if self.angle == 0.0 and luck.random() < 0.6:
            floor, ground = " y=-1:open", f"wall y-=slip\nwallfriction y- friction={mu}"
        else:
            ground = (
                f"body plate block material=m lower=({x - 4},{y - 4*h}{deep}) "
                f"upper=({x + long},{y}{deep.replace('-', '')}) ppc=2 rotation={math.degrees(self.angle)} "
                f"pivot=({x},{y})\nrigid plate\ncontact ball plate friction={mu}"
            )
        self.decks = [f"""dimension {space}
grid cell={h}{floor}
METHOD
time end={end} cfl=0.5
material m elastic density=1 young={young} poisson=0.3
body ball {shape} material=m radius=1 ppc=2
{ground}
bodyforce ball x="{down[0]}*{ramp}" y="{down[1]}*{ramp}"
history steps=50
output csv at=end fields=velocity,mass,body
"""]

    def errors(self, results):
        _, v, spin = moments(results[0].rows, 1, "ball")
        along, _ = turned(-self.angle, v[0], v[1])
        # where it slides little turns it, and all else may do as much
        return [("velocity", (along - self.way)/self.way, 0.05), ("spin", (-spin - self.turn)/self.way, 0.1)]


# Depth of a ball that bounces, over Hertz's, by speed and Poisson's ratio: verification/surfaces/balls.py
BALL_DEPTH = {(0.01, 0.0): 0.957, (0.01, 0.3): 0.938, (0.03, 0.0): 0.922, (0.03, 0.3): 0.901}


class Hertz(Truth):
    """An elastic ball meets a rigid plane or its like so slowly that it is at rest inside: how far it comes, and its
    velocity afterwards (Hertz, and what finite elements add)."""

    def make(self):
        luck = self.luck
        radius, self.v = luck.choice((8, 12, 16, 24)), luck.choice((0.01, 0.03))
        self.cells, h, nu = 2*radius, 1/radius, luck.choice((0.0, 0.3))
        self.kind = luck.choice(("wall", "plate", "ball"))
        modulus = 1/(1 - nu**2)
        mass = 4/3*math.pi
        # two balls: half of the mass, of the radius and of the modulus, twice the velocity
        self.depth = BALL_DEPTH[self.v, nu]*(15*mass*self.v**2/(16*modulus))**0.4
        last = 2.94*self.depth/self.v
        gap = luck.uniform(1.5, 2.5)*h
        end = gap/self.v + 1.3*last
        z = luck.random()*(self.kind != "wall")
        ground, grid, wall = "", "", ""
        if self.kind == "wall":
            grid, wall = "z=0:open", "wall z-=slip"
        elif self.kind == "plate":
            ground = (f"body plate block material=m lower=(0,{z - 4*h}) upper=(1.5,{z}) ppc=2\nrigid plate\n"
                      "contact a plate")
        else:
            ground = (f"body b sphere material=m centre=(0,{z - 1 - gap}) radius=1 ppc=2\nvelocity b z={self.v}\n"
                      "contact a b")
        self.start = z + 1 + gap
        self.gap = gap
        self.decks = [f"""dimension axisymmetric
grid cell={h} r=0:open {grid}
{wall}
METHOD
time end={end} cfl=0.5
material m elastic density=1 young=1 poisson={nu}
body a sphere material=m centre=(0,{self.start}) radius=1 ppc=2
velocity a z={-self.v}
{ground}
history steps=4
"""]

    def errors(self, results):
        rows = [row for row in results[0].bodies if row["name"] == "a"]
        depth = self.start - self.gap - min(row["z"] for row in rows)
        found = [("velocity", rows[-1]["velocity_z"]/self.v - 1, 0.05)]
        # a wall of the grid acts up to half a cell late; nothing is known to less than a tenth of a cell
        allowed = max(0.05, 0.2/(self.cells*self.depth))
        return found + [("depth", depth/self.depth - 1, allowed)]*(self.kind != "wall")


class Vacuum(Truth):
    """Gas that is let go into empty space: what has left its place, and how fast."""

    def make(self):
        luck = self.luck
        space, gamma = luck.choice(("1", "2", "3")), luck.choice((1.4, 5/3))
        self.cells = luck.choice({"1": (50, 100), "2": (30, 60), "3": (24,)}[space])
        h, c = 1/self.cells, math.sqrt(gamma)
        end = luck.uniform(0.4, 0.9)/c
        self.truth = c*(2/(gamma + 1))**((gamma + 1)/(gamma - 1))*end
        self.speed = end/self.truth  # all that has left has the momentum of the pressure p0 = 1 at the wall
        wide = 4*h
        self.wide = wide**(int(space) - 1)
        axis = luck.choice("xyz"[:int(space)])
        self.axis, side = axis, luck.choice((1, -1))
        self.side = side
        axes = "xyz"[:int(space)]
        low = [(0 if side == 1 else -1) if a == axis else 0 for a in axes]
        high = [(1 if side == 1 else 0) if a == axis else wide for a in axes]
        grid = " ".join(f"{a}={'0:open' if side == 1 else 'open:0'}" if a == axis else f"{a}=0:{wide}" for a in axes)
        walls = " ".join((f"{a}-=slip" if side == 1 else f"{a}+=slip") if a == axis else f"{a}-=slip {a}+=slip"
                         for a in axes)
        def point(values):
            return str(values[0]) if len(values) == 1 else f"({','.join(str(value) for value in values)})"
        self.decks = [f"""dimension {space}
grid cell={h} {grid}
wall {walls}
METHOD
time end={end} cfl={luck.choice((0.2, 0.4))}
material a fluid density=1
eos a ideal_gas gamma={gamma} pressure0=1
viscosity all
body a block material=a lower={point(low)} upper={point(high)} ppc=2
history steps=20
output csv at=end fields=velocity,mass
"""]

    def errors(self, results):
        rows = [row for row in results[0].rows if row[self.axis]*self.side > 1]
        left = sum(row["mass"] for row in rows)/self.wide
        layer = 0.5/self.cells  # of particles: mass is counted to half of one
        return [("mass", left/self.truth - 1, 0.05 + 0.5*layer/self.truth)]


class Flash(Truth):
    """Energy in a few cells of cold gas, at a point, on a line or in a plane (Sedov's blast, before it is alike at all
    times): how far it has come, how fast its gas is, by a Lagrangian code of its own."""

    ALPHA = {"sphere": 0.851, "cylinder": 0.984, "plane": 1.077}  # of Sedov: E t^2/(rho R^(n + 2)), gamma = 1.4
    CORE = 3  # cells

    def make(self):
        luck = self.luck
        self.shape = luck.choice(tuple(self.ALPHA))
        self.n = {"sphere": 3, "cylinder": 2, "plane": 1}[self.shape]
        self.cells = luck.choice((40, 60, 150) if self.shape == "plane" else (40, 60))
        h = 1/self.cells
        core = self.CORE*h
        self.end = math.sqrt(self.ALPHA[self.shape]*luck.uniform(0.6, 0.75)**(self.n + 2))
        self.energy = 1/{"sphere": 4/3*math.pi*core**3, "cylinder": math.pi*core**2, "plane": 2*core}[self.shape]
        flat = self.shape == "cylinder" and luck.random() < 0.5
        head, grid, walls = {
            "plane": ("1", "x=0:open", "x-=slip"), "sphere": ("axisymmetric", "r=0:open z=0:open", "z-=slip"),
            "cylinder": ("2", "x=0:open y=0:open", "x-=slip y-=slip") if flat else
                        ("axisymmetric", f"r=0:open z=0:{4*h}", "z-=slip z+=slip"),
        }[self.shape]
        if self.shape == "sphere" or flat:
            round_ = "sphere radius" if self.shape == "sphere" else "cylinder length=1 radius"
            bodies = [f"body a {round_}={core} material=hot ppc=2", "intersect a block lower=(0,0) upper=(1,1)",
                      f"body b {round_}=1 material=cold ppc=2", f"subtract b {round_}={core}",
                      "intersect b block lower=(0,0) upper=(1,1)"]
        else:
            low, high = ("0", "{}") if self.shape == "plane" else ("(0,0)", f"({{}},{4*h})")
            start = low if self.shape == "plane" else "(0,0)"
            inner = f"{core}" if self.shape == "plane" else f"({core},0)"
            bodies = [f"body a block material=hot lower={start} upper={high.format(core)} ppc=2",
                      f"body b block material=cold lower={inner} upper={high.format(1)} ppc=2"]
        self.decks = ["\n".join((
            f"dimension {head}", f"grid cell={h} {grid}", f"wall {walls}", "METHOD",
            f"time end={self.end} cfl={luck.choice((0.2, 0.4))}", "material hot fluid density=1",
            f"eos hot ideal_gas gamma=1.4 energy0={self.energy}", "material cold fluid density=1",
            "eos cold ideal_gas gamma=1.4 energy0=1e-6", "viscosity all", *bodies, "history steps=20",
            "output csv at=end fields=velocity,mass")) + "\n"]

    def radial(self, rows):
        """Radius, radial velocity and mass of particles."""
        axes = ["x", "z" if "axisymmetric" in self.decks[0] else "y"]
        axes = axes[:1] if self.shape == "plane" or (self.shape == "cylinder" and axes[1] == "z") else axes
        for row in rows:
            r = math.hypot(*(row[axis] for axis in axes))
            yield r, sum(row[axis]*row[f"velocity_{axis}"] for axis in axes)/max(r, 1e-9), row["mass"]

    @staticmethod
    def of(parts):
        """Mean velocity beyond half of the largest radius at which gas moves, and that radius: there the mean over the
        mass around is half of the largest."""
        parts = sorted(parts)
        total, means, wide = sum(mass for _, _, mass in parts), [], []
        for r, v, mass in parts:
            wide.append((r, v, mass))
            if sum(one[2] for one in wide) > 0.01*total:
                weight = sum(one[2] for one in wide)
                means.append((wide[-1][0], sum(one[1]*one[2] for one in wide)/weight, weight))
                wide = []
        best = max(range(len(means)), key=lambda i: means[i][1])
        front = next((one[0] for one in means[best:] if one[1] < 0.5*means[best][1]), means[-1][0])
        return front, sum(one[1]*one[2] for one in means)/total

    def errors(self, results):
        core = self.CORE/self.cells
        hot, cold = Gas(1.0, 1.4, 0.4*self.energy), Gas(1.0, 1.4, 0.4e-6)
        row = Row([Layer(hot, 0.0, core, 40), Layer(cold, core, 1.0, 400)], self.n - 1, left=0.0).run(self.end)
        middle = 0.5*(row.x[row.first] + row.x[row.first + 1]), 0.5*(row.v[row.first] + row.v[row.first + 1])
        front, mean = self.of(zip(*middle, row.mass))
        found, moves = self.of(self.radial(results[0].rows))
        return [("radius", found/front - 1, 0.05), ("velocity", moves/mean - 1, 0.05)]


CLASSES = (Whirl, Twist, Roll, Hertz, Vacuum, Flash)
