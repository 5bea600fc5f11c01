#!/usr/bin/env python3
"""Erosion: what goes is booked. Mass, momentum and energy of what is left and of what has gone are those of the start;
nothing is left that was to go.

usage: erosion.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import ERODING, Report, run

DENSITY = {1: 1.0, 2: 1.0, 3: 1.0}  # of the bodies
# One particle of ten is fast: it alone forces short steps.
FAST = """
dimension 1
grid cell=1 x=open:open
time cfl=0.5 steps=20
material m elastic density=1 young=1 poisson=0
{erode}
body slow block material=m lower=0 upper=10 ppc=1
body fast block material=m lower=20 upper=21 ppc=1
group one slow,fast
velocity fast x=9
history steps=1
output csv at=end fields=mass
"""


def close(report, title, found, expected, size):
    """Equal but for rounding."""
    report.check(abs(found - expected) <= 1e-11*size, f"{title}: {found} instead of {expected}")


def books(report):
    """Every method and update."""
    for method, update in (
        ("sgmp", "musl"), ("sgmp", "usf"), ("sgmp", "usl"), ("gimp", "musl"), ("gimp", "usavg"), ("mpm", "musl"),
    ):
        name = f"books_{method}_{update}"
        result = run(
            name, ERODING.replace("time_step=0.02", "") if update == "usf" else ERODING, method=method, update=update
        )
        if not report.finished(result, name):
            continue
        rows, history = result.table("particles_end.csv"), result.table("history.csv")
        start, end = history[0], history[-1]
        report.check(end["eroded_particles"] >= 20, f"{name}: {end['eroded_particles']} particles eroded")
        report.check(
            end["eroded_particles"] + len(rows) == 4 * (6 * 8 + 12 * 8 + 18 * 6),
            f"{name}: {end['eroded_particles']} eroded, {len(rows)} left",
        )
        mass = sum(row["mass"] for row in rows)
        close(report, f"{name}: mass", mass + end["eroded_mass"], 6*8 + 12*8 + 18*6, mass)
        momentum = sum(row["mass"]*row["velocity_x"] for row in rows)
        close(report, f"{name}: momentum of what is left", end["momentum_x"], momentum, mass)
        close(report, f"{name}: momentum", end["momentum_x"] + end["eroded_momentum_x"], start["momentum_x"], mass)
        kinetic = sum(0.5*row["mass"]*(row["velocity_x"]**2 + row["velocity_y"]**2) for row in rows)
        close(
            report, f"{name}: kinetic energy of what is left", result["energy.kinetic"], kinetic, start["total_energy"]
        )
        internal = sum(row["energy"]*row["mass"] for row in rows)
        close(
            report,
            f"{name}: internal energy of what is left",
            result["energy.internal"],
            internal,
            start["total_energy"],
        )
        close(report, f"{name}: kinetic identity", result["energy.remainder"], 0.0, start["total_energy"])
        gone = end["eroded_kinetic_energy"] + end["eroded_internal_energy"]
        report.check(gone > 0, f"{name}: {gone} of energy eroded")
        gone += end["contact_dissipation"]
        drift = (result["energy.total"] + gone - start["total_energy"])/start["total_energy"]
        report.check(
            abs(drift - result["energy.drift"]) < 1e-9, f"{name}: drift {result['energy.drift']} instead of {drift}"
        )
        for key in ("mass", "kinetic_energy", "internal_energy"):
            report.check(result[f"eroded.{key}"] == end[f"eroded_{key}"], f"{name}: {key} of summary and history")
        for row in rows:
            if row["body"] == 1 and row["damage"] >= 1 or row["body"] == 2 and row["plastic_strain"] >= 0.05:
                report.check(False, f"{name}: particle {row['id']} is still there")
        report.check(
            any("was eroded" in reason for reason in result["verdict_reasons"]) == (end["eroded_mass"] > 0.05 * 252),
            f"{name}: {result['verdict_reasons']}",
        )
        bodies = [row for row in result.table("bodies.csv") if row["step"] == end["step"]]
        for row in bodies:
            own = [particle for particle in rows if particle["body"] == row["body"]]
            close(
                report,
                f"{name}: mass of body {row['body']}",
                row["mass"],
                sum(particle["mass"] for particle in own),
                mass,
            )
            close(
                report,
                f"{name}: centroid of body {row['body']}",
                row["x"] * row["mass"],
                sum(particle["mass"] * particle["x"] for particle in own),
                30 * mass,
            )
            close(
                report,
                f"{name}: energy of body {row['body']}",
                row["internal_energy"],
                sum(particle["mass"] * particle["energy"] for particle in own),
                start["total_energy"],
            )


def any_step(report):
    """With any update, with a Courant number that the program chooses, and with steps that are fixed: there a Courant
    number of 1 counts, here of the particle with c + |v| = 10 at a step of 0.1."""
    cases = [(words, limit, goes) for words, limit, goes in (
        ("cfl=0.5", 0.04, False), ("cfl=0.5", 0.053, True), ("cfl=auto", 0.04, False), ("cfl=auto", 0.21, True),
        ("dt=0.02", 0.099, False), ("dt=0.02", 0.101, True))]
    for update in ("musl", "usf", "usl", "usavg"):
        for words, limit, goes in cases:
            name = f"any_{update}_{words.replace('=', '')}_{limit}"
            deck = FAST.format(erode=f"erode m time_step={limit}").replace("cfl=0.5", words)
            result = run(name, deck + f"method sgmp update={update}\n")
            if not report.finished(result, name):
                continue
            found = result["eroded.particles"]
            report.check(found == (1 if goes else 0), f"{name}: {found} eroded")
            rows = result.table("history.csv")
            if goes and words == "cfl=0.5":  # the step that it forces is the first alone
                report.check(rows[-1]["dt"] > 0.1, f"{name}: steps of {rows[-1]['dt']}")


def steps(report):
    """A particle with c + |v| = 10 forces steps of 0.05, the others of 0.5; at the limit it stays."""
    for limit, goes in ((0.04, False), (0.053, True), (0.4, True)):
        result = run(f"steps_{limit}", FAST.format(erode=f"erode m time_step={limit}"))
        if report.finished(result, f"steps_{limit}"):
            rows = result.table("particles_end.csv")
            report.check(len(rows) == (10 if goes else 11), f"limit {limit}: {len(rows)} particles")
            report.check(
                result["eroded.particles"] == (1 if goes else 0), f"limit {limit}: {result['eroded.particles']} eroded"
            )
            if goes:
                close(report, "momentum", result["eroded.momentum"][0], 9.0, 1.0)
                close(report, "kinetic energy", result["eroded.kinetic_energy"], 40.5, 1.0)
                report.check(
                    result.table("history.csv")[-1]["dt"] > 0.1,
                    f"limit {limit}: {result.table('history.csv')[-1]['dt']}",
                )


def nothing(report):
    """Without the card nothing is stored or written."""
    result = run("nothing", FAST.format(erode=""))
    if report.finished(result, "nothing"):
        report.check(
            "eroded_mass" not in result.table("history.csv")[0] and "eroded" not in result.summary,
            "nothing: columns of erosion",
        )


def main():
    """All of them."""
    report = Report()
    books(report)
    steps(report)
    any_step(report)
    nothing(report)
    report.end()


main()
