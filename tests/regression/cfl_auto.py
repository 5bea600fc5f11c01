#!/usr/bin/env python3
"""cfl=auto: stable where it puts itself, not much too careful, the same on any number of threads.

usage: cfl_auto.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import Report, run

# method, update: 1.3 times the limit of resting particles must be too much (METHOD's measure: energy doubled)
PAIRS = [("gimp", "musl"), ("gimp", "usl"), ("sgmp", "musl"), ("sgmp", "usf"), ("sgmp", "usl"), ("mpm", "musl")]


def growth(result):
    """Largest total energy over the first."""
    energy = [row["total_energy"] for row in result.table("history.csv")]
    return max(energy) / energy[0]


def bar(report):
    """The driven bar: quiet with auto, not quiet beyond the limit."""
    for method, update, mass in [(*pair, "lumped") for pair in PAIRS] + [("sgmp", "musl", "consistent")]:
        name = f"bar_{method}_{update}_{mass}"
        settings = {"method": method, "update": update, "mass": mass, "t_end": 0.01}
        quiet = run(name, "bar_stability.inp", cfl="auto", **settings)
        if not report.finished(quiet, name):
            continue
        report.check(growth(quiet) < 1.5, f"{name}: energy grows {growth(quiet)} times at cfl {quiet['cfl']}")
        report.check(0.0 < quiet["cfl"] < quiet["cfl_limit"], f"{name}: {quiet['cfl']} of {quiet['cfl_limit']}")
        wild = run(name + "_beyond", "bar_stability.inp", cfl=1.3 * quiet["cfl_limit"], **settings)
        report.check(wild.code == 4 or growth(wild) > 2.0, f"{name}: quiet at 1.3 times the limit")


def others(report):
    """Two and three dimensions, contact, and threads."""
    scenes = [
        ("beam", "beam.inp", {"h": 1.25, "t_end": 0.02}), ("taylor_bar", "taylor_bar.inp", {"h": 1.9, "t_end": 0.04}),
        ("rings", "rings.inp", {"h": 2, "t_end": 3}),
    ]
    for name, deck, settings in scenes:
        sums = set()
        for threads in (1, 2):
            result = run(f"{name}_{threads}", deck, threads=threads, cfl="auto", **settings)
            if report.finished(result, name):
                sums.add((result["checksum"], result["cfl"]))
        report.check(len(sums) == 1, f"{name}: threads matter: {sums}")
        report.check(growth(result) < 1.1, f"{name}: energy grows {growth(result)} times at cfl {result['cfl']}")


# Nothing resists a particle that is alone, so nothing limits its step but the reach of its stencil.
ALONE = """
parameter method = sgmp
dimension 2
grid cell=1
method $method
time cfl=auto end=20
gravity (0,-0.5)
material m elastic density=2 young=1 poisson=0.3
body a block material=m lower=(0.1,0.2) upper=(0.6,0.7) spacing=0.5
velocity a x=5 y=3
output csv at=end
"""


def alone(report):
    """A particle alone flies its parabola in a number of steps that makes sense."""
    for method, reach in (("mpm", 2), ("gimp", 4), ("sgmp", 4), ("bspline", 4)):
        result = run(f"alone_{method}", ALONE, method=method)
        if not report.finished(result, f"alone, {method}"):
            continue
        report.check(
            result["cfl_limit"] <= reach and result["cfl"] < reach,
            f"alone, {method}: cfl {result['cfl']} of {result['cfl_limit']}",
        )
        row, = result.table("particles_end.csv")
        wrong = max(abs(row["x"] - 100.35), abs(row["y"] - (0.45 + 60 - 100)))
        report.check(wrong < 1e-9, f"alone, {method}: {wrong} cells beside its parabola after {result['steps']} steps")


def main():
    """All checks."""
    report = Report()
    alone(report)
    bar(report)
    others(report)
    report.end()


if __name__ == "__main__":
    main()
