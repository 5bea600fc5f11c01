#!/usr/bin/env python3
"""Nanoseconds per particle and step of the solver on this machine, beside targets and ceilings.

usage: bench.py SGMP [--runs N] [--cells N] [--only TEXT] [--check | --options | --against OTHER [--cpu]]
[--set NAME=VALUE] [--prefix COMMAND] [--output DIR]

In one sitting it measures the machine (multiply-adds from registers, a triad through memory, a plain scalar loop of the
same method: the Fortran programs beside), then every case several times. The median of the solver's own solve_seconds
counts (reading the deck and making the particles does not); beside it stand wall and CPU seconds of the whole process.
Writes results.json and table.md and prints the table; scripts/bench/compare_bench.py puts two results side by side,
--against takes turns with another executable in one sitting (a busy machine then slows both),
scripts/bench/plot_bench.py draws the roofline. How flops and bytes are counted: doc/performance.md.
"""
import argparse
import json
import os
import pathlib
import platform
import re
import resource
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]


BLOCK_NS = 50  # dense elastic block, one thread, of the machine for which the scaled targets are stated


class Case:
    """A scene, its parameters, and what is known of its particles. `targets` are nanoseconds by threads; those of
    `scaled` hold where the dense elastic block takes 50 ns, and grow and shrink with it."""

    def __init__(
        self, name, deck, targets=None, scaled=None, ndim=3, stencil=2, history=1, output=False, ppc=8, block=False,
        cards="", **parameters,
    ):
        # deck: of input/ or of this folder
        self.name, self.deck, self.targets, self.scaled = name, deck, targets or {}, scaled or {}
        self.cards = cards  # lines added to the deck
        self.ndim, self.stencil, self.ppc, self.block, self.output = ndim, stencil, ppc, block, output
        self.history = history  # columns that a particle stores beside its stress
        self.parameters = parameters

    def flops(self):
        """Additions and multiplications of a MUSL step with an elastic law, per particle."""
        d, p = self.ndim, self.stencil**self.ndim
        flux = d*(d + 1)//2
        weights = 8*p
        gather = 2*p*d + 2*p*(d + d*d)
        scatter = 2*p*d + 2*p*(1 + d + flux)
        motion = (8*d + 4) + 5*d + 2*d + 6
        stress = {1: 20, 2: 62, 3: 140}[d]
        q = 2**d
        grid = ((1 + d)*q + d*d*q + 12*d + d*(q + 1) + 2*d*q + d*d*q)/self.ppc
        return weights + gather + scatter + motion + stress + grid

    def bytes(self):
        """Bytes of particle data that the two sweeps read and write, per particle."""
        d = self.ndim
        stream_a, stream_b = 2*d + 1, {1: 3, 2: 4, 3: 6}[d] + self.history
        return 8*((stream_a + d) + (stream_a + stream_b) + (d + stream_b))


def block(name, targets=None, **more):
    """A case of the dense block; history=… tells stored columns beside the stress, the rest goes to the deck."""
    return Case(name, "block.inp", targets, block=True, **more)


SPACES = {"section in the plane": ("2", "xy"), "section of rings": ("axisymmetric", "rz")}


def section(name, material, space):
    """A case of scripts/bench/section.inp."""
    target = {"2": 35, "axisymmetric": 40}[space[0]] if material == "elastic" else None
    dimension, (first, second) = space
    velocity = f'velocity section {first}="5e-3*sin(pi*{first}/edge)" {second}="5e-3*cos(pi*{second}/edge)"'
    return Case(
        name,
        "section.inp",
        scaled={1: target} if target else None,
        ndim=2,
        ppc=4,
        history=4 if material == "impact" else 1,
        cards=velocity,
        material=material,
        space=dimension,
    )


