"""More classes of tests/fuzz/_truths.py: solids that vibrate, stand, are squeezed, bounce."""
import json
import math
from pathlib import Path

from _plates import Plate
from _truths import SMALL, Truth, body_end, vibration, zero

REBOUNDS = json.loads((Path(__file__).resolve().parents[2] / "verification/surfaces/bounce.json").read_text())


class Segments(Truth):
    """A bar at a wall with another, heavier one at its end, in their first mode: frequency, by matching displacement
    and force where they meet."""

    def make(self):
        n, heavy, stiff, end = (
            self.luck.choice((8, 10, 20, 40)), self.luck.choice((2, 4, 16)), self.luck.choice((1, 4)), 0.5,
        )
        self.cells = end*n
        slow = math.sqrt(heavy/stiff)  # slowness of the second

        def unbalanced(omega):
            return math.cos(omega)*math.cos(omega*slow*end) - stiff*slow*math.sin(omega)*math.sin(omega*slow*end)

        omega = zero(unbalanced, 1e-3, min(0.5*math.pi, 0.5*math.pi/(slow*end)))
        self.period = 2*math.pi/omega
        ratio = math.sin(omega)/math.cos(omega*slow*end)
        self.decks = [f"""dimension 1
grid cell={1/n} x=0:open
wall x-=fixed
METHOD
time end={2.4*self.period} cfl={self.luck.choice((0.3, 0.5))}
material a elastic density=1 young=1 poisson=0
material b elastic density={heavy} young={stiff} poisson=0
body a block material=a lower=0 upper=1 ppc=2
body b block material=b lower=1 upper={1 + end} ppc=2
velocity a x="1e-3*sin({omega}*x)"
velocity b x="1e-3*{ratio}*cos({omega*slow}*({1 + end}-x))"
history steps=1
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Weight(Truth):
    """A cantilever under its own weight, damped to rest: deflection by beam theory with shear."""

    def make(self):
        self.cells = self.luck.choice((3, 4, 6))
        h, slim, lift = 1/self.cells, 5, self.luck.choice((0, 0.25, 0.5))
        omega, g, stiff = 3.516*math.sqrt(1/(12*(1 - 0.3**2)))/slim**2, 1e-7, 1/(1 - 0.3**2)
        self.slim = slim
        self.exact = g*(12*slim**4/(8*stiff) + 1.2*slim**2/2*2*1.3)
        self.decks = [f"""dimension 2
grid cell={h} x=0:open
wall x-=fixed
METHOD
time end={14/omega} cfl=0.5
damping rate={2*omega}
gravity (0,{-g})
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=(0,{lift*h}) upper=({slim},{1 + lift*h}) ppc=2
history steps=50
output csv at=end fields=displacement,initial_position
"""]

    def errors(self, results):
        end = [row["displacement_y"] for row in results[0].rows if row["x0"] > self.slim - 0.8/self.cells]
        return [("deflection", -sum(end)/len(end)/(self.exact*(1 - 4/3*0.5/self.cells/self.slim)) - 1, 0.05)]


class Drop(Truth):
    """A bar on a wall on which gravity begins to act at once: its top after half a period, twice as deep as at rest."""

    def make(self):
        self.cells, g, space = (
            self.luck.choice((8, 12, 24)), self.luck.choice((1e-4, 1e-3)), self.luck.choice(("1", "2")),
        )
        h = 1/self.cells
        grid, upper, walls, down = (
            ("", "1", "", "-{}") if space == "1" else (f" y=0:{4 * h}", f"(1,{4 * h})", " y-=slip y+=slip", "(-{},0)")
        )
        self.exact = g*(1 - (0.25*h)**2)  # of the outermost particles
        self.h = h
        self.decks = [f"""dimension {space}
grid cell={h} x=0:open{grid}
wall x-=slip{walls}
METHOD
time end=2 cfl={self.luck.choice((0.3, 0.5))}
gravity {down.format(g)}
material m elastic density=1 young=1 poisson=0
body m block material=m lower={'0' if space == '1' else '(0,0)'} upper={upper} ppc=2
history steps=20
output csv at=end fields=displacement,initial_position
"""]

    def errors(self, results):
        end = [row["displacement_x"] for row in results[0].rows if row["x0"] > 1 - 0.4*self.h]
        return [("way of the top", -sum(end)/len(end)/self.exact - 1, 0.05)]


class Bounce(Truth):
    """A bar that flies against a wall and comes back: its velocity, and where it turns."""

    def make(self):
        cells, v, space = self.luck.choice((10, 20, 40)), self.luck.choice((0.001, 0.01)), self.luck.choice(("1", "2"))
        h, self.v, self.cells = 1/cells, v, cells
        gap = self.luck.choice((0.3, 1.5, 2.3))*h
        grid, lower, upper, walls = (("", f"{gap}", f"{1 + gap}", "") if space == "1" else
                                     (f" y=0:{4*h}", f"({gap},0)", f"({1 + gap},{4*h})", " y-=slip y+=slip"))
        self.decks = [f"""dimension {space}
grid cell={h} x=0:open{grid}
wall x-=slip{walls}
METHOD
time end={2*gap/v + 2.5} cfl={self.luck.choice((0.3, 0.5))}
material m elastic density=1 young=1 poisson=0
body m block material=m lower={lower} upper={upper} ppc=2
velocity m x={-v}
history steps=20
"""]

    def errors(self, results):
        turns = min(row["x"] for row in results[0].bodies)
        return [("velocity", body_end(results[0], "m", "velocity_x")/self.v - 1, 0.05),
                ("place where it turns", turns - 0.5*(1 - self.v), 0.05)]


# Restitution of bodies of Young's modulus and density 1 at a rigid frictionless wall, by finite elements
# (verification/surfaces/elements.py): shape, Poisson's ratio, yield stress, velocity, restitution.
RECOILS = (
    ("disk", 0.3, None, 0.003, 0.993), ("disk", 0.3, None, 0.03, 0.985), ("disk", 0.3, None, 0.1, 0.95),
    ("disk", 0.0, None, 0.03, 0.974), ("disk", 0.45, None, 0.03, 0.964), ("block", 0.3, None, 0.03, 0.79),
    ("block", 0.15, None, 0.03, 0.967), ("block", 0.45, None, 0.03, 0.69), ("disk", 0.3, 0.02, 0.0718, 0.16),
    ("block", 0.3, 0.02, 0.0718, 0.12), ("block", 0.3, 0.005, 0.0718, 0.023),
)


class Recoil(Truth):
    """A disk or a square of side 1 that flies at a slip wall of any face, elastic or not, with another beside it that
    does not: its velocity after it."""

    def make(self):
        shape, poisson, strength, v, self.truth = self.luck.choice(RECOILS)
        self.cells, self.axis, self.side = self.luck.choice((8, 12, 16, 24, 36)), self.luck.choice((0, 1)), \
            self.luck.choice((-1, 1))
        h, gap, self.v = 1/self.cells, self.luck.uniform(0.05, 3)/self.cells, self.side*v
        place = [self.luck.uniform(-1, 1) for _ in range(2)]
        wall = place[self.axis]
        place[self.axis] = wall - self.side*(0.5 + gap)
        name, low = "xy"[self.axis], self.side < 0
        corners = ",".join(f"{p - 0.5}" for p in place), ",".join(f"{p + 0.5}" for p in place)
        body = f"sphere centre=({place[0]},{place[1]}) radius=0.5" if shape == "disk" else \
            f"block lower=({corners[0]}) upper=({corners[1]})"
        law = f"j2 density=1 young=1 poisson={poisson} yield={strength}" if strength else \
            f"elastic density=1 young=1 poisson={poisson}"
        self.decks = [f"""dimension 2
grid cell={h} {name}={f"{wall}:open" if low else f"open:{wall}"}
wall {name}{"-" if low else "+"}=slip
METHOD
time end={gap/v + 12} cfl={self.luck.choice((0.3, 0.5))}
material m {law}
body m {body} material=m {self.luck.choice(("", "ppc=2", "ppc=3"))}
velocity m {name}={self.v}
history steps=20
"""]

    def errors(self, results):
        return [("velocity", (-body_end(results[0], "m", f"velocity_{'xy'[self.axis]}")/self.v - self.truth), 0.05)]


class Rebound(Truth):
    """Two rings or disks that bounce off each other along any line: mean velocity after it, by finite elements
    (verification/surfaces/references.py, which is not part of the program)."""

    def make(self):
        name = self.luck.choice(tuple(REBOUNDS))
        body, self.cells = REBOUNDS[name], self.luck.choice((3, 5, 8))
        radius, sound = body["outer"], math.sqrt(body["young"]/1.01e-3)  # young and density there (MPa, g/mm^3)
        inner = body["inner"]/radius
        h = (1 - inner)/self.cells if inner else 0.5/self.cells
        self.cells = self.cells if inner else 4*self.cells  # of a disk: across it
        angle, self.v, self.truth = self.luck.uniform(0, 2*math.pi), body["speed"]/sound, body["rebound"]
        self.along = math.cos(angle), math.sin(angle)
        reach, place = 1 + 0.5*h, (self.luck.random(), self.luck.random())
        layout = self.luck.choice(("", "ppc=2", "ppc=3"))
        shape = f"ring inner={inner}" if inner else "sphere"
        self.decks = [f"""dimension 2
grid cell={h}
METHOD
time end={body["end"]*sound/radius} cfl={self.luck.choice((0.3, 0.5))}
material m neo_hookean density=1 young=1 poisson={body["poisson"]}
""" + "".join(f"""body {body_name} {shape} material=m centre=({at[0]},{at[1]}) radius=1 {layout}
velocity {body_name} x={-side*self.v*self.along[0]} y={-side*self.v*self.along[1]}
""" for body_name, side, at in (
            (body_name, side, [place[axis] + side*reach*self.along[axis] for axis in range(2)])
            for body_name, side in (("a", 1), ("b", -1))
        )) + "contact a b\nhistory steps=20\n"]

    def errors(self, results):
        end = [body_end(results[0], "a", f"velocity_{axis}") for axis in "xy"]
        return [("velocity", sum(a*b for a, b in zip(end, self.along))/self.v/self.truth - 1, 0.05)]


class Hoop(Truth):
    """A thin ring that breathes, in the plane or about its axis: frequency of the membrane."""

    def make(self):
        self.cells = self.luck.choice((3, 4, 6))
        h, flat, nu = 0.2/self.cells, self.luck.random() < 0.5, self.luck.choice((0, 0.3))
        self.period = 2*math.pi*math.sqrt(1 - nu**2)
        if flat:
            x, y = self.luck.random(), self.luck.random()
            place, walls, body = "", "", f"ring material=m centre=({x},{y}) radius=1.1 inner=0.9"
            motion = f"x=\"1e-3*(x-{x})/hypot(x-{x},y-{y})\" y=\"1e-3*(y-{y})/hypot(x-{x},y-{y})\""
            motion = motion.replace(f"hypot(x-{x},y-{y})", f"sqrt((x-{x})^2+(y-{y})^2)")
        else:
            shift = self.luck.uniform(0, h)
            place, walls, body = (
                f"r=0:open z=0:{3 * h}", "wall z-=slip z+=slip\n",
                f"block material=m lower=({0.9 + shift},0) upper=({1.1 + shift},{3 * h})",
            )
            self.period *= 1 + shift
            motion = "r=1e-3"
        self.decks = [f"""dimension {'2' if flat else 'axisymmetric'}
grid cell={h} {place}
{walls}METHOD
time end={2.4*self.period} cfl=0.5
material m elastic density=1 young=1 poisson={nu}
body m {body} ppc=2
velocity m {motion}
history steps=2
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Torsion(Truth):
    """A free rod that is twisted about its axis, in its first mode: frequency."""

    def make(self):
        self.card = f"method sgmp update={self.luck.choice(('musl', 'usf', 'usl', 'usavg'))}"
        radius = self.luck.choice((3, 4, 8))
        self.cells = 2*radius
        slim, h, z, nu = self.luck.choice((3, 5)), 1/radius, self.luck.random(), self.luck.choice((0, 0.3))
        self.period = 2*slim*math.sqrt(2*(1 + nu))
        self.decks = [f"""dimension axisymmetric swirl=yes
grid cell={h} r=0:open
METHOD
time end={2.4*self.period} cfl=0.5
material m elastic density=1 young=1 poisson={nu}
body m block material=m lower=(0,{z}) upper=(1,{z + slim}) ppc=2
velocity m spin="1e-3*cos({math.pi/slim}*(z-{z}))"
history steps=2
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Press(Truth):
    """A block that a moved part squeezes slowly between walls: stress along it by the law at the strain that its
    particles show; heat of Johnson and Cook's."""

    def make(self):
        self.cells, self.law = (
            self.luck.choice((4, 8)),
            self.luck.choice(("elastic", "neo_hookean", "j2", "johnson_cook", "crushable_foam")),
        )
        space, h, squeeze = self.luck.choice(("1", "2")), 1/self.cells, self.luck.choice((0.05, 0.2, 0.4))
        if self.law in ("elastic", "neo_hookean"):
            squeeze = min(squeeze, 0.2)
        grid, lower, upper, walls = (
            ("", "0", "2.25", "") if space == "1" else (f" y=0:{4 * h}", "(0,0)", f"(2.25,{4 * h})", " y-=slip y+=slip")
        )
        matter = {
            "elastic": "poisson=0.3",
            "neo_hookean": "poisson=0.3",
            "j2": "poisson=0.3 yield=0.01",
            "johnson_cook": "poisson=0.3 yield=0.01 thermal=yes melt_temperature=1293 "
            "specific_heat=1e-5 thermal_exponent=1",
            "crushable_foam": "poisson=0 plateau=0.01 linear_hardening=0.01 densification_strain=1.5",
        }[self.law]
        time = 60
        self.decks = [f"""dimension {space}
grid cell={h} x=0:open{grid}
wall x-=slip{walls}
METHOD
time end={time} cfl=0.5
material m {self.law} density=1 young=1 {matter}
body m block material=m lower={lower} upper={upper} ppc=2
motion m where="x>2" x="{-2*squeeze/time}*(1-cos({2*math.pi/time}*t))"
history steps=50
output csv at=end fields=displacement,initial_position,stress{',temperature' if self.law == 'johnson_cook' else ''}
"""]

    def exact(self, e):
        """Stress along it, and heating, at a logarithmic strain e > 0 of compression."""
        bulk, shear, lame = 1/1.2, 1/2.6, 0.3/(1.3*0.4)
        if self.law == "elastic":
            return -(bulk + 4/3*shear)*e, 0.0
        if self.law == "neo_hookean":
            stretch = math.exp(-e)
            return (shear*(stretch**2 - 1) + lame*math.log(stretch))/stretch, 0.0
        if self.law == "crushable_foam":
            plastic = (e - 0.01)/(1 + 0.01/1.5)
            return -(e - max(plastic, 0.0)), 0.0
        heat = 0.0
        if self.law == "johnson_cook":  # yield stress falls to 0 at 1000 degrees: dT = 0.9 Y de/(rho c)
            for _ in range(50):  # what is elastic depends on the heat
                plastic = max(0.0, 2/3*e - 0.01*(1 - heat/1000)/(3*shear))
                heat = 1000*(1 - math.exp(-0.9*0.01/1e-5*plastic/1000))
        strength = min(0.01*(1 - heat/1000), 2*shear*e)
        return -bulk*e - 2/3*strength, heat

    def errors(self, results):
        rows = [row for row in results[0].rows if 0.5 < row["x0"] < 1.5]
        mean = [sum(row[key] for row in rows)/len(rows) for key in ("x0", "displacement_x")]
        slope = sum((row["x0"] - mean[0]) * (row["displacement_x"] - mean[1]) for row in rows) / sum(
            (row["x0"] - mean[0]) ** 2 for row in rows
        )
        stress, heat = self.exact(-math.log(1 + slope))
        found = [("stress", sum(row["stress_xx"] for row in rows)/len(rows)/stress - 1, 0.05)]
        if heat:
            found.append(("heat", (sum(row["temperature"] for row in rows)/len(rows) - 293)/heat - 1, 0.05))
        return found


class Twin(Truth):
    """Two equal disks of a group that meet in a plane of nodes, and one of them at a wall in its place: velocity after
    it."""

    def make(self):
        self.cells = self.luck.choice((4, 6, 8))
        h, v, law = 0.5/self.cells, self.luck.uniform(0.02, 0.1), self.luck.choice(("elastic", "neo_hookean", "j2"))
        start = 0.5 + self.luck.choice((1, 2))*h
        head = f"""dimension 2
grid cell={h} {{}}
{{}}METHOD
time end={2 + 2*h/v} cfl=0.4
material m {law} density=1 young=1 poisson=0.3{' yield=0.02' if law == 'j2' else ''}
history steps=20
body a sphere material=m centre=({start},0) radius=0.5 ppc=2
velocity a x={-v}
"""
        other = f"body b sphere material=m centre=({-start},0) radius=0.5 ppc=2\nvelocity b x={v}\ngroup one a,b\n"
        self.v = v
        self.decks = [head.format("", "") + other, head.format("x=0:open", "wall x-=slip shift=none\n")]

    def errors(self, results):
        ends = [body_end(result, "a", "velocity_x") for result in results]
        return [("velocity", (ends[1] - ends[0])/self.v, SMALL)]


class Sector(Truth):
    """A ring that breathes and is pressed flat, whole and as a quarter between walls: energies."""

    def make(self):
        self.cells = self.luck.choice((2, 4, 6))
        h = 1/self.cells
        head = f"""dimension 2
grid cell={h} {{}}
{{}}METHOD
time end=12 cfl=0.4
material m {self.luck.choice(('elastic', 'neo_hookean'))} density=1 young=1 poisson=0.3
body m ring material=m centre=(0,0) radius=3 inner=2 ppc=2
{{}}velocity m x="{self.luck.uniform(-0.02, 0.02)}*x" y="{self.luck.uniform(-0.02, 0.02)}*y"
history steps=10
"""
        self.decks = [
            head.format("", "", ""),
            head.format("x=0:open y=0:open", "wall x-=slip y-=slip\n", "intersect m block lower=(0,0) upper=(4,4)\n"),
        ]

    def errors(self, results):
        ends = [result.history[-1] for result in results]
        total = ends[0]["kinetic_energy"] + ends[0]["internal_energy"]
        return [(key, (4*ends[1][key] - ends[0][key])/total, SMALL) for key in ("kinetic_energy", "internal_energy")]


class Disc(Truth):
    """A free circular plate about the axis in its first mode: frequency with shear and the inertia of rotation."""

    def make(self):
        self.cells = self.luck.choice((3, 4, 6, 8))
        thick, nu = self.luck.choice((0.1, 0.2, 0.25)), self.luck.choice((0.0, 0.3))
        h, plate, z = thick/self.cells, Plate(thick, nu), self.luck.uniform(-thick, thick)
        self.period = 2*math.pi/plate.omega
        deflection, slope = plate.mode()
        self.decks = [f"""dimension axisymmetric
grid cell={h}
METHOD
time end={2.4*self.period} cfl=0.5
material m elastic density=1 young=1 poisson={nu}
body m cylinder material=m radius=1 centre=(0,{z}) length={thick} ppc=2
velocity m r="1e-4*(z-{z + 0.5*thick})*{slope}" z="1e-4*{deflection}"
history steps=5
"""]

    def errors(self, results):
        return vibration(results[0], self.period)


class Held(Truth):
    """A strip at an angle whose ends are held under tension stays as it is: its stress is that of the start."""

    def make(self):
        self.cells = self.luck.choice((3, 4, 6))
        self.stress = self.luck.choice((0.02, 0.05, 0.1))
        angle, self.x, self.y = (self.luck.uniform(0, width) for width in (90, 1, 1))
        ways = self.luck.choice((10, 30, 100, 200))
        half, grip = 3.5*self.cells, 2.5*self.cells
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        self.turn = (c, s)
        self.decks = [f"""dimension 2
grid cell=1 x=open y=open
METHOD
time end={ways/self.stress} cfl=0.4
material m elastic density=1 young=1 poisson=0
body m block material=m lower=({self.x - half},{self.y - self.cells/2}) layout=uniform spacing=0.5 &
  upper=({self.x + half},{self.y + self.cells/2}) rotation={angle} pivot=({self.x},{self.y}) &
  jitter={self.luck.choice((0.001, 0.03, 0.1))}
motion m where="abs((x0-{self.x})*{c} + (y0-{self.y})*{s}) > {grip}" x=0 y=0
initial_stress m xx={self.stress*c*c} yy={self.stress*s*s} xy={self.stress*s*c}
history steps=100
output csv at=end fields=stress
"""]

    def errors(self, results):
        """The mean stress along the strip between its grips, and the elastic energy."""
        c, s = self.turn
        rows = [row for row in results[0].rows if abs((row["x"] - self.x)*c + (row["y"] - self.y)*s) < 2*self.cells]
        along = [row["stress_xx"]*c*c + row["stress_yy"]*s*s + 2*row["stress_xy"]*s*c for row in rows]
        energy = [row["internal_energy"] for row in results[0].history]
        return [("stress", sum(along)/len(along)/self.stress - 1, 0.05), ("energy", energy[-1]/energy[0] - 1, 0.1)]


CLASSES = (Segments, Weight, Drop, Bounce, Recoil, Rebound, Hoop, Torsion, Press, Twin, Sector, Disc, Held)
