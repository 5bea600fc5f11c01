#!/usr/bin/env python3
"""Dumps and histories change no stability limit: a vibrating bar at the Courant numbers of a scan, bare, with histories
and with dumps at intervals that are no multiple of the step.

usage: landing.py SGMP SOURCE_DIR SCRATCH_DIR

Expected values: rows stand at the first step at or after their time; energies are those that a linear bar must keep.
Where steps alternate between m (1 - e) and m (1 + e), modes with (w m)^2 between 2/(1 + e) and 2/(1 - e) grow although
they are stable at either length (doc/time-step.md); with intervals of 2.5 steps cut at their ends the bars of TROUBLE
gain a thousandfold.
"""
import math

from _runs import Report, run

BAR = """
parameter cells = 32
parameter method = gimp
parameter update = musl
parameter cfl = 1
parameter v = 0.001
dimension 1
grid cell=1/cells x=0:1
wall x-=fixed x+=fixed
method $method update=$update
time cfl=cfl end=40
material stuff elastic density=1 young=1 poisson=0
body bar block material=stuff lower=0 upper=1 layout=gauss ppc=2
velocity bar x="v*sin(pi*x)"
stop energy_growth=1e6
"""
BARE = "history steps=10\n"
ROWS = "history every=2.5*cfl/cells\n"
DUMPS = "history steps=10\noutput tecplot every=2.5*cfl/cells\n"
FAR_DUMPS = "history steps=10\noutput tecplot every=25.5*cfl/cells\n"
TROUBLE = (("gimp", "musl", 1.2), ("gimp", "usf", 1.2), ("mpm", "musl", 1.0), ("mpm", "usf", 1.2))
SCAN = [0.8 + 0.2*k for k in range(7)]


def energy(result):
    """Total energy at the end over that at the start; infinite if the run failed."""
    ratio = result["energy.total"]/result["energy.initial_total"] if result.code == 0 else math.inf
    return ratio if 0 < ratio < math.inf else math.inf


def kept(report):
    """Energies with rows and dumps where steps cut for them would gain a thousandfold."""
    for method, update, cfl in TROUBLE:
        settings = {"method": method, "update": update, "cfl": cfl}
        bare = run("bare", BAR + BARE, **settings)
        report.check(abs(energy(bare) - 1) < 0.04, f"{method} {update} {cfl}: bare {energy(bare)}")
        rows = run("rows", BAR + ROWS, **settings)
        report.check(
            rows["checksum"] == bare["checksum"], f"{method} {update} {cfl}: rows change the run: {energy(rows)}"
        )
        for name, cards in (("dumps", DUMPS), ("far", FAR_DUMPS)):
            result = run(name, BAR + cards, **settings)
            report.check(abs(energy(result) - 1) < 0.04, f"{method} {update} {cfl}: {name} {energy(result)}")


def limits(report):
    """The largest Courant number of a scan up to which every run is sound."""
    for method, update in (("sgmp", "musl"), ("gimp", "musl"), ("gimp", "usl"), ("mpm", "usl")):
        largest = {}
        for name, cards in (("bare", BARE), ("rows", ROWS), ("far", FAR_DUMPS)):
            sound = [
                cfl
                for cfl in SCAN
                if abs(energy(run(name, BAR + cards, method=method, update=update, cfl=cfl)) - 1) < 0.2
            ]
            largest[name] = max([cfl for k, cfl in enumerate(SCAN) if sound[:k + 1] == SCAN[:k + 1]], default=0.6)
        report.check(largest["bare"] == largest["rows"] == largest["far"], f"{method} {update}: {largest}")


def rows_in_time(report):
    """Each row stands at the first step at or after its time; every step has a row where they are longer than the
    interval."""
    step = 1.3/32
    result = run(
        "times", BAR.replace("time cfl=cfl end=40", f"time dt={step!r} steps=200") + "history every=0.1\n",
        method="sgmp",
    )
    expected = [0.0]
    for k in range(1, 201):
        if math.floor(k*step/0.1 + 1e-9) > math.floor((k - 1)*step/0.1 + 1e-9):
            expected.append(k*step)
    found = [row["time"] for row in result.table("history.csv")]
    report.check(
        len(found) == len(expected) and all(abs(a - b) < 1e-12 for a, b in zip(found, expected)), f"rows at {found[:9]}"
    )
    result = run("often", BAR.replace("time cfl=cfl end=40", f"time dt={step!r} steps=20") + "history every=1e-12\n")
    report.check([row["step"] for row in result.table("history.csv")] == list(range(21)), "a row for every step")


def main():
    """All of them."""
    report = Report()
    kept(report)
    limits(report)
    rows_in_time(report)
    report.end()


main()
