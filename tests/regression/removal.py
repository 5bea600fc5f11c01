#!/usr/bin/env python3
"""Bodies that the card `remove` takes out of the scene: what is booked, what is left, the step, any layout, restarts.

usage: removal.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from math import isclose, pi, sqrt

from _restarts import goes_on, mpirun, straight
from _runs import Report, run

# Two blocks that fly apart, the stiffer one for a while only: known to round-off.
APART = """
parameter method = sgmp
parameter update = musl
dimension {dimension}
grid cell=1 {grid}
wall {walls}
method $method update=$update
time end=30 cfl=0.4 growth=1.5
material ram elastic density=2 young=16 poisson=0
material steel elastic density=2 young=1 poisson=0
body ram block material=ram lower=({lower}) upper=({upper}) ppc=2
body steel block material=steel lower=({from_}) upper=({to}) ppc=2
velocity steel {along}=0.125
velocity ram {along}=-0.25
remove ram time=2
history steps=1
"""
SPACES = {
    "1D": (
        dict(dimension=1, grid="x=0:20", walls="x-=slip", lower="2", upper="7", from_="10", to="13", along="x"), 5.0,
        3.0,
    ),
    "plane": (
        dict(
            dimension=2, grid="x=0:4 y=0:20", walls="x-=slip x+=slip y-=slip", lower="0,2", upper="4,7", from_="0,10",
            to="4,13", along="y",
        ),
        20.0,
        12.0,
    ),
    "rings": (
        dict(
            dimension="axisymmetric", grid="r=0:4 z=0:20", walls="r+=slip z-=slip", lower="0,2", upper="4,7",
            from_="0,10", to="4,13", along="z",
        ),
        80.0 * pi,
        48.0 * pi,
    ),
    "space": (
        dict(
            dimension=3, grid="x=0:3 y=0:3 z=0:20", walls="x-=slip x+=slip y-=slip y+=slip z-=slip", lower="0,0,2",
            upper="3,3,7", from_="0,0,10", to="3,3,13", along="z",
        ),
        45.0,
        27.0,
    ),
}
# Compressed gas that throws a plate, is removed, and leaves the plate to fly on.
THROWN = """
dimension 2
grid cell=1 x=0:6 y=0:30
wall x-=slip x+=slip y-=slip
method sgmp
time end=30 cfl=0.4
material air fluid density=0.1
eos air ideal_gas gamma=1.4 pressure0=0.02
material steel elastic density=2 young=1 poisson=0
body air block material=air lower=(0,0) upper=(6,6) ppc=2
body plate block material=steel lower=(0,6) upper=(6,9) ppc=2
contact all
remove air time=12
history steps=1
output csv at=end fields=stress,velocity
"""
WAYS = [
    ("sgmp", "musl"), ("sgmp", "usf"), ("sgmp", "usl"), ("sgmp", "usavg"), ("mpm", "musl"), ("gimp", "usf"),
    ("bspline", "musl"),
]


def known(report, space, method, update):
    """Mass, momentum, energy and time steps, of blocks in free flight."""
    card, ram, block = SPACES[space]
    axis = card["along"]
    name = f"apart_{space}_{method}_{update}"
    result = run(name, APART.format(**card), method=method, update=update)
    if not report.finished(result, name):
        return
    expected = {"mass": 2*ram, "kinetic_energy": 0.5*2*ram*0.25**2, "internal_energy": 0.0}
    for key, value in expected.items():
        report.check(
            isclose(result[f"removed.{key}"], value, rel_tol=1e-9, abs_tol=1e-12),
            f"{name}: {key} {result[f'removed.{key}']} of {value}",
        )
    rows = result.table("history.csv")
    report.check(
        isclose(rows[-1][f"removed_momentum_{axis}"], -0.25 * 2 * ram, rel_tol=1e-9),
        f"{name}: momentum {rows[-1][f'removed_momentum_{axis}']}",
    )
    steps = {row["time"]: row["dt"] for row in rows if row["step"] > 1}
    early = [dt for time, dt in steps.items() if time < 1.9]
    late = [dt for time, dt in steps.items() if 10 < time < 25]
    for which, found, step in (("with the ram", early, 0.4/(sqrt(8) + 0.25)), ("alone", late, 0.4/(sqrt(0.5) + 0.125))):
        report.check(
            found and all(isclose(dt, step, rel_tol=0.03) for dt in found), f"{name}: steps {which} {found}, not {step}"
        )
    steel = [row for row in result.table("bodies.csv") if row["name"] == "steel"][-1]
    report.check(
        isclose(steel[f"velocity_{axis}"], 0.125, rel_tol=1e-9),
        f"{name}: the block flies at {steel[f'velocity_{axis}']}",
    )
    report.check(isclose(steel["mass"], 2*block, rel_tol=1e-12), f"{name}: mass {steel['mass']} of the block")
    report.check(abs(result["energy.drift"]) < 1e-9, f"{name}: drift {result['energy.drift']}")
    report.check(result["verdict"] != "doubtful", f"{name}: {result['verdict']} {result['verdict_reasons']}")


def thrown(report):
    """The plate keeps the momentum that it has, whatever runs it; momentum of gas and plate is booked."""
    result = straight(report, "thrown", THROWN + "checkpoint every=10 keep=99\n")
    plate = [row for row in result.table("bodies.csv") if row["name"] == "plate"]
    late = [row["velocity_y"] for row in plate if row["time"] > 13]
    report.check(
        late[0] > 0.01 and max(late) - min(late) < 1e-12, f"thrown: the plate flies at {min(late)} to {max(late)}"
    )
    last = result.table("history.csv")[-1]
    report.check(
        isclose(last["momentum_y"], 2 * 18 * late[-1], rel_tol=1e-9),
        f"thrown: momentum {last['momentum_y']} of {36 * late[-1]}",
    )
    left = sum(plate[-1][key] for key in ("kinetic_energy", "internal_energy"))
    taken = result["removed.kinetic_energy"] + result["removed.internal_energy"]
    report.check(
        isclose(left + taken, 0.02 / 0.4 * 36, rel_tol=0.01),
        f"thrown: energy {left} left, {taken} taken of {0.02 / 0.4 * 36}",
    )
    report.check(abs(result["energy.drift"]) < 0.01, f"thrown: drift {result['energy.drift']}")
    straight_two = straight(report, "thrown_threads", THROWN, threads=2)
    ranks = straight(report, "thrown_ranks", THROWN, launcher=mpirun(2))
    for other in (straight_two, ranks):
        report.check(other["checksum"] == result["checksum"], "thrown: other bits in another layout")
    for step in (10, 50):
        goes_on(report, result, f"thrown_{step}", THROWN + "checkpoint every=10 keep=99\n", step)


def main():
    report = Report()
    for space in SPACES:
        for method, update in WAYS if space in ("1D", "plane") else WAYS[:1]:
            known(report, space, method, update)
    thrown(report)
    report.end()


if __name__ == "__main__":
    main()