# The targets of the dense block are those of hand-made kernels on one 3.66 GHz Zen 4 core with AVX-512
# (doc/performance.md).
CASES = [
    block("block sgmp elastic", {1: 32, 2: 17}),
    block("block sgmp j2", {1: 32, 2: 17}, history=2, material="j2"),
    block("block sgmp johnson-cook, eos", {1: 48, 2: 26}, history=4, material="impact"),
    block("block mpm elastic", {1: 28, 2: 15}, method="mpm"),
    block("block gimp elastic", {1: 80, 2: 42}, stencil=3, method="gimp"),
    block("block cpgimp elastic", stencil=3, history=4, method="cpgimp"),
    block("block sgmp, 5 % change cell", scaled={1: 75}, drift=0.05),  # whole layers of the lattice in one step of 12
    block("block sgmp, 5 % at random", scaled={1: 75}, drift=0.05, jitter=0.49),  # as many in every step
    block("block sgmp normalised", stress="normalised"),
    Case("taylor bar", "taylor_bar.inp", scaled={1: 65, 2: 36}, history=3, cfl=1.8),
    *(
        Case(
            f"taylor bar, cfl 0.8, {method}",
            "taylor_bar.inp",
            scaled={1: 65, 2: 36} if method == "sgmp" else None,
            stencil=3 if method == "gimp" else 2,
            history=3,
            cfl=0.8,
            method=method,
        )
        for method in ("sgmp", "mpm", "gimp")
    ),
    Case(
        "taylor bar, axisymmetric",
        "taylor_bar_axisymmetric.inp",
        scaled={1: 40},
        ndim=2,
        ppc=4,
        history=3,
        h=0.19,
        cfl=0.8,
    ),
    Case("taylor bar, its output", "taylor_bar.inp", history=3, output=True, cfl=1.8),
    Case("taylor bar, largest step", "taylor_bar.inp", history=3, cfl=2.2),  # of the sound speed
    Case("rings 2D, contact", "rings.inp", scaled={1: 60}, ndim=2, ppc=4, history=5, t_end=0.6, spacing="h/2"),
    Case("bar 1D, 2 per cell", "bar.inp", scaled={1: 25}, ndim=1, ppc=2, cells=4096, steps=300),
    Case("tnt slab 1D, 2 per cell", "tnt_slab.inp", scaled={1: 25}, ndim=1, ppc=2, history=3, h=0.05),
    Case("beam 2D, 4 per cell", "beam.inp", scaled={1: 35}, ndim=2, ppc=4, t_end=0.005),
    Case("tnt on steel 3D", "tnt_steel.inp", history=4),
    Case("charge in air 3D", "charge_air.inp", history=5, t_end=0.01),
    *(
        section(f"{what}, {material}", material, space)
        for material in ("elastic", "impact")
        for what, space in SPACES.items()
    ),
]


# What options cost, as ratios to the plain case: measured with --options on a smaller block, one thread.
OPTIONS = [
    block("plain"),
    block("update=usl", update="usl"),
    block("update=usf", update="usf"),
    block("update=usavg", update="usavg"),
    block("method flip=0.99", cards="flip"),
    block("stress=normalised", stress="normalised"),
    block("gravity", cards="gravity (0,0,-9.81e-3)"),
    block("viscosity", cards="viscosity"),
    block("bodyforce, a formula", cards='bodyforce block x="1e-3*sin(x)"'),
    block("bodyforce, a formula of time", cards='bodyforce block x="1e-3*sin(t)"'),
    block("pressure, a formula of time", cards='pressure block p="1e-3*sin(t)"'),
    block("history every step", cards="history"),
]


def call(prefix, command, threads=1):
    """Standard output of a command, or the end."""
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads))
    done = subprocess.run(prefix + command, capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"bench: {shlex.join(command)}\n{done.stdout}{done.stderr}")
    return done.stdout


def solve(sgmp, case, cells, threads, prefix, scratch):
    """One run of a case; its summary."""
    text = next(folder/case.deck for folder in (ROOT/"input", HERE) if (folder/case.deck).exists()).read_text()
    if not case.output:
        text = re.sub(r"^(output|gauge)[^\n]*", "", text, flags=re.M)
    if case.cards == "flip":
        text = text.replace("stress=$stress", "stress=$stress flip=0.99")
    elif case.cards == "history":
        text = text.replace("history steps=10", "history steps=1")
    deck = pathlib.Path(scratch)/case.deck
    deck.write_text(text + ("" if case.cards in ("flip", "history") else case.cards) + "\n")
    folder = pathlib.Path(scratch)/"out"
    parameters = dict(case.parameters)
    if case.block:
        parameters.update(cells=cells, steps=6 if case.stencil == 3 else 12)
    command = [sgmp, str(deck), "--quiet", "--threads", str(threads), "--output", str(folder)]
    for name, value in parameters.items():
        command += ["--set", f"{name}={value}"]
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    call(prefix, command, threads)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    summary = json.loads((folder/"summary.json").read_text())
    summary["process_wall_seconds"] = time.monotonic() - started
    summary["process_cpu_seconds"] = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    shutil.rmtree(folder)
    return summary


