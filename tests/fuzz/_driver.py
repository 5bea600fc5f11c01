"""What the fuzzers share: the driver that takes command lines one after another, seeds, findings."""
import argparse
import os
import re
import shutil
import signal
import subprocess
import sys
import time

CRASH = re.compile(
    r"Backtrace|SIG[A-Z]{3,}|runtime error|terminate called|AddressSanitizer|At line \d+ of file|Fortran runtime"
)


HANGS = (-signal.SIGXCPU, -signal.SIGALRM)  # too much of the processor, too long by the clock: split.c


class Driver:
    """sgmp without its start: fuzz_driver, beside the executable in build/…/tests."""

    def __init__(self, executable, scratch):
        self.path = os.path.join(os.path.dirname(executable), "tests", "fuzz_driver")
        self.log = os.path.join(scratch, "printed")
        self.process = None

    def start(self):
        """A process that waits for command lines."""
        environment = {**os.environ, "OMPI_MCA_ess_singleton_isolated": "1", "OMP_NUM_THREADS": "1"}
        self.process = subprocess.Popen([self.path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)

    def run(self, words):
        """Exit code (or minus the signal) and everything printed."""
        if self.process is None or self.process.poll() is not None:
            self.start()
        self.process.stdin.write(("\t".join([self.log, *words]) + "\n").encode())
        self.process.stdin.flush()
        code = int(self.process.stdout.readline())
        with open(self.log, "rb") as file:
            return code, file.read().decode("utf-8", "replace")

    def close(self):
        """Ends the process."""
        if self.process is not None:
            self.process.stdin.close()
            self.process.wait()


class Findings:
    """Inputs that did what they must not; each is kept with what was printed."""

    def __init__(self, scratch):
        self.folder = os.path.join(scratch, "findings")
        shutil.rmtree(self.folder, ignore_errors=True)
        self.count = 0
        self.kinds = {}
        self.started = time.monotonic()

    def add(self, kind, name, content, printed):
        """Keeps the first ten of a kind."""
        self.count += 1
        self.kinds[kind] = self.kinds.get(kind, 0) + 1
        if self.kinds[kind] > 10:
            return
        os.makedirs(self.folder, exist_ok=True)
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content)
        with open(path + ".txt", "w", encoding="utf-8") as file:
            file.write(kind + "\n" + printed)
        print(f"FAIL {kind}: {path}")

    def end(self, inputs, what, seed, codes):
        """Last line and exit code."""
        seconds = time.monotonic() - self.started
        ends = ", ".join(f"{count} with {code}" for code, count in sorted(codes.items()))
        print(
            f"{inputs} {what} of seed {seed} in {seconds:.0f} s ({inputs / seconds:.0f} per second): {ends}; "
            f"{self.count} findings"
        )
        sys.exit(1 if self.count or not inputs else 0)


def arguments(doc, inputs, seed=1):
    """SGMP SOURCE_DIR SCRATCH_DIR and how many of which seed."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sgmp")
    parser.add_argument("source")
    parser.add_argument("scratch")
    parser.add_argument("--inputs", type=int, default=inputs)
    parser.add_argument("--seed", type=int, default=seed)
    chosen = parser.parse_args()
    for name in ("sgmp", "source", "scratch"):
        setattr(chosen, name, os.path.abspath(getattr(chosen, name)))
    os.makedirs(chosen.scratch, exist_ok=True)
    return chosen
