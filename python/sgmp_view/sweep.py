"""Runs a deck for all combinations of parameters, some at a time, and collects the summaries.

    sgmp-view sweep input/taylor_bar.inp --vary cfl=0.5,1,2 --vary method=sgmp,gimp --set h=1.9 --jobs 2
    sgmp-view sweep my.inp --vary h=0.8,0.4,0.2 --quantity bodies.bar.z --quantity energy.drift

Results go to DECK.sweep/ (or --output): a folder for each combination, sweep.csv and sweep.png. A combination that has
ended with this deck and these settings is not run again; one that was stopped after a checkpoint goes on from it.
--list prints the commands instead of running them, one a line, for a job array: `sed -n "${SLURM_ARRAY_TASK_ID}p" |
bash`. Exit code 1 if any run failed; the others are collected all the same.
"""

import csv
import hashlib
import itertools
import json
import shlex
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib.pyplot as plt

from .compare import text_of
from .files import SgmpFileError, existing, plot_style, read_summary_if_any
from .quantities import quantity_of
from .runs import program_of

DONE = (0, 4)           # exit codes of runs that would end the same way again
STOPPED = 6             # after a checkpoint
STANDARD = ("energy.drift", "solve_seconds")
STAMP = "sweep.json"    # in each run's folder: what it was run with


class Member:
    """One combination: its folder, its command and what came of it."""

    def __init__(self, combination, options):
        self.values = dict(combination)
        self.name = ",".join(f"{name}={value}" for name, value in combination)
        self.folder = options.output / self.name.replace("/", "_")
        self.command = [
            options.sgmp, str(options.deck), "--quiet", "--threads", str(options.threads), "--output", str(self.folder),
        ]
        for name, value in [*(setting.split("=", 1) for setting in options.set), *combination]:
            self.command += ["--set", f"{name}={value}"]
        settings = sorted(option for option in self.command[7:] if option != "--set")
        self.stamp = {"deck": hashlib.sha256(options.deck.read_bytes()).hexdigest(), "settings": settings}
        self.code = None

    def is_done(self):
        """Whether it has ended with this very deck and these settings."""
        return self.same_as_before() and read_summary_if_any(self.folder).get("exit_status") in DONE

    def same_as_before(self):
        """Whether the folder is of this very deck and these settings."""
        path = self.folder / STAMP
        return path.exists() and json.loads(path.read_text()) == self.stamp

    def run(self):
        """Runs it, or goes on where it was stopped."""
        if self.is_done():
            self.code = read_summary_if_any(self.folder)["exit_status"]
            return f"{self.name}: done before"
        command = self.command
        if self.same_as_before() and read_summary_if_any(self.folder).get("exit_status") == STOPPED:
            command = [*command, "--restart", "latest"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.code = done.returncode
        if self.code in (2, 3):
            return f"{self.name}: exit code {self.code}\n{done.stdout}"
        (self.folder / STAMP).write_text(json.dumps(self.stamp, indent=1) + "\n")
        return f"{self.name}: {read_summary_if_any(self.folder).get('verdict', 'no verdict')}, exit code {self.code}"

    def row(self, quantities):
        """What stands in the table."""
        summary = read_summary_if_any(self.folder)
        row = {**self.values, "exit_status": self.code, "verdict": summary.get("verdict", "")}
        for quantity in quantities:
            try:
                row[quantity] = quantity_of(self.folder, quantity)
            except SgmpFileError:
                row[quantity] = None
        return row


def ranges(texts):
    """Name and values of each --vary."""
    found = {}
    for text in texts:
        name, _, values = text.partition("=")
        if not name or not values:
            raise ValueError(f"--vary {text}: expected NAME=VALUE,VALUE,…")
        found[name] = values.split(",")
    return found


def write_table(path, rows):
    """The table as CSV, and on the terminal."""
    with open(path, "w", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    lines = [list(rows[0])] + [[text_of(value) for value in row.values()] for row in rows]
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    print("\n".join("  ".join(word.rjust(width) for word, width in zip(line, widths)) for line in lines))


def draw(path, rows, varied, quantities):
    """Each quantity over the first varied parameter that is a number, a line for each combination of the others."""
    def number(word):
        try:
            return float(word)
        except ValueError:
            return None

    abscissa = next(
        (name for name, values in varied.items() if len(values) > 1 and None not in map(number, values)), None
    )
    if abscissa is None:
        return False
    with plt.rc_context(plot_style()):
        figure, axes = plt.subplots(
            1, len(quantities), figsize=(5 * len(quantities), 4), layout="constrained", squeeze=False
        )
        others = [name for name in varied if name != abscissa]
        for key in dict.fromkeys(tuple(row[name] for name in others) for row in rows):
            line = sorted((number(row[abscissa]), row) for row in rows if tuple(row[name] for name in others) == key)
            for axis, quantity in zip(axes[0], quantities):
                points = [
                    (x, row[quantity]) for x, row in line if row[quantity] is not None and row["exit_status"] == 0
                ]
                axis.plot(*zip(*points) if points else ([], []), "o-", label=", ".join(key))
        for axis, quantity in zip(axes[0], quantities):
            axis.set(xlabel=abscissa, ylabel=quantity)
        if others:
            axes[0][0].legend()
        figure.savefig(path)
        plt.close(figure)
    return True


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("deck", type=Path)
    parser.add_argument(
        "--vary", action="append", required=True, metavar="NAME=V1,V2,…",
        help="a parameter of the deck and its values; may be repeated",
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="a parameter that is the same in all runs"
    )
    parser.add_argument(
        "--quantity", action="append", default=[], metavar="NAME",
        help="what to collect beside drift and time, see `convergence`",
    )
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at a time (default: 1)")
    parser.add_argument("--threads", type=int, default=1, metavar="N", help="threads of each run (default: 1)")
    parser.add_argument("--sgmp", help="the program (default: $SGMP, the path, build/release/sgmp)")
    parser.add_argument("--list", action="store_true", help="print the commands, run nothing")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="folder of the study (default: the deck's name and .sweep)"
    )


def run(options):
    """Runs what is missing, then writes table and figure."""
    existing(options.deck)
    options.sgmp = program_of(options.sgmp)
    options.output = options.output or Path(options.deck.stem + ".sweep")
    varied = ranges(options.vary)
    members = [Member(list(zip(varied, values)), options) for values in itertools.product(*varied.values())]
    if options.list:
        print("\n".join(shlex.join(member.command) for member in members))
        return 0
    options.output.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(max(1, options.jobs)) as pool:
        for message in pool.map(Member.run, members):
            print(message, flush=True)
    if all(member.code in (2, 3) for member in members):
        return 1
    quantities = [*options.quantity, *STANDARD]
    rows = [member.row(quantities) for member in members]
    write_table(options.output / "sweep.csv", rows)
    print(options.output / "sweep.csv")
    if draw(options.output / "sweep.png", rows, varied, quantities):
        print(options.output / "sweep.png")
    return 1 if any(member.code for member in members) else 0
