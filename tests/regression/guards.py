#!/usr/bin/env python3
"""What goes wrong numerically ends with exit code 4 and says where: blow-up, too small a step, particles that leave.

usage: guards.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math
import os
import re
import signal

from _runs import INPUT, Report, run

NUMERICAL = 4

# A block that flies through a box without walls.
FLYING = """
parameter policy = error
parameter method = sgmp
dimension {dimension}
grid cell=0.25 {extent}
lost $policy
method $method
time dt=0.01 steps={steps}
material m elastic density=2 young=50 poisson=0.25
body runner block material=m lower={lower} upper={upper} ppc=2
velocity runner x=2
history steps=1
output csv at=end
"""
FALLING = """
dimension 1
grid cell=0.25 x=0:4
wall x-=fixed
method sgmp
time end=10 cfl=0.5{dt_min}
material soft elastic density=2 young=50 poisson=0
body bar block material=soft lower=0 upper=2 ppc=2
{more}
"""
# A bar that hangs at its foot bounces: the work of gravity comes back to nothing, the energies with it but for their
# ripple.
BOUNCING = """
dimension 1
grid cell=0.125 x=0:4
wall x-=fixed
method sgmp stress=plain
time end=40 cfl=1.5
gravity (0.01,0,0)
material soft elastic density=1 young=1 poisson=0
body bar block material=soft lower=0 upper=2 ppc=2
stop energy_growth=1.1
"""
# A liquid under pressure, set free: its energy counts from the initial volume, so that it has none to begin with.
RELEASED = """
parameter update = musl
dimension 1
grid cell=0.125 x=0:open
wall x-=slip
method sgmp update=$update
time end=1 cfl=0.3
bodyforce all x="1e-9*cos(t)"
material water fluid density=1
eos water tait c0=1 pressure0=0.1
body drop block material=water lower=0 upper=2 ppc=2
"""
# The benchmark block without the guard against growing energy.
BLOCK = f'include "{os.path.join(INPUT, "block.inp")}"\nstop energy_growth=1e60\n'


def flying(dimension, extent, steps):
    """The deck of the flying block in one, two or three dimensions."""
    lower, upper = ("(" + ",".join([number]*dimension) + ")" for number in ("0.25", "1"))
    return FLYING.format(dimension=dimension, extent=extent, steps=steps, lower=lower, upper=upper)


def failed(report, name, result, patterns, may_trap=False):
    """A numerical abort that names what it must; a build that traps stops where the nonsense begins."""
    if may_trap and result.code == -signal.SIGFPE:
        return
    report.check(result.code == NUMERICAL, f"{name}: exit code {result.code}\n{result.text}")
    for pattern in patterns:
        report.check(re.search(pattern, result.text), f"{name}: not found: {pattern}\n{result.text}")
    report.check(not re.search(r"Backtrace|SIG[A-Z]{3,}", result.text), f"{name}: it crashed\n{result.text}")
    if report.check(result.summary, f"{name}: no summary.json"):
        report.check(result["exit_status"] == NUMERICAL and "failure" in result.summary, f"{name}: {result.summary}")


def blow_ups(report):
    """Time steps far too long."""
    result = run("courant", "bar_stability.inp", cfl=20, cells=16, t_end=0.01)
    failed(report, "courant", result, [r"particle \d+ of body bar", r"step \d+"], may_trap=True)
    for method in ("sgmp", "gimp", "mpm"):
        result = run(f"inside_out_{method}", BLOCK, cells=4, steps=200, dt="6*h/c", method=method)
        failed(
            report, f"inside out {method}", result,
            [r"particle \d+ of body block is inside out or not a number after step \d+"], may_trap=True,
        )
    result = run("taylor", "taylor_bar.inp", h=1.9, cfl=30, threads=2)
    failed(report, "taylor", result, [r"particle \d+ of body bar", r"step \d+"], may_trap=True)


def small_steps(report):
    """A step below the deck's minimum names what limits it."""
    result = run("dt_min", FALLING.format(dt_min=" dt_min=1", more=""))
    failed(
        report, "dt_min", result,
        [r"the time step \S+ is below its minimum 1 in step 1", r"particle \d+ of body bar \(soft\)", r"dt_min"],
    )
    # A step that lands on an output time may be as short as it likes.
    result = run(
        "landing",
        FALLING.format(dt_min=" dt_min=0.01", more="output vtu every=0.051\nstop kinetic_below=0").replace(
            "end=10", "end=0.102"
        ),
    )
    report.finished(result, "landing")


