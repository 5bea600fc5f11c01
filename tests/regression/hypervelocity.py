#!/usr/bin/env python3
"""Debris of hypervelocity impacts (doc/materials.md): energy that does not grow, in all methods and updates; collisions
that keep momentum; a Whipple shield that is computed to its end, with and without contact, and through whose whole wall
nothing leaks; torn matter without a card; the same bits.

usage: hypervelocity.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: energy is conserved, and no fragment is much faster than what it comes from.
"""
import math

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

# A ball whose rear opens and whose front hits a wall: it fails everywhere, at once.
CLOUD = """
parameter cfl = 0.4
parameter cell = 0.4
parameter carries = nothing
parameter method = sgmp
parameter update = musl
parameter t_end = 0.012
parameter back = -30
units mm g ms
dimension axisymmetric
grid cell=cell r=0:open z=back:open
wall z-=slip
method $method update=$update
time end=t_end cfl=cfl
material al j2 density=2.7e-3 young=70e3 poisson=0.33 yield=300
eos al gruneisen c0=5240 s=1.4 gamma0=1.97
failure al pmin=-1500 carries=$carries
viscosity al quadratic=1.5
body a sphere material=al centre=(0,0) radius=2
velocity a r=2500*r/2 z=2500*z/2-5000
history every=0.001
output csv at=end
checkpoint every=100
"""
# Bumper and rear wall at a fourth of the usual distance, coarse.
SHIELD = """
parameter t_end = 0.014
units mm g ms
dimension axisymmetric
grid cell=0.5 r=0:open
method sgmp
time end=t_end cfl=0.4
material al johnson_cook density=2.7e-3 young=70e3 poisson=0.33 yield=265 hardening_modulus=426 hardening_exponent=0.34
eos al gruneisen c0=5240 s=1.4 gamma0=1.97
failure al pmin=-1500 plastic_strain=1.5
viscosity all
body ball sphere material=al centre=(0,2.6) radius=2.5 spacing=0.25
body bumper cylinder material=al centre=(0,-2) axis=(0,1) radius=15 length=2 spacing=0.25
body rear cylinder material=al centre=(0,-27) axis=(0,1) radius=20 length=5 spacing=0.25
velocity ball z=-6000
{contact}
history every=0.001
output csv at=end fields=mass
checkpoint every=100
"""
# A ball through a plate in space, with surfaces of both that come apart.
DEBRIS = """
units mm g ms
grid cell=4.24
method sgmp
time end=0.025 cfl=0.5
material lead johnson_cook density=11.35e-3 young=17000 poisson=0.42 yield=12 hardening_modulus=125
eos lead gruneisen c0=2092 s=1.45 gamma0=2
failure lead plastic_strain=3 pmin=-1000
viscosity lead
body ball sphere material=lead centre=(0,0,-7.5) radius=7.5
body plate block material=lead lower=(-32,-32,0) upper=(32,32,6.36)
velocity ball z=6580
history every=0.005
"""
# The ball of CLOUD as a disk in the plane, with the cures that sgmp has there without a word.
PLANE = CLOUD.replace("dimension axisymmetric", "dimension 2").replace("grid cell=cell r=0:open z=back:open",
    "grid cell=cell y=back:open").replace("wall z-=slip", "wall y-=slip").replace(
    "velocity a r=2500*r/2 z=2500*z/2-5000", "velocity a x=2500*x/2 y=2500*y/2-5000")
WALL = -27, 20  # its back and its radius
# Lead that is torn without a card `failure`.
LEAD = """
units mm g ms
dimension axisymmetric
grid cell=1 r=0:open
method {method}
time end=0.02 cfl=0.4
material lead j2 density=11.34e-3 young=16e3 poisson=0.42 yield=14
eos lead gruneisen c0=2060 s=1.5 gamma0=2.7
viscosity all
body ball sphere material=lead centre=(0,7.6) radius=7.5 spacing=0.5
body plate cylinder material=lead centre=(0,-6) axis=(0,1) radius=40 length=6 spacing=0.5
velocity ball z=-6580
history every=0.001
output csv at=end
"""


def fastest(result):
    return max(
        math.sqrt(sum(row[f"velocity_{axis}"] ** 2 for axis in "xyz")) for row in result.table("particles_end.csv")
    )


def energies(report, name, result, drift, speed):
    if report.finished(result, name):
        report.check(abs(result["energy.drift"]) < drift, f"{name}: drift {result['energy.drift']}")
        report.check(fastest(result) < speed, f"{name}: a fragment at {fastest(result)} m/s")


