#!/usr/bin/env python3
"""scripts/hpc/slurm.sh under a real SLURM: munge, a controller and a node of its own on this machine, in the scratch
folder and gone afterwards. A job whose time limit is a minute is warned, writes a checkpoint, puts itself back into the
queue, goes on from there, until the run has come to its end with the bits of one without interruption.

usage: slurm.py SGMP SOURCE_DIR SCRATCH_DIR     exit code 77 where SLURM is missing, with what is

Needs root, or the right to start slurmd, and on Debian: apt-get install --no-install-recommends slurmctld slurmd
slurm-client munge
"""
import os
import shutil
import socket
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "regression"))
from _restarts import clear, deck, same_files, straight  # noqa: E402
from _runs import SCRATCH, SGMP, SOURCE, Report, Run  # noqa: E402

PROGRAMS = {
    "munged": "munge",
    "slurmctld": "slurmctld",
    "slurmd": "slurmd",
    "sbatch": "slurm-client",
    "srun": "slurm-client",
    "scontrol": "slurm-client",
}
MISSING = 77
SECONDS = 900  # for all jobs together
# ranks that wait for each other on a busy machine hardly get on
RANKS = 2 if os.getloadavg()[0] < os.cpu_count() else 1
LONG = 90      # seconds of the whole run: longer than from the start to the warning, at any load of the machine
DECK = deck("block.inp", "checkpoint every=100000\n")
SETTINGS = {"cells": 6, "drift": 0.001, "jitter": 0.3}
CONFIGURATION = """
ClusterName=sgmp
SlurmctldHost={host}({address})
SlurmctldPort={port}
SlurmdPort={next_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
CredType=cred/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/affinity
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
MpiDefault=pmix
ReturnToService=2
KillWait=30
SchedulerParameters=sched_interval=5,bf_interval=5
NodeName={host} NodeAddr={address} CPUs={cores} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """What has to be installed, and what else stands in the way."""
    found = [f"{program} (Debian: {package})" for program, package in PROGRAMS.items() if not which(program)]
    return found + ["root, which slurmd needs"]*(os.geteuid() != 0)


def which(program):
    """Path of a program, also where only root looks."""
    return shutil.which(program, path=os.environ.get("PATH", "") + ":/usr/sbin:/usr/local/sbin")


class Cluster:
    """Controller and node, with a munge of their own."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        shutil.rmtree(folder, ignore_errors=True)
        for name in ("", "munge", "state", "spool"):
            os.makedirs(os.path.join(folder, name))
            os.chmod(os.path.join(folder, name), 0o755)
        self.environment = {**os.environ, "SLURM_CONF": os.path.join(folder, "slurm.conf")}
        port = 20000 + os.getpid() % 20000
        with open(self.environment["SLURM_CONF"], "w", encoding="ascii") as file:
            file.write(
                CONFIGURATION.format(
                    host=socket.gethostname().split(".")[0], address="127.0.0.1", port=port, next_port=port + 1,
                    user="root", folder=folder, cores=max(RANKS, os.cpu_count()),
                )
            )
        with open(os.path.join(folder, "cgroup.conf"), "w", encoding="ascii") as file:
            file.write("CgroupPlugin=autodetect\nIgnoreSystemd=yes\n")

    def start(self):
        """munged, slurmctld, slurmd; waits for the node."""
        munge = os.path.join(self.folder, "munge")
        key = os.path.join(munge, "key")
        with open(key, "wb") as file:
            file.write(os.urandom(128))
        os.chmod(key, 0o600)
        self.spawn(
            "munged", "--foreground", f"--socket={munge}/socket", f"--key-file={key}", f"--pid-file={munge}/pid",
            f"--log-file={munge}/log", f"--seed-file={munge}/seed",
        )
        wait(lambda: os.path.exists(f"{munge}/socket"), 30)
        self.spawn("slurmctld", "-D")
        self.spawn("slurmd", "-D", "-N", socket.gethostname().split(".")[0])
        return wait(lambda: "idle" in self.ask("sinfo", "-h", "-o", "%T"), 90)

    def spawn(self, program, *options):
        """A daemon in the foreground, its words in a file."""
        with open(os.path.join(self.folder, program + ".out"), "wb") as out:
            self.processes.append(
                subprocess.Popen([which(program), *options], stdout=out, stderr=subprocess.STDOUT, env=self.environment)
            )

    def ask(self, *words):
        """What a command of SLURM says."""
        done = subprocess.run(
            words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=self.environment, check=False, timeout=60
        )
        return done.stdout.decode("utf-8", "replace")

    def words(self):
        """The ends of all logs."""
        found = []
        for name in sorted(os.listdir(self.folder)):
            if name.endswith((".log", ".out")):
                with open(os.path.join(self.folder, name), encoding="utf-8", errors="replace") as file:
                    found.append(f"--- {name}\n" + "".join(file.readlines()[-15:]))
        return "\n".join(found)

    def stop(self):
        """Ends the daemons, the last first."""
        for process in reversed(self.processes):
            process.terminate()
            try:
                process.wait(timeout=20)
            except subprocess.TimeoutExpired:
                process.kill()


