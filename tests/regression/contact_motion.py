#!/usr/bin/env python3
"""Parts that are moved in bodies that touch others (doc/loads.md): what contact gives to them is a force on whoever
moves them.

usage: contact_motion.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: a body that is moved as a whole is a rigid one; momentum is what the forces of motion.csv have
given; a bar between two grips bears what its modulus says.
"""
import random

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import Report, run

SCENE = """
dimension {dimension}
grid cell=0.25 {grid}
method {method}
time end=0.4 dt=5e-3
material steel elastic density=4 young=200 poisson=0.3
material soft elastic density=1 young=20 poisson=0.3
body plate block material=steel {plate} ppc=2
body ball block material=soft {ball} ppc=2
velocity ball {velocity}
contact plate ball friction={friction}
{hold}
history steps=1
output csv at=end
"""
# Plates do not end on lines of nodes: there round-off says whether the next node has mass. It also says, where bodies
# are pressed together, in which step a node that they come to share acts first, so places were taken where it does not
# come to that.
SPACES = {
    "1": {"grid": "x=open", "plate": "lower=0.11 upper=1.11", "ball": "lower=1.14 upper=2.11", "velocity": "x=-1",
          "axis": "x", "friction": 0},
    "2": {"grid": "x=open y=open", "plate": "lower=(0.03,0.02) upper=(2.03,0.52)",
          "ball": "lower=(0.52,0.56) upper=(1.3,1.3)", "velocity": "x=0.5 y=-1",
          "axis": "y", "friction": 0.3},
    "3": {"grid": "x=open y=open z=open", "plate": "lower=(0,0,0) upper=(1.5,1.5,0.5)",
          "ball": "lower=(0.3,0.3,0.53) upper=(1,1,1)",
          "velocity": "x=0.3 y=0.5 z=-1", "axis": "z", "friction": 0.3},
    "axisymmetric": {"grid": "r=0:3 z=open", "plate": "lower=(0,0.02) upper=(2,0.52)",
                     "ball": "lower=(0,0.56) upper=(0.7,1.3)", "velocity": "z=-1", "axis": "z",
                     "friction": 0.3},
}
PLAIN = " rotation=plain surfaces=plain stress=plain"


def axes(dimension):
    return "rz" if dimension == "axisymmetric" else "xyz"[:int(dimension)]


def held_as_rigid(report):
    """The same particles, impulses and energy, moved by a card motion or rigid."""
    cases = [(d, m, u) for d in ("1", "2", "axisymmetric") for m in ("sgmp", "mpm", "gimp", "bspline")
             for u in ("musl", "usavg")]
    cases = [*cases[::2], *cases[1::4], ("3", "sgmp", "musl"), ("3", "mpm", "usf"), ("2", "sgmp", "usl"),
             ("2", "sgmp", "usf")]
    for number, (dimension, method, update) in enumerate(cases):
        speed = ('"0.3*sin(5*t)"', "0")[number % 5 == 4 and dimension != "axisymmetric"]
        space = SPACES[dimension]
        words = {**space, "dimension": dimension, "method": f"{method} update={update}" + PLAIN*(method == "sgmp")}
        name = f"{dimension}_{method}_{update}"
        rigid = run(f"rigid_{name}", SCENE.format(hold=f"rigid plate {space['axis']}={speed}", **words))
        ways = " ".join(f"{axis}={speed if axis == space['axis'] else 0}" for axis in axes(dimension))
        moved = run(f"moved_{name}", SCENE.format(hold=f'motion plate where="1" {ways}', **words))
        if not (report.finished(rigid, name) and report.finished(moved, name)):
            continue
        pairs = zip(rigid.table("particles_end.csv"), moved.table("particles_end.csv"))
        apart = max(abs(a[key] - b[key]) for a, b in pairs for key in a)
        report.check(apart < 1e-11, f"{name}: particles are {apart} from those at a rigid plate")
        a, b = rigid["energy.contact_dissipation"], moved["energy.contact_dissipation"]
        report.check(abs(a - b) < 1e-12, f"{name}: contact took {b}, at a rigid plate {a}")
        # The plate's own kinetic energy is its mover's work, too; a rigid body's is in no balance.
        own = moved.table("bodies.csv")
        kinetic = [row["kinetic_energy"] for row in own if round(row["body"]) == 1]
        work = moved["energy.external_work"] - (kinetic[-1] - kinetic[0])
        report.check(abs(work - rigid["energy.external_work"]) < 1e-11,
                     f"{name}: work {work}, of a rigid plate {rigid['energy.external_work']}")


def given(result):
    """Momentum by components that history.csv has gained, and what motion.csv has given."""
    rows, since, total = result.table("motion.csv"), {}, {"x": 0.0, "y": 0.0, "z": 0.0}
    for row in rows:
        before = since.get((row["body"], row["motion"]), 0.0)
        since[row["body"], row["motion"]] = row["time"]
        for axis in total:
            total[axis] += row[f"force_{axis}"]*(row["time"] - before)
    history = result.table("history.csv")
    return {axis: history[-1][f"momentum_{axis}"] - history[0][f"momentum_{axis}"] for axis in total}, total


GRIPS = """
dimension {dimension}
grid cell=1 {grid}
method {method}
time steps=60 cfl=0.3
material hard elastic density={heavy} young=200 poisson=0.3
material soft neo_hookean density=1 young=20 poisson=0.3
body low block material=hard {low} ppc=2
body high block material=soft {high} ppc=2
velocity high {velocity}
contact all friction={friction}
{motions}
history steps=1
checkpoint every=20 keep=9
output csv at=end
"""


