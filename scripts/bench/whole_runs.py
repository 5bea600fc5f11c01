#!/usr/bin/env python3
"""What a run takes beside its steps, and how it grows with threads: rows for what bench.py does not measure.

usage: whole_runs.py SGMP [--runs N] [--threads T] [--cells N] [--mpm3d EXECUTABLE] [--prefix COMMAND] [--output DIR]

Rows, each with what was asked for (doc/performance.md, Whole runs):

  start, end       seconds per million particles of a block, one thread and T
  output           seconds for a million particles: CSV, VTKHDF, VTU
  memory           bytes per particle, plain and with corrected surfaces and exact rotation
  Taylor bar       h = 0.38 mm and its default output: the part of the time that T threads do not divide, and what holds
                   it; phases that take more than a hundredth of it
  --check          what it says over what the run takes, short decks of input/ and input/gallery/
  MPM3D-F90        nanoseconds and CPU seconds there over those here (compare_mpm3d.py), where an executable is given

Medians of N runs (3). Writes whole_runs.json.
"""
import argparse
import json
import os
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# Decks of half a second to some ten seconds.
CHECKED = """taylor_bar taylor_bar_axisymmetric block rings tnt_slab vortex rod_plate gallery/dam_break
gallery/ball_plate gallery/cylinder_test gallery/concrete_slab gallery/blast_plate gallery/slope gallery/whipple
gallery/ogive gallery/flyer_spall gallery/cushion gallery/column_collapse""".split()


class Bench:
    """Runs of one executable in a folder of scratch."""

    def __init__(self, options, scratch):
        self.sgmp = str(Path(options.sgmp).resolve())
        self.prefix = shlex.split(options.prefix)
        self.runs, self.threads, self.scratch = options.runs, options.threads, Path(scratch)
        self.rows = []

    def call(self, words):
        """What a command prints; the end where it fails."""
        done = subprocess.run(self.prefix + words, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"whole_runs: {shlex.join(words)}\n{done.stdout}{done.stderr}")
        return done.stdout

    def once(self, deck, threads, sets=(), cards=None):
        """The summary of one run; cards take the place of the deck's output and gauges."""
        path = ROOT/"input"/f"{deck}.inp"
        if cards is not None:
            text = re.sub(r"^(output|gauge)[^\n]*", "", path.read_text(encoding="utf-8"), flags=re.M)
            path = self.scratch/path.name
            path.write_text(text + cards + "\n", encoding="utf-8")
        folder = self.scratch/"out"
        shutil.rmtree(folder, ignore_errors=True)
        words = [self.sgmp, str(path), "--quiet", "--threads", str(threads), "--output", str(folder)]
        done = subprocess.run(self.prefix + words + [word for text in sets for word in ("--set", text)],
                              capture_output=True, text=True, check=False,
                              env={**os.environ, "SGMP_THREADS": "exact"})
        if not (folder/"summary.json").exists():
            sys.exit(f"whole_runs: {shlex.join(words)}\n{done.stdout}{done.stderr}")
        return json.loads((folder/"summary.json").read_text(encoding="utf-8"))

    def median(self, values):
        """Median over the runs of a function without arguments that gives a dictionary of numbers."""
        found = [values() for _ in range(self.runs)]
        return {key: statistics.median(one[key] for one in found) for key in found[0]}

    def row(self, what, value, unit, asked=""):
        """One row: printed and kept."""
        self.rows.append({"what": what, "value": value, "unit": unit, "asked": asked})
        print(f"{what:66s} {value:9.3f} {unit:22s} {asked}", flush=True)


def start_and_end(bench, cells):
    """Seconds per million particles before the first and after the last step."""
    def seconds(threads):
        summary = bench.once("block", threads, [f"cells={cells}", "steps=2"], "")
        return {phase: summary["phase_seconds"][phase]*1e6/summary["particles"] for phase in ("start", "end")}
    for threads, asked in ((1, {}), (bench.threads, {"start": "0.20", "end": "0.15"})):
        for phase, value in bench.median(lambda threads=threads: seconds(threads)).items():
            bench.row(f"{phase}, {threads} thread(s)", value, "s per 10^6 particles", asked.get(phase, ""))


def outputs(bench, cells):
    """Seconds that a file of all particles adds to a run of two steps."""
    cards = {"none": "", "CSV": "output csv at=end fields=stress",
             "VTKHDF": "output vtkhdf fields=stress", "VTU": "output vtu fields=stress"}  # the latter at the start, too

    def seconds():
        found = {}
        for name, card in cards.items():
            summary = bench.once("block", bench.threads, [f"cells={cells}", "steps=2"], card)
            phases = summary["phase_seconds"]
            found[name] = (phases["output"] + phases["end"])*1e6/summary["particles"]
        return {name: (found[name] - found["none"])/(1 if name == "CSV" else 2) for name in cards if name != "none"}
    for name, value in bench.median(seconds).items():
        bench.row(f"output {name}, {bench.threads} thread(s)", value, "s per 10^6 particles",
                  {"CSV": "1.0", "VTKHDF": "0.2"}.get(name, ""))


