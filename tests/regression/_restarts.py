"""What the tests of restarts share: a straight run with checkpoints, and one that goes on from one of them."""
import filecmp
import os
import shutil
import signal
import subprocess
import time

from _runs import ENVIRONMENT, FULL, INPUT, SCRATCH, SGMP, Run, run  # noqa: F401 (FULL: for those that import it)

# Same in both runs, byte by byte; run.log and summary.json hold wall times.
DIFFERENT = ("run.log", "summary.json")
ENVIRONMENT = {**ENVIRONMENT, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}


def mpirun(ranks):
    """A launcher of several ranks."""
    return ["mpirun", "-n", str(ranks)]


def deck(name, extra=""):
    """A deck of input/ with further cards."""
    return f'include "{os.path.join(INPUT, name)}"\n{extra}\n'


def clear(name):
    """An empty folder of results."""
    folder = os.path.join(SCRATCH, name)
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def command(name, text, options=(), settings=None, threads=1):
    """The command line of a run in a folder of its own."""
    path = os.path.join(SCRATCH, name + ".inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    line = [SGMP, path, "--quiet", "--threads", str(threads), "--output", os.path.join(SCRATCH, name), *options]
    for key, value in (settings or {}).items():
        line += ["--set", f"{key}={value}"]
    return line


def execute(line, name, launcher=(), timeout=300):
    """Runs a command line to its end."""
    environment = dict(ENVIRONMENT)
    if launcher:
        environment.pop("OMPI_MCA_ess_singleton_isolated", None)
    done = subprocess.run(
        [*launcher, *line], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=timeout, check=False,
        env=environment,
    )
    return Run(done.returncode, done.stdout.decode("utf-8", "replace"), os.path.join(SCRATCH, name))


def checkpoints(folder):
    """The steps of the checkpoints in a folder."""
    if not os.path.isdir(folder):
        return []
    return sorted(int(name[11:-3]) for name in os.listdir(folder)
                  if name.startswith("checkpoint_") and name.endswith(".h5"))


def path_of(folder, step):
    """The checkpoint of a step."""
    return os.path.join(folder, f"checkpoint_{step:07d}.h5")


def same_files(report, first, second, title, layouts=False):
    """Two folders with the same results; checkpoints of other layouts of ranks have other gaps."""
    names = {name for folder in (first, second) for name in os.listdir(folder)} - set(DIFFERENT)
    for name in sorted(names):
        if layouts and name.endswith(".h5"):
            continue
        paths = [os.path.join(folder, name) for folder in (first, second)]
        if report.check(all(os.path.exists(path) for path in paths), f"{title}: {name} is in one folder only"):
            report.check(filecmp.cmp(*paths, shallow=False), f"{title}: {name} differs")


def straight(report, name, text, threads=1, launcher=(), **settings):
    """A run from start to end."""
    clear(name)
    if launcher:
        result = execute(command(name, text, (), settings, threads), name, launcher)
    else:
        result = run(name, text, threads=threads, **settings)
    report.finished(result, name)
    return result


def goes_on(report, reference, name, text, step, threads=1, launcher=(), source=None, **settings):
    """Restarts a copy of a finished run from the checkpoint of a step; the results must be those of the run. The
    checkpoints may come from another run, of other ranks."""
    folder = clear(name)
    shutil.copytree((source or reference).folder, folder)
    for later in [other for other in checkpoints(folder) if other > step]:
        os.remove(path_of(folder, later))
    os.remove(os.path.join(folder, "summary.json"))
    result = execute(command(name, text, ["--restart", "latest"], settings, threads), name, launcher)
    if report.finished(result, name):
        report.check(
            result["restarted_from"].endswith(f"_{step:07d}.h5"), f"{name}: started from {result['restarted_from']}"
        )
        for key in ("checksum", "steps", "particle_steps", "energy.total", "energy.remainder", "particles_lost"):
            report.check(result[key] == reference[key], f"{name}: {key} {result[key]}, straight {reference[key]}")
        same_files(report, reference.folder, folder, name, layouts=bool(launcher or source))
    return result


class Going:
    """A run in progress, to be interrupted."""

    def __init__(self, line, name, launcher=()):
        self.name = name
        self.folder = os.path.join(SCRATCH, name)
        environment = dict(ENVIRONMENT)
        if launcher:
            environment.pop("OMPI_MCA_ess_singleton_isolated", None)
        self.process = subprocess.Popen(
            [*launcher, *line], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment
        )

    def wait_for(self, condition, seconds=60.0):
        """Waits until something is true or the run has ended; whether it became true."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if condition():
                return True
            if self.process.poll() is not None:
                return False
            time.sleep(0.001)
        return False

    def has_steps(self, rows):
        """Whether history.csv has come so far."""
        try:
            with open(os.path.join(self.folder, "history.csv"), "rb") as file:
                return file.read().count(b"\n") > rows
        except OSError:
            return False

    def writes_checkpoint(self):
        """Whether a checkpoint is being written."""
        try:
            return any(name.startswith("checkpoint_") and name.endswith(".part") for name in os.listdir(self.folder))
        except OSError:
            return False

    def solvers(self):
        """Process numbers of the solver itself, below a launcher."""
        if os.path.basename(self.process.args[0]) == os.path.basename(SGMP):
            return [self.process.pid]
        with open(f"/proc/{self.process.pid}/task/{self.process.pid}/children", encoding="ascii") as file:
            return [int(number) for number in file.read().split()]

    def end(self, number=None):
        """Sends a signal to the solver, if asked, and waits for the end."""
        if number is not None and self.process.poll() is None:
            for pid in self.solvers():
                os.kill(pid, number)
        text, _ = self.process.communicate(timeout=300)
        return Run(self.process.returncode, text.decode("utf-8", "replace"), self.folder)

    def kill(self):
        """kill -9."""
        return self.end(signal.SIGKILL)
