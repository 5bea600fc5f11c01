"""More classes of tests/fuzz/_truths.py: bodies that are dragged, stand on inclines, collide aside of their middles."""
import math

from _truths import Truth, body_end
from _truths_impacts import turned


class Drag(Truth):
    """A block on a rigid plate that begins to move: it slides at friction times gravity, until it has its velocity.
    Its surface sticks and slips by turns before that (finer cells more), so no scene ends shortly before."""

    def make(self):
        luck = self.luck
        self.cells, space = luck.choice((4, 6, 8)), luck.choice(("2", "2", "3"))
        h, mu, self.v = 1/self.cells, luck.choice((0.1, 0.3)), luck.uniform(0.2, 1.0)
        self.end = luck.choice((luck.uniform(0.4, 0.7), luck.uniform(1.4, 1.7)))*self.v/mu
        self.truth = min(self.v, mu*self.end)
        angle = luck.choice((0.0, luck.uniform(0, 2*math.pi)))
        self.way = turned(angle, 1, 0)
        down, fast = turned(angle, 0, -1), turned(angle, self.v, 0)
        deep = "" if space == "2" else ",{}"
        low, high = deep.format(0), deep.format(1)
        walls = "" if space == "2" else " z=0:1"
        self.decks = [f"""dimension {space}
grid cell={h}{walls}
{'wall z-=slip z+=slip' if walls else ''}
METHOD
time end={self.end} cfl=0.5
gravity ({down[0]},{down[1]}{deep.format(0)})
material m elastic density=1 young=1e3 poisson=0.3
body plate block material=m lower=({-1 - self.v*self.end},-0.5{low}) upper=(3,0{high}) ppc=2 &
  rotation={math.degrees(angle)}
body block block material=m lower=(0,0{low}) upper=(2,1{high}) ppc=2 rotation={math.degrees(angle)}
rigid plate x={fast[0]} y={fast[1]}
contact block plate friction={mu}
history steps=50
"""]

    def errors(self, results):
        v = [body_end(results[0], "block", f"velocity_{axis}") for axis in "xy"]
        return [("velocity", (v[0]*self.way[0] + v[1]*self.way[1] - self.truth)/self.v, 0.05)]


class Sit(Truth):
    """A block on a rigid incline with friction, damped to rest: it stays where it is, its weight on the incline."""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((4, 6, 8))
        h, slope, mu = 1/self.cells, math.radians(luck.choice((0, 10, 20))), 0.6
        angle = luck.choice((0.0, luck.uniform(0, 2*math.pi)))
        self.way = turned(angle, 1, 0)
        down = turned(angle, math.sin(slope), -math.cos(slope))
        self.start = turned(angle, 1, 0.5)
        self.cos = math.cos(slope)
        self.decks = [f"""dimension 2
grid cell={h}
METHOD
time end=12 cfl=0.5
damping rate=1
gravity ({down[0]},{down[1]})
material m elastic density=1 young=1e3 poisson=0.3
body plate block material=m lower=(-1,-0.5) upper=(3,0) ppc=2 rotation={math.degrees(angle)}
body block block material=m lower=(0,0) upper=(2,1) ppc=2 rotation={math.degrees(angle)}
rigid plate
contact block plate friction={mu}
history steps=50
output csv at=end fields=pressure,stress,body
"""]

    def errors(self, results):
        first, last = results[0].bodies[1], results[0].bodies[-1]
        rows = [row for row in results[0].rows if row["body"] in (2, "block")]
        c, s = self.way
        across = sum(row["stress_xx"]*s*s - 2*row["stress_xy"]*s*c + row["stress_yy"]*c*c for row in rows)/len(rows)
        return [("way", math.hypot(last["x"] - first["x"], last["y"] - first["y"]), 0.02),
                ("stress", -across/(0.5*self.cos) - 1, 0.1)]


