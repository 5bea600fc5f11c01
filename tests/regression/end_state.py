#!/usr/bin/env python3
"""What the end of a run looks like in summary.json (end_state.*), in short scenes whose ends are known from outside.

Expected: p = (gamma - 1) energy0 of a gas at rest, bodies that are made of two pieces, uniform stretch x = X (1 + t),
the particles in particles_end.csv.

usage: end_state.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import Report, run

# Two gases at rest side by side, each with four particles in each cell.
STILL = """
dimension 2
grid cell=1 x=0:8 y=0:4
wall x-=slip x+=slip y-=slip y+=slip
method sgmp
time dt=1e-6 steps=3
material thin fluid density=2
material dense fluid density=4
eos thin ideal_gas gamma=1.4 energy0=1
eos dense ideal_gas gamma=1.4 energy0=2
body left block material=thin lower=(0,0) upper=(4,4) ppc=2
body right block material=dense lower=(4,0) upper=(8,4) ppc=2
"""
# One body of one shape, out of whose middle a piece is cut: two halves of 64 particles that share no node.
HALVES = """
dimension 2
grid cell=1 x=open:open y=0:open
wall y-=slip
method sgmp
time dt=1e-6 steps=1
detonation point=(0,0,0)
material gas fluid density=1
eos gas ideal_gas gamma=1.4 energy0=1
material charge explosive density=1 detonation_speed=7
eos charge jwl a=3 b=0.1 r1=4 r2=1 omega=0.3 energy0=0.3
material steel elastic density=1 young=1 poisson=0
material glass j2 density=1 young=1 poisson=0 yield=1
failure glass principal_stress=0.5
material wax j2 density=1 young=1 poisson=0 yield=1
erode wax plastic_strain=0.5
material sand mohr_coulomb density=1 young=1 poisson=0 friction=30
material tile johnson_holmquist density=0.9 shear_modulus=40 k1=60 k2=20 k3=30 hugoniot_limit=3 &
  hugoniot_pressure=1.2 intact_strength=0.9 intact_exponent=0.6 &
  fractured_strength=0.4 fractured_exponent=0.7 rate_coefficient=0.02 reference_rate=1e-3 tension_limit=1 &
  damage_strain=0.1