def measure(sgmp, case, threads, options, machine, scratch):
    """Median over several runs of one case, and its ratios to what the machine can do."""
    prefix = shlex.split(options.prefix)
    summaries = [solve(sgmp, case, options.cells, threads, prefix, scratch) for _ in range(options.runs)]
    costs = [summary["ns_per_particle_step"] for summary in summaries]
    best = min(summaries, key=lambda summary: summary["ns_per_particle_step"])
    cost = statistics.median(costs)
    ceiling = machine["ceilings"][str(min(threads, len(machine["ceilings"])))]
    target = case.targets.get(threads)
    if threads in case.scaled:
        target = case.scaled[threads]*machine["block_ns"]/BLOCK_NS
    return {
        "case": case.name, "threads": threads, "particles": best["particles"], "steps": best["steps"],
        "ns_median": cost, "ns_min": min(costs), "ns_max": max(costs), "target": target,
        "solve_wall_seconds": statistics.median(summary["solve_seconds"] for summary in summaries),
        "process_wall_seconds": statistics.median(summary["process_wall_seconds"] for summary in summaries),
        "process_cpu_seconds": statistics.median(summary["process_cpu_seconds"] for summary in summaries),
        "flops": case.flops(), "bytes": case.bytes(),
        "share_of_peak": case.flops()/(cost*ceiling["gigaflops"]),
        "share_of_bandwidth": case.bytes()/(cost*ceiling["gigabytes_per_second"]),
        "gain_over_reference": machine["reference_ns"]/cost,
        "memory_bytes_per_particle": best["peak_memory_bytes"]/best["particles"],
        "phases_percent": best["phase_percent"],
        "checksum": best["checksum"],
    }


def check_reference(sgmp, tools, scratch):
    """Ends where the plain loop does not compute what the solver does."""
    plain = json.loads(call([], [str(tools/"reference"), "8", "19"]))
    scene = Case("check", "block.inp", cells=8, steps=20)
    energy = solve(sgmp, scene, 8, 1, [], scratch)["energy"]
    share = energy["kinetic"]/energy["initial_total"]
    if abs(plain["kinetic_share"] - share) > 1e-6:
        sys.exit(f"bench: the reference loop keeps {plain['kinetic_share']} of the kinetic energy, the solver {share}")


def measure_machine(options, tools, scratch):
    """Ceilings, the dense block by which targets are scaled, and the plain scalar loop - after a look whether it
    computes what the solver does."""
    prefix = shlex.split(options.prefix)
    threads = max(options.threads)
    ceilings = json.loads(call(prefix, [str(tools/"ceilings")], threads))
    reference = json.loads(call(prefix, [str(tools/"reference"), "32", "8"]))
    check_reference(options.sgmp, tools, scratch)
    dense = [
        solve(options.sgmp, CASES[0], options.cells, 1, prefix, scratch)["ns_per_particle_step"]
        for _ in range(options.runs)
    ]
    return {"ceilings": ceilings, "reference_ns": reference["ns"], "block_ns": statistics.median(dense)}


def measure_options(options, scratch):
    """Cost of each option over the plain case, medians of runs that take turns."""
    costs = {case.name: [] for case in OPTIONS}
    for _ in range(options.runs + 2):
        for case in OPTIONS:
            costs[case.name].append(
                solve(options.sgmp, case, min(options.cells, 32), 1, shlex.split(options.prefix), scratch)[
                    "ns_per_particle_step"
                ]
            )
    plain = statistics.median(costs["plain"])
    print("\ncost of options, sgmp elastic, 1 thread")
    for name, values in costs.items():
        print(f"{name:28s} {statistics.median(values):7.1f} ns {statistics.median(values)/plain:6.2f}")


