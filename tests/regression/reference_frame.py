#!/usr/bin/env python3
"""Particles that see the grid from their first places (method frame=reference, doc/reference-frame.md): a ring that
bounces off a wall, flight, a bar held under tension, a bar that is pulled far, rings of revolution; what is refused and
what ends a run.

usage: reference_frame.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: the rebound of the ring, 0.833, from finite elements; free flight; the tension of a bar that rests;
the stress of a bar is the traction on its end; a thin ring rings with c/(2 pi r).
"""
import math
import re

from _runs import REFERENCE, REFERENCE_SPACE, Report, changed, run

RING = """
units mm g ms
parameter kind = mpm
parameter frame = reference
dimension 2
grid cell=2 x=-100:0 y=-60:60
wall x+=slip
method $kind frame=$frame
time end=5
material rubber neo_hookean density=1.01e-3 young=73 poisson=0.4
body r ring material=rubber centre=(-41,0,0) axis=(0,0,1) radius=40 inner=30 spacing=2/3
velocity r x=30
history every=0.01
"""
FLIGHT = """
parameter kind = gimp
dimension 2
grid cell=0.25
method $kind frame=reference
time end=200 cfl=0.5
material m elastic density=1 young=1 poisson=0.3
body m block material=m lower=(0.03,0.01) upper=(2.03,1.01) ppc=2 rotation=33
velocity m x=0.4 y=0.3
history steps=50
output csv at=end fields=stress,displacement
"""
HELD = """
dimension 1
parameter frame = reference
grid cell=1 x=0:40
wall x-=fixed x+=fixed
method gimp frame=$frame
time end=3000 cfl=0.4
material stuff elastic density=1 young=1 poisson=0
body bar block material=stuff lower=0 upper=40 layout=uniform spacing=0.5 jitter=0.001
initial_stress bar xx=0.1
history steps=100
output csv at=end fields=stress
"""
PULLED = """
parameter kind = gimp
dimension 2
grid cell=0.25 x=0:8 y=0:4
wall x-=slip y-=slip
method $kind frame=reference
time end=200 cfl=0.5
damping rate=0.1
material rubber neo_hookean density=1 young=1 poisson=0.3
body bar block material=rubber lower=(0,0) upper=(3,1) ppc=2
traction bar face=x+ x="0.5*min(t/100,1)"
output csv at=end fields=stress,displacement,initial_position
"""
HOOP = """
dimension axisymmetric
grid cell=0.1 r=0:3 z=0:0.4
wall z-=slip z+=slip
method gimp frame=reference
time end=60 cfl=0.5
material m elastic density=1 young=1 poisson=0
body ring block material=m lower=(1.9,0) upper=(2.1,0.4) ppc=2
velocity ring r=0.001
history every=0.1
gauge middle point=(2,0.2)
"""
report = Report()


def ring():
    """Comes back as finite elements say; in the frame that moves along gimp loses a tenth more."""
    for kind, off in (("mpm", 0.02), ("gimp", 0.04)):
        result = run(f"ring_{kind}", RING, kind=kind)
        if not report.finished(result, f"ring_{kind}"):
            continue
        rows = result.table("bodies.csv")
        report.check(abs(-rows[-1]["velocity_x"]/30/0.833 - 1) < off, f"ring {kind}: {rows[-1]['velocity_x']/30}")
        report.check(abs(result["energy.drift"]) < 0.01, f"ring {kind}: energy {result['energy.drift']}")
        report.check(result["verdict"] != "doubtful", f"ring {kind}: {result['verdict_reasons']}")


def flight():
    """Hundreds of cells further on nothing has changed but the place."""
    for kind in ("gimp", "mpm"):
        for name, deck in (("plane", FLIGHT), ("space", changed(
            FLIGHT, ("dimension 2", "dimension 3"), ("end=200", "end=20"), ("(0.03,0.01)", "(0.03,0.01,0)"),
            ("(2.03,1.01)", "(1.03,1.01,1)")))):
            result = run(f"flight_{kind}_{name}", deck, kind=kind)
            if not report.finished(result, f"flight {kind} {name}"):
                continue
            time = result["time"]
            for row in result.table("particles_end.csv"):
                off = max(abs(row["displacement_x"] - 0.4*time), abs(row["displacement_y"] - 0.3*time))
                if not report.check(off < 1e-10*time, f"flight {kind} {name}: {off} off at {time}"):
                    break
                stress = max(abs(value) for key, value in row.items() if key.startswith("stress"))
                if not report.check(stress < 1e-12, f"flight {kind} {name}: stress {stress}"):
                    break


