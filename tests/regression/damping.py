#!/usr/bin/env python3
"""Damping (doc/damping.md): decay of a mode, of free flight and of a spin, the way to an equilibrium, the ledger, the
same bits.

usage: damping.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: exp(-rate t/2) of a mode, exp(-rate t) of what is free, the deflection and energy of a column under
gravity.
"""
import math
import os

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import INCLINED, KEPT_PLANE, SCRATCH, SPLIT, SWIRL, Report, changed, run

RATE = 0.5
BAR = f"""
parameter method = sgmp
parameter update = musl
dimension 1
grid cell=1/32 x=0:1
wall x-=fixed x+=fixed
method $method update=$update
time end=10 dt=1/128
material rubber elastic density=1 young=1 poisson=0 strain=small
body bar block lower=0 upper=1 material=rubber spacing=1/64
velocity bar x="1e-4*sin(pi*x)"
damping rate={RATE}
gauge middle point=0.5
"""
# Two bodies that fly on, one of them as prescribed, and a third that spins.
FLIGHT = """
dimension 2
grid cell=1
method sgmp rotation=exact
time end=4 dt=0.05
material stiff elastic density=2 young=10 poisson=0.3
body free block lower=(0,0) upper=(4,4) material=stiff
body tool block lower=(0,20) upper=(4,24) material=stiff
rigid tool x=1
velocity free x=1 y=-0.5
damping rate=0.5 until=2
history steps=1
"""
COLUMN = """
parameter end = 400
dimension 1
grid cell=1/16 x=0:open
wall x-=fixed
method sgmp
time end=end cfl=0.4
stop at_rest=1e-6 hold=8 after=3
material rubber elastic density=1 young=1 poisson=0 strain=small
body bar block lower=0 upper=1 material=rubber spacing=1/32
gravity -1e-4
damping kinetic=yes
history steps=1
output csv at=end fields=displacement
"""
# Under a weight from the start: every step takes a part of 0.2 of the velocity; and four cells, damped critically.
WEIGHT = """
parameter cells = 16
parameter rate = 6.4
parameter method = sgmp
parameter update = musl
dimension 1
grid cell=1/cells x=0:open
wall x-=fixed
method $method update=$update
time end=80 dt=0.5/cells
material rubber elastic density=1 young=1 poisson=0 strain=small
body bar block lower=0 upper=1 material=rubber ppc=2
gravity -1e-4
damping rate=rate
history steps=1
output csv at=end fields=displacement
"""
SPINNING = """
parameter slow = 1
dimension axisymmetric swirl=yes
grid cell=1/8
method sgmp
time end=2 dt=1/64
material rubber elastic density=1 young=100 poisson=0.3
body disc cylinder material=rubber centre=(0,0) axis=(0,1) radius=1 length=1
velocity disc spin=0.1
damping rate=slow
"""
# A block between a plate at rest and one that moves along itself for a while.
SHEARED = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=0.125 x=open:open y=0:1
wall y-=fixed y+=fixed
wallmotion y+ x="0.002*min(t/2,1)*min(max(22-t,0)/2,1)"
method $method update=$update
time end=30 cfl=0.4
material m elastic density=1 young=250 poisson=0.25
body b block material=m lower=(0,0) upper=(4,1) ppc=2
damping rate=2
history every=1
output csv at=end fields=stress
"""
LAME = """
parameter update=musl nu=0.45 cells=6
dimension axisymmetric
grid cell=1/cells r=0:open z=0:3/cells
wall z-=slip z+=slip
method sgmp update=$update
time end=140 cfl=0.5
material m elastic density=1 young=1 poisson=nu
body tube block material=m lower=(2,0) upper=(3.5,3/cells) ppc=2
pressure tube p="1e-3*min(1,t/84)" face=r-
damping rate=0.6
output csv at=end fields=stress,displacement
"""
# A cantilever whose end is pushed within one and a half of its periods.
BENT = """
parameter cells=6
dimension 2
grid cell=1/cells x=open y=open
time end=900 cfl=0.5
material m elastic density=1 young=1 poisson=0.45
body beam block material=m lower=(0,0) upper=(8,1) ppc=2
motion beam where="x0<1/cells" x=0 y=0
traction beam face=x+ y="1e-5*min(1,t/600)"
output csv at=end fields=stress,displacement
"""
TUMBLING = """
dimension 2
grid cell=1/4
method sgmp rotation=exact
time end=12 cfl=0.4
material rubber elastic density=1 young=10 poisson=0.3
body block block material=rubber lower=(-1,-1) upper=(1,1)
velocity block x=-0.05*y y=0.05*x
damping kinetic=yes
history steps=1
"""


def oscillation(values, dt):
    """Rate and frequency of a damped oscillation: v(k+1) + p v(k) + q v(k-1) = 0 has the roots exp((-rate +- i omega)
    dt)."""
    after, here, before = values[2:], values[1:-1], values[:-2]
    def product(a, b):
        return sum(x*y for x, y in zip(a, b))
    determinant = product(here, here)*product(before, before) - product(here, before)**2
    p = (product(before, after)*product(here, before) - product(here, after)*product(before, before))/determinant
    q = (product(here, after)*product(here, before) - product(before, after)*product(here, here))/determinant
    return -0.5*math.log(q)/dt, math.acos(-0.5*p/math.sqrt(q))/dt


def ledger(report, name, result, balance):
    """Kinetic energy to round-off, the total to what the scheme itself dissipates; the last row is that of the
    summary."""
    energy, row = result["energy"], result.table("history.csv")[-1]
    supplied = energy["supplied"]
    report.check(abs(energy["remainder"]) < 1e-13*supplied, f"{name}: kinetic identity {energy['remainder']/supplied}")
    gone = (
        energy["total"]
        + energy["damping_dissipation"]
        + energy.get("unfelt_dissipation", 0.0)  # of sgmp
        + energy["contact_dissipation"]
        - energy["initial_total"]
        - energy["external_work"]
    ) / supplied
    report.check(abs(gone) < balance, f"{name}: {gone} of the energy unexplained")
    report.check(abs(gone - energy["drift"]) < 1e-12, f"{name}: drift {energy['drift']}, not {gone}")
    report.check(
        row["damping_dissipation"] == energy["damping_dissipation"] > 0,
        f"{name}: {row['damping_dissipation']} in history.csv",
    )
    report.check(
        abs(row["kinetic_energy"] - sum(body["kinetic_energy"] for body in result.table("bodies.csv")[-1:]))
        < 1e-13 * supplied,
        f"{name}: bodies.csv",
    )


def modes(report):
    """A bar decays with half the rate whatever the scheme; its frequency falls as that of an oscillator, to the order
    of the step."""
    for method, update in (
        ("sgmp", "musl"), ("sgmp", "usf"), ("sgmp", "usl"), ("sgmp", "usavg"), ("mpm", "musl"), ("gimp", "musl"),
    ):
        name = f"bar_{method}_{update}"
        result = run(name, BAR, method=method, update=update)
        if not report.finished(result, name):
            continue
        rate, omega = oscillation([row["velocity_x"] for row in result.table("gauges.csv")[1:]], 1/128)
        extra = 1e-3 if update == "usl" else 0.0  # which dissipates by itself; re-mapped updates a 50th of it
        report.check(abs(rate/(0.5*RATE) - 1) < 2e-5 + extra, f"{name}: rate {rate}, not {0.5*RATE}")
        report.check(abs(omega/math.sqrt(math.pi**2 - 0.25*RATE**2) - 1) < 5e-3, f"{name}: frequency {omega}")
        ledger(report, name, result, 5e-3)


def lame(report):
    """A thick tube that a pressure widens slowly has the stress of Lame: none that alternates from cell to cell, of
    which no particle feels anything."""
    inner, outer, pressure = 2.0, 3.5, 1e-3
    scale = pressure*inner**2/(outer**2 - inner**2)
    cases = {
        "musl": (LAME, "musl", 0.45, 6), "usavg": (LAME, "usavg", 0.45, 6), "fine": (LAME, "musl", 0.3, 8),
        "slow": (changed(LAME, ("damping", "! damping"), ("end=140", "end=420"), ("t/84", "t/250")), "musl", 0.45, 6),
    }
    for name, (deck, update, poisson, cells) in cases.items():
        result = run(f"lame_{name}", deck, update=update, nu=poisson, cells=cells)
        if not report.finished(result, name):
            continue
        off = max(
            abs(row["stress_xx"] - scale*(1 - (outer/(row["x"] - row["displacement_x"]))**2))/pressure
            for row in result.table("particles_end.csv") if 2.1 < row["x"] < 3.4
        )
        print(f"lame {name}: stress off by {off:.4f} of the pressure")
        report.check(off < 0.03, f"lame {name}: stress off by {off} of the pressure")
        report.check(abs(result["energy.drift"]) < 0.02, f"lame {name}: drift {result['energy.drift']}")
        dissipated = result["energy.unfelt_dissipation"]
        report.check(dissipated > 0, f"lame {name}: {dissipated}")


def bent(report):
    """A cantilever has the stress of a beam, -P (L - x) y/I, with no damping."""
    result = run("bent", BENT)
    if not report.finished(result, "bent"):
        return
    largest = 1e-5*8*0.5*12
    off = [
        row["stress_xx"] + 1e-5*(8 - row["x"])*(row["y"] - row["displacement_y"] - 0.5)*12
        for row in result.table("particles_end.csv") if 1.5 < row["x"] < 6.5
    ]
    rms = math.sqrt(sum(one**2 for one in off)/len(off))/largest
    print(f"bent: stress off by {rms:.4f} of the largest")
    report.check(rms < 0.008, f"bent: stress off by {rms} of the largest")


def flight(report):
    """What is free decays with the rate, until damping ends, a rigid body, too; what is prescribed goes on."""
    for name, deck in (("flight", FLIGHT), ("rigid flight", FLIGHT + "rigid free free=yes\n")):
        result = run(name.replace(" ", "_"), deck)
        if report.finished(result, name):
            flown(report, name, result)


def flown(report, name, result):
    """One of them."""
    rows = [row for row in result.table("bodies.csv") if row["name"] == "free"]
    for row in rows[1:]:
        expected = math.exp(-0.5*(min(row["time"], 2.0) - 0.025))  # velocities are those half a step before
        report.check(
            abs(row["velocity_x"] / expected - 1) < 1e-12,
            f"{name}: {row['velocity_x']} at {row['time']}, not {expected}",
        )
        report.check(abs(row["velocity_y"] + 0.5*row["velocity_x"]) < 1e-12, f"{name}: direction at {row['time']}")
    report.check(
        all(abs(row["velocity_x"] - 1) < 1e-13 for row in result.table("bodies.csv")[1:] if row["name"] == "tool"),
        f"{name}: the tool is slowed",
    )
    report.check(
        abs(result["energy.damping_dissipation"] / (20 * (1 - math.exp(-0.5 * 2 * (2 - 0.025)))) - 1) < 1e-12,
        f"{name}: {result['energy.damping_dissipation']}",
    )
    result = run("spinning", SPINNING)
    if report.finished(result, "spinning"):
        first, last = (result.table("history.csv")[row]["angular_momentum"] for row in (0, -1))
        report.check(
            abs(last / first - math.exp(-(2 - 1 / 128))) < 1e-12, f"spinning: {last / first} of the angular momentum"
        )
        ledger(report, "spinning", result, 1e-4)


def equilibrium(report):
    """Kinetic damping takes a column under gravity to rest, where the run ends; a block that turns stops and stays."""
    result = run("column", COLUMN)
    if report.finished(result, "column"):
        rows, last = result.table("particles_end.csv"), result.table("history.csv")[-1]
        worst = max(abs(row["displacement_x"] + 1e-4*(place - 0.5*place**2)) for row in rows
                    for place in [row["x"] - row["displacement_x"]])
        report.check(worst < 1e-4*1e-3, f"column: {worst} off the deflection")
        report.check(
            abs(last["internal_energy"] / (1e-4**2 / 6) - 1) < 5e-3, f"column: elastic energy {last['internal_energy']}"
        )
        report.check(11 <= last["time"] < 200, f"column: at rest at {last['time']}")
        report.check(last["kinetic_energy"] < 1e-6*last["total_energy"], "column: not at rest")
        ledger(report, "column", result, 0.02)
    early = run("early", COLUMN.replace(" hold=8 after=3", ""))
    if report.finished(early, "early"):
        report.check(early["time"] < 2, f"early: the first turn is at rest at {early['time']}")
    result = run("tumbling", TUMBLING)
    if report.finished(result, "tumbling"):
        kinetic = [row["kinetic_energy"] for row in result.table("history.csv")]
        stops = [n for n, energy in enumerate(kinetic) if energy == 0]
        report.check(
            stops and max(kinetic[stops[0] :]) < 1e-3 * kinetic[0],
            f"tumbling: {stops[:1]}, then {max(kinetic[stops[0] :]) / kinetic[0] if stops else None}",
        )


def weights(report):
    """A column under its weight sinks as far as it should with every update, and the energy that gravity gives is found
    again (the order of the step, doc/damping.md)."""
    for method in ("sgmp", "gimp", "mpm"):
        for update in ("musl", "usf", "usl", "usavg"):
            name = f"weight_{method}_{update}"
            result = run(name, WEIGHT, method=method, update=update)
            if report.finished(result, name):
                worst = max(
                    abs(row["displacement_x"] + 1e-4 * (place - 0.5 * place**2))
                    for row in result.table("particles_end.csv")
                    for place in [row["x"] - row["displacement_x"]]
                )
                report.check(worst < 0.5e-4*0.003, f"{name}: {worst/0.5e-4} off the deflection")
                report.check(abs(result["energy.drift"]) < 0.002, f"{name}: drift {result['energy.drift']}")
    result = run("weight_critical", WEIGHT, cells=4, rate=math.pi)
    if report.finished(result, "weight_critical"):
        report.check(abs(result["energy.drift"]) < 0.05, f"weight_critical: drift {result['energy.drift']}")


def plates(report):
    """Walls that move shear a block while it is damped: the stress of simple shear in its middle, the work of the wall
    is in it or taken; images behind walls keep what belongs to the walls."""
    stress = 100*0.002*20
    for method, update in (("sgmp", "musl"), ("sgmp", "usf"), ("sgmp", "usl"), ("sgmp", "usavg"), ("bspline", "usl")):
        for name, deck in ((f"plates_{method}_{update}", SHEARED),
                           (f"stops_{method}_{update}", SHEARED.replace("rate=2", "kinetic=yes"))):
            result = run(name, deck, method=method, update=update)
            if not report.finished(result, name):
                continue
            middle = [row["stress_xy"] for row in result.table("particles_end.csv")
                      if abs(row["x"] - 2) < 0.5 and abs(row["y"] - 0.5) < 0.3]
            mean = sum(middle)/len(middle)
            report.check(abs(mean/stress - 1) < 0.015, f"{name}: stress {mean:.5f} instead of {stress}")
            ledger(report, name, result, 2e-3)


def rest(report):
    """What is at rest under a load stays where it is, whatever updates the stress: an inclined strip with
    rotation=exact, its places at two times."""
    for update in ("musl", "usf", "usavg"):
        places = []
        for span in (2, 3):
            result = run(f"rest_{update}_{span}", INCLINED, rotation="exact", update=update, span=span)
            if report.finished(result, f"rest {update}"):
                places.append([(row["x"], row["y"]) for row in result.table("particles_end.csv")])
        if len(places) == 2:
            way = max(math.dist(a, b) for a, b in zip(*places))
            report.check(way < 0.01, f"rest {update}: a particle has moved by {way}")


def bits(report):
    """The same for threads, ranks and restarts, where velocities have companions: kept volumes, swirl, exact rotation,
    halves."""
    scenes = {
        "kept": KEPT_PLANE + "velocity gas x=0.3*y\ndamping rate=0.05\n",
        "swirl": SWIRL + "damping rate=0.2 kinetic=yes\n",
        "split": SPLIT + "damping rate=0.1\n",
        "tumbling": TUMBLING.replace("end=12", "steps=80").replace("kinetic=yes", "rate=0.3"),
    }
    for name, text in scenes.items():
        text += "checkpoint every=30 keep=9\n"
        reference = straight(report, name, text)
        for title, threads, launcher in ((f"{name}_threads", 3, ()), (f"{name}_ranks", 1, mpirun(2))):
            other = straight(report, title, text, threads=threads, launcher=launcher)
            for key in ("checksum", "energy.damping_dissipation", "energy.total"):
                report.check(other[key] == reference[key], f"{title}: {key} {other[key]}, not {reference[key]}")
        goes_on(report, reference, f"{name}_again", text, checkpoints(os.path.join(SCRATCH, name))[0])


if __name__ == "__main__":
    REPORT = Report()
    modes(REPORT)
    lame(REPORT)
    bent(REPORT)
    flight(REPORT)
    equilibrium(REPORT)
    weights(REPORT)
    plates(REPORT)
    rest(REPORT)
    bits(REPORT)
    REPORT.end()