def cloud(report):
    # The fastest of the start has 7500 m/s. What carries nothing flies on.
    for settings in (
        {"cfl": 0.1},
        {"cfl": 0.8},
        {"method": "mpm"},
        {"method": "gimp"},
        {"method": "bspline"},
        {"update": "usf"},
        {"update": "usl"},
        {"update": "usavg"},
    ):
        name = "_".join(["cloud", *map(str, settings.values())])
        energies(report, name, run(name, CLOUD, **settings), 0.001, 7600)
    # With pressure what debris gives is settled step by step, but with usavg.
    for settings in (
        {"cfl": 0.25},
        {"cfl": 0.8},
        {"method": "gimp", "cfl": 0.8},
        {"method": "cpgimp", "cfl": 0.8},
        {"method": "bspline"},
        {"update": "usf", "cfl": 0.8},
        {"update": "usavg"},
        {"method": "mpm"},
        {"method": "mpm", "cfl": 0.8},
        {"update": "usl"},
        {"update": "usl", "cfl": 0.8},
        {"update": "usl", "method": "mpm", "cfl": 0.4},
    ):
        name = "_".join(["pressure", *map(str, settings.values())])
        result = run(name, CLOUD, carries="pressure", **settings)
        energies(report, name, result, 0.03 if settings.get("update") == "usavg" else 0.002, 1.5*7500)
        heat = result["energy.collision_heat"]/result["energy.initial_total"]
        report.check(0.3 < heat < 1, f"{name}: collisions turn {heat} of the energy to heat")


def plane(report):
    """The cures of surfaces, rotation and sections of the defaults leave debris its energy."""
    for update in ("usl", "musl", "usf"):
        name = f"plane_{update}"
        energies(report, name, run(name, PLANE, update=update, carries="pressure"), 0.002, 1.5*7500)


def announced(report):
    """What cannot be cured is said before a step is taken."""
    for settings, words in (
        ({"update": "usl"}, "update=usl strains"),
        ({"carries": "everything"}, "carries everything"),
        ({}, ""),
    ):
        result = run("announced", CLOUD, options=("--check",), **settings)
        said = "update=usl strains" in result.text, "carries everything" in result.text
        report.check(said == ("usl" in words, "everything" in words), f"announced {settings}: {result.text[-400:]}")


def momentum(report):
    """Without walls collisions keep it; the spread of the axial velocities must be there to be lost."""
    for method in ("sgmp", "mpm", "gimp"):
        free = CLOUD.replace("wall z-=slip\n", "").replace("2500*z/2-5000", "2500*z/2+3000*sin(40*z+31*r)")
        result = run(f"momentum_{method}", free, carries="pressure", method=method, t_end=0.001)
        if not report.finished(result, f"momentum {method}"):
            continue
        first, last = (float(result.table("history.csv")[row]["momentum_z"]) for row in (0, -1))
        report.check(abs(last - first) < 1e-9*9e4*1e-3, f"momentum {method}: {first} becomes {last}")
        report.check(
            result["energy.collision_heat"] > 1e-3 * result["energy.initial_total"],
            f"momentum {method}: nothing collides",
        )
        report.check(
            abs(result["energy.remainder"]) < 1e-10 * result["energy.initial_total"],
            f"momentum {method}: remainder {result['energy.remainder']}",
        )


def free_debris(report):
    """Rows of cells that hold nothing but debris beside rows that hold the rest of a body: corrected strains near
    surfaces
    take as much momentum on one side as they give on the other."""
    rows = run("free_debris", DEBRIS).table("history.csv")
    first, last = (float(rows[row]["momentum_z"]) for row in (0, -1))
    report.check(abs(last/first - 1) < 1e-12, f"free debris: momentum {first} becomes {last}")


def shields(report):
    for name, contact in (("shield", ""), ("shield_contact", "contact all")):
        result = run(name, SHIELD.format(contact=contact))
        energies(report, name, result, 0.03, 9000)
        rows = result.table("particles_end.csv")
        ball = sum(row["mass"] for row in rows if row["body"] == 1)
        leaked = sum(row["mass"] for row in rows if row["body"] < 3 and row["z"] < WALL[0] and row["x"] < WALL[1])
        report.check(leaked < 1e-4*ball, f"{name}: {leaked/ball} of the ball's mass is behind the wall")
        report.check(result["energy.collision_heat"] > 0.1*result["energy.initial_total"], f"{name}: nothing collides")


def torn(report):
    for method in ("sgmp", "mpm"):
        energies(report, f"lead {method}", run(f"lead_{method}", LEAD.format(method=method)), 0.05, 1.5*6580)


def bits(report):
    for title, deck, settings in (
        ("bits", CLOUD, {"carries": "pressure", "t_end": 0.0055}),
        ("bits_contact", SHIELD.format(contact="contact all friction=0.2"), {"t_end": 0.007}),
    ):
        reference = straight(report, title, deck, **settings)
        report.check(reference["energy.collision_heat"] > 0, f"{title}: nothing collides")
        for how, threads, launcher in (("threads", 2, ()), ("ranks", 1, mpirun(3))):
            other = straight(report, f"{title}_{how}", deck, threads=threads, launcher=launcher, **settings)
            report.check(
                other["checksum"] == reference["checksum"],
                f"{title} {how}: checksum {other['checksum']}, not {reference['checksum']}",
            )
        goes_on(report, reference, f"{title}_again", deck, checkpoints(f"{SCRATCH}/{title}")[-2], **settings)


if __name__ == "__main__":
    REPORT = Report()
    cloud(REPORT)
    plane(REPORT)
    announced(REPORT)
    momentum(REPORT)
    free_debris(REPORT)
    shields(REPORT)
    torn(REPORT)
    bits(REPORT)
    REPORT.end()
