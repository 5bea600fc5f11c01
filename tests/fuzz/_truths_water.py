"""More classes of tests/fuzz/_truths.py: water between explosives and metals, of which the truth is the Lagrangian code
of _lagrange.py, under what floats on it, and before what is driven into it."""
import math

from _lagrange import Water
from _truths import Truth, body_end
from _truths_layers import METALS, Matter, Shell, Stack, metal, tnt


def water():
    """Water that boils where it is pulled."""
    return Matter(
        "water",
        "material water fluid density=1e-3\neos water gruneisen c0=1480 s=1.92 gamma0=0.1\nfailure water pmin=0\n",
        Water(1e-3, 1480, 1.92, 0.1), 1480,
    )


class Sea(Stack):
    """Layers of water, metal and explosive in a row: velocities of the metals."""

    kinds = ("mine", "slug", "slam")
    parting = ("slug", "slam")

    def mine(self):
        """Explosive, water, a plate."""
        plate, long, gap = metal(self.luck.choice(list(METALS))), self.luck.choice((1, 2)), self.luck.choice((2, 4, 8))
        return (
            True, [(tnt(), 0, long, 0.0), (water(), long, long + gap, 0.0), (plate, long + gap, long + gap + 1, 0.0)],
            long/6930 + gap/2500 + self.luck.uniform(2, 5)/4500,
        )

    def slug(self):
        """Water that flies at a plate."""
        plate, long = metal(self.luck.choice(list(METALS))), self.luck.choice((2, 4))
        v, gap = self.luck.choice((100.0, 300.0, 1000.0)), self.luck.choice((0.0, 0.4, 1.3))
        return (
            False, [(water(), 0, long, v), (plate, long + gap, long + gap + 1, 0.0)],
            gap/v + self.luck.uniform(0.5, 2)*long/1480,
        )

    def slam(self):
        """A plate that flies onto water at a wall."""
        plate, long = metal(self.luck.choice(list(METALS))), self.luck.choice((4, 8))
        v, gap = self.luck.choice((30.0, 100.0, 300.0)), self.luck.choice((0.0, 0.4))
        return (
            True, [(water(), 0, long, 0.0), (plate, long + gap, long + gap + 1, -v)],
            gap/v + self.luck.uniform(0.5, 1.5)*long/1480,
        )


class Well(Shell):
    """The same about an axis or a point: explosive, water, a tube or a hollow ball of metal."""

    kinds = ("mine",)

    def mine(self):
        """Explosive in water in metal."""
        shell, inner, gap = metal(self.luck.choice(list(METALS))), self.luck.choice((1, 2)), self.luck.choice((1, 2))
        return (
            True,
            [(tnt(), 0, inner, 0.0), (water(), inner, inner + gap, 0.0), (shell, inner + gap, inner + gap + 1, 0.0)],
            inner/6930 + gap/3000 + self.luck.uniform(3, 6)/4500,
        )


class Float(Truth):
    """A light block that is set on water: how deep it floats (half of it, beside a plane of symmetry)."""

    def make(self):
        luck = self.luck
        self.cells, self.share = luck.choice((4, 6)), luck.uniform(0.2, 0.8)
        h, self.half, self.deep = 1/self.cells, luck.choice((1, 1.5)), luck.choice((2, 3))
        self.wide = self.half + luck.choice((1, 2))
        self.decks = [f"""dimension 2
grid cell={h} x=0:{self.wide} y=0:open
wall x-=slip x+=slip y-=slip
METHOD
time end=30 cfl=0.5
damping rate=1
gravity (0,-1)
material w fluid density=1
eos w tait c0=15
initial_stress w surface={self.deep}
material m elastic density={self.share} young=200 poisson=0.3
body w block material=w lower=(0,0) upper=({self.wide},{self.deep}) ppc=2
body m block material=m lower=(0,{self.deep}) upper=({self.half},{self.deep + 1}) ppc=2
history steps=50
"""]

    def errors(self, results):
        # The block is 1 high; what it displaces lifts the surface.
        middle = self.deep + self.share*self.half/self.wide - self.share + 0.5
        return [("height", body_end(results[0], "m", "y") - middle, 0.1)]


class Slam(Truth):
    """Half of a rigid wedge, beside a plane of symmetry, is driven into wide water at a constant speed: its force grows
    with the time (similarity solution of R. Zhao and O. Faltinsen, J. Fluid Mech. 246, 1993, 593-612)."""

    forces = {20: 42.485, 25: 23.657, 30: 14.139}  # of both faces over rho v^3 t, from memory of the literature

    def make(self):
        luck = self.luck
        self.deadrise, self.depth = luck.choice(list(self.forces)), luck.choice((6, 8, 12, 16, 24))
        self.cells, slope = self.depth, math.tan(math.radians(self.deadrise))
        wet, top = math.pi/2/slope, 5*slope  # half of the width that is wet, over the depth (Wagner)
        self.decks = [f"""dimension 2
grid cell={1/self.depth} x=0:open fine_x=(0,{1.2*wet}) fine_y=(-1.5,1) ratio=1.15 largest=8
wall x-=slip
METHOD
time end=1 cfl=0.5
material w fluid density=1
eos w tait c0={luck.uniform(28, 40)}
material s elastic density=3 young=1e4 poisson=0.3
body w block material=w lower=(0,-25) upper=(30,0)
body s polygon material=s corners=(0,0),(5,{top}),(5,{top + 0.5}),(0,{top + 0.5})
rigid s y=-1
contact s w
history every=0.02
"""]

    def errors(self, results):
        rows = [row for row in results[0].contacts if row["time"] > 0.3]
        force = sum(row["force_y"] for row in rows)
        return [("force", 2*force/sum(self.forces[self.deadrise]*(row["time"] - 0.01) for row in rows) - 1, 0.06)]


CLASSES = (Sea, Well, Float, Slam)
