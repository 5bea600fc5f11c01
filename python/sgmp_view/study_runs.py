"""Runs of copies of a deck within a budget of wall time: told before, done once, gone on with where they were
stopped."""

import hashlib
import json
import os
import re
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

from .files import SgmpFileError, read_summary, read_summary_if_any
from .quantities import keep_impact
from .turning import keep_matrix
from .runs import version_of

DONE = (0, 4)                                           # exit codes of runs that would end the same way again
STOPPED = 6                                             # after a checkpoint
NS_FIRST = 400.0                                        # per particle and step before any run has told
# over that of the deck's own run: what is shorter tells of start and end
LEAST_WORK = 0.5
DUMPS = ("particles_*.vtu", "particles.pvd", "particles.vtkhdf", "particles.dat")
STAMP = "study.json"                                    # in each run's folder: what it was run with


@dataclass
class Member:
    """A run of the study: its part of the error, its place, what differs in words, its deck, what it costs beside the
    deck's own run."""

    part: str
    name: str
    words: str
    text: str
    work: float                                         # particle-steps over those of the deck's own run
    code: int = -1                                      # exit code; -1: not run
    note: str = ""
    fault: float = 0.0                                  # of the bodies' mass
    axes: int = 0                                       # of a scene that was turned; 0: it was not
    factor: float = 1.0                                 # of the deck's cells
    # name of the run with coarser cells that it differs from; empty: the deck's own
    beside: str = ""


class Checked:
    """What --check says of a deck: whether it is accepted, particle-steps, faults of the bodies' masses, masses of
    their shapes."""

    def __init__(self, printed):
        self.accepted = printed.returncode == 0
        self.words = (printed.stderr or printed.stdout).strip()
        steps = re.search(r"^steps .* (\S+) particle-steps$", printed.stdout, re.M)
        self.work = float(steps[1]) if steps else 0.0
        masses = re.findall(r"^ +mass +\S+; of its shapes (\S+) \((\S+) %\)", printed.stdout, re.M)
        self.masses = [float(mass) for mass, _ in masses]
        self.fault = max((abs(float(fault)) / 100 for _, fault in masses), default=0.0)


class Runner:
    """Runs members in a folder until the budget is spent."""

    def __init__(self, folder, program, threads, budget):
        self.folder, self.program, self.threads, self.budget = Path(folder), program, threads, budget
        self.version = version_of(program)
        self.environment = {"OMP_WAIT_POLICY": "passive", **os.environ}  # threads that wait would count as CPU time
        self.started = time.monotonic()
        self.base_work, self.seconds_per_work = 0.0, NS_FIRST * 1e-9 / (threads or 1)

    def left(self):
        """Seconds of the budget."""
        return self.budget - (time.monotonic() - self.started)

    def expected(self, member):
        """Seconds that a member takes, by what the runs before it took."""
        return 0.0 if self.is_done(member) else self.seconds_per_work * self.base_work * member.work

    def output(self, member):
        """Folder of a member."""
        return self.folder / member.name

    def command(self, path, *more):
        """The program's command line."""
        return [self.program, str(path), *(["--threads", str(self.threads)] if self.threads else []), *more]

    def write(self, name, text):
        """Writes a copy of the deck."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / f"{name}.inp"
        path.write_text(text)
        return path

    def check(self, text):
        """What the program says of a deck without running it."""
        path = self.write("checked", text)
        printed = subprocess.run(self.command(path, "--check"), capture_output=True, text=True, check=False)
        path.unlink()
        return Checked(printed)

    def stamp(self, member):
        """What a run is known by."""
        return {"deck": hashlib.sha256(member.text.encode()).hexdigest(), "version": self.version}

    def is_same(self, member):
        """Whether its folder is of this very deck and program."""
        path = self.output(member) / STAMP
        return path.exists() and json.loads(path.read_text()) == self.stamp(member)

    def is_done(self, member):
        """Whether it has been run to its end."""
        return self.is_same(member) and read_summary_if_any(self.output(member)).get("exit_status") in DONE

    def fits(self, member, kept=0.0):
        """Whether it is there or fits in what is left of the budget beside what is kept for others."""
        return self.expected(member) + kept <= max(0.0, self.left())

    def run(self, member):
        """Runs it, goes on with it, or takes what is there; whether it has ended."""
        summary = read_summary_if_any(self.output(member))
        if self.is_done(member):
            member.code, member.note = summary["exit_status"], "done before"
            return member.code == 0
        if not self.fits(member):
            member.note = f"left out: about {clock(self.expected(member))}"
            return False
        limit = max(1, int(self.left()))
        more = [
            "--quiet", "--output", str(self.output(member)), "--time-limit",
            f"{limit // 3600}:{limit // 60 % 60:02d}:{limit % 60:02d}",
        ]
        if self.is_same(member) and summary.get("exit_status") == STOPPED:
            more += ["--restart", "latest"]
        begun = time.monotonic()
        done = subprocess.run(
            self.command(self.write(member.name, member.text), *more), capture_output=True, text=True, check=False,
            env=self.environment,
        )
        member.code = done.returncode
        if member.code in (*DONE, STOPPED):
            (self.output(member) / STAMP).write_text(json.dumps(self.stamp(member)) + "\n")
        if member.code in DONE and member.part != "deck":
            if member.axes:
                keep_matrix(self.output(member), member.axes == 2)
            keep_impact(self.output(member))
            self.remove_dumps(member)
        if member.code == 0 and "--restart" not in more and self.base_work > 0 and member.work >= LEAST_WORK:
            self.seconds_per_work = max((time.monotonic() - begun) / (self.base_work * member.work), 1e-10)
        member.note = {0: "", STOPPED: "stopped at the budget"}.get(member.code, first_line(done.stderr or done.stdout))
        return member.code == 0

    def remove_dumps(self, member):
        """Takes away what only pictures need. The copies write it, as steps are shortened to land on its times."""
        for pattern in DUMPS:
            for path in self.output(member).glob(pattern):
                path.unlink()

    def summary(self, member):
        """Its summary."""
        return read_summary(self.output(member))

    def must_run(self, member):
        """Runs what nothing can be said without."""
        if not self.run(member):
            wanted = self.expected(member) * 1.2 + 1
            more = (
                f": it needs about {clock(wanted)}, the budget is {clock(self.budget)}"
                if member.note.startswith(("left", "stopped"))
                else ""
            )
            raise SgmpFileError(f"{member.name}: {member.note or f'exit code {member.code}'}{more}")


def first_line(text):
    """The first line that says something."""
    return next((line.strip() for line in text.splitlines() if line.strip()), "")


def clock(seconds):
    """A time in words."""
    if seconds < 100:
        return f"{seconds:.3g} s" if seconds >= 1 else f"{seconds:.2g} s"
    return f"{seconds / 60:.3g} min" if seconds < 6000 else f"{seconds / 3600:.3g} h"
