#!/usr/bin/env python3
"""The folder of results belongs to one run, whose files only are in it; what cannot fit into memory is refused; odd
masses are told.

usage: folder.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import fcntl
import json
import os
import re
import resource
import signal
import subprocess
import time

from _restarts import ENVIRONMENT, Going, clear, command, execute, mpirun
from _runs import SANITIZED, SCRATCH, SGMP, Report

DECK = """dimension 2
parameter steps = 20
parameter side = 4
parameter spacing = 0.5
grid cell=1
time cfl=0.3 end=1e9 steps=steps
material m elastic density=2 young=100 poisson=0.3
body plate block material=m lower=(0,0) upper=(side,side) spacing=spacing
velocity plate x="0.1*x"
"""
EVERYTHING = """output vtu every=0.1
output vtkhdf every=0.1
output tecplot every=0.1
output csv at=end
gauge g point=(1,1)
body other block material=m lower=(5,0) upper=(7,2) spacing=0.5
body wheel block material=m lower=(9,0) upper=(11,2) spacing=0.5
rigid wheel omega_z=1
motion plate where="x<1" x=0
contact other wheel
checkpoint every=10
"""
STOPPED, WRONG_DECK, WRONG_FILE = 6, 3, 5
ENDLESS = {"steps": 100000000}


def going(name, launcher=()):
    """A run that does not end by itself, once it steps."""
    clear(name)
    run = Going(command(name, DECK, settings=ENDLESS), name, launcher)
    run.wait_for(lambda: run.has_steps(4))
    return run


def locked(report):
    """A second run in the folder of one that is going is refused and harms nothing; after a kill the folder is free."""
    for title, launcher in (("alone", ()), ("ranks", mpirun(2))):
        name = f"locked_{title}"
        first = going(name, launcher)
        second = execute(command(name, DECK), name)
        report.check(second.code == WRONG_FILE and "still going" in second.text and "--output" in second.text,
                     f"{name}: exit code {second.code}\n{second.text}")
        result = first.end(signal.SIGTERM)
        report.check(result.code == STOPPED, f"{name}: the first ended with {result.code}\n{result.text}")
    first = going("locked_kill")
    first.kill()
    report.finished(execute(command("locked_kill", DECK), "locked_kill"), "after a kill")


def orphans(report):
    """Every rank has its part of the lock, and any part keeps a new run out: so does a rank that outlives its run."""
    name = "orphan"
    path = os.path.join(SCRATCH, name, ".lock")
    run = going(name, mpirun(2))
    for rank in (0, 1, 2):
        report.check(is_free(path, rank) == (rank == 2), f"{name}: part {rank} of the lock")
    run.end(signal.SIGTERM)
    with open(path, "r+b") as file:
        fcntl.lockf(file, fcntl.LOCK_EX, 1, 1)
        second = execute(command(name, DECK), name)
    report.check(
        second.code == WRONG_FILE and str(os.getpid()) in second.text, f"{name}: exit code {second.code}\n{second.text}"
    )
    report.finished(execute(command(name, DECK), name), "after the orphan's end")


def is_free(path, rank):
    """Whether a part of the lock could be had."""
    with open(path, "r+b") as file:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, rank)
        except OSError:
            return False
    return True


def interrupted(report):
    """Ctrl-C: checkpoint, summary and a message; a second one ends the program."""
    name = "ctrl_c"
    result = going(name).end(signal.SIGINT)
    report.check(result.code == STOPPED and "SIGINT" in result.text and result.summary.get("exit_status") == STOPPED,
                 f"{name}: exit code {result.code}\n{result.text}\n{result.summary}")
    report.check(any(entry.startswith("checkpoint_") for entry in os.listdir(result.folder)), f"{name}: no checkpoint")


def stale(report):
    """A new run removes what the run before has left; what is not the program's stays."""
    name = "stale"
    folder = clear(name)
    report.finished(execute(command(name, DECK + EVERYTHING), name), name)
    before = set(os.listdir(folder))
    for needed in (
        "contact.csv", "motion.csv", "rigid.csv", "gauges.csv", "particles.pvd", "particles.vtkhdf", "particles.dat",
        "particles_end.csv", "particles_0000000.vtu",
    ):
        report.check(needed in before, f"{name}: no {needed} to be removed")
    with open(os.path.join(folder, "notes.txt"), "w", encoding="ascii") as file:
        file.write("mine\n")
    report.finished(execute(command(name, DECK), name), name)
    after = set(os.listdir(folder))
    expected = {".lock", "run.log", "history.csv", "bodies.csv", "summary.json", "notes.txt"}
    left = {entry for entry in after - expected if not entry.endswith(".h5.old")}
    report.check(not left and expected <= after, f"{name}: {sorted(after)}")
    # refused: bodies overlap
    execute(command(name, DECK + "body twin block material=m lower=(0,0) upper=(1,1)\n"), name)
    report.check("summary.json" not in os.listdir(folder), f"{name}: the summary of the run before survives a failure")


