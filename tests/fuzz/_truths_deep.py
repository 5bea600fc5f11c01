"""More classes of tests/fuzz/_truths.py: what flows through what, and what yields all through."""
import math

from _truths import Truth


class Jet(Truth):
    """A long rod without strength goes into a target without any, about the axis: where they meet moves at V/(1 +
    sqrt(rho_t/rho_r)), for the pressure on both sides of it is the same. What sticks to a target denser than it is held
    back, and is not drawn."""

    def make(self):
        luck = self.luck
        radius = luck.choice((3, 4, 6))
        self.cells, h, v = 2*radius, 1/radius, luck.choice((0.2, 0.3))
        heavy = luck.choice((0.5, 1, 2, 4))
        bond = luck.choice(("", "contact all\n")) if heavy >= 1 else "contact all\n"
        self.speed = v/(1 + math.sqrt(1/heavy))
        end = 8/(v - self.speed)  # of the rod's 12 radii 8 are used up
        self.times = (0.5*end, end)
        deep, lift = self.speed*end + 4, luck.uniform(0, h)
        self.decks = [f"""dimension axisymmetric
grid cell={h} r=0:open z=open
METHOD
time end={time} cfl=0.4
material a j2 density={heavy} young={heavy} poisson=0.3 yield={1e-4*heavy}
material b j2 density=1 young=1 poisson=0.3 yield=1e-4
body rod block material=a lower=(0,{lift}) upper=(1,{lift + 12}) ppc=2
body target block material=b lower=(0,{lift - deep}) upper=(8,{lift}) ppc=2
velocity rod z=-{v}
{bond}history steps=50
output csv at=end
""" for time in self.times]

    def errors(self, results):
        deepest = [min(row["z"] for row in result.rows if row["body"] in (1, "rod")) for result in results]
        found = (deepest[0] - deepest[1])/(self.times[1] - self.times[0])
        return [("velocity of the hole's bottom", found/self.speed - 1, 0.1)]


class Hill(Truth):
    """A thick tube under a pressure inside that rises slowly, until it yields up to some radius: the radial stress
    there is -p + 2 k ln(r/a), k = yield/sqrt(3) (plane strain)."""

    def make(self):
        luck = self.luck
        self.cells, wide = luck.choice((6, 8, 12)), luck.choice((1.0, 1.5))
        h, nu, flow = 1/self.cells, luck.choice((0.3, 0.45)), 2e-3
        self.inner = luck.choice((1.0, 2.0))
        outer, self.shear = self.inner + wide, flow/math.sqrt(3)
        self.up_to = self.inner + wide*luck.uniform(0.4, 0.8)
        self.p = self.shear*(2*math.log(self.up_to/self.inner) + 1 - (self.up_to/outer)**2)
        tall, low = 3*h, luck.uniform(0, h)
        end = 40*outer
        self.decks = [f"""dimension axisymmetric
grid cell={h} r=0:open z={low}:{low + tall}
wall z-=slip z+=slip
METHOD
time end={end} cfl=0.5
material m j2 density=1 young=1 poisson={nu} yield={flow}
body m block material=m lower=({self.inner},{low}) upper=({outer},{low + tall}) ppc=2
pressure m p="{self.p}*min(1,t/{0.6*end})" face=r-
damping rate={2/outer}
history steps=50
output csv at=end fields=stress
"""]

    def errors(self, results):
        found = [row["stress_xx"] + self.p - 2*self.shear*math.log(row["x"]/self.inner) for row in results[0].rows
                 if self.inner + 0.1 < row["x"] < 0.95*self.up_to]
        return [("radial stress", sum(found)/len(found)/self.p, 0.1),
                ("its scatter", math.sqrt(sum(one**2 for one in found)/len(found))/self.p, 0.25)]


CLASSES = (Jet, Hill)
