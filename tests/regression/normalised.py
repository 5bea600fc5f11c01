#!/usr/bin/env python3
"""Volume-normalised stress: the same in one, two and three dimensions, momentum kept, several bodies, and that it does
something.

usage: normalised.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import Report, run

# A bar that vibrates so hard that the volume at the centres is uneven; the walls across it are slippery, the ends fixed
# or free.
BAR = """
parameter stress = normalised
parameter update = musl
parameter end = fixed
dimension {dimension}
grid cell=1/16 x={box}{across}
wall x-={end} x+={end}{walls}
method sgmp update=$update stress=$stress
time dt=2e-3 steps=120
material stuff elastic density=25 young=50 poisson=0
body bar block material=stuff lower=({lower}) upper=({upper}) layout=gauss ppc=2
velocity bar x="2*sin(pi*x)"
history steps=1
output csv at=end fields=stress
"""


def bar(dimension, end):
    across = "".join(f" {axis}=0:0.25" for axis in "yz"[:dimension - 1])
    walls = "".join(f" {axis}-=slip {axis}+=slip" for axis in "yz"[:dimension - 1])
    lower = ",".join(["0" if end == "fixed" else "0.25"] + ["0"] * (dimension - 1))
    upper = ",".join(["1" if end == "fixed" else "0.75"] + ["0.25"] * (dimension - 1))
    return BAR.format(
        dimension=dimension, box="0:1" if end == "fixed" else "-1:2", across=across, walls=walls, end=end, lower=lower,
        upper=upper,
    )


def along(result):
    """Position, velocity and stress along the bar by the particles' places; the particles of a section must agree."""
    rows = sorted(
        (round(row["x"], 9), row["x"], row["velocity_x"], row["stress_xx"]) for row in result.table("particles_end.csv")
    )
    sections = {}
    for key, *values in rows:
        sections.setdefault(key, []).append(values)
    spread = max(max(v[i] for v in s) - min(v[i] for v in s) for s in sections.values() for i in range(3))
    return [s[0] for _, s in sorted(sections.items())], spread


def same_in_all_dimensions(report):
    """Slip walls make plane and space a line: the same motion up to round-off, and not that of plain stress."""
    for end in ("fixed", "free"):
        for update in ("musl", "usf", "usl", "usavg"):
            found = {}
            for dimension in (1, 2, 3) if update == "musl" else (1, 2):
                result = run(f"{end}_{update}_{dimension}", bar(dimension, end), update=update)
                if not report.finished(result, f"{end} {update} {dimension}"):
                    return
                found[dimension], spread = along(result)
                report.check(spread < 1e-9, f"{end} {update}, {dimension} dimensions: a section is not plane: {spread}")
            for dimension in list(found)[1:]:
                miss = max(abs(a - b) for p, q in zip(found[1], found[dimension]) for a, b in zip(p, q))
                report.check(len(found[1]) == len(found[dimension]) and miss < 1e-8,
                             f"{end} {update}: {dimension} dimensions differ from one by {miss}")
        plain, _ = along(run(f"{end}_plain", bar(1, end), stress="plain"))
        miss = max(abs(p[2] - q[2]) for p, q in zip(found[1], plain))
        report.check(miss > 1e-3, f"{end}: normalised and plain stress differ by {miss} only")


BLOCKS = """
parameter together = yes
parameter stress = normalised
dimension 2
grid cell=1
method sgmp update=musl stress=$stress
time dt=0.05 steps=200
material gel neo_hookean density=1 young=10 poisson=0.3
{bodies}
history steps=1
output csv at=end fields=stress
"""
ONE = """
body left block material=gel lower=(0.3,0.2) upper=(8.3,5.2) ppc=2
velocity left x="0.3*sin(0.7*x)+0.1" y="0.2*cos(0.9*x)"
"""
TWO = """
body left block material=gel lower=(0.3,0.2) upper=(4.3,5.2) ppc=2
body right block material=gel lower=(4.3,0.2) upper=(8.3,5.2) ppc=2
velocity left x="0.3*sin(0.7*x)+0.1" y="0.2*cos(0.9*x)"
velocity right x="0.3*sin(0.7*x)+0.1" y="0.2*cos(0.9*x)"
"""
# A neighbour in the same cells that never touches: its field is its own, and so is the volume it normalises by.
NEIGHBOUR = ONE + """
body other block material=gel lower=(9.6,0.2) upper=(13.6,5.2) ppc=2
velocity other x="3"
contact all
"""


def state(result, body=None):
    rows = [row for row in result.table("particles_end.csv") if body is None or row["body"] == body]
    return sorted(
        (row["x0"] if "x0" in row else 0.0, row["x"], row["y"], row["velocity_x"], row["stress_xx"], row["stress_xy"])
        for row in rows
    )


def several_bodies(report):
    """Bodies that share a field are one body to it; a body with a field of its own does not see the others' volume."""
    results = {
        name: run(f"blocks_{name}", BLOCKS.format(bodies=bodies))
        for name, bodies in (("one", ONE), ("two", TWO), ("neighbour", NEIGHBOUR))
    }
    for name, result in results.items():
        if not report.finished(result, name):
            return
    one, two = state(results["one"]), state(results["two"])
    miss = max(abs(a - b) for p, q in zip(one, two) for a, b in zip(p, q))
    report.check(len(one) == len(two) and miss < 1e-10, f"two bodies that share a field differ from one by {miss}")
    alone = state(results["neighbour"], 1)
    miss = max(abs(a - b) for p, q in zip(one, alone) for a, b in zip(p, q))
    report.check(
        len(one) == len(alone) and miss < 1e-10, f"a neighbour with a field of its own changes a body by {miss}"
    )
    report.check(
        state(run("blocks_plain", BLOCKS.format(bodies=ONE), stress="plain")) != one,
        "normalised stress has no effect on the blocks",
    )


def momentum(report):
    """Momentum is kept to round-off, with free surfaces and uneven particles, in two and three dimensions."""
    for name, deck, settings in (
        ("plane", BLOCKS.format(bodies=ONE), {}),
        ("space", "block.inp", {"cells": 5, "steps": 60, "drift": 0.3, "jitter": 0.4, "stress": "normalised"}),
    ):
        result = run(f"momentum_{name}", deck, **settings)
        if not report.finished(result, name):
            return
        rows = result.table("history.csv")
        for axis in "xyz":
            values = [row[f"momentum_{axis}"] for row in rows]
            scale = max(abs(row["momentum_x"]) for row in rows)
            report.check(
                max(abs(v - values[0]) for v in values) < 1e-11 * scale,
                f"{name}: momentum along {axis} drifts: {values[0]} to {values[-1]}",
            )
        report.check(abs(rows[-1]["energy_remainder"]) < 1e-11 * rows[0]["total_energy"],
                     f"{name}: kinetic energy that the identity leaves unexplained: {rows[-1]['energy_remainder']}")


def main():
    report = Report()
    same_in_all_dimensions(report)
    several_bodies(report)
    momentum(report)
    report.end()


if __name__ == "__main__":
    main()
