#!/usr/bin/env python3
"""Puts small faults into src/, one at a time, and sees whether the tests notice.

usage: mutate.py [--sample N] [--seed N] [--files FILE …] [--faults LIST] [--kinds KIND …] [--without TEST …] [--budget
SECONDS]
                 [--jobs N] [--least PART]

All faults of the sample are compiled into one copy of the sources, each behind a switch (SGMP_MUTANT). A first round of
all tests without a fault tells which tests, and which of their runs, come by which fault and how long they take; then
every fault is switched on, and the tests that come by it run until one fails or the budget is used up: first those that
promise most per second, by what they have noticed before. Of a test only the runs that come by the fault are repeated
(recall/). A fault that no test comes by, or that all let pass, has survived. equivalent.txt names those that change
nothing, with the reason.

What was found is kept (build/mutation/memory.json): the same call again goes on where the last one ended, and tries
survivors with tests that have changed or were beyond the budget.

Results: report_*.txt and results_*.json in build/mutation. Exit code 1: less than 85 % noticed (--least), or less than
75 % in an area of 8.
"""
import argparse
import collections
import concurrent.futures
import dataclasses
import functools
import json
import os
import pathlib
import queue
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

import mutants
from memory import Memory, digest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WORK = ROOT / "build" / "mutation"
BUILD = WORK / "tree/build/faults"  # where the program finds the decks that come with it
KINDS = ("unit", "decks", "regression")
LEAST, LEAST_OF_AREA, AREA = 0.85, 0.75, 8
SKIPPED = 77
# Their runs are interrupted or timed: what fails on a busy machine must fail twice.
TIMED = {f"regression_{name}" for name in ("cost", "folder", "hpc", "interrupt", "view")}
COPIES = (
    "CHANGELOG.md", "CMakeLists.txt", "CONTRIBUTING.md", "LICENSE", "README.md", "cmake", "doc", "input", "packaging",
    "python", "scripts", "src", "tests", "verification",
)  # as they are now
# Nothing that a test could see: speed, times of clocks, hints to the system. The program's own file has no module.
LEFT_OUT = re.compile(r"/(main|prefetch|large_pages|timers|process|cost_estimate)\.[fF]90$")


@dataclasses.dataclass
class Test:
    """An entry of ctest."""
    name: str
    kind: str
    command: list
    folder: str
    environment: dict
    passes: list
    state: str                          # of its own files
    seconds: float = 0.0                # of CPU time without a fault, all processes together
    reaches: frozenset = frozenset()
    runs: tuple = ()                    # (seconds, faults) of the runs of the program that can be recalled

    def cost(self, mutant):
        """Seconds that a test takes with a fault: runs that do not come by it are recalled."""
        return max(0.05, self.seconds - sum(seconds for seconds, reaches in self.runs if mutant.number not in reaches))

    def run(self, worker, program, environment):
        """Whether the test passes, on a worker's own scratch folder; its text; the seconds."""
        scratch = WORK / "scratch" / str(worker) / self.name
        scratch.mkdir(parents=True, exist_ok=True)
        command = [str(scratch) if part == self.folder else part for part in self.command]
        recall = {"PYTHONPATH": str(HERE / "recall"), "SGMP_MUTANT_PROGRAM": str(BUILD / "sgmp"),
                  "SGMP_MUTANT_RECORDS": str(WORK / "records" / program / str(worker) / self.name)}
        # CPU time is the measure: other work on the machine is no fault. What waits without end takes none.
        most = int(3.0*self.seconds) + 5 if self.seconds else 3600
        wait = 60.0 + 20.0*self.seconds if self.seconds else 3600.0
        with open(scratch / "output.txt", "w+", encoding="utf-8", errors="replace") as output:
            process = subprocess.Popen(
                command,
                cwd=scratch,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=lambda: prepare(most),
                env={**os.environ, **self.environment, **recall, **environment},
            )
            code, seconds = wait_for(process, wait)
            output.seek(0)
            text = output.read()
        fine = code is not None and (
            any(re.search(p, text) for p in self.passes) if self.passes else code in (0, SKIPPED)
        )
        return fine, text, seconds


