#!/usr/bin/env python3
"""Error against CPU seconds, every method with its best Courant number: figures and tables of
doc/speed-and-accuracy.md.

    python3 verification/speed/speed.py                 run what is missing, then write the page and its figures
    python3 verification/speed/speed.py beam hertz      some scenes only; the page is written from all that has been run
    python3 verification/speed/speed.py --draw          no runs

A run that was made by the same executable from the same deck is not repeated (build/speed/SCENE.json), so the script
may be stopped and started again. Short runs are repeated and the least counts. One thread; nothing else should run on
the machine, and where it does, user CPU time suffers less than wall time.
"""
import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import page  # noqa: E402
from scenes import SCENES  # noqa: E402

from common import ROOT, NUMERICAL_ABORT, Case, Run  # noqa: E402
from sgmp_view.files import read_summary  # noqa: E402

OUTPUT = ROOT / "build/speed"
SHORT, REPEATS = 0.3, 3  # user CPU seconds below which a run is made that often
TOLERANCE = 1.1          # error of the best Courant number over that of the smallest


class Ledger:
    """Runs of a scene that have been made, by executable, deck and parameters; kept in a file."""

    def __init__(self, solver, name):
        self.solver, self.name, self.path = solver, name, OUTPUT / f"{name}.json"
        self.digest = hashlib.sha256(solver.read_bytes()).hexdigest()
        self.rows = json.loads(self.path.read_text()) if self.path.exists() else {}

    def run(self, scene, curve, size, courant, make):
        """The row of a run: from the file, or made now unless `make` is false (then None)."""
        text = timed_deck(scene, scene.curves[curve])
        parameters = {**scene.extra.get(curve, {}), **scene.size(size, courant)}
        key = hashlib.sha256(
            "\n".join([self.digest, text, json.dumps(parameters, sort_keys=True)]).encode()
        ).hexdigest()[:20]
        if key not in self.rows:
            if not make:
                return None
            self.rows[key] = {"curve": curve, "size": size, "courant": courant, **self.measure(scene, text, parameters)}
            self.path.write_text(json.dumps(self.rows, indent=0))
            row = self.rows[key]
            print(
                f"  {curve:12s} {size:8g} {scene.unit:12s} Courant {courant:<5g} error "
                f"{row['error'] if row['error'] else 'failed'}"
                f"  {row['process']:.2f} s",
                flush=True,
            )
        return self.rows[key]

    def measure(self, scene, text, parameters):
        """Error, and the least CPU seconds of one or several runs."""
        folder, deck = OUTPUT / self.name, OUTPUT / f"{self.name}.inp"
        deck.write_text(text)
        case = Case(deck.relative_to(ROOT), **parameters)
        best = None
        while best is None or (best["process"] < SHORT and best["repeats"] < REPEATS):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            started = time.monotonic()
            process = subprocess.Popen(
                [str(self.solver), str(deck), *case.arguments(), "--output", str(folder), "--threads", "1", "--quiet"],
                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, cwd=ROOT,
            )
            complaint = process.stderr.read().decode(errors="replace")
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode, wall = os.waitstatus_to_exitcode(status), time.monotonic() - started
            if process.returncode not in (0, NUMERICAL_ABORT):
                sys.exit(f"exit code {process.returncode}: {case.command()}\n{complaint}")
            summary = read_summary(folder)
            failed = process.returncode != 0 or summary["particles_lost"] > 0
            row = {
                "process": usage.ru_utime,
                "solve": usage.ru_utime * summary["solve_seconds"] / wall,
                "wall": wall,
                "steps": summary["steps"],
                "particles": summary["particles"],
                "error": None
                if failed
                else scene.error(Run(case, folder, process.returncode, usage.ru_utime, summary)),
            }
            repeats = best["repeats"] + 1 if best else 1
            if best is None or row["process"] < best["process"]:
                best = row
            best["repeats"] = repeats
        shutil.rmtree(folder)
        return best


def timed_deck(scene, words):
    """The scene's deck without files that the error does not need, with a card method of these words."""
    text = (ROOT / scene.deck).read_text()
    for card in ("output vtu", "output vtkhdf", "output tecplot", "gauge"):
        if card != scene.keeps:
            text = re.sub(rf"^{card}\b.*\n", "", text, flags=re.M)
    text = re.sub(r"^parameter (method|update|stress|rotation|surfaces) *=.*\n", "", text, flags=re.M)
    return re.sub(r"^method .*$", f"method {words}", text, flags=re.M)


def best_courant(rows):
    """Of runs of one size: the largest Courant number whose error is at most a tenth above that of the smallest."""
    rows = sorted(rows, key=lambda row: row["courant"])
    if not rows or rows[0]["error"] is None:
        return None
    return max(
        row["courant"] for row in rows if row["error"] is not None and row["error"] <= TOLERANCE * rows[0]["error"]
    )


def collect(ledger, scene, make):
    """All runs of a scene: {curve: (best Courant number, rows)}."""
    found = {}
    for curve in scene.curves:
        rows = [ledger.run(scene, curve, size, courant, make) for size in scene.scan for courant in scene.courants]
        rows = [row for row in rows if row]
        best = best_courant([row for row in rows if row["size"] == scene.scan[-1]])
        for size in scene.fine if best else ():
            for courant in sorted((c for c in scene.courants if c <= best), reverse=True):
                row = ledger.run(scene, curve, size, courant, make)
                rows += [row] if row else []
                if not row or row["error"] is not None:
                    break  # a finer size may need a smaller one
        found[curve] = best, rows
    return found


def main():
    """Runs, figures, page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="of " + ", ".join(SCENES))
    parser.add_argument("--draw", action="store_true", help="write the page from the runs that there are")
    parser.add_argument("--sgmp", type=Path, default=ROOT / "build/release/sgmp", help="executable")
    options = parser.parse_args()
    unknown = set(options.scenes) - set(SCENES)
    if unknown:
        parser.error(f"no scene {', '.join(sorted(unknown))}; there are {', '.join(SCENES)}")
    OUTPUT.mkdir(parents=True, exist_ok=True)
    found = {}
    for name, scene in SCENES.items():
        make = not options.draw and name in (options.scenes or SCENES)
        if make:
            print(scene.title, flush=True)
        found[name] = collect(Ledger(options.sgmp.resolve(), name), scene, make)
    page.write(found, OUTPUT / "runs.csv")


if __name__ == "__main__":
    main()
