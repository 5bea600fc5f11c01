#!/usr/bin/env python3
"""The job scripts of scripts/hpc/ under a scheduler that is not there: it starts the ranks, warns them, and puts the
job back into the queue until the run has come to its end, with the bits of one without interruption.

usage: hpc.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import stat
import subprocess
import sys

from _restarts import ENVIRONMENT, clear, deck, same_files, straight
from _runs import SCRATCH, SGMP, SOURCE, Report, Run

DECK = deck("block.inp", "output vtkhdf every=0.003\ncheckpoint every=100\n")
SETTINGS = {"cells": 8, "steps": 300, "drift": 0.1, "jitter": 0.3}
STOPPED = 6
WARNINGS = 2  # jobs whose time runs out

# Drops its own options, runs the rest, and warns it once it has got going, as long as there are warnings left.
LAUNCHER = """#!{python}
import os, signal, subprocess, sys, time
words = sys.argv[1:]
with open({log!r}, "a") as log:
    log.write(" ".join(words) + "\\n")
program = next(i for i, word in enumerate(words) if os.path.basename(word) == {program!r})
run = subprocess.Popen(words[program:])
history = {history!r}
jobs = sum(1 for _ in open({log!r}))
start = os.path.getsize(history) if os.path.exists(history) and jobs > 1 else 0
while jobs <= {warnings} and run.poll() is None:
    if os.path.exists(history) and os.path.getsize(history) > start + 200:
        run.send_signal(signal.SIGUSR1)
        break
    time.sleep(0.002)
sys.exit(run.wait())
"""
QUEUE = """#!{python}
import sys
with open({log!r}, "a") as log:
    log.write(" ".join(sys.argv[1:]) + "\\n")
"""


def install(folder, name, text):
    """A program on the PATH of the job."""
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    os.chmod(path, os.stat(path).st_mode | stat.S_IXUSR)


def lines(path):
    """Lines of a file, none where it is not there."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        return file.read().splitlines()


def job(report, reference, name, launcher, queue, environment, words, expected):
    """Runs a job script again and again, as the scheduler would."""
    folder = clear(name)
    tools = clear(name + "_tools")
    os.makedirs(tools)
    path = os.path.join(SCRATCH, name + ".inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(DECK)
    started, queued = os.path.join(tools, "started"), os.path.join(tools, "queued")
    install(tools, launcher, LAUNCHER.format(python=sys.executable, log=started, program=os.path.basename(SGMP),
                                             history=os.path.join(folder, "history.csv"), warnings=WARNINGS))
    if queue:
        install(tools, queue, QUEUE.format(python=sys.executable, log=queued))
    options = ["--output", folder]
    for key, value in SETTINGS.items():
        options += ["--set", f"{key}={value}"]
    environment = {
        **ENVIRONMENT,
        **environment,
        "PATH": tools + os.pathsep + os.environ["PATH"],
        "SGMP": SGMP,
        "DECK": path,
        "OPTIONS": " ".join(options),
    }
    codes = []
    while len(codes) <= WARNINGS + 1:
        done = subprocess.run(
            ["bash", os.path.join(SOURCE, "scripts", "hpc", name + ".sh"), *words(path, options)], cwd=SCRATCH,
            env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300, check=False,
        )
        codes.append(done.returncode)
        if done.returncode != STOPPED:
            break
    text = done.stdout.decode("utf-8", "replace")
    report.check(codes == [STOPPED]*WARNINGS + [0], f"{name}: exit codes {codes}\n{text}")
    report.check(len(lines(queued)) == (WARNINGS if queue else 0), f"{name}: queued again {lines(queued)}")
    report.check(all(expected(line) for line in lines(queued)), f"{name}: {lines(queued)}")
    placement = lines(started)
    report.check(
        placement and all("--restart latest" in line and "bind" in line for line in placement), f"{name}: {placement}"
    )
    result = Run(codes[-1], text, folder)
    if report.check(result.summary.get("checksum") == reference["checksum"], f"{name}: other bits, {result.summary}"):
        same_files(report, reference.folder, folder, name)


def main():
    """SLURM, PBS and LSF."""
    report = Report()
    reference = straight(report, "reference", DECK, **SETTINGS)
    nodes = os.path.join(SCRATCH, "nodes")
    with open(nodes, "w", encoding="ascii") as file:
        file.write("localhost\n")
    job(report, reference, "slurm", "srun", "scontrol", {"SLURM_CPUS_PER_TASK": "2", "SLURM_JOB_ID": "17"},
        lambda path, options: [path, *options], lambda line: line == "requeue 17")
    job(
        report,
        reference,
        "pbs",
        "mpirun",
        "qsub",
        {"PBS_NODEFILE": nodes, "PBS_O_WORKDIR": SCRATCH, "OMP_NUM_THREADS": "1"},
        lambda path, options: [],
        lambda line: line.startswith("-v DECK=") and line.endswith("pbs.sh"),
    )
    job(report, reference, "lsf", "mpirun", None, {"OMP_NUM_THREADS": "1"}, lambda path, options: [], lambda line: True)
    report.end()


main()