def prepare(most):
    """A shell's background job ignores Ctrl-C, and so would the runs that a test interrupts; a limit of CPU time."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_CPU, (most, most + 5))


def wait_for(process, most):
    """Exit code of a process, None if it had to be ended; its CPU seconds and those of what it has started."""
    end, pause = time.monotonic() + most, 0.002
    while time.monotonic() < end:
        ended, status, usage = os.wait4(process.pid, os.WNOHANG)
        if ended:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage.ru_utime + usage.ru_stime
        time.sleep(pause)
        pause = min(0.05, 1.5*pause)
    end_session(process)
    return None, most


def end_session(process):
    """Ends a process and those that it started."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, number)
            process.wait(5)
        except (ProcessLookupError, subprocess.TimeoutExpired):
            continue


# ------------------------------------------------------------------------------------------------ sample and build
def equivalents():
    """(file, part of the statement, change) -> reason"""
    entries = {}
    for line in (HERE / "equivalent.txt").read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            file, text, what, reason = (part.strip() for part in line.split("|", 3))
            entries[file, text, what] = reason
    return entries


def reason_of(mutant, known):
    """Why a mutant changes nothing, if that is known."""
    for (file, text, what), reason in known.items():
        if mutant.file.endswith(file) and text in mutant.was and what in (mutant.what, "any"):
            return reason
    return None


def listed(path):
    """Faults that a file lists: end of the path | part of a statement | what stands there instead | what is wrong | who
    notices."""
    faults, stale = [], []
    for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            file, was, now, what, _ = (part.strip() for part in line.split(" | "))
            file = f"src/{file}"
            try:
                faults.append(mutants.by_hand(file, (ROOT / file).read_text(encoding="utf-8"), was, now, what))
            except (OSError, ValueError) as error:
                stale.append(str(error))
    if stale:
        sys.exit(f"{path} no longer fits the sources:\n  " + "\n  ".join(stale))
    return faults


