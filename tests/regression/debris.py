#!/usr/bin/env python3
"""Hypervelocity debris: a lead ball through a lead plate, most of which flies on in particles that have lost each
other.

usage: debris.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: energy and momentum are conserved, nothing accelerates what flies freely, so that the time step goes
back to what it was.
"""
from _runs import Report, run

LEAD = """
parameter method = sgmp
parameter cfl = 0.25
parameter pmin = -1000
parameter carries = nothing
parameter t_end = 0.03
units mm g ms
dimension 3
grid cell=4.24
method $method
time end=t_end cfl=cfl
material lead johnson_cook density=11.35e-3 young=17000 poisson=0.42 yield=12 hardening_modulus=125
eos lead gruneisen c0=2092 s=1.45 gamma0=2
failure lead plastic_strain=3 pmin=pmin carries=$carries
viscosity lead
body ball sphere material=lead centre=(0,0,-7.5) radius=7.5 spacing=2.12
body plate block material=lead lower=(-33.92,-33.92,0) upper=(33.92,33.92,6.36) spacing=2.12
velocity ball z=6580
history every=0.001
"""


def main():
    """With spall every method gets through; without it a run that goes wrong does not end as if nothing were."""
    report = Report()
    for method, cfl, carries in (
        ("sgmp", 0.25, "nothing"), ("sgmp", 0.5, "pressure"), ("gimp", 0.25, "nothing"), ("mpm", 0.2, "nothing"),
    ):
        name = f"{method}_{carries}"
        result = run(name, LEAD, method=method, cfl=cfl, carries=carries)
        if not report.finished(result, name):
            continue
        drift = result["energy.drift"]
        momentum = [float(row["momentum_z"]) for row in result.table("history.csv")]
        lost = abs(momentum[-1] / momentum[0] - 1)
        report.check(lost < 1e-12, f"{name}: momentum {lost}")
        report.check(abs(drift) < (0.05 if carries == "nothing" else 0.07), f"{name}: energy {drift}")
        if carries == "nothing":
            # Shocks need shorter steps; what flies apart then needs none.
            steps = [float(row["dt"]) for row in result.table("history.csv")[1:]]
            report.check(steps[-1] >= steps[0], f"{name}: the step was {steps[0]} and ends at {steps[-1]}")
        report.check(
            result["end_state.least_pressure"] > -1500, f"{name}: pressure {result['end_state.least_pressure']}"
        )
        report.check(result["verdict"] == "doubtful", f"{name}: particles fly alone, verdict {result['verdict']}")
    for method in ("sgmp", "mpm"):
        result = run(f"{method}_whole", LEAD.replace("failure", "! failure"), method=method, cfl=0.2)
        report.check(
            result.code != 0 or result["verdict"] == "doubtful",
            f"{method} without failure: {result.code} {result['verdict']}",
        )
    report.end()


main()