def wait(condition, seconds):
    """Waits until something is true; whether it became so."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.5)
    return False


def submit(cluster, name):
    """The job with a limit of a minute, warned 50 seconds before; its number and where it prints."""
    folder, path, printed = clear(name), os.path.join(SCRATCH, name + ".inp"), os.path.join(SCRATCH, name + ".txt")
    if os.path.exists(printed):
        os.remove(printed)
    with open(path, "w", encoding="utf-8") as file:
        file.write(DECK)
    options = ["--output", folder]
    for key, value in SETTINGS.items():
        options += ["--set", f"{key}={value}"]
    cluster.environment["SGMP"] = SGMP
    said = cluster.ask(
        "sbatch", f"--ntasks-per-node={RANKS}", "--cpus-per-task=1", "--time=1", "--signal=USR1@50",
        f"--output={printed}", f"--chdir={SCRATCH}", os.path.join(SOURCE, "scripts", "hpc", "slurm.sh"), path, *options,
    )
    return said.split()[-1], folder, printed


def main():
    """One job through its time limit, the queue and restarts."""
    if missing():
        print("missing: " + ", ".join(missing()))
        sys.exit(MISSING)
    os.makedirs(SCRATCH, exist_ok=True)
    report = Report()
    SETTINGS["steps"] = 400
    trial = straight(report, "trial", DECK, **SETTINGS)
    # of a busy machine the clock says less than the processor
    seconds = min(trial["solve_seconds"], trial["cpu_seconds"])
    SETTINGS["steps"] = max(400, int(400*LONG/seconds))
    reference = straight(report, "reference", DECK, **SETTINGS)
    cluster = Cluster(os.path.join(SCRATCH, "cluster"))
    try:
        if report.check(cluster.start(), "the node did not come up\n" + cluster.words()):
            job, folder, printed = submit(cluster, "job")
            path = os.path.join(folder, "summary.json")
            ended = wait(lambda: os.path.exists(path) and Run(0, "", folder).summary.get("exit_status") == 0, SECONDS)
            state = cluster.ask("scontrol", "show", "job", job)
            text = open(printed, encoding="utf-8", errors="replace").read() if os.path.exists(printed) else ""
            if report.check(ended, f"the run did not come to its end\n{state}\n{text}\n{cluster.words()}"):
                restarts = int(state.split("Restarts=")[1].split()[0])
                print(f"job {job}: {restarts} times back in the queue")
                report.check(
                    restarts >= 1 and text.count("stopped by SIGUSR1") == restarts,
                    f"{restarts} restarts\n{state}\n{text}",
                )
                result = Run(0, text, folder)
                report.check(
                    result["checksum"] == reference["checksum"] and result["ranks"] == RANKS,
                    f"checksum {result['checksum']} of {result['ranks']} ranks, expected {reference['checksum']}",
                )
                same_files(report, reference.folder, folder, "job", layouts=True)
    finally:
        cluster.stop()
    report.end()


main()