def too_large(report):
    """Under a limit on memory: refused before anything is allocated, with a remedy; --check says what would be
    needed."""
    name = "memory"
    settings = {"side": 4000, "spacing": 0.25}

    def limited():
        resource.setrlimit(resource.RLIMIT_AS, (2 * 1024**3, 2 * 1024**3))

    for options, code, words in (((), WRONG_DECK, "GiB of memory"), (("--check",), 0, "does not fit")):
        started = time.monotonic()
        done = subprocess.run(
            command(name, DECK, options, settings), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
            timeout=300, env=ENVIRONMENT, preexec_fn=limited,
        )
        text = done.stdout.decode("utf-8", "replace")
        report.check(
            done.returncode == code and words in text, f"{name} {options}: exit code {done.returncode}\n{text}"
        )
        report.check(time.monotonic() - started < 60, f"{name} {options}: took {time.monotonic() - started:.0f} s")


def estimated(report):
    """The need that decides is near the measured peak."""
    for title, settings in (("four per cell", {"side": 400}), ("one per cell", {"side": 300, "spacing": 1})):
        name = "peak"
        result = execute(command(name, DECK, settings={**settings, "steps": 1}), name)
        report.finished(result, name)

        def limited():
            resource.setrlimit(resource.RLIMIT_AS, (600 * 1024**2, 600 * 1024**2))

        done = subprocess.run(
            command(name, DECK, ("--check",), {"side": 10 * settings["side"], "spacing": settings.get("spacing", 0.5)}),
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, env=ENVIRONMENT, preexec_fn=limited,
        )
        found = re.search(r"about ([\d.]+) MiB needed", done.stdout.decode("utf-8", "replace"))
        if report.check(found, f"{title}: no need in\n{done.stdout.decode()}"):
            process = 20e6
            need = (float(found.group(1)) * 1024**2 - process) / 100 + process
            peak = result["peak_memory_bytes"]
            report.check(0.8 < need / peak < 1.25, f"{title}: estimated {need/1e6:.0f} MB, measured {peak/1e6:.0f} MB")
            print(f"{title}: estimated {need/1e6:.0f} MB, measured {peak/1e6:.0f} MB")


def named_after_the_deck(report):
    """Without --output the folder is DECK.out where the run is started, wherever the deck is."""
    below = os.path.join(SCRATCH, "decks", "of_mine")
    os.makedirs(below, exist_ok=True)
    with open(os.path.join(below, "plate.thin.inp"), "w", encoding="utf-8") as file:
        file.write(DECK)
    done = subprocess.run(
        [SGMP, "decks/of_mine/plate.thin.inp", "--quiet", "--set", "steps=1"], cwd=SCRATCH, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, check=False, env=ENVIRONMENT,
    )
    report.check(
        done.returncode == 0 and os.path.exists(os.path.join(SCRATCH, "plate.thin.out", "summary.json")),
        f"named: {done.returncode} {done.stdout}",
    )


def masses(report):
    """A body thinner than its spacing has the mass of its shape; of whole cubes it has more: --check shows it, a run
    warns."""
    thin = DECK.replace("upper=(side,side)", "upper=(6,0.3)")
    result = execute(command("thin", thin, ("--check",)), "thin")
    report.check(re.search(r"mass +3\.6; of its shapes 3\.6 ", result.text), f"thin: {result.text}")
    thin = DECK.replace("upper=(side,side)", "upper=(6,0.3) fit=cubes")
    result = execute(command("thin", thin, ("--check",)), "thin")
    report.check(re.search(r"mass +6; of its shapes 3\.6 \(\+66\.7 %\)", result.text), f"thin: {result.text}")
    line = [word for word in command("thin", thin) if word != "--quiet"]
    result = execute(line, "thin")
    report.check(
        "warning" in result.text and "'plate'" in result.text and "mass" in result.text, f"thin: {result.text}"
    )
    result = execute(command("thick", DECK, ("--check",)), "thick")
    report.check("(+0.0 %)" in result.text, f"a mass that is right: {result.text}")
    result = execute([word for word in command("thick", DECK) if word != "--quiet"], "thick")
    report.check("mass" not in result.text, f"thick: {result.text}")


