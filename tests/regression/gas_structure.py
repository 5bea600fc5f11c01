#!/usr/bin/env python3
"""Gas against a structure that no card but `contact plate` parts from it: TNT in air over a steel plate of two cells
(doc/contact.md).

usage: gas_structure.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: gas does not go through steel; a plate that gas slides along does not make the waves of the gas
faster than one that it sticks to.
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
        stuck = straight(report, f"stuck_{name}", SCENE.format(method=method, contact=""))
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
    bits(REPORT)
    REPORT.end()
