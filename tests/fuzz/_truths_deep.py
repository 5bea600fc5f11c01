"""More classes of tests/fuzz/_truths.py: what flows through what, what yields all through, water about an axis."""
import math

from _truths import Truth, vibration


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




def bessel(order, argument):
    """J0 or J1 as a formula of a deck, by its series: 1e-6 up to an argument of 4."""
    square = f"(0.25*({argument})^2)"
    terms = [(-1)**n/(math.factorial(n)*math.factorial(n + order)) for n in range(11)]
    series = repr(terms[-1])
    for term in reversed(terms[:-1]):
        series = f"({term!r}+{square}*{series})"
    return f"(0.5*({argument})*{series})" if order else series


class Bowl(Truth):
    """Water in a round basin: that at rest stays at rest; waves around the axis have the frequency omega^2 = g k tanh(k
    H), k R the first zero of J1."""

    def make(self):
        luck = self.luck
        self.cells, wide, ppc = luck.choice((8, 12, 16)), luck.choice((1, 2)), luck.choice((2, 2, 3))
        h, k = 1/self.cells, 3.8317059702/wide
        omega = math.sqrt(k*math.tanh(k))
        self.period = 2*math.pi/omega
        self.still = luck.random() < 0.5
        size = 0.03*omega/math.sinh(k)
        out, up = (bessel(order, f"{k}*r") for order in (1, 0))
        wave = f'velocity m r="{-size}*{out}*cosh({k}*z)" z="{size}*{up}*sinh({k}*z)"\n'
        self.decks = [f"""dimension axisymmetric
grid cell={h} r=0:{wide} z=0:open
wall r+=slip z-=slip
METHOD
time end={(1.2 if self.still else 2.4)*self.period} cfl=0.4
gravity (0,-1)
material m fluid density=1
eos m tait c0=15
initial_stress m surface=1
body m block material=m lower=(0,0) upper=({wide},1) ppc={ppc}
{"" if self.still else wave}history steps=10
output csv at=end
"""]

    def errors(self, results):
        if not self.still:
            return vibration(results[0], self.period)
        # Over the speed of long waves, 1.
        fastest = max(math.hypot(row["velocity_r"] if "velocity_r" in row else row["velocity_x"], row["velocity_z"])
                      for row in results[0].rows)
        return [("velocity at rest", fastest, 0.05)]


CLASSES = (Jet, Hill, Bowl)
