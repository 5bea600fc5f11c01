"""What all checks share: runs of the solver (two at a time, kept for the next call), results with tolerances, figures.

A check module has a function `check(book, full)`; `book` collects what it finds:

    from common import Case, solve
    runs = solve([Case("bar", cells=8, method="sgmp"), Case("bar", cells=16, method="sgmp")])
    book.within("bar", "error at 1/8", value, 9.60e-5, 0.02)
"""

import argparse
import hashlib
import json
import math
import os
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "scripts")]
from sgmp_view.files import plot_style, read_history, read_particles_csv, read_summary  # noqa: E402
from sgmp_view.picture import draw_particles  # noqa: E402

SOLVER = ROOT / "build/release/sgmp"
BUILD = ROOT / "build/verification"
NUMERICAL_ABORT = 4  # exit code of a run that blows up
COLOURS = {
    "mpm": "#d62728",
    "gimp": "#ff9d1c",
    "cpgimp": "#8c564b",
    "sgmp": "#1f5fb4",
    "bspline": "#7a3fb0",
    "normalised": "#2ca02c",
}
NAMES = {
    "mpm": "MPM",
    "gimp": "GIMP",
    "cpgimp": "cpGIMP",
    "sgmp": "SGMP",
    "bspline": "B-spline",
    "normalised": "SGMP, normalised stress",
}
MARKERS = {"mpm": "o", "gimp": "^", "cpgimp": "v", "sgmp": "s", "bspline": "P", "normalised": "D"}
# parameters of the decks behind a name
VARIANTS = {name: {"method": name} for name in ("mpm", "gimp", "cpgimp", "sgmp", "bspline")}
VARIANTS["normalised"] = {"method": "sgmp", "stress": "normalised"}


# ---------------------------------------------------------------- runs

class Case:
    """A deck of input/ (or a path) and the parameters that `--set` changes. A tag keeps repeated runs apart. Dumps are
    removed after the run unless they are to be kept."""

    def __init__(self, deck, tag="", keep_dumps=False, **parameters):
        self.keep_dumps = keep_dumps
        self.deck = ROOT / "input" / f"{deck}.inp" if "/" not in str(deck) else ROOT / deck
        self.tag = tag
        self.parameters = self.paper(parameters)

    def paper(self, parameters):
        """The decks of the paper's examples are run with the paper's scheme: what the program would choose beyond it
        (doc/surfaces.md) is asked for by those checks that want it."""
        if self.deck.parent != ROOT / "input":
            return parameters
        given, plain = self.deck.read_text(), {}
        if parameters.get("method", "sgmp") == "sgmp":
            plain = {name: "plain" for name in ("stress", "rotation", "surfaces")}
        if "surfaces" not in parameters:
            plain["fit"] = "cubes"
        plain = {name: word for name, word in plain.items() if f"\nparameter {name} " in given}
        return {**plain, **parameters}

    def arguments(self):
        words = []
        for name, value in self.parameters.items():
            words += ["--set", f"{name}={value!r}" if isinstance(value, float) else f"{name}={value}"]
        return words

    def command(self):
        return " ".join(["build/release/sgmp", str(self.deck.relative_to(ROOT)), *self.arguments()])

    def folder(self, solver_hash):
        key = hashlib.sha256("\n".join([solver_hash, self.deck.read_text(), self.tag, *self.arguments()]).encode())
        words = "_".join(f"{name}-{value}" for name, value in self.parameters.items()).replace("/", "over")
        return BUILD / "runs" / solver_hash[:12] / f"{self.deck.stem}_{words}"[:120] / key.hexdigest()[:12]