def draw(files, size, seed):
    """A sample of all mutants of some files, in the order drawn, with some more for those that are no Fortran; how many
    there are."""
    found = [m for file in files for m in mutants.candidates(file, (ROOT / file).read_text(encoding="utf-8"))]
    most = min(len(found), size + size//4 + 5) if size else len(found)
    return numbered(random.Random(seed).sample(found, most)), len(found)


def numbered(chosen):
    """Gives mutants numbers from 1, in the order of their places."""
    for number, mutant in enumerate(sorted(chosen, key=lambda m: (m.file, m.line)), 1):
        mutant.number = number
    return chosen


def make_tree(chosen):
    """A copy of the project whose sources hold the mutants; owners of the lines of each file."""
    tree = WORK / "tree"
    files = [
        path for name in COPIES for path in ([ROOT / name] if (ROOT / name).is_file() else (ROOT / name).rglob("*"))
    ]
    wanted = {path.relative_to(ROOT): path for path in files if path.is_file() and "__pycache__" not in path.parts}
    wanted |= {pathlib.Path("src/base") / name: HERE / name for name in ("mutant.c", "mutant.f90")}
    for path in [path for name in COPIES for path in (tree / name).rglob("*")]:
        if path.is_file() and path.relative_to(tree) not in wanted:
            path.unlink()
    mutated = {m.file for m in chosen}
    for name, path in wanted.items():
        if name.as_posix() not in mutated:
            write_changed(tree / name, path.read_bytes())
    if (ROOT / "build/venv").exists() and not (tree / "build/venv").is_symlink():
        (tree / "build").mkdir(exist_ok=True)
        (tree / "build/venv").symlink_to((ROOT / "build/venv").resolve())
    return {file: write_source(tree, file, chosen) for file in mutated}


def write_changed(path, contents):
    """Writes a file where that changes it, so that the build repeats no more than it must."""
    if not path.is_file() or path.read_bytes() != contents:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(contents)


def write_source(tree, file, chosen):
    """Writes one source with its mutants; line -> mutants there."""
    source = (ROOT / file).read_text(encoding="utf-8")
    text, owners = mutants.with_switches(source, [m for m in chosen if m.file == file], impure_functions())
    write_changed(tree / file, text.encode("utf-8"))
    return owners


@functools.cache
def impure_functions():
    """Names of functions that may have side effects."""
    return mutants.impure_functions(path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.[fF]90"))


def build(chosen, jobs):
    """Builds the copy without those mutants that are no Fortran; returns the others."""
    owners = make_tree(chosen)
    configure = ["cmake", "-S", str(WORK / "tree"), "-B", str(BUILD), "-DCMAKE_BUILD_TYPE=Repro",
                 "-DCMAKE_Fortran_FLAGS=-ffree-line-length-none", "-DCMAKE_Fortran_FLAGS_REPRO=-O2 -ffp-contract=off"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    for _ in range(40):
        done = subprocess.run(["cmake", "--build", str(BUILD), "--parallel", str(jobs), "--", "-k"],
                              capture_output=True, text=True)
        if done.returncode == 0:
            return chosen
        text = done.stdout + done.stderr
        bad = {m.number for path, line in re.findall(r"tree/(src/\S+?):(\d+):\d+(?:-\d+)?:", text)
               for m in owners.get(path, {}).get(int(line), [])}
        if not bad:
            sys.exit(f"the copy does not build:\n{text[-4000:]}")
        files = {m.file for m in chosen if m.number in bad}
        chosen = [m for m in chosen if m.number not in bad]
        for file in files:
            owners[file] = write_source(WORK / "tree", file, chosen)
    sys.exit("the copy does not build after 40 attempts")


def tests_of_build():
    """The entries of ctest that count."""
    listing = subprocess.run(["ctest", "--test-dir", str(BUILD), "--show-only=json-v1"], check=True,
                             capture_output=True, text=True).stdout
    for entry in json.loads(listing)["tests"]:
        properties = {p["name"]: p["value"] for p in entry.get("properties", [])}
        kind = next((label for label in properties.get("LABELS", []) if label in KINDS), None)
        if kind:
            environment = dict(setting.split("=", 1) for setting in properties.get("ENVIRONMENT", []))
            yield Test(entry["name"], kind, entry["command"], properties.get("WORKING_DIRECTORY", ""), environment,
                       properties.get("PASS_REGULAR_EXPRESSION", []), digest(own_files(entry["name"], kind)))


def own_files(name, kind):
    """What a test consists of."""
    folder = ROOT / "tests" / {"decks": "decks"}.get(kind, kind)
    if kind == "unit":
        return [folder / f"{name}.pf", *sorted(folder.glob("support/*"))]
    if kind == "regression":
        return [folder / f"{name.removeprefix('regression_')}.py", *sorted(folder.glob("_*.py"))]
    return sorted(path for path in folder.rglob("*") if path.is_file())


# ------------------------------------------------------------------------------------------------ running
def without_faults(tests, program, memory, jobs):
    """Runs all tests once, where that is not known: which mutants they come by, how long they take. Returns those that
    pass."""
    def first(test, worker):
        known = memory.first_round(test, program)
        if known is None:
            trace = WORK / "scratch" / f"{test.name}.trace"
            for _ in range(2): # a busy machine may fail a test that has to do with time
                trace.unlink(missing_ok=True)
                runs = WORK / "records" / program / str(worker) / test.name / "runs"
                runs.unlink(missing_ok=True)
                fine, text, seconds = test.run(worker, program, {"SGMP_MUTANT": "0", "SGMP_MUTANT_TRACE": str(trace)})
                if fine:
                    break
            else:
                print(f"{test.name} fails without a fault and is left out:\n{text[-2000:]}", flush=True)
                return None
            reaches = {n for n, byte in enumerate(trace.read_bytes()) if byte} if trace.exists() else set()
            lines = [line.split() for line in runs.read_text(encoding="ascii").splitlines()] if runs.exists() else []
            recallable = [(float(line[0]), [int(number) for number in line[1:]]) for line in lines]
            # What was recalled in this round took no time.
            known = {"seconds": max(seconds, sum(run[0] for run in recallable)), "runs": recallable,
                     "reaches": sorted(reaches.union(*(run[1] for run in recallable)))}
            memory.keep_first_round(test, program, known)
        test.seconds, test.reaches = known["seconds"], frozenset(known["reaches"])
        test.runs = tuple((seconds, frozenset(reaches)) for seconds, reaches in known["runs"])
        return test

    (WORK / "scratch").mkdir(parents=True, exist_ok=True)
    return [test for test in in_turns(first, tests, jobs) if test]


def in_turns(work, items, jobs):
    """work(item, worker) of all items on some workers, in the order of the items."""
    workers = queue.Queue()
    for worker in range(jobs):
        workers.put(worker)

    def turn(item):
        worker = workers.get()
        try:
            return work(item, worker)
        finally:
            workers.put(worker)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(turn, items))


def try_mutant(mutant, tests, program, memory, budget, worker):
    """(name of the test that noticed or None, tests that came by and ran, tests left out)"""
    coming = [test for test in tests if mutant.number in test.reaches]
    noticed = next((test.name for test in coming if memory.outcome(mutant, test)), None)
    if noticed:
        return noticed, 1, 0
    coming.sort(key=lambda test: test.cost(mutant)/memory.promise(test, mutant))
    left = 0
    for test in coming:
        if memory.outcome(mutant, test) is False:
            continue
        cost = test.cost(mutant)
        if cost > budget:
            left += 1
            continue
        budget -= cost
        switch = {"SGMP_MUTANT": str(mutant.number), "SGMP_TEST_FIRST_ENDS": "1"}
        fine, _, _ = test.run(worker, program, switch)
        if not fine and test.name in TIMED:
            fine, _, _ = test.run(worker, program, switch)
        memory.keep(mutant, test, not fine)
        if not fine:
            return test.name, 1, 0
    return None, len(coming) - left, left


# ------------------------------------------------------------------------------------------------ the report
def report(results, total, seconds, least):
    """Text of the report, and whether it is good enough."""
    areas = collections.defaultdict(lambda: [0, 0, 0])
    survivors = []
    for mutant, killer, ran, left, reason in results:
        column = 2 if reason else 0 if killer else 1
        areas[mutant.folder][column] += 1
        if column == 1:
            how = (
                f"{ran} tests came by" + (f", {left} more beyond the budget" if left else "")
                if ran + left
                else "no test comes by"
            )
            survivors.append(
                f"{mutant.file}:{mutant.line}: {mutant.what} ({how})\n    {mutant.was.strip()}\n    "
                f"{mutant.now.strip()}"
            )
        elif column == 2:
            survivors.append(f"{mutant.file}:{mutant.line}: {mutant.what} (equivalent: {reason})")
    noticed, survived, same = (sum(area[n] for area in areas.values()) for n in range(3))
    lines = [f"{'area':12} noticed survived equivalent  score"]
    for name, (yes, no, equal) in sorted(areas.items()):
        lines.append(f"{name:12} {yes:7} {no:8} {equal:10} {share(yes, no):6.0%}")
    lines.append(f"{'all':12} {noticed:7} {survived:8} {same:10} {share(noticed, survived):6.0%}")
    lines += ["", f"{len(results)} of {total} possible faults, {seconds:.0f} s", "", *survivors]
    good = share(noticed, survived) >= least and all(
        share(yes, no) >= LEAST_OF_AREA for yes, no, _ in areas.values() if yes + no >= AREA)
    return "\n".join(lines) + "\n", good


def share(yes, no):
    """Part that was noticed."""
    return yes/(yes + no) if yes + no else 1.0


def main():
    """Draws, builds, runs, reports."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sample", type=int, help="number of faults (default 200, with --files all)")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (default 1)")
    parser.add_argument("--files", nargs="*", default=[], help="sources, or folders of them (default src)")
    parser.add_argument("--faults", help="a file that lists faults by hand; with --sample both, else these alone")
    parser.add_argument("--fits", action="store_true", help="only see whether the faults listed still fit the sources")
    parser.add_argument(
        "--kinds", nargs="*", default=list(KINDS), choices=KINDS, help="labels of the tests that run (default all)"
    )
    parser.add_argument("--without", nargs="*", default=[], help="tests that do not run")
    parser.add_argument("--budget", type=float, default=120.0, help="CPU seconds of tests per fault (default 120)")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count(), help="faults at the same time (default: processors)"
    )
    parser.add_argument(
        "--least", type=float, default=LEAST, help="part that must be noticed (default 0.85); small samples scatter"
    )
    options = parser.parse_args()
    if options.fits:
        print(f"{len(listed(options.faults))} faults fit the sources")
        return
    start = time.monotonic()
    places = [ROOT / name for name in options.files or ["src"]]
    files = sorted({p.relative_to(ROOT).as_posix() for place in places
                    for p in ([place] if place.is_file() else place.rglob("*.[fF]90"))})
    files = [file for file in files if not LEFT_OUT.search(file)] if not options.files else files
    size = options.sample or (None if options.files or options.faults else 200)
    drawn, total = draw(files, size, options.seed) if size or options.files else ([], 0)
    by_hand = listed(options.faults) if options.faults else []
    for number, mutant in enumerate(by_hand, len(drawn) + 1):
        mutant.number = number
    memory = Memory(WORK / "memory.json", digest(sorted((ROOT / "src").rglob("*.*"))))
    built = build([m for m in drawn + by_hand if memory.fits(m)], options.jobs)
    memory.keep_unfit(m for m in drawn + by_hand if m not in built)
    chosen = [m for m in drawn if m in built][:size]
    unfit = len(drawn) + len(by_hand) - len(built)
    print(
        f"{len(drawn) + len(by_hand)} faults, {unfit} of them no Fortran; built after {time.monotonic() - start:.0f} s",
        flush=True,
    )
    program = digest(sorted((WORK / "tree/src").rglob("*.*")))
    for old in (WORK / "records").glob("*"):
        if old.name != program:
            shutil.rmtree(old)
    tests = [test for test in tests_of_build() if test.kind in options.kinds and test.name not in options.without]
    tests = without_faults(tests, program, memory, options.jobs)
    print(f"{len(tests)} tests pass without a fault; {time.monotonic() - start:.0f} s", flush=True)
    known = equivalents()

    good = True

    def judge(mutant, worker):
        reason = reason_of(mutant, known)
        killer, ran, left = (
            (None, 0, 0) if reason else try_mutant(mutant, tests, program, memory, options.budget, worker)
        )
        verdict = f"equivalent: {reason}" if reason else killer or "SURVIVED"
        print(f"{mutant.file}:{mutant.line}: {mutant.what}: {verdict}", flush=True)
        return mutant, killer, ran, left, reason

    for title, faults in (("sample", chosen), ("by hand", [m for m in by_hand if m in built])):
        results = sorted(in_turns(judge, faults, options.jobs), key=lambda result: result[0].number)
        if not results:
            continue
        text, fine = report(results, total or len(faults), time.monotonic() - start, options.least)
        good = good and fine
        name = title.replace(" ", "_")
        (WORK / f"report_{name}.txt").write_text(text, encoding="utf-8")
        (WORK / f"results_{name}.json").write_text(json.dumps(
            [{**dataclasses.asdict(m), "noticed_by": killer, "tests": ran, "left_out": left, "equivalent": reason}
             for m, killer, ran, left, reason in results], indent=1))
        print(f"\n{title}\n{text}")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
