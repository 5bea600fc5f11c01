#!/usr/bin/env python3
"""Gas against a structure that no card but `contact plate` parts from it: TNT in air over a steel plate of two cells
(doc/contact.md).

usage: gas_structure.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: gas does not go through steel; a plate that gas slides along does not make the waves of the gas
faster than one that it sticks to; what leaves a room through a slit is sonic there, rho c w (2/(gamma+1))^((gamma+1)/
(2(gamma-1))) times a coefficient that for sharp edges and a vacuum is 0.6 to 0.85.
"""
import os

from _restarts import mpirun, straight
from _runs import Report

PLATE = 1                             # number of its body
SCENE = """
units mm g ms
parameter h=10
parameter wide=120
dimension axisymmetric
grid cell=h r=0:wide z=-100:200
wall r+=fixed
lost remove
method {method}
time end=0.25 cfl=0.4
material steel j2 density=7.85e-3 young=2.1e5 poisson=0.3 yield=270
material tnt explosive density=1.63e-3 detonation_speed=6930
eos tnt jwl a=3.712e5 b=3.231e3 r1=4.15 r2=0.95 omega=0.30 energy0=7000
material air fluid density=1.225e-6
eos air ideal_gas gamma=1.4 pressure0=0.1013
viscosity all quadratic=1.5 linear=0.3
body plate block lower=(0,-20) upper=(wide,0) material=steel ppc=2
body charge block lower=(0,70) upper=(20,90) material=tnt ppc=2
body air block lower=(0,0) upper=(wide,150) material=air ppc=2
subtract air block lower=(0,70) upper=(20,90)
detonation point=(0,80)
{contact}
history every=2e-2
output csv at=end fields=mass
"""


def behind(result):
    """Part of the gas that is behind the plate's upper face by more than half of the plate."""
    gas = [row for row in result.table("particles_end.csv") if round(row["body"]) != PLATE]
    depth = [row["mass"] for row in gas if row["z"] < -10]
    return sum(depth)/sum(row["mass"] for row in gas)


def impulse(result):
    """What contact has given to the plate along z."""
    total = since = 0.0
    for row in result.table("contact.csv"):
        total += row["force_z"]*(row["time"] - since)
        since = row["time"]
    return total


def tell(text):
    """What was measured, for documents."""
    if os.environ.get("SGMP_TEST_VERBOSE"):
        print(text)


def closed(report):
    """No gas gets through, and steps stay as long as those of the scene in which all bodies stick together."""
    impulses = []
    for method in ("sgmp split=0.75", "sgmp", "gimp split=0.75", "bspline split=0.75 update=usavg"):
        name = method.replace(" ", "_")
        # Gas that shares cells with the plate's steel gains a tenth of its energy with stress=normalised.
        shared = f"{method} stress=plain" if "sgmp" in method else method
        stuck = straight(report, f"stuck_{name}", SCENE.format(method=shared, contact=""))
        slips = straight(report, f"slips_{name}", SCENE.format(method=method, contact="contact plate"))
        part, steps = behind(slips), slips["steps"]/stuck["steps"]
        tell(f"{name}: {part:.1e} of the gas is behind the plate; {slips['steps']} steps, {steps:.2f} of those without "
                    f"the card; impulse {impulse(slips):.4g}")
        if "split" in method:  # gas that is not in pieces
            impulses.append(impulse(slips))
        report.check(part < 1e-3, f"{name}: {part} of the gas has gone through the plate")
        report.check(steps < 1.5, f"{name}: {steps} times as many steps as without contact")
        report.check(abs(slips["energy.remainder"]) < 1e-12*slips["energy.initial_total"],
                     f"{name}: remainder {slips['energy.remainder']}")
    report.check(min(impulses) < 0 and min(impulses)/max(impulses) < 1.1,
                 f"methods do not agree on the impulse: {impulses}")


# Half of a room whose wall has a slit of eight cells; behind it is nothing.
ROOM = """
dimension 2
grid cell=1 x=-1:120 y=0:40
wall y-=slip y+=slip x-=slip
lost remove
method gimp update=usavg split=0.75
time end={end} cfl=0.3
material gas fluid density=1
eos gas ideal_gas gamma=1.4 pressure0=1
viscosity gas quadratic=1.5 linear=0.06
material steel elastic density=8 young=2e3 poisson=0.3
body gas block material=gas lower=(-1,0) upper=(40,40) ppc=2
body plate block material=steel lower=(40,4) upper=(42,40) ppc=2
rigid plate
contact gas plate
output csv at=end fields=mass
"""


def leak(report):
    """A hole lets through what gas dynamics say."""
    passed = []
    for end in (12, 24):
        rows = straight(report, f"room_{end}", ROOM.format(end=end)).table("particles_end.csv")
        gas = [row for row in rows if round(row["body"]) != PLATE + 1]
        passed.append(sum(row["mass"] for row in gas if row["x"] > 42))
        inside = [row for row in gas if 40.5 < row["x"] < 41.5 and row["y"] > 5]
        report.check(not inside, f"slit: {len(inside)} particles of gas in the wall")
    sonic = 1.4**0.5*(2/2.4)**3*4
    coefficient = (passed[1] - passed[0])/12/sonic
    tell(f"slit: {coefficient:.3f} of the sonic flow through it")
    report.check(0.6 < coefficient < 0.85, f"slit: {coefficient} of the sonic flow")


def bits(report):
    """The same in any layout."""
    text = SCENE.format(method="sgmp split=0.75", contact="contact plate").replace("end=0.25", "end=0.06")
    reference = straight(report, "bits", text)
    for title, threads, launcher in (("threads", 2, ()), ("ranks", 1, mpirun(2))):
        other = straight(report, title, text, threads=threads, launcher=launcher)
        report.check(other["checksum"] == reference["checksum"],
                     f"{title}: checksum {other['checksum']}, not {reference['checksum']}")


if __name__ == "__main__":
    REPORT = Report()
    closed(REPORT)
    leak(REPORT)
    bits(REPORT)
    REPORT.end()