def returning_work(report):
    """The guard against growing energy measures with the most that was there, not with what is left of it."""
    result = run("bouncing", BOUNCING)
    if report.finished(result, "bouncing"):
        work = [row["external_work"] for row in result.table("history.csv")]
        total = [row["total_energy"] for row in result.table("history.csv")]
        report.check(
            result["energy.supplied"] == max(work), f"bouncing: supplied {result['energy.supplied']}, {max(work)}"
        )
        report.check(
            any(t > 1.1 * w for t, w in zip(total[1:], work[1:])),
            "bouncing: the ripple never shows: nothing was tested",
        )
        expected = (total[-1] - work[-1])/max(work)
        report.check(
            abs(result["energy.drift"] - expected) < 1e-12, f"bouncing: drift {result['energy.drift']}, {expected}"
        )
        half = [*BOUNCING.split("end=40"), ""]
        run("bouncing_parts", half[0] + "end=40 steps=100" + half[1] + "checkpoint every=100\n")
        result = run(
            "bouncing_parts", half[0] + "end=40" + half[1] + "checkpoint every=100\n", options=["--restart", "latest"]
        )
        if report.finished(result, "bouncing on from a checkpoint"):
            report.check(
                result["energy.supplied"] == max(work),
                f"bouncing: supplied {result['energy.supplied']} after a restart",
            )


def released_pressure(report):
    """What matter gives away is no growth; an elastic wave takes p0 v from each length that it reaches, half of it to
    motion."""
    for update in ("musl", "usf", "usl", "usavg"):
        result = run(f"released_{update}", RELEASED, update=update)
        if report.finished(result, f"released {update}"):
            report.check(abs(result["energy.drift"]) < 0.25, f"released {update}: drift {result['energy.drift']}")
            report.check(
                0.5 * 0.1**2 < result["energy.supplied"] < 2 * 0.1**2,
                f"released {update}: supplied {result['energy.supplied']}",
            )


def nowhere(report):
    """A formula that stops being a number, in the middle of a run; with all policies, on all sides open."""
    for policy in ("error", "remove", "reflect"):
        for more in ('bodyforce all x="x > 1 ? sqrt(0.01-t) : 0"', 'wall y+=fixed\nwallmotion y+ x="sqrt(0.01-t)"'):
            deck = flying(2, "x=0:8 y=0:1", 20) + more.replace("\\n", "\n") + "\n"
            failed(
                report, f"nowhere {policy}", run(f"nowhere_{policy}_{len(more)}", deck, policy=policy),
                [r"not a number", r"step \d+"],
            )


def named(report):
    """A formula of t that stops being a number: the error stands at its card, a formula that keeps its value is not
    blamed."""
    kept = 'load runner y="0*sqrt(t)"\n'
    for more in ('load runner x="sqrt(0.01-t)"', 'bodyforce runner x="sqrt(0.01-t)"', 'motion runner x="sqrt(0.01-t)"',
                 'pressure runner p="1/max(0,0.01-t)"'):
        deck = flying(2, "x=0:8 y=0:1", 20) + kept + more + "\n"
        line = deck.rstrip("\n").count("\n") + 1
        failed(
            report,
            f"named {more}",
            run(f"named_{more.split()[0]}", deck),
            [rf"\.inp:{line}:1: error: a formula of this card has no value at time", r"step \d+"],
        )


def leaving(report):
    """All three policies, in all dimensions and methods."""
    for dimension, extent in ((1, "x=0:2"), (2, "x=0:2 y=0:2"), (3, "x=0:2 y=0:2 z=0:2")):
        for method in ("sgmp", "gimp", "mpm"):
            name = f"leaving_{dimension}_{method}"
            deck = flying(dimension, extent, 150)
            result = run(name + "_error", deck, method=method)
            failed(
                report, name, result,
                [r"particle \d+ of body runner left the grid along x at \S+ in step \d+", r"lost policy"],
            )
            count = 6**dimension
            result = run(name + "_remove", deck, method=method, policy="remove")
            if report.finished(result, name):
                report.check(result["particles_lost"] == count and result["particles"] == 0,
                             f"{name}: {result['particles_lost']} of {count} removed")
            shorter = flying(dimension, extent, 75)
            result = run(name + "_some", shorter, method=method, policy="remove", threads=2)
            if report.finished(result, name):
                lost = result["particles_lost"]
                rows = result.table("particles_end.csv")
                report.check(0 < lost < count and len(rows) == count - lost, f"{name}: {lost} lost, {len(rows)} left")
                report.check(all(row["x"] <= 2.125 + 1e-12 for row in rows), f"{name}: a particle outside")
                report.check(abs(result["energy.remainder"]) < 1e-10*result["energy.initial_total"],
                             f"{name}: remainder {result['energy.remainder']}")
            result = run(name + "_reflect", deck, method=method, policy="reflect")
            if report.finished(result, name):
                rows = result.table("particles_end.csv")
                report.check(len(rows) == count and result["particles_lost"] == 0, f"{name}: {len(rows)} reflected")
                report.check(all(-0.126 <= row["x"] <= 2.126 for row in rows), f"{name}: a particle outside")
                report.check(sum(row["velocity_x"] for row in rows) < 0, f"{name}: not turned round")
                report.check(all(math.isfinite(value) for value in result["energy"].values()), f"{name}: energies")
                report.check(result["energy.total"] < 1.5*result["energy.initial_total"],
                             f"{name}: {result['energy.total']/result['energy.initial_total']:.3g} of the energy")


def main():
    """All guards."""
    report = Report()
    blow_ups(report)
    small_steps(report)
    returning_work(report)
    released_pressure(report)
    nowhere(report)
    named(report)
    leaving(report)
    report.end()


main()