@dataclass
class Run:
    """A finished run."""

    case: Case
    folder: Path
    exit_code: int
    cpu_seconds: float  # user and system time of the process
    summary: dict

    def history(self):
        return read_history(self.folder)

    def particles(self):
        return read_particles_csv(self.folder)

    @property
    def loop_seconds(self):
        """CPU time of the time loop without start and output. A short loop is seldom interrupted: its wall time. A long
        one: the process's CPU time by the loop's share of the wall time, which other processes on the machine stretch
        but do not change much."""
        loop = sum(seconds for phase, seconds in self.summary["phase_seconds"].items() if phase != "output")
        return loop if loop < 0.2 else self.cpu_seconds * loop / self.summary["wall_seconds"]

    @property
    def cpu_ns(self):
        """CPU time of the time loop per particle and step (ns)."""
        return 1e9 * self.loop_seconds / self.summary["particle_steps"]


def solver_hash():
    if not SOLVER.exists():
        sys.exit(f"{SOLVER.relative_to(ROOT)} is missing: run `make build` first")
    return hashlib.sha256(SOLVER.read_bytes()).hexdigest()


def execute(case, folder):
    """Runs the solver into an empty folder; gives its exit code and CPU time. Open MPI starts a daemon for a process
    without mpirun, which costs time and fails now and then; the variable below does without, and a failed start is
    tried again."""
    environment = dict(os.environ, OMPI_MCA_ess_singleton_isolated="1")
    for attempt in range(4):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        with open(folder / "terminal.txt", "w") as terminal:
            process = subprocess.Popen(
                [str(SOLVER), str(case.deck), *case.arguments(), "--output", str(folder), "--threads", "1", "--quiet"],
                stdout=terminal, stderr=subprocess.STDOUT, cwd=ROOT, env=environment,
            )
            _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode == 0 or "MPI_Init" not in (folder / "terminal.txt").read_text(errors="replace"):
            break
        time.sleep(1 + attempt)
    return process.returncode, usage.ru_utime + usage.ru_stime


def solve_one(case, digest, may_fail):
    folder = case.folder(digest)
    record = folder / "run.json"
    if not record.exists():
        code, seconds = execute(case, folder)
        if not case.keep_dumps:
            for dump in folder.glob("*.vtu"):  # gigabytes that no check reads
                dump.unlink()
        if code in (0, NUMERICAL_ABORT):
            record.write_text(json.dumps({"command": case.command(), "exit_code": code, "cpu_seconds": seconds}))
    else:
        found = json.loads(record.read_text())
        code, seconds = found["exit_code"], found["cpu_seconds"]
    if code != 0 and not (may_fail and code == NUMERICAL_ABORT):
        raise RuntimeError(
            f"exit code {code}: {case.command()}\n{(folder / 'terminal.txt').read_text(errors='replace')[-2000:]}"
        )
    summary = read_summary(folder) if (folder / "summary.json").exists() else {}
    return Run(case, folder, code, seconds, summary)


def forget_old_runs():
    """Removes the runs of other executables."""
    for folder in (BUILD / "runs").glob("*"):
        if folder.name != solver_hash()[:12]:
            shutil.rmtree(folder)


def solve(cases, may_fail=False, workers=2):
    """Runs all cases on `workers` cores and returns the runs in the same order; a run made before by the same
    executable from the same deck is reused. A run that ends with an exit code other than 0 raises; if it may fail, the
    solver's numerical abort does not."""
    digest = solver_hash()
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(lambda case: solve_one(case, digest, may_fail), cases))


# ---------------------------------------------------------------- results

@dataclass
class Section:
    """One example of the report."""

    title: str
    text: list = field(default_factory=list)      # paragraphs, tables and figures in their order, as (kind, content)
    commands: list = field(default_factory=list)


def band(known, reference):
    """How far a value may be from a known deviation."""
    return min(0.05 * abs(known), 0.25 * abs(known - float(reference)))