def measure_pairs(options, scratch):
    """Every case by two executables in turns; the median of the ratios pair by pair, and whether both made the same
    particles."""
    other = str(pathlib.Path(options.against).resolve())
    prefix = shlex.split(options.prefix)
    print(f"{'case':28s} th     this    other   ratio: median least most  checksums")
    pairs = []
    for case in CASES:
        for threads in options.threads:
            if options.only not in case.name or (case.ndim == 1 and threads > 1):
                continue
            costs, sums = [], set()
            for turn in range(options.runs):
                couple = {}
                for program in (options.sgmp, other) if turn % 2 else (other, options.sgmp):
                    summary = solve(program, case, options.cells, threads, prefix, scratch)
                    couple[program] = summary["process_cpu_seconds" if options.cpu else "ns_per_particle_step"]
                    sums.add(summary["checksum"])
                costs.append((couple[options.sgmp], couple[other]))
            ratios_of = sorted(this/that for this, that in costs)
            row = {"case": case.name, "threads": threads, "this": statistics.median(cost[0] for cost in costs),
                   "other": statistics.median(cost[1] for cost in costs), "ratio": statistics.median(ratios_of),
                   "least": ratios_of[0], "most": ratios_of[-1], "same": len(sums) == 1}
            pairs.append(row)
            print(
                f"{case.name:28s} {threads:2d} {row['this']:8.2f} {row['other']:8.2f} {row['ratio']:14.3f} "
                f"{row['least']:5.2f}"
                f" {row['most']:4.2f}  {'same' if row['same'] else 'differ'}",
                flush=True,
            )
    folder = pathlib.Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    (folder/"pairs.json").write_text(json.dumps(pairs, indent=1))


def processor():
    """The processor's name, where the system tells."""
    try:
        for line in open("/proc/cpuinfo"):
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor()


def show(row):
    """One line of the table."""
    target = f"{row['target']:6.0f} {row['ns_median']/row['target']:5.2f}" if row["target"] else " "*12
    phases = " ".join(f"{percent:3.0f}" for percent in row["phases_percent"].values())
    print(
        f"{row['case']:28s} {row['threads']:2d} {row['ns_median']:7.1f} {row['ns_min']:7.1f} {target}"
        f" {100 * row['share_of_peak']:5.0f} % {100 * row['share_of_bandwidth']:5.0f} % "
        f"{row['gain_over_reference']:6.1f}"
        f" {row['solve_wall_seconds']:7.2f} {row['process_wall_seconds']:6.2f} {row['process_cpu_seconds']:6.2f}   "
        f"{phases}",
        flush=True,
    )