def drawn(seed):
    """Two blocks that meet, some of whose ends and faces are moved, also where they meet."""
    luck = random.Random(seed)
    dimension = luck.choice(("1", "2", "2", "3"))
    n = int(dimension)
    places = [axes(dimension)[a] for a in range(n)]

    def block(low, high):
        def vector(x):
            return str(x[0]) if n == 1 else "(" + ",".join(map(str, x)) + ")"
        return f"lower={vector([0.3]*(n - 1) + [low])} upper={vector([3.3]*(n - 1) + [high])}"
    motions, top = [], places[-1]
    for body, low, high in (("low", 0.2, 3.2), ("high", 3.2, 6.2)):
        for _ in range(luck.choice((0, 1))) if body == "high" else range(1):
            where = luck.choice((f"{top}<{low + 1}", f"{top}>{high - 1}", f"{places[0]}<{1.3 if n > 1 else low + 1}"))
            chosen = luck.sample(places, luck.randint(1, n))
            motions.append(f'motion {body} where="{where}" ' +
                           " ".join(f'{axis}="{luck.choice(("0", "0.2*sin(t)", "0.1"))}"' for axis in chosen)
                           + luck.choice(("", "", " until=0.8")))
    method = luck.choice(("sgmp" + PLAIN, "sgmp rotation=exact surfaces=plain", "sgmp", "mpm", "gimp", "bspline"))
    exact = "rotation=exact" in method and n > 1
    method = method if n > 1 else method.replace(" rotation=exact surfaces=plain", "").replace(PLAIN, "")
    velocity = " ".join(f"{axis}={luck.choice((-0.4, 0.2)) if axis != top else -0.5}" for axis in places)
    return GRIPS.format(dimension=dimension, grid=" ".join(f"{axis}=open" for axis in places),
                        method=f"{method} update={luck.choice(('musl', 'usf', 'usavg', 'usavg'))}",
                        heavy=luck.choice((1, 4, 100)), low=block(0.2, 3.2), high=block(3.2, 6.2), velocity=velocity,
                        friction=0 if exact else luck.choice((0, 0.3, 10)),
                        motions="\n".join(motions))


def identities(report):
    """Momentum comes from the grips and from nothing else, the kinetic identity holds, and with usavg energy stays."""
    for seed in range(24):
        text = drawn(seed)
        result = run(f"grips_{seed}", text)
        if not report.finished(result, f"grips {seed}"):
            continue
        gained, total = given(result)
        scale = sum(abs(value) for value in total.values()) + 1.0
        for axis, value in gained.items():
            report.check(abs(value - total[axis]) < 1e-11*scale,
                         f"grips {seed}: momentum {value} along {axis}, from the grips {total[axis]}\n{text}")
        energy = result["energy"]
        report.check(abs(energy["remainder"]) < 1e-12*energy["supplied"],
                     f"grips {seed}: remainder {energy['remainder']} of {energy['supplied']}\n{text}")
        if "usavg" in text and "mpm" not in text:
            report.check(energy["drift"] < 1e-2, f"grips {seed}: drift {energy['drift']}\n{text}")


def bits(report):
    """The same in any layout and after a restart."""
    for seed in (1, 5, 8):
        text = drawn(seed)
        reference = straight(report, f"bits_{seed}", text)
        for title, threads, launcher in (("threads", 2, ()), ("ranks", 1, mpirun(2))):
            other = straight(report, f"bits_{title}_{seed}", text, threads=threads, launcher=launcher)
            report.check(other["checksum"] == reference["checksum"],
                         f"{seed} {title}: checksum {other['checksum']}, not {reference['checksum']}")
            report.check(other.table("motion.csv") == reference.table("motion.csv"),
                         f"{seed} {title}: motion.csv differs")
        goes_on(report, reference, f"bits_again_{seed}", text, checkpoints(reference.folder)[0])


def squeezed(report):
    """Two bars in touch between grips that press them together slowly: force by the series of both moduli."""
    text = """
dimension 1
grid cell=0.05
method {method} update=usavg
time end=20 cfl=0.5
material a elastic density=1 young=100 poisson=0
material b elastic density=1 young=50 poisson=0
body left block material=a lower=0 upper=1 ppc=2
body right block material=b lower=1 upper=2 ppc=2
contact left right
motion left where="x<0.1" x="0.01*min(t/10,1)"
motion right where="x>1.9" x=0
damping rate=1
stop at_rest=1e-9 after=1e9
history every=0.5
"""
    for method in ("sgmp", "mpm", "gimp", "bspline"):
        result = run(f"squeezed_{method}", text.replace("0.01*min(t/10,1)", "0.01*(t<10)/10").format(method=method))
        if not report.finished(result, method):
            continue
        last = [row for row in result.table("motion.csv") if row["time"] == result.table("motion.csv")[-1]["time"]]
        # Free lengths 0.9 each, as grips strain nothing: u = F (0.9/100 + 0.9/50).
        wanted = 0.01/(0.9/100 + 0.9/50)
        force = sorted(row["force_x"] for row in last)
        report.check(abs(force[1]/wanted - 1) < 0.06 and abs(sum(force)) < 0.01*wanted,
                     f"{method}: forces {force}, expected {wanted}")


if __name__ == "__main__":
    REPORT = Report()
    held_as_rigid(REPORT)
    identities(REPORT)
    bits(REPORT)
    squeezed(REPORT)
    REPORT.end()