class Book:
    """Results, sections, figures and tables of a verification run."""

    def __init__(self, output=BUILD):
        self.output = Path(output)
        self.output.mkdir(parents=True, exist_ok=True)
        self.results = []
        self.sections = []

    # ---- checks: each adds a row to results.json and tells whether it passed

    def add(self, case, quantity, value, reference, tolerance, passed, note="", known=None):
        """`known`: what the value is known to be where the target is out of reach, for a reason that the note gives.
        Such a check is reported as not passed; it counts as failed only if the value has left the band about the known
        one, whose width is half of the deviation and at most a tenth of the value: a deviation that shrinks or grows is
        news."""
        value = float(value)
        reference = reference.item() if hasattr(reference, "item") else reference  # numpy's, which JSON does not know
        deviation = bool(not passed and known is not None and abs(value - known) <= band(known, reference))
        a_band = {} if known is None or not band(known, reference) else {"known": known, "band": band(known, reference)}
        self.results.append(
            {
                "section": self.sections[-1].title if self.sections else "",
                "case": case,
                "quantity": quantity,
                "value": value if math.isfinite(value) else str(value),
                "reference": reference,
                "tolerance": tolerance,
                "pass": bool(passed),
                "known_deviation": deviation,
                "note": note,
                **a_band,
            }
        )
        print(
            f"  {'pass' if passed else 'known' if deviation else 'FAIL'}  {case}: {quantity} = {value:.6g}  "
            f"({tolerance} {reference})",
            flush=True,
        )
        return bool(passed)

    def within(self, case, quantity, value, reference, relative, note="", known=None):
        """The value is within a relative tolerance of its reference."""
        return self.add(case, quantity, value, reference, f"± {100 * relative:g} % of",
                        abs(value - reference) <= relative * abs(reference), note, known)

    def near(self, case, quantity, value, reference, absolute, note="", known=None):
        """The value is within an absolute tolerance of its reference."""
        return self.add(
            case, quantity, value, reference, f"± {absolute:g} about", abs(value - reference) <= absolute, note, known
        )

    def regression(self, case, quantity, value, found, relative, note=""):
        """The value is what the program has given before, within a relative tolerance. There is no reference that says
        it is right: a change is to be looked at, and may be a gain."""
        passed = self.add(case, quantity, value, found, f"regression value ± {100 * relative:g} %:",
                          abs(value - found) <= relative * abs(found), note)
        self.results[-1]["regression"] = True
        return passed

    def at_most(self, case, quantity, value, bound, note="", known=None):
        return self.add(case, quantity, value, bound, "at most", value <= bound, note, known)

    def at_least(self, case, quantity, value, bound, note="", known=None):
        return self.add(case, quantity, value, bound, "at least", value >= bound, note, known)

    def failed(self):
        """Checks that failed, without the known deviations."""
        return [result for result in self.results if not result["pass"] and not result["known_deviation"]]

    # ---- the report

    def section(self, title):
        self.sections.append(Section(title))
        print(f"\n{title}", flush=True)

    def say(self, text):
        self.sections[-1].text.append(("text", text))

    def command(self, *cases):
        self.sections[-1].commands += [case.command() if isinstance(case, Case) else case for case in cases]

    def table(self, name, header, rows, caption):
        """A table of the report, also written as NAME.csv."""
        with open(self.output / f"{name}.csv", "w") as stream:
            stream.write(",".join(header) + "\n")
            for row in rows:
                stream.write(",".join(f"{cell:.8g}" if isinstance(cell, float) else str(cell) for cell in row) + "\n")
        self.sections[-1].text.append(("table", (name, header, rows, caption)))

    def figure(self, name, figure, caption):
        """A figure of the report, also written as NAME.png."""
        path = self.output / f"{name}.png"
        figure.savefig(path)
        plt.close(figure)
        self.sections[-1].text.append(("figure", (path, caption)))


# ---------------------------------------------------------------- numbers and figures

def slopes(sizes, errors):
    """Orders of convergence between neighbouring cell sizes."""
    sizes, errors = np.asarray(sizes, float), np.asarray(errors, float)
    return np.diff(np.log(errors)) / np.diff(np.log(sizes))