def full_log(report):
    """A log that cannot be written: the run says so, at its end at the latest, and ends with the code for files."""
    name = "full_log"
    os.makedirs(clear(name))
    os.symlink("/dev/full", os.path.join(SCRATCH, name, "run.log"))
    result = execute(command(name, DECK), name)
    report.check(result.code == WRONG_FILE and "error: cannot write" in result.text and "run.log" in result.text,
                 f"{name}: exit code {result.code}\n{result.text}")


def no_dumps(report):
    """A file of particles that the first of two ranks cannot make: both end, and say it once."""
    name = "no_dumps"
    os.makedirs(clear(name))
    os.symlink(os.path.join(SCRATCH, "no_such_folder", "file"), os.path.join(SCRATCH, name, "particles.vtkhdf"))
    result = execute(command(name, DECK + "output vtkhdf every=0.1\n"), name, mpirun(2), timeout=60)
    report.check(
        result.code == WRONG_FILE and result.text.count("error: cannot create") == 1 and "HDF5-DIAG" not in result.text,
        f"{name}: exit code {result.code}\n{result.text}",
    )


def linked_log(report):
    """A link in the place of run.log is replaced; what it points to stays as it is."""
    name = "linked_log"
    folder = clear(name)
    os.makedirs(folder)
    kept = os.path.join(SCRATCH, "kept.txt")
    with open(kept, "w", encoding="ascii") as file:
        file.write("kept")
    os.symlink(kept, os.path.join(folder, "run.log"))
    result = execute(command(name, DECK), name)
    with open(kept, encoding="ascii") as file:
        report.check(
            result.code == 0 and file.read() == "kept",
            f"{name}: exit code {result.code}, or the file that the link points to has changed",
        )
    report.check(
        not os.path.islink(os.path.join(folder, "run.log")) and os.path.getsize(os.path.join(folder, "run.log")) > 0,
        f"{name}: no run.log",
    )


def pipe(report):
    """A pipe that a deck includes is refused; nothing waits for it."""
    name, path = "pipe", os.path.join(SCRATCH, "pipe.fifo")
    if not os.path.exists(path):
        os.mkfifo(path)
    try:
        result = execute(command(name, DECK + 'include "pipe.fifo"\n'), name, timeout=20)
    except subprocess.TimeoutExpired:
        report.check(False, f"{name}: waits for ever")
        return
    report.check(
        result.code == WRONG_DECK and "is a pipe or a device" in result.text,
        f"{name}: exit code {result.code}\n{result.text}",
    )


def title(report):
    """Bytes of a title that are no UTF-8 are marked in summary.json; letters beyond ASCII stay."""
    name = "title"
    words = command(name, DECK)
    with open(words[1], "rb") as file:
        deck = file.read()
    with open(words[1], "wb") as file:
        file.write(b'title "caf\xe9 \xc3\xa9"\n' + deck)
    result = execute(words, name)
    with open(os.path.join(SCRATCH, name, "summary.json"), "rb") as file:
        text = file.read()
    try:
        found = json.loads(text.decode("utf-8"))["title"]
    except UnicodeDecodeError:
        found = "no UTF-8"
    report.check(result.code == 0 and found == "caf\ufffd \u00e9", f"{name}: exit code {result.code}, title {found!r}")


def main():
    """All checks; the exit code is that of the report."""
    os.makedirs(SCRATCH, exist_ok=True)
    report = Report()
    of_memory = () if SANITIZED else (too_large, estimated)
    for check in (
        locked, orphans, interrupted, stale, *of_memory, masses, named_after_the_deck, full_log, no_dumps, linked_log,
        pipe, title,
    ):
        check(report)
    report.end()


if __name__ == "__main__":
    main()
