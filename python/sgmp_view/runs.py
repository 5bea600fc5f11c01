"""Runs of sgmp as objects: a deck is run with other values of its parameters, and its results are numbers.

    import sgmp_view as sv
    run = sv.run("penetration.inp", speed=600)
    run.bodies["core"].velocity_z                     # at the end; run.bodies["core"].start["velocity_z"] at the start
    run.summary["verdict"], run.history["time"], run.dump().points
"""

import json
import os
import shutil
import subprocess
import tempfile
from functools import cached_property
from pathlib import Path

import numpy as np

from .files import SgmpFileError, read_dump, read_history, read_summary, read_table

PROGRAM = "SGMP"                                       # environment: the program where it is not in PATH


class RunError(Exception):
    """A run that did not end well: the program's own words, and its exit code in `code`."""

    def __init__(self, words, code):
        super().__init__(words)
        self.code = code


class Body:
    """What bodies.csv has of a body: its columns at the end as attributes, all of them in `series`, those at the start
    in `start`."""

    def __init__(self, name, series):
        self.name, self.series = name, series
        self.start = {column: values[0] for column, values in series.items()}
        self.end = {column: values[-1] for column, values in series.items()}

    def __getattr__(self, column):
        if column in ("series", "start", "end"):       # not yet there, as while it is copied
            raise AttributeError(column)
        try:
            return self.end[column]
        except KeyError:
            raise AttributeError(f"body '{self.name}' has no '{column}'; there are: {', '.join(self.end)}") from None


class Run:
    """The output folder of a run that has ended; files are read when they are asked for."""

    def __init__(self, folder):
        self.folder = Path(folder)

    @cached_property
    def summary(self):
        """summary.json."""
        return read_summary(self.folder)

    @cached_property
    def history(self):
        """Columns of history.csv."""
        return read_history(self.folder)

    @cached_property
    def bodies(self):
        """Bodies by name."""
        table = read_table(self.folder / "bodies.csv")
        names = table.pop("name")
        return {
            str(names[table["body"] == number][0]): Body(
                str(names[table["body"] == number][0]),
                {column: values[table["body"] == number] for column, values in table.items()},
            )
            for number in np.unique(table["body"])
        }

    @property
    def verdict(self):
        """The word of the verdict."""
        return self.summary["verdict"]

    def dump(self, step="last"):
        """Particles of a dump."""
        return read_dump(self.folder, step)


def program_of(program=None):
    """The program: as given, as the environment says, in PATH, or in the build folder of the sources."""
    sources = Path(__file__).resolve().parents[2] / "build" / "release" / "sgmp"
    for candidate in (program, os.environ.get(PROGRAM), shutil.which("sgmp"), sources):
        if candidate and Path(candidate).exists():
            return str(Path(candidate).resolve())
    raise SgmpFileError(f"sgmp is not in PATH; give program=… or set {PROGRAM}")


def run(deck, output=None, *, threads=None, program=None, again=False, **parameters):
    """Runs a deck with values of its parameters and waits for it; the Run.

    output: folder (default: a new one, which stays). What is there already of the same deck, program and values is
    taken, unless `again`. Raises RunError where the exit code is not 0.
    """
    deck, program = Path(deck), program_of(program)
    if not deck.exists():
        raise SgmpFileError(f"{deck}: no such file")
    folder = Path(output) if output else Path(tempfile.mkdtemp(prefix=f"{deck.stem}_")) / "out"
    key = {
        "deck": deck.read_text(errors="replace"),
        "set": {name: text_of(value) for name, value in parameters.items()},
        "version": version_of(program),
    }
    record = folder / "run.json"
    if not again and record.exists() and json.loads(record.read_text()) == key:
        return Run(folder)
    record.unlink(missing_ok=True)
    words = [program, str(deck), "--quiet", "--output", str(folder)]
    words += [word for name, value in key["set"].items() for word in ("--set", f"{name}={value}")]
    words += ["--threads", str(threads)] if threads else []
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RunError((done.stderr or done.stdout).strip() or f"exit code {done.returncode}", done.returncode)
    record.write_text(json.dumps(key))
    return Run(folder)


def text_of(value):
    """A value as a deck has it: yes and no, numbers with all digits."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(value)


def version_of(program):
    """What the program says it is, and when it was built."""
    words = subprocess.run([program, "--version"], capture_output=True, text=True, check=False).stdout.strip()
    return f"{words} {os.stat(program).st_mtime_ns}"