class Tumble(Truth):
    """Two free bodies collide aside of their middles, with or without friction: momentum and angular momentum of both
    together stay."""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((8, 12, 16))
        h, v, mu = 1/self.cells, luck.choice((0.01, 0.05)), luck.choice((0.0, 0.3))
        aside, angle, gap = luck.uniform(0.2, 0.7), luck.uniform(0, 2*math.pi), luck.uniform(0.4, 2)*h
        kinds = [luck.choice(("block", "sphere")) for _ in range(2)]
        places = [(0.0, 0.0), turned(angle, 1 + gap + (0.5 if "block" in kinds else 0.0), aside)]
        speeds = [turned(angle, 0.5*v, 0), turned(angle, -0.5*v, 0)]
        self.v, bodies = v, ""
        for name, kind, place, speed in zip("ab", kinds, places, speeds):
            x, y = place
            shape = (f"block lower=({x - 0.5},{y - 0.5}) upper=({x + 0.5},{y + 0.5}) "
                     f"rotation={luck.uniform(0, 360)} pivot=({x},{y})"
                     if kind == "block" else f"sphere centre=({x},{y}) radius=0.5")
            bodies += f"body {name} {shape} material=m ppc=2\nvelocity {name} x={speed[0]} y={speed[1]}\n"
        self.decks = [f"""dimension 2
grid cell={h}
METHOD
time end={(gap + 1.0)/v + 10} cfl=0.5
material m elastic density=1 young=1 poisson=0.3
{bodies}contact all friction={mu}
history steps=50
output csv at=end fields=velocity,mass,body
"""]

    def errors(self, results):
        rows, first = results[0].rows, results[0].bodies[:2]
        before = sum(row["mass"]*(row["x"]*row["velocity_y"] - row["y"]*row["velocity_x"]) for row in first)
        after = sum(row["mass"]*(row["x"]*row["velocity_y"] - row["y"]*row["velocity_x"]) for row in rows)
        scale = 0.5*max(row["mass"] for row in first)*self.v
        push = [sum(row["mass"]*row[f"velocity_{axis}"] for row in rows) -
                sum(row["mass"]*row[f"velocity_{axis}"] for row in first) for axis in "xy"]
        return [("angular momentum", (after - before)/scale, 0.05), ("momentum", math.hypot(*push)/scale, 0.01)]


class Topple(Truth):
    """A stiff block stands on something rough and is pushed over: a wall of the grid on any side, a rigid plate, ground
    as stiff that a fixed wall or a card motion holds. Its angle by the moments about the edge on which it turns. The
    particle there bears it at its middle, a quarter of a cell inside of the edge."""

    def make(self):
        luck = self.luck
        self.cells = luck.choice((6, 8))
        h, high, face, way = 1/self.cells, luck.choice((2.0, 3.0)), luck.choice(("x-", "x+", "y-", "y+")), \
            luck.choice((1, -1))
        mass, inertia, lift = high, high*(1 + high**2)/3, 0.5*(math.hypot(1, high) - high)
        pulse = luck.uniform(0.2, 0.5)
        push = (math.sqrt(2*luck.uniform(2, 5)*mass*lift*inertia) + 0.5*mass*pulse)/(0.25*high**2*pulse)
        angle = rate = time = 0.0
        start, step = math.atan2(high, 1), 1e-4
        while angle < 0.6:
            moment = 0.5*high**2*push*math.sin(math.pi*time/pulse)**2 if time < pulse else 0.0
            moment -= mass*0.5*math.hypot(1, high)*math.cos(start + angle)
            rate = max(rate + step*moment/inertia, 0.0) if angle <= 0 else rate + step*moment/inertia
            angle += step*rate
            time += step
        self.truth, axis = angle, "xy".index(face[0])
        up = 1 if face[1] == "-" else -1

        def turned_to(x, y):
            return f"({x},{up*y})" if axis else f"({up*y},{x})"
        corners = [turned_to(0, 0), turned_to(1, high)] if up > 0 else [turned_to(0, high), turned_to(1, 0)]
        grid = ("0:open", "open:0")[up < 0]
        pushed = "yx"[axis] + ("-" if way > 0 else "+")
        self.kind = luck.choice(("wall", "wall", "plate", "ground", "held"))
        floor = f"wall {face}=slip\nwallfriction {face} friction=2"
        bounds = f" {face[0]}={grid}"
        if self.kind != "wall":
            deep = 0.5 if self.kind == "plate" else 1.0
            under, above = (-deep, 0) if up > 0 else (0, -deep)
            ends = turned_to(-1.5, under), turned_to(2.5, above)
            floor = f"body ground block material=m lower={ends[0]} upper={ends[1]} ppc=2\ncontact m ground friction=2\n"
            floor += {"plate": "rigid ground", "ground": f"wall {face}=fixed",
                      "held": f'motion ground where="abs({face[0]})>0.6" x=0 y=0'}[self.kind]
            bounds = f" {face[0]}={('-1:open', 'open:1')[up < 0]}" if self.kind == "ground" else ""
        self.decks = [f"""dimension 2
grid cell={h}{bounds}
METHOD
time end={time} cfl=0.4
gravity {turned_to(0, -1)}
material m elastic density=1 young=3e4 poisson=0.2
body m block material=m lower={corners[0]} upper={corners[1]} ppc=2
{floor}
pressure m face={pushed} p="{push}*sin(pi*t/{pulse})^2*(t<{pulse})"
history steps=50
output csv at=end fields=initial_position,mass,body
"""]

    def errors(self, results):
        rows = [row for row in results[0].rows if row["body"] in (1, "m")]
        mean = {key: sum(row[key] for row in rows)/len(rows) for key in ("x", "y", "x0", "y0")}
        sine = cosine = 0.0
        for row in rows:
            x, y, x0, y0 = (row[key] - mean[key] for key in ("x", "y", "x0", "y0"))
            sine += x0*y - y0*x
            cosine += x0*x + y0*y
        return [("angle", abs(math.atan2(sine, cosine))/self.truth - 1, 0.12)]


