"""Where a run is: step, time, what is left, also of one that is dead.

    sgmp-view status taylor_bar.out
    sgmp-view status *.out

Reads .lock (is anybody at work?), history.csv, run.log and summary.json. Exit code 0 if all have finished or are at
work, 1 if one has failed or died.
"""

import fcntl
import struct
import time
from pathlib import Path

from .files import SgmpFileError, folder_of, read_history, read_summary_if_any, read_units, run_name

FLOCK = "hhqqi4x"       # struct flock of 64-bit Linux: kind, whence, start, length, process
REASONS = {
    0: "finished",
    2: "refused: command line",
    3: "refused: deck",
    4: "failed: the computation",
    5: "failed: files",
    6: "stopped after a checkpoint",
}


def is_at_work(folder):
    """Whether a process holds the lock of the folder; asks without taking it."""
    path = folder / ".lock"
    if not path.exists():
        return False
    with open(path, "rb") as lock:
        question = struct.pack(FLOCK, fcntl.F_WRLCK, 0, 0, 0, 0)
        return struct.unpack(FLOCK, fcntl.fcntl(lock, fcntl.F_GETLK, question))[0] != fcntl.F_UNLCK


def end_of(folder):
    """The time at which the run ends, from the deck in its log, or None."""
    log = folder / "run.log"
    for line in log.read_text(errors="replace").splitlines() if log.exists() else ():
        if line.startswith("time "):
            for word in line.split()[1:]:
                if word.startswith("end="):
                    return float(word[4:])
    return None


def hours(seconds):
    """h:mm:ss."""
    return f"{int(seconds) // 3600}:{int(seconds) // 60 % 60:02d}:{int(seconds) % 60:02d}"


def progress(folder):
    """Last step, time, start and end of the clock of a run that has written rows."""
    history = read_history(folder)
    if not len(history.get("time", ())):
        return None
    return int(history["step"][-1]), float(history["time"][-1]), (folder / "history.csv").stat().st_mtime


def describe(folder):
    """One line, and whether it is bad news."""
    folder = folder_of(folder)
    summary, unit = read_summary_if_any(folder), read_units(folder)["time"]
    at_work = is_at_work(folder)
    if summary and not at_work:
        code = summary.get("exit_status")
        verdict = f", {summary['verdict']}" if "verdict" in summary else ""
        return (
            f"{REASONS.get(code, f'exit code {code}')}{verdict}: step {summary.get('steps')}, t = "
            f"{summary.get('time'):.6g} {unit}"
            f", {hours(summary.get('wall_seconds', 0))}"
        ).replace("  ", " "), code not in (0, 6)
    try:
        step, now, written = progress(folder)
    except (SgmpFileError, TypeError):
        return (
            ("at work, no rows of history yet", False)
            if at_work
            else ("died, or never began: no rows of history", True)
        )
    end = end_of(folder)
    share = f" of {end:g} ({100 * now / end:.1f} %)" if end else ""
    text = f"step {step}, t = {now:.6g}{share} {unit}".rstrip()
    if not at_work:
        kept = sorted(folder.glob("checkpoint*")) or sorted(folder.glob("*.chk"))
        remedy = f"; go on with --restart latest ({kept[-1].name})" if kept else "; no checkpoint"
        return f"died {hours(time.time() - written)} ago at {text}{remedy}", True
    started = (folder / ".lock").stat().st_mtime
    left = (written - started) * (end - now) / now if end and now > 0 else None
    return f"at work: {text}" + (f", about {hours(left)} left" if left is not None else ""), False


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folders", nargs="+", type=Path, metavar="OUT_DIR", help="output folder(s) of sgmp")


def run(options):
    """Prints one line for each run."""
    bad = False
    for folder in options.folders:
        if not folder.is_dir():
            raise SgmpFileError(f"{folder}: no such folder")
        text, is_bad = describe(folder)
        bad = bad or is_bad
        print(f"{run_name(folder)}: {text}" if len(options.folders) > 1 else text)
    return int(bad)
