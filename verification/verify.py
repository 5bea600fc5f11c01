#!/usr/bin/env python3
"""Runs the examples of the paper, compares them with their references and writes a report.

    python3 verification/verify.py                 the quick set: a few minutes on two cores
    python3 verification/verify.py --full          every size, every figure, and the copy in doc/verification/
    python3 verification/verify.py bar beam        some examples only

Writes build/verification/: results.json, report.html, a PNG file per figure, a CSV file per table. A target that cannot
be met for a reason given with it is a known deviation: reported, not counted as a failure. Ends with exit code 1 if a
check fails, 2 if an example could not be run. Needs numpy and matplotlib, and the executable build/release/sgmp.
"""

import argparse
import importlib.util
import json
import os
import sys
import time
import traceback
from pathlib import Path

import report
from common import BUILD, ROOT, Book, forget_old_runs

EXAMPLES = ("bar", "bar_rotated", "bar_stability", "beam", "energy", "tnt_slab", "vortex", "taylor_bar",
            "taylor_metals", "normalised",
            "contact_bars", "contact_sliding", "contact_rolling", "contact_rings", "contact_hertz", "contact_gap",
            "contact_rod",
            "contact_rest", "contact_scenes", "rotation", "contact_axisymmetric", "axisymmetric", "swirl", "tube",
            "noh", "sedov", "cavity", "cylinder", "blast", "blast_load", "plate_impulse", "charge_plate",
            "penetration", "perforation", "long_rod", "fluids", "flows", "hugoniot", "piston", "spall", "hypervelocity",
            "volumes", "mass",
            "statics", "rigid", "soils", "length", "fragments")


def load(example):
    path = ROOT / "verification" / example / "check.py"
    specification = importlib.util.spec_from_file_location(f"check_{example}", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def version():
    """Version and commit that the runs themselves recorded."""
    for path in sorted((BUILD / "runs").glob("*/*/*/summary.json"), key=lambda p: p.stat().st_mtime, reverse=True):
        summary = json.loads(path.read_text())
        return f"sgmp {summary['version']}, commit {summary['commit']}"
    return "sgmp"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("examples", nargs="*", metavar="EXAMPLE", help="of " + ", ".join(EXAMPLES))
    parser.add_argument("--full", action="store_true", help="all sizes and figures")
    arguments = parser.parse_args()
    unknown = set(arguments.examples) - set(EXAMPLES)
    if unknown:
        parser.error(f"no example {', '.join(sorted(unknown))}; there are {', '.join(EXAMPLES)}")
    forget_old_runs()
    book, broken, start = Book(), [], time.time()
    for example in arguments.examples or EXAMPLES:
        try:
            load(example).check(book, arguments.full)
        except Exception:  # an example that cannot be run must not hide the others
            traceback.print_exc()
            broken.append(example)
            book.at_most(example, "examples that could not be run", 1, 0,
                         traceback.format_exc(limit=1).strip().splitlines()[-1])
    command = "make verify-full" if arguments.full else "make verify"
    if arguments.examples:
        command = " ".join(["verification/verify.py", *arguments.examples] + ["--full"] * arguments.full)
    took = f"{(time.time() - start) / 60:.0f} minutes on {os.cpu_count()} cores"
    report.write(book, command, version(), took)
    if arguments.full and not arguments.examples:
        report.publish(book, ROOT / "doc/verification", command, version(), took)
    failed = book.failed()
    passed = sum(result["pass"] for result in book.results)
    kept = sum(result["pass"] and result.get("regression", False) for result in book.results)
    print(f"\n{len(book.results)} checks: {passed} pass ({kept} of them regression values), "
          f"{len(book.results) - passed - len(failed)} known deviations, {len(failed)} fail; {time.time() - start:.0f} "
          f"s")
    for result in book.results:
        if not result["pass"]:
            print(f"{'known' if result['known_deviation'] else 'FAIL '}  {result['case']}: {result['quantity']} = "
                  f"{result['value']}, want {result['tolerance']} {result['reference']}  ({result['note']})")
    print(f"report: {BUILD / 'report.html'}")
    sys.exit(2 if broken else 1 if failed else 0)


if __name__ == "__main__":
    main()
