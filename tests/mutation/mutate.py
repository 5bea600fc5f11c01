#!/usr/bin/env python3
"""Puts small faults into src/, one at a time, and sees whether the tests notice.

usage: mutate.py [--sample N] [--seed N] [--files FILE …] [--faults LIST] [--kinds KIND …] [--without TEST …] [--budget SECONDS]
                 [--jobs N]

All faults of the sample are compiled into one copy of the sources, each behind a switch (SGMP_MUTANT). A first round of all
tests without a fault tells which tests come by which fault and how long they take; then every fault is switched on, and the
tests that come by it run, unit tests first, the quick ones first, until one fails or the budget is used up. A fault that no
test comes by, or that all let pass, has survived. equivalent.txt names those that change nothing, with the reason.

Results: build/mutation/report.txt and results.json. Exit code 1: less than 85 % noticed, or less than 75 % in an area of 8.
"""
import argparse
import collections
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import queue
import random
import re
import signal
import subprocess
import sys
import time

import mutants

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WORK = ROOT / "build" / "mutation"
KINDS = ("unit", "decks", "regression")
LEAST, LEAST_OF_AREA, AREA = 0.85, 0.75, 8
COPIES = ("CMakeLists.txt", "cmake", "doc", "input", "python", "scripts", "src", "tests", "verification") # as they are now
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
    timeout: float
    seconds: float = 0.0
    reaches: frozenset = frozenset()

    def run(self, worker, environment, timeout):
        """Whether the test passes, on a worker's own scratch folder; its text; the seconds."""
        scratch = WORK / "scratch" / str(worker) / self.name
        scratch.mkdir(parents=True, exist_ok=True)
        command = [str(scratch) if part == self.folder else part for part in self.command]
        start = time.monotonic()
        with open(scratch / "output.txt", "w+", encoding="utf-8", errors="replace") as output:
            process = subprocess.Popen(command, cwd=scratch, stdout=output, stderr=subprocess.STDOUT, start_new_session=True,
                                       preexec_fn=hear_interrupts, env={**os.environ, **self.environment, **environment})
            try:
                code = process.wait(timeout)
            except subprocess.TimeoutExpired:
                code = None
                end_session(process)
            output.seek(0)
            text = output.read()
        fine = code is not None and (any(re.search(p, text) for p in self.passes) if self.passes else code == 0)
        return fine, text, time.monotonic() - start