def subplots(*arguments, **keywords):
    """plt.subplots in the common style."""
    plt.rcParams.update(plot_style())
    plt.rcParams.update({"savefig.dpi": 130, "legend.fontsize": 8.5})
    return plt.subplots(*arguments, layout="constrained", **keywords)


def draw_plane(axis, points, values, spacing, limits, cut=False):
    """Particles of a plane, or of a body seen along y, on `axis` as the viewer draws them; gives what a colour bar asks
    for."""
    drawn = draw_particles(axis, points, values, spacing, cut=cut, limits=limits, most=900)
    axis.set_aspect("equal")
    return drawn


def slope_triangle(axis, x, y, order, width=2.0):
    """Marks a slope in a double logarithmic figure: corner (x, y), rising to the right."""
    axis.plot([x, x * width, x * width, x], [y, y, y * width**order, y], color="0.4", linewidth=0.9)
    axis.text(x * width * 1.08, y * width**(0.5 * order), f"{order:g}", color="0.3", fontsize=8, va="center")


def cell_ticks(axis, sizes):
    """Marks the cell sizes themselves on a logarithmic axis; every second one where there are many."""
    shown = sizes if len(sizes) < 8 else sizes[::2]
    axis.set_xticks([1 / cells for cells in shown], [f"1/{cells}" for cells in shown])
    axis.set_xticks([], minor=True)


def work_precision(book, name, title, points, error_label, goals):
    """Diagram and table of CPU time over error, and the cheapest run for each error in `goals`. points: as `point`
    makes them."""
    figure, axis = subplots(figsize=(8.4, 4.4))
    for curve in dict.fromkeys(point["curve"] for point in points):
        chosen = [p for p in points if p["curve"] == curve]
        method = chosen[0]["method"]
        axis.plot([p["error"] for p in chosen], [p["cpu_seconds"] for p in chosen], linestyle=chosen[0]["line"],
                  color=COLOURS[method], marker=MARKERS[method], markersize=4, label=curve)
    errors, times = [p["error"] for p in points], [p["cpu_seconds"] for p in points]
    axis.set(xlabel=error_label, ylabel="CPU time (s)", xscale="log" if max(errors) > 8 * min(errors) else "linear",
             yscale="log" if max(times) > 8 * min(times) else "linear")
    axis.invert_xaxis()
    axis.set_title(title, loc="left", fontweight="bold")
    figure.legend(loc="outside right upper", handlelength=3.2)
    book.figure(name, figure, "CPU time of the time loop, one core, against error; better is lower and further right.")
    book.table(name, ["curve", "setting", "error", "CPU time (s)"],
               [[p["curve"], p["setting"], float(p["error"]), float(p["cpu_seconds"])] for p in points],
               "The numbers behind the diagram.")
    cheapest = []
    for goal in goals:
        good = [p for p in points if p["error"] <= goal]
        if good:
            best = min(good, key=lambda p: p["cpu_seconds"])
            cheapest.append(f"below {goal:g}: {best['curve']}, {best['setting']} ({best['cpu_seconds']:.3g} s)")
    book.say(f"<b>Cheapest setting</b> for a given {error_label}: {'; '.join(cheapest)}.")


def point(curve, method, setting, run, error, line="-", seconds=None):
    """A point of a work-precision diagram; its CPU time is the run's unless given."""
    return {
        "curve": curve,
        "method": method,
        "setting": setting,
        "cpu_seconds": run.loop_seconds if seconds is None else seconds,
        "error": float(error),
        "line": line,
    }


def main(check, doc):
    """Command line of a single check."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--full", action="store_true", help="all sizes and figures, not only the quick set")
    arguments = parser.parse_args()
    book = Book(BUILD / "single")
    check(book, arguments.full)
    sys.exit(1 if book.failed() else 0)