body drops block material={matter} lower=(0,0) upper=(12,4) ppc=2
subtract drops block lower=({cut},0) upper=(8,4)
"""
# Moves with v = rate X at all times, nearly without force: the wall in the plane of symmetry.
UNIFORM = """
parameter rate = 1
dimension 2
grid cell=0.25 x=0:open y=0:2
wall x-=slip y-=slip y+=slip
method sgmp
time end=0.5 cfl=0.4
material rubber neo_hookean density=2 young=1e-3 poisson=0
body bar block material=rubber lower=(0,0) upper=(2,2) ppc=2
velocity bar x=rate*x
output csv at=end fields=density,volume,mass,pressure
"""
# Flies apart to nine times its length in a step of time 2; glass has failed by then, steel has not.
SCATTERED = """
dimension 2
grid cell=0.25 x=0:open y=0:2
wall x-=slip y-=slip y+=slip
method sgmp mass=lumped
time end=2 cfl=0.4
material glass j2 density=2 young=1e-3 poisson=0 yield=1
failure glass principal_stress=1e-5 carries={carries}
material steel elastic density=2 young=1e-6 poisson=0
body bar block material={material} lower=(0,0) upper=(2,2) ppc=2
velocity bar x="4*x"
"""
# A disk that turns, and a small body of one particle that flies off the grid or does not.
TURNING = """
parameter wide = 8
dimension 2
grid cell=0.25 x=-8:wide
method sgmp stress=plain rotation=plain surfaces=plain
lost remove
time end=1 cfl=0.8
material m elastic density=2 young=1e3 poisson=0.3
material dust elastic density=2e-9 young=1e-6 poisson=0.3
body disk cylinder material=m centre=(0.03,0.04,0) radius=1 spacing=0.125
body speck block material=dust lower=(6,6) upper=(6.25,6.25) ppc=1
group one disk,speck
velocity disk x="-3*(y-0.04)" y="3*(x-0.03)"
velocity speck x=6
"""


def near(report, name, result, expected, tolerance=1e-5):
    """The values of end_state."""
    for key, value in expected.items():
        found = result["end_state"].get(key)
        fine = (
            found == value
            if isinstance(value, str)
            else found is not None and abs(found - value) <= tolerance * max(1, abs(value))
        )
        report.check(fine, f"{name}: {key} {found}, expected {value}")


def still(report):
    """All values of a scene at rest: walls double the width of 4 cells, and the height has walls at both ends."""
    result = run("still", STILL)
    if report.finished(result, "still"):
        near(
            report,
            "still",
            result,
            {
                "contact_share": 0,
                "viscous_share": 0,
                "projection_share": 0,
                "shortest_step": 1e-6,
                "longest_step": 1e-6,
                "limited_by": "fixed",
                "thinnest_body_cells": 8,
                "lost_impulse": 0,
                "least_particles_per_cell": 4,
                "gaps": 0,
                "particles_larger_than_a_cell": 0,
                "particles_out_of_reach": 0,
                "particles_inside_other_bodies": 0,
                "volume_over_box": 1,
                "box_reached": 1,
                "largest_compression": 1,
                "largest_expansion": 1,
                "volume_without_room": 0,
                "least_pressure": 0.4 * 1,
                "largest_pressure": 0.4 * 2,
            },
        )


def halves(report):
    """What may fly apart - fluids, explosives, soils, what fails or is eroded - is not called numerical fracture;
    anything else is."""
    for matter in ("gas", "charge", "glass", "wax", "sand", "tile"):
        result = run(f"halves_{matter}", HALVES.format(matter=matter, cut=4))
        if report.finished(result, matter):
            report.check(
                result["verdict"] == "sound" and result["end_state.particles_out_of_reach"] == 0,
                f"{matter}: {result.text}",
            )
    result = run("halves_steel", HALVES.format(matter="steel", cut=4))
    report.check(
        result["end_state.particles_out_of_reach"] == 4 * 4 * 4
        and "50.00 % of body 'drops' is out of reach" in result.text,
        f"steel: {result.text}",
    )
    result = run("halves_near", HALVES.format(matter="steel", cut=7))  # one cell apart, which is within reach
    report.check(
        result["end_state.particles_out_of_reach"] == 0 and result["verdict"] == "sound", f"near: {result.text}"
    )


def uniform(report):
    """Stretched to 1.5 times its length, or pressed to half of it, everywhere alike; and extremes over all
    particles."""
    for name, rate, expected in (
        ("stretched", 1, {"largest_expansion": 1.5}),
        ("pressed", -1, {"largest_compression": 2}),
    ):
        result = run(name, UNIFORM, rate=rate)
        if not report.finished(result, name):
            continue
        near(report, name, result, expected, 0.05)
        rows = result.table("particles_end.csv")
        growth = [row["density"]/2 for row in rows]
        pressures = [row["pressure"] for row in rows]
        near(report, name, result, {"largest_compression": max(1, *growth), "largest_expansion": 1/min(1, *growth),
                                    "least_particles_per_cell": 0.25**2/max(row["volume"] for row in rows)}, 1e-9)
        near(report, name, result, {"least_pressure": min(pressures), "largest_pressure": max(pressures)}, 1e-15)
        report.check(max(pressures) - min(pressures) > 1e-6, f"{name}: one pressure {pressures[0]}")


def scattered(report):
    """Debris that is larger than a cell bears no stress and is not doubted; what holds together, or still bears stress,
    is."""
    for material, carries, doubted in (
        ("glass", "nothing", False), ("glass", "pressure", False), ("glass", "everything", True),
        ("steel", "nothing", True),
    ):
        name = f"scattered_{material}_{carries}"
        result = run(name, SCATTERED.format(material=material, carries=carries))
        if report.finished(result, name):
            large = result["end_state.particles_larger_than_a_cell"]
            report.check(
                (large > 0.5 * 256) == doubted and result["end_state.least_particles_per_cell"] < 0.9,
                f"{name}: {large} larger than a cell",
            )
            report.check(
                any("larger than a cell" in reason for reason in result["verdict_reasons"]) == doubted,
                f"{name}: {result['verdict_reasons']}",
            )


def one_lost(report):
    """Angular momentum that leaves with a particle is not held against the run; the same run without a loss is
    doubted."""
    kept = run("none_lost", TURNING, wide=16)
    report.check(
        kept["particles_lost"] == 0 and kept["end_state.angular_momentum_change"] > 0.05, f"none lost: {kept.text}"
    )
    lost = run("one_lost", TURNING)
    report.check(
        lost["particles_lost"] == 1 and "angular_momentum_change" not in lost["end_state"], f"one lost: {lost.text}"
    )
    for result, doubted in ((kept, True), (lost, False)):
        report.check(
            any("angular momentum" in reason for reason in result["verdict_reasons"]) == doubted,
            f"{result['verdict_reasons']}",
        )


def main():
    """All of them."""
    report = Report()
    for part in (still, halves, uniform, scattered, one_lost):
        part(report)
    report.end()


main()