def hear_interrupts():
    """A shell's background job ignores Ctrl-C, and so would the runs that a test interrupts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


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
    """Faults that a file lists: end of the path | part of a statement | what stands there instead | what is wrong | who notices."""
    for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
        if line.strip() and not line.startswith("#"):
            file, was, now, what, _ = (part.strip() for part in line.split(" | "))
            file = f"src/{file}"
            yield mutants.by_hand(file, (ROOT / file).read_text(encoding="utf-8"), was, now, what)


def draw(files, size, seed):
    """A sample of all mutants of some files."""
    found = [m for file in files for m in mutants.candidates(file, (ROOT / file).read_text(encoding="utf-8"))]
    return numbered(found if size is None or size >= len(found) else random.Random(seed).sample(found, size)), len(found)


def numbered(chosen):
    """Mutants in the order of their places, with numbers from 1."""
    chosen.sort(key=lambda m: (m.file, m.line))
    for number, mutant in enumerate(chosen, 1):
        mutant.number = number
    return chosen


def make_tree(chosen):
    """A copy of the project whose sources hold the mutants; owners of the lines of each file."""
    tree = WORK / "tree"
    files = [path for name in COPIES for path in ([ROOT / name] if (ROOT / name).is_file() else (ROOT / name).rglob("*"))]
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
    text, owners = mutants.with_switches((ROOT / file).read_text(encoding="utf-8"), [m for m in chosen if m.file == file])
    write_changed(tree / file, text.encode("utf-8"))
    return owners


def build(chosen, jobs):
    """Builds the copy without those mutants that are no Fortran; returns the others."""
    owners = make_tree(chosen)
    configure = ["cmake", "-S", str(WORK / "tree"), "-B", str(WORK / "build"), "-DCMAKE_BUILD_TYPE=Repro",
                 "-DCMAKE_Fortran_FLAGS=-ffree-line-length-none"]
    subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    for _ in range(40):
        done = subprocess.run(["cmake", "--build", str(WORK / "build"), "--parallel", str(jobs), "--", "-k"],
                              capture_output=True, text=True)
        if done.returncode == 0:
            return chosen
        text = done.stdout + done.stderr
        bad = {m.number for path, line in re.findall(r"tree/(src/\S+?):(\d+):\d+:", text)
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
    listing = subprocess.run(["ctest", "--test-dir", str(WORK / "build"), "--show-only=json-v1"], check=True,
                             capture_output=True, text=True).stdout
    for entry in json.loads(listing)["tests"]:
        properties = {p["name"]: p["value"] for p in entry.get("properties", [])}
        kind = next((label for label in properties.get("LABELS", []) if label in KINDS), None)
        if kind:
            environment = dict(setting.split("=", 1) for setting in properties.get("ENVIRONMENT", []))
            yield Test(entry["name"], kind, entry["command"], properties.get("WORKING_DIRECTORY", ""), environment,
                       properties.get("PASS_REGULAR_EXPRESSION", []), float(properties.get("TIMEOUT", 600)))


# ------------------------------------------------------------------------------------------------ running
def without_faults(tests, jobs):
    """Runs all tests once: which mutants they come by, how long they take. They must pass."""
    def first(test, worker):
        trace = WORK / "scratch" / f"{test.name}.trace"
        trace.unlink(missing_ok=True)
        fine, text, test.seconds = test.run(worker, {"SGMP_MUTANT": "0", "SGMP_MUTANT_TRACE": str(trace)}, 3*test.timeout)
        if not fine:
            return f"{test.name} fails without a fault:\n{text[-3000:]}"
        test.reaches = frozenset(n for n, byte in enumerate(trace.read_bytes()) if byte) if trace.exists() else frozenset()
        return None

    (WORK / "scratch").mkdir(parents=True, exist_ok=True)
    failures = [text for text in in_turns(first, tests, jobs) if text]
    if failures:
        sys.exit("\n".join(failures))


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


def try_mutant(mutant, tests, budget, worker):
    """(name of the test that noticed or None, tests that came by and ran, tests left out)"""
    coming = sorted((t for t in tests if mutant.number in t.reaches), key=lambda t: (t.kind != "unit", t.seconds))
    spent, ran = 0.0, 0
    for test in coming:
        if test.kind != "unit" and spent + test.seconds > budget:
            break
        spent += test.seconds
        ran += 1
        fine, _, _ = test.run(worker, {"SGMP_MUTANT": str(mutant.number), "SGMP_TEST_FIRST_ENDS": "1"}, 20.0 + 5.0*test.seconds)
        if not fine:
            return test.name, ran, len(coming) - ran
    return None, ran, len(coming) - ran


# ------------------------------------------------------------------------------------------------ the report
def report(results, total, seconds):
    """Text of the report, and whether it is good enough."""
    areas = collections.defaultdict(lambda: [0, 0, 0])
    survivors = []
    for mutant, killer, ran, left, reason in results:
        column = 2 if reason else 0 if killer else 1
        areas[mutant.folder][column] += 1
        if column == 1:
            how = f"{ran} tests came by" + (f", {left} more beyond the budget" if left else "") if ran + left else "no test comes by"
            survivors.append(f"{mutant.file}:{mutant.line}: {mutant.what} ({how})\n    {mutant.was.strip()}\n    {mutant.now.strip()}")
        elif column == 2:
            survivors.append(f"{mutant.file}:{mutant.line}: {mutant.what} (equivalent: {reason})")
    noticed, survived, same = (sum(area[n] for area in areas.values()) for n in range(3))
    lines = [f"{'area':12} noticed survived equivalent  score"]
    for name, (yes, no, equal) in sorted(areas.items()):
        lines.append(f"{name:12} {yes:7} {no:8} {equal:10} {share(yes, no):6.0%}")
    lines.append(f"{'all':12} {noticed:7} {survived:8} {same:10} {share(noticed, survived):6.0%}")
    lines += ["", f"{len(results)} of {total} possible faults, {seconds:.0f} s", "", *survivors]
    good = share(noticed, survived) >= LEAST and all(
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
    parser.add_argument("--faults", help="a file that lists faults by hand, instead of a sample")
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=KINDS, help="labels of the tests that run (default all)")
    parser.add_argument("--without", nargs="*", default=[], help="tests that do not run")
    parser.add_argument("--budget", type=float, default=120.0, help="seconds of regression tests per fault (default 120)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="faults at the same time (default: processors)")
    options = parser.parse_args()
    start = time.monotonic()
    places = [ROOT / name for name in options.files or ["src"]]
    files = sorted({p.relative_to(ROOT).as_posix() for place in places
                    for p in ([place] if place.is_file() else place.rglob("*.[fF]90"))})
    files = [file for file in files if not LEFT_OUT.search(file)] if not options.files else files
    size = options.sample or (None if options.files else 200)
    if options.faults:
        chosen = numbered(list(listed(options.faults)))
        total = len(chosen)
    else:
        chosen, total = draw(files, size, options.seed)
    drawn = len(chosen)
    chosen = build(chosen, options.jobs)
    print(f"{drawn} faults, {drawn - len(chosen)} of them no Fortran; built after {time.monotonic() - start:.0f} s", flush=True)
    tests = [test for test in tests_of_build() if test.kind in options.kinds and test.name not in options.without]
    without_faults(tests, options.jobs)
    print(f"{len(tests)} tests pass without a fault; {time.monotonic() - start:.0f} s", flush=True)
    known = equivalents()

    def judge(mutant, worker):
        reason = reason_of(mutant, known)
        killer, ran, left = (None, 0, 0) if reason else try_mutant(mutant, tests, options.budget, worker)
        verdict = f"equivalent: {reason}" if reason else killer or "SURVIVED"
        print(f"{mutant.file}:{mutant.line}: {mutant.what}: {verdict}", flush=True)
        return mutant, killer, ran, left, reason

    results = in_turns(judge, chosen, options.jobs)
    text, good = report(results, total, time.monotonic() - start)
    (WORK / "report.txt").write_text(text, encoding="utf-8")
    (WORK / "results.json").write_text(json.dumps([{**dataclasses.asdict(m), "noticed_by": killer, "tests": ran, "left_out": left,
                                                    "equivalent": reason} for m, killer, ran, left, reason in results], indent=1))
    print("\n" + text)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
