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
    for method, update in PAIRS:
        name = f"bar_{method}_{update}"
        settings = {"method": method, "update": update, "t_end": 0.01}
        quiet = run(name, "bar_stability.inp", cfl="auto", **settings)
        if not report.finished(quiet, name):
            continue
        report.check(growth(quiet) < 1.5, f"{name}: energy grows {growth(quiet)} times at cfl {quiet['cfl']}")
        report.check(0.0 < quiet["cfl"] < quiet["cfl_limit"], f"{name}: {quiet['cfl']} of {quiet['cfl_limit']}")
        wild = run(name + "_beyond", "bar_stability.inp", cfl=1.3 * quiet["cfl_limit"], **settings)
        report.check(wild.code == 4 or growth(wild) > 2.0, f"{name}: quiet at 1.3 times the limit")


def others(report):
    """Two and three dimensions, contact, and threads."""
    scenes = [("beam", "beam.inp", {"h": 1.25, "t_end": 0.02}), ("taylor_bar", "taylor_bar.inp", {"h": 1.9, "t_end": 0.04}),
              ("rings", "rings.inp", {"h": 2, "t_end": 3})]
    for name, deck, settings in scenes:
        sums = set()
        for threads in (1, 2):
            result = run(f"{name}_{threads}", deck, threads=threads, cfl="auto", **settings)
            if report.finished(result, name):
                sums.add((result["checksum"], result["cfl"]))
        report.check(len(sums) == 1, f"{name}: threads matter: {sums}")
        report.check(growth(result) < 1.1, f"{name}: energy grows {growth(result)} times at cfl {result['cfl']}")


def main():
    """All checks."""
    report = Report()
    bar(report)
    others(report)
    report.end()


if __name__ == "__main__":
    main()