def held():
    """Tension stays what it is for thousands of cells' waves; what crosses cells loses half of it."""
    result = run("held", HELD)
    if report.finished(result, "held"):
        stress = [row["stress_xx"] for row in result.table("particles_end.csv")]
        report.check(max(abs(s/0.1 - 1) for s in stress) < 5e-3, f"held: stress {min(stress)} to {max(stress)}")
        report.check(result["energy.kinetic"] < 1e-5*result["energy.internal"], f"held: {result.summary['energy']}")
        report.check(result["verdict"] == "sound", f"held: {result['verdict_reasons']}")


def pulled():
    """At rest the stress along a bar is the traction on its end per area now, and there is none across."""
    for kind in ("gimp", "mpm"):
        result = run(f"pulled_{kind}", PULLED, kind=kind)
        if not report.finished(result, f"pulled {kind}"):
            continue
        rows = [r for r in result.table("particles_end.csv") if r["x0"] < 2]
        longer = max(r["displacement_x"]/r["x0"] for r in rows)
        report.check(longer > 0.3, f"pulled {kind}: only by {longer}")
        for r in rows:
            fine = abs(r["stress_xx"]/0.5 - 1) < 0.01 and abs(r["stress_yy"]) < 0.005 and abs(r["stress_xy"]) < 0.005
            if not report.check(fine, f"pulled {kind}: {r}"):
                break


def hoop():
    """A thin ring breathes with c/r, c^2 = E/rho."""
    result = run("hoop", HOOP)
    if not report.finished(result, "hoop"):
        return
    rows = result.table("gauges.csv")
    speed = [(row["time"], row["velocity_x"]) for row in rows]
    down = [t0 + (t1 - t0)*v0/(v0 - v1) for (t0, v0), (t1, v1) in zip(speed, speed[1:]) if v0 > 0 >= v1]
    period = (down[-1] - down[0])/(len(down) - 1)
    exact = 2*math.pi*2
    report.check(len(down) > 3 and abs(period/exact - 1) < 0.01, f"hoop: period {period/exact} of the exact one")


def ends():
    """A wall that holds nothing yet must not be passed; nor may first places be far from the truth."""
    through = changed(FLIGHT, ("grid cell=0.25", "grid cell=0.25 x=-2:5 y=-2:open\nwall x+=slip"),
                      ("end=200", "end=30"))
    result = run("through", through)
    report.check(result.code == 4 and "has come through a wall that it did not touch" in result.text,
                 f"through: {result.code} {result.text}")
    squeezed = changed(PULLED, ('x="0.5*min(t/100,1)"', 'x="-3*min(t/100,1)"'))
    result = run("squeezed", squeezed)
    report.check(result.code == 4 and "is shorter than a fifth" in result.text,
                 f"squeezed: {result.code} {result.text}")


def refused():
    """What the first shape does not know."""
    for name, words, *pairs in (
        ("sgmp", "does not go with method sgmp", ("method = gimp", "method = sgmp")),
        ("flows", "flows: its first shape", ("neo_hookean density=1 young=1 poisson=0.3",
                                             "fluid density=1\neos rubber tait c0=1 exponent=7")),
        ("apart", "are not one piece", ("velocity", "body other block material=rubber lower=(4,0) upper=(5,1) ppc=2\n"
                                                    "velocity")),
        ("turns", "a card motion turns a part", ("history", 'motion block where="x<0.3" omega_z=1\nhistory')),
        ("fails", "does not go with failure", ("body", "failure rubber principal_stress=1\nbody")),
    ):
        result = run(f"refused_{name}", changed(REFERENCE, *pairs))
        report.check(result.code == 3 and words in result.text, f"refused {name}: {result.code} {result.text}")
    glued = changed(REFERENCE, ("velocity", "body other block material=rubber lower=(2.1,0) upper=(3.1,1) ppc=2 "
                                            "rotation=20 pivot=(1.1,0.5)\nvelocity"),
                    ("omega_z=0.2", ""), ("rotation=20\n", "rotation=20 pivot=(1.1,0.5)\n"), ("x=0.3 y=0.8", ""))
    result = run("glued", glued)
    report.finished(result, "glued")


def memory():
    """What is noted of the first places."""
    for deck, columns in ((REFERENCE, 6), (REFERENCE_SPACE, 12)):
        used = []
        for text in (deck, deck.replace(" frame=reference", "")):
            result = run("memory", text, options=["--check"])
            used.append(float(re.search(r"particles: ([0-9.]+) bytes per particle, grid", result.text)[1]))
        # Chunks have room for eight particles, and cells at the surface of a turned body fill few of it.
        report.check(8*columns <= used[0] - used[1] < 32*columns, f"memory, {columns} columns: {used}")


for check in (ring, flight, held, pulled, hoop, ends, refused, memory):
    check()
report.end()