def memory(bench, cells):
    """Bytes per particle."""
    for name, sets, asked in (("plain scheme", [], ""), ("surfaces=corrected rotation=exact stress=normalised", [
            "surfaces=corrected", "rotation=exact", "stress=normalised"], "150")):
        summary = bench.once("block", 1, [f"cells={cells}", "steps=2", *sets], "")
        bench.row(f"memory, {name}", summary["peak_memory_bytes"]/summary["particles"], "bytes per particle", asked)


def taylor(bench):
    """What threads do not divide: with T threads a run takes T1 ((1 - s)/T + s)."""
    def seconds():
        found = {}
        for threads in (1, bench.threads):
            summary = bench.once("taylor_bar", threads, ["h=0.38"])
            found[str(threads)] = summary["solve_seconds"]
            found.update({f"{phase} {threads}": value for phase, value in summary["phase_seconds"].items()})
        return found
    found = bench.median(seconds)
    one, more = found["1"], found[str(bench.threads)]
    bench.row(f"Taylor bar, h = 0.38 mm: gain of {bench.threads} threads", one/more, "")
    bench.row("  part that threads do not divide", 100*(more*bench.threads/one - 1)/(bench.threads - 1), "%", "2")
    for key, value in found.items():
        phase, _, threads = key.rpartition(" ")
        if threads == "1" and phase and value > 0.01*one:
            bench.row(f"  {phase}: part of the time, 1 thread", 100*value/one, "%")
            bench.row(f"  {phase}: gain of {bench.threads} threads", value/found[f"{phase} {bench.threads}"], "")


def estimates(bench):
    """What --check says of the time of a run over what it takes."""
    close = 0
    for deck in CHECKED:
        def ratio(deck=deck):
            path = ROOT/"input"/f"{deck}.inp"
            said = bench.call([bench.sgmp, str(path), "--check", "--threads", "1"])
            seconds = float(re.search(r"run time +about ([0-9.e+-]+) s ", said).group(1))
            return {"ratio": seconds/bench.once(deck, 1)["solve_seconds"]}
        value = bench.median(ratio)["ratio"]
        close += 1/1.3 <= value <= 1.3
        bench.row(f"--check, {deck}: said over taken", value, "", "0.77 to 1.3")
    bench.row(f"--check: decks of {len(CHECKED)} within 30 %", close, "", str(len(CHECKED)))


def beside_mpm3d(bench, executable):
    """Rows of compare_mpm3d.py, or where to get what is missing."""
    if not executable:
        print("MPM3D-F90: not measured; build https://github.com/xzhang66/MPM3D-F90 and give --mpm3d EXECUTABLE")
        return
    print(bench.call([sys.executable, str(HERE/"compare_mpm3d.py"), bench.sgmp, executable,
                      "--runs", str(bench.runs)]))


def main():
    """All rows, printed and written."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sgmp", help="path of the executable")
    parser.add_argument("--runs", type=int, default=3, help="runs per row (default 3)")
    parser.add_argument("--threads", type=int, default=2, help="threads (default 2)")
    parser.add_argument("--cells", type=int, default=50, help="cells along the block's edge (50)")
    parser.add_argument("--mpm3d", default="", help="an executable of MPM3D-F90")
    parser.add_argument("--only", default="", help="one part: start output memory taylor check mpm3d")
    parser.add_argument("--prefix", default="", help="command to start every run with, such as `taskset -c 2,3`")
    parser.add_argument("--output", default=str(ROOT/"build"/"bench"), help="folder of whole_runs.json")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        bench = Bench(options, scratch)
        parts = {
            "start": lambda: start_and_end(bench, options.cells), "output": lambda: outputs(bench, options.cells),
            "memory": lambda: memory(bench, options.cells), "taylor": lambda: taylor(bench),
            "check": lambda: estimates(bench), "mpm3d": lambda: beside_mpm3d(bench, options.mpm3d),
        }
        print(f"{'what':66s} {'measured':>9s} {'':22s} asked")
        for name, part in parts.items():
            if options.only in name:
                part()
    folder = Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    (folder/"whole_runs.json").write_text(json.dumps(bench.rows, indent=1), encoding="utf-8")
    print(f"written: {folder/'whole_runs.json'}")


if __name__ == "__main__":
    main()
