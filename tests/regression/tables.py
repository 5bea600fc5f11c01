#!/usr/bin/env python3
"""Equations of state from files, and afterburn. A shock tube with a table of the ideal gas is that of `ideal_gas`, in
other units, too, and a restart refuses other rows. Products in a closed box get the heat of afterburn and no more.

usage: tables.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math
import os

from _runs import SCRATCH, Report, run

TUBE = """
parameter steps = 150
units m kg s
dimension 1
grid cell=0.02 x=-3:4
method sgmp stress=normalised
time cfl=0.3 steps=steps
{cards}
viscosity all quadratic=1.5 linear=0.3
body left block lower=0 upper=0.5 material=left ppc=4
body right block lower=0.5 upper=1 material=right ppc=4
output csv at=end fields=density,pressure,energy
checkpoint every=50 keep=9
"""
GAS = "".join(f"material {name} fluid density={density}\neos {name} {{eos}} energy0={energy}\n"
              for name, density, energy in (("left", 1, 2.5e5), ("right", 0.125, 2.5e4)))
BOX = """
dimension 1
grid cell=0.1 x=0:1
wall x-=slip x+=slip
time dt=1e-3 steps=400
material gas explosive density=1.5 detonation_speed=1e3
eos gas jwl a=371.2 b=3.2 r1=4.15 r2=0.95 omega=0.3 energy0=7 {words}
detonation point=0
body b block lower=0 upper=1 material=gas ppc=2
output csv at=end fields=energy{more}
"""


def rows(path, factors=(1, 1, 1)):
    """A table of an ideal gas, energies first, with temperatures."""
    with open(path, "w", encoding="ascii") as file:
        file.write("# density energy pressure temperature\n")
        for i in range(12):
            for j in range(14):
                rho, e = 0.005*1600**(i/11)/factors[0], 1e4*500**(j/13)/factors[1]
                file.write(f"{rho!r}, {e!r}, {0.4*rho*e*factors[0]*factors[1]/factors[2]!r}, {300*e*factors[1]!r}\n")


def tubes(report):
    """The tube with the gas, with its table, and with a table and constants in other units."""
    rows(os.path.join(SCRATCH, "air.tab"))
    rows(os.path.join(SCRATCH, "metric.tab"), (1e3, 1e6, 1e9))
    tabled = GAS.format(eos='table file="air.tab"')
    metric = GAS.format(eos='table file="metric.tab"')
    for metres, millimetres in (("=1\n", "=1e-3\n"), ("=0.125", "=1.25e-4"), ("250000.0", "2.5e-4")):
        metric = metric.replace(metres, millimetres)
    with open(os.path.join(SCRATCH, "gas_metric.inp"), "w", encoding="ascii") as opened:
        opened.write("units mm mg us scope=file\n" + metric.replace("25000.0", "2.5e-5"))
    ends = {}
    scenes = {"ideal": GAS.format(eos="ideal_gas gamma=1.4"), "tabled": tabled, "metric": 'include "gas_metric.inp"'}
    for name, cards in scenes.items():
        result = run(name, TUBE.format(cards=cards))
        if report.finished(result, name):
            ends[name] = sorted(result.table("particles_end.csv"), key=lambda row: row["x"])
    for name in ("tabled", "metric"):
        if len(ends) == 3:
            off = max(abs(a[key] - b[key])/max(abs(c[key]) for c in ends["ideal"])
                      for key in ("x", "density", "pressure", "energy") for a, b in zip(ends["ideal"], ends[name]))
            report.check(off < 1e-7, f"{name}: {off:.1e} from the ideal gas")
    rows(os.path.join(SCRATCH, "air.tab"), (1, 1, 1.001))
    folder = os.path.join(SCRATCH, "tabled")
    middle = sorted(name for name in os.listdir(folder) if name.startswith("checkpoint"))[0]
    result = run("again", TUBE.format(cards=tabled), options=["--restart", os.path.join(folder, middle)])
    report.check(result.code == 3 and "checksum" in result.text,
                 f"another table: exit code {result.code}\n{result.text}")


def boxes(report):
    """Energy of products per initial volume at the end of 0.4 time units, all lit at once nearly."""
    rate = "afterburn=10 afterburn_rate=2 afterburn_pressure=1 afterburn_order=1 afterburn_exponent=0"
    for name, words, part in (("none", "", 0.0),
                              ("window", "afterburn=10 afterburn_start=0.1 afterburn_end=0.3", 1.0),
                              ("half", "afterburn=10 afterburn_start=0.2 afterburn_end=0.6", 0.5),
                              ("rate", rate, 1 - math.exp(-0.8))):
        result = run("box_" + name, BOX.format(words=words, more=",afterburnt"*bool(words)))
        if report.finished(result, "box " + name):
            ends = result.table("particles_end.csv")
            energy = sum(row["energy"] for row in ends)/len(ends)
            report.check(abs(energy - 7 - 10*part) < 0.03, f"{name}: the energy is {energy}, not {7 + 10*part}")
            report.check(all(abs(row.get("afterburnt", 0.0) - part) < 3e-3 for row in ends),
                         f"{name}: not the part {part} is burnt")


def main():
    report = Report()
    tubes(report)
    boxes(report)
    report.end()


main()