class Footing(Truth):
    """A rigid strip that is pressed into clay bears (2 + pi) c b (Prandtl), smooth or rough, half of it beside a plane
    of symmetry or whole, at any place in the grid and any angle to it."""

    def make(self):
        luck = self.luck
        n, half = luck.choice((4, 6, 8)), luck.random() < 0.4
        h, self.cells = 0.5/n, n if half else 2*n
        angle = 0.0 if half or luck.random() < 0.5 else luck.uniform(0, 2*math.pi)
        aside = 0.0 if half or luck.random() < 0.5 else luck.uniform(0, h)
        self.half, friction = half, luck.choice((0, 0.3, 1))
        self.down = turned(angle, 0, -1)
        speed, ramp = 1.0, 0.02
        corners = (0.0 if half else -2.5, 2.5, 0.0 if half else -0.5 + aside, 0.5 + aside)
        walls = "wall x-=slip" if half else ""
        grid = " x=0:open" if half else ""
        clay, strip = ((f"block material={name} lower=({low},{bottom}) upper=({high},{top})"
                        f" rotation={math.degrees(angle)} pivot=(0,0)")
                       for name, low, high, bottom, top in (
                           ("clay", corners[0], corners[1], -2.0, 0.0), ("steel", corners[2], corners[3], 0.0, 3*h)))
        sine, cosine = math.sin(angle), math.cos(angle)
        held = f"max({sine}*x-{cosine}*y-2,abs({cosine}*x+{sine}*y)-2.5)>-{2*h}"  # its lower and lateral faces
        self.decks = [f"""dimension 2
grid cell={h}{grid}
{walls}
METHOD
time end=0.04 cfl=0.5
material clay j2 density=3e-3 young=1000 poisson=0.45 yield=sqrt(3)
material steel elastic density=1 young=1 poisson=0.3
body soil {clay}
body footing {strip}
motion soil where="{held}" x=0 y=0
rigid footing x="{speed*self.down[0]}*min(t/{ramp},1)" y="{speed*self.down[1]}*min(t/{ramp},1)"
contact footing soil friction={friction}
history every=0.002
"""]

    def errors(self, results):
        rows = [row for row in results[0].contacts if row["time"] > 0.02]
        force = -sum(row["force_x"]*self.down[0] + row["force_y"]*self.down[1] for row in rows)/len(rows)
        return [("force", force/((2 + math.pi)*(0.5 if self.half else 1.0)) - 1, 0.05)]


CLASSES = (Drag, Sit, Tumble, Topple, Footing)