def markdown(rows):
    """The table of doc/performance.md and README.md."""
    lines = [
        "| case | threads | ns, median (least) | target | ratio | of multiply-add peak | of bandwidth | gain over "
        "plain loop "
        "| solve, wall s | process, wall s | process, CPU s |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        target = f"{row['target']:.0f} | {row['ns_median']/row['target']:.2f}" if row["target"] else " | "
        lines.append(
            f"| {row['case']} | {row['threads']} | {row['ns_median']:.1f} ({row['ns_min']:.1f}) | {target} "
            f"| {100 * row['share_of_peak']:.0f} % | {100 * row['share_of_bandwidth']:.0f} % "
            f"| {row['gain_over_reference']:.1f} | {row['solve_wall_seconds']:.2f} | {row['process_wall_seconds']:.2f} "
            f"| {row['process_cpu_seconds']:.2f} |"
        )
    return "\n".join(lines) + "\n"


def ratios(rows):
    """Targets that are ratios of two figures: (what, value, target)."""
    found = {(row["case"], row["threads"]): row for row in rows}

    def cost(name, threads=1):
        row = found.get((name, threads))
        return row["ns_median"] if row else None

    def per_flop(name):
        row = found.get((name, 1))
        return row["ns_median"]/row["flops"] if row else None

    def divide(a, b):
        return a/b if a and b else None

    dense = cost("block sgmp elastic")
    return [
        entry
        for entry in [
            ("sgmp over mpm, 1 thread", divide(dense, cost("block mpm elastic")), "<= 1.20"),
            (
                "taylor bar over dense block with johnson-cook, eos",
                divide(cost("taylor bar"), cost("block sgmp johnson-cook, eos")), "<= 1.30",
            ),
            ("two threads' efficiency", divide(dense, 2 * (cost("block sgmp elastic", 2) or 0)), ">= 0.92"),
            ("1D over 3D, per flop", divide(per_flop("bar 1D, 2 per cell"), per_flop("block sgmp elastic")), "<= 1.50"),
            (
                "2D over 3D, per flop", divide(per_flop("beam 2D, 4 per cell"), per_flop("block sgmp elastic")),
                "<= 1.50",
            ),
            (
                "rings over bars, elastic",
                divide(cost("section of rings, elastic"), cost("section in the plane, elastic")), "<= 1.15",
            ),
            (
                "rings over bars, johnson-cook, eos",
                divide(cost("section of rings, impact"), cost("section in the plane, impact")), "<= 1.15",
            ),
            (
                "rings with contact, two threads over one",
                divide(cost("rings 2D, contact", 2), cost("rings 2D, contact")), "< 1",
            ),
            ("taylor bar, output on over off", divide(cost("taylor bar, its output"), cost("taylor bar")), ""),
        ]
        if entry[1]
    ]


def main():
    """Measures the machine, then all cases on one and two threads."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sgmp", help="path of the executable")
    parser.add_argument("--runs", type=int, default=3, help="runs per case (default 3)")
    parser.add_argument("--cells", type=int, default=64, help="cells along the dense block's edge (default 64)")
    parser.add_argument(
        "--check", action="store_true", help="see whether the plain loop computes what the solver does, nothing else"
    )
    parser.add_argument("--options", action="store_true", help="measure what options cost, nothing else")
    parser.add_argument("--against", default="", help="another executable: runs take turns, nothing else is measured")
    parser.add_argument(
        "--cpu", action="store_true", help="with --against: CPU seconds of the process, for a machine with other work"
    )
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter of the decks, such as steps=4000"
    )
    parser.add_argument("--only", default="", help="only cases whose name contains this text")
    parser.add_argument("--prefix", default="", help="command to start every run with, such as `taskset -c 2,3`")
    parser.add_argument("--threads", type=int, nargs="*", default=[1, 2], help="numbers of threads (default 1 2)")
    parser.add_argument("--output", default=str(ROOT/"build"/"bench"), help="folder of results.json")
    options = parser.parse_args()
    options.sgmp = str(pathlib.Path(options.sgmp).resolve())
    for case in CASES:
        case.parameters.update(setting.split("=", 1) for setting in options.set)
    rows = []
    if options.check:
        with tempfile.TemporaryDirectory() as scratch:
            check_reference(options.sgmp, pathlib.Path(options.sgmp).parent/"bench", scratch)
        return
    if options.against:
        with tempfile.TemporaryDirectory() as scratch:
            measure_pairs(options, scratch)
        return
    if options.options:
        with tempfile.TemporaryDirectory() as scratch:
            measure_options(options, scratch)
        return
    with tempfile.TemporaryDirectory() as scratch:
        machine = measure_machine(options, pathlib.Path(options.sgmp).parent/"bench", scratch)
        print(f"{processor()}, {os.cpu_count()} processors")
        for threads, ceiling in machine["ceilings"].items():
            print(f"{threads} thread(s): {ceiling['gigaflops']:.1f} Gflop/s of multiply-adds,"
                  f" {ceiling['gigabytes_per_second']:.1f} GB/s (triad)")
        print(
            f"plain scalar loop of sgmp, elastic: {machine['reference_ns']:.0f} ns per particle and step; dense "
            f"block {machine['block_ns']:.1f} ns: "
            f"targets but the block's own are {machine['block_ns'] / BLOCK_NS:.2f} times those for {BLOCK_NS} ns"
        )
        print(
            "\nns per particle and step; seconds: solution (wall), process (wall, CPU); phases in percent: momentum "
            "sweep, stress sweep,"
            " grid, re-binning, output, step limit, halo, balancing, contact, start, end"
        )
        print(f"{'case':28s} th  median   least target ratio    peak  memory   gain   solve   wall    CPU   phases")
        for case in CASES:
            for threads in options.threads:
                if options.only not in case.name or (case.ndim == 1 and threads > 1):
                    continue  # one row of cells is one thread's work
                rows.append(measure(options.sgmp, case, threads, options, machine, scratch))
                show(rows[-1])
    print()
    for what, value, target in ratios(rows):
        print(f"{what:52s} {value:6.2f}  {target}")
    folder = pathlib.Path(options.output)
    folder.mkdir(parents=True, exist_ok=True)
    results = {"processor": processor(), **machine, "rows": rows,
               "ratios": [{"what": what, "value": value, "target": target} for what, value, target in ratios(rows)]}
    (folder/"results.json").write_text(json.dumps(results, indent=1))
    (folder/"table.md").write_text(markdown(rows))
    print(f"written: {folder/'results.json'}, {folder/'table.md'}")


if __name__ == "__main__":
    main()
