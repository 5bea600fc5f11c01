"""Contact scenes drawn by seed: three to five bodies of unequal densities and stiffnesses, in two and three dimensions,
at an angle to the grid. Each scene is laid out along its own axes (x along the surface, y up) and turned about the
grid's origin; gravity turns with it."""
import math
import random
from dataclasses import dataclass, field

TURNS = (0, 30, 45)
FRICTIONS = (0, 0.3, 10)
MATTER = ((1, 1), (1, 1e4), (1, 1e5), (1e4, 1e4), (1e4, 1))  # density, Young's modulus
METHODS = ("sgmp", "mpm", "gimp")
STRAIN = 1e-3           # of what is loaded most, at most
MOST_STEPS = {2: 40000, 3: 10000}
SLOPE = math.radians(30)
PRESSED = 0.01          # cells by which the tools come closer


@dataclass
class Block:
    """A block of a scene; of none of the materials: rigid."""

    name: str
    lower: tuple
    upper: tuple
    density: float = 1.0
    young: float = 0.0

    @property
    def size(self):
        return [high - low for low, high in zip(self.lower, self.upper)]

    @property
    def mass(self):
        return self.density*math.prod(self.size)


@dataclass
class Scene:
    """One scene: what is in it, and its deck."""

    kind: str
    seed: int
    fine: int = 1  # times as many cells across the blocks of a press
    luck: random.Random = field(repr=False, default=None)

    def __post_init__(self):
        # Dimension, angle and friction go round so that any 18 seeds in a row have all of their combinations.
        self.luck = random.Random(f"{self.kind} {self.seed}")
        self.dimension = 2 + self.seed % 2
        self.turn = TURNS[self.seed//2 % 3]
        self.friction = FRICTIONS[self.seed//6 % 3]
        self.method = METHODS[(self.seed + self.seed//3) % 3]
        self.update, self.flip, self.gravity, self.least = "usavg", 1.0, 0.0, 0
        self.poisson, self.courant = 0.25, 0.4
        while True:
            self.blocks, self.motions = [], []
            getattr(self, self.kind)()
            # 1.2: waves at nu = 0.25
            self.dt = self.courant/max(math.sqrt(block.young/block.density*1.2) for block in self.soft())
            self.end = max(self.end, self.least*self.dt)
            self.steps = math.ceil(self.end/self.dt)
            if self.steps <= self.fine*MOST_STEPS[self.dimension]:
                break

    @property
    def name(self):
        ratios = "/".join(f"{block.density:g}:{block.young:g}" for block in self.soft())
        fine = f", cells of 1/{self.fine}" if self.fine > 1 else ""
        return (
            f"{self.kind} {self.seed} ({self.dimension}D, {self.turn} degrees, friction {self.friction:g}, "
            f"{ratios}{fine})"
        )

    def soft(self):
        """Bodies that are not rigid."""
        return [block for block in self.blocks if block.young > 0]

    def add(self, lower, size, matter=(1, 0)):
        """A block of so many cells; a rigid one without matter."""
        size = size[:self.dimension]
        lower = tuple([*lower, 0.0][:self.dimension])
        self.blocks.append(Block(f"b{len(self.blocks)}", lower, tuple(low + s for low, s in zip(lower, size)), *matter))
        return self.blocks[-1]

    def base(self, length):
        """A rigid body whose upper face is y = 0."""
        return self.add((-3, -2, -1), (length + 6, 2, 5))

    def matter(self, number):
        """So many densities and stiffnesses, not all the same."""
        chosen = [self.luck.choice(MATTER) for _ in range(number)]
        return chosen if len(set(chosen)) > 1 else self.matter(number)

    def load(self, gravity_direction=1.0):
        """Gravity that strains nothing by more than STRAIN, and the slowest period of the pile."""
        above, softness, slowest = 0.0, 0.0, 0.0
        for block in sorted(self.soft(), key=lambda block: -block.lower[1]):
            above += block.mass
            area = block.mass/block.density/block.size[1]
            softness = max(softness, above/area/block.young)
            slowest = max(slowest, 2*math.pi*math.sqrt(above/area*block.size[1]/block.young))
        self.gravity = STRAIN/softness*gravity_direction
        return slowest

    # ---- the kinds

    def pile(self):
        """A tower, a bridge, or two on one, on a rigid base, loaded at once; to two periods or so."""
        self.courant = 0.2
        self.lay(self.luck.choice(("tower", "bridge", "pair")), self.matter(3))

    def rest(self):
        """The same with the heavy ones below and PIC's damping: comes to rest and stays there. Without friction blocks
        side by side push each other apart when they are loaded: towers only."""
        self.update, self.flip, self.least = "musl", 0.95, 8000
        stuff = sorted(self.matter(3), reverse=True)
        layout = "tower" if self.friction == 0 else self.luck.choice(("tower", "bridge", "pair"))
        self.lay(layout, stuff[1:] + stuff[:1] if layout == "pair" else stuff)

    def lay(self, layout, stuff):
        """Three blocks on a rigid base."""
        self.base(6)
        height = self.luck.choice((2, 3))
        if layout == "tower":
            for level, matter in enumerate(stuff):
                self.add(
                    (self.luck.choice((0, 0.5, 1)) if self.friction else 0, level * height, 0), (5, height, 3), matter
                )
        else:
            low = 0 if layout == "bridge" else height
            self.add((0, low, 0), (3, height, 3), stuff[0])
            self.add((3, low, 0), (3, height, 3), stuff[1])
            self.add((0, height - low, 0), (6, height, 3), stuff[2])
        self.end = 2*self.load()

    def incline(self):
        """Two blocks on each other on a rigid slope of 30 degrees: Coulomb's law for both, whatever they weigh. Where
        they slide, friction holds the upper one on the lower: with the slope's coefficient it would be at the very edge
        of slipping. The heavier one is the upper: a light one is thrown by what the other vibrates."""
        self.update = self.luck.choice(("musl", "usavg"))
        self.flip = 0.99
        self.base(14 if self.friction < 1 else 6)
        stuff = sorted(self.matter(2))
        self.add((0, 0, 0), (6, 2, 3), stuff[0])
        self.add((0, 2, 0), (6, 2, 3), stuff[1])
        slowest = self.load()
        way = 0.5*self.gravity*(math.sin(SLOPE) - min(self.friction, math.tan(SLOPE))*math.cos(SLOPE))
        self.end = math.sqrt(4.0/way) if way > 0 else 2*slowest

    def flight(self):
        """Four blocks meet in empty space. Impacts excite what a step resolves worst: a short one."""
        self.courant = 0.1
        stuff = self.matter(4)
        slowest = min(math.sqrt(young/density) for density, young in stuff)  # of the speeds of their waves
        speed = STRAIN*slowest
        self.add((0, 0, 0), (3, 3, 3), stuff[0])
        self.motions = [(0, 0, 0)]
        places = ((3.01, 0.5, 0.0), (-3.01, -0.5, 0.0), (-0.5, 3.01, 0.5))
        for lower, matter in zip(places, stuff[1:]):
            self.add(lower, (3, 3, 3), matter)
            along = [low/3.01 if abs(low) > 3 else self.luck.uniform(-0.1, 0.1) for low in lower]
            size = speed*self.luck.uniform(0.5, 1)
            self.motions.append(tuple(-size*a for a in along))
        self.end = 0.02/speed + 10/slowest

    def press(self):
        """Two blocks in series between rigid tools that come closer by a hundredth of a cell, slowly. Without friction
        the blocks would be squeezed out sideways."""
        self.friction = self.friction or 1.0
        self.poisson = 0.0
        stuff = self.matter(2)
        self.base(5)
        height = 4*self.fine
        for level, matter in enumerate(stuff):
            self.add((0, level*height, 0), (5, height, 3), matter)
        self.add((-3, 2*height, -1), (11, 2, 5))
        area = self.soft()[0].mass/self.soft()[0].density/height
        self.gravity = 0.0
        slowest = max(2*math.pi*math.sqrt(sum(b.mass for b in self.soft())/area*height/b.young) for b in self.soft())
        self.end = 4*slowest

    # ---- the deck

    def turned(self, vector):
        """A vector of the scene on the grid, as a deck writes it."""
        c, s = math.cos(math.radians(self.turn)), math.sin(math.radians(self.turn))
        x, y = vector[:2]
        return [c*x - s*y, s*x + c*y, *vector[2:self.dimension]]

    def deck(self):
        """The deck's text."""
        slope = SLOPE if self.kind == "incline" else 0.0
        lines = [
            f'title "{self.name}"', f"dimension {self.dimension}", "grid cell=1",
            f"method {self.method} update={self.update} flip={self.flip:g} mass_cutoff=1e-20",
            f"time dt={self.dt!r} steps={self.steps}",
        ]
        if self.gravity:
            lines.append(
                "gravity " + vector(self.turned((self.gravity * math.sin(slope), -self.gravity * math.cos(slope), 0)))
            )
        for block in self.blocks:
            lines.append(
                f"material m_{block.name} elastic density={block.density:g} young={block.young or 1:g} "
                f"poisson={self.poisson:g} strain=small"
            )
            lines.append(
                f"body {block.name} block material=m_{block.name} lower={vector(block.lower)} "
                f"upper={vector(block.upper)} ppc=2 rotation={self.turn}"
            )
        for block, motion in zip(self.blocks, self.motions):
            lines.append(
                f"velocity {block.name} "
                + " ".join(f"{axis}={value!r}" for axis, value in zip("xyz", self.turned(motion)))
            )
        for block in self.blocks:
            if block.young > 0:
                continue
            speed = ""
            if self.kind == "press" and block is self.blocks[-1]:
                down = self.turned((0, -2*PRESSED/self.end))
                speed = " ".join(f'{axis}="{value!r}*sin(pi*t/{self.end!r})^2"' for axis, value in zip("xy", down))
            lines.append(f"rigid {block.name} {speed}")
        lines.append(f"contact all friction={self.friction:g}")
        if self.kind == "incline" and self.friction:
            lines.append("contact b1 b2 friction=10")
        lines.append("history steps=10")
        return "\n".join(lines) + "\n"


def vector(components):
    """Components as a deck writes them."""
    return "(" + ",".join(f"{component!r}" for component in components) + ")"
