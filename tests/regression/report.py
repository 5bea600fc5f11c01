#!/usr/bin/env python3
"""What summary.json, run.log and the terminal say of a run is what was run.

Expected: the deck's own numbers, the tables beside it, sums that must hold.

usage: report.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math
import os
import pty
import re
import subprocess

from _restarts import execute, mpirun
from _restarts import command as command_line
from _runs import ENVIRONMENT, Report, run

DECK = """
title "Two blocks of known size"
units mm g ms
dimension 2
grid cell=0.5 x=0:open y=0:open
wall y-=slip
method gimp update=usf
time cfl=0.25 steps={steps}
gravity (0,-0.001)
material steel elastic density=7.85e-3 young=210 poisson=0.3
body heavy block material=steel lower=(1,0) upper=(4,2) spacing=0.25
body light block material=steel lower=(6,0) upper=(8,2) spacing=0.25
velocity heavy x=0.5
contact all
history steps=5
balance every=3 gain=0
"""
PARTICLES = 12*8 + 8*8
GAS = """material gas explosive density=1e-3 detonation_speed=5
eos gas jwl a=3 b=0.1 r1=4 r2=1 omega=0.3 energy0=0.3
detonation point=(6,0)
"""


def written(result):
    """run.log as text."""
    with open(os.path.join(result.folder, "run.log"), encoding="utf-8") as file:
        return file.read()


def scene(report):
    """Scene, sizes and units."""
    result = run("report", DECK.format(steps=40))
    if not report.finished(result, "report"):
        return
    for key, expected in (
        ("title", "Two blocks of known size"), ("method", "gimp"), ("update", "usf"), ("dimension", 2), ("cfl", 0.25),
        ("h", 0.5), ("spacing", 0.25), ("particles", PARTICLES), ("particles_lost", 0), ("units.length", "mm"),
        ("units.mass", "g"), ("units.time", "ms"), ("steps", 40), ("particle_steps", 40 * PARTICLES), ("ranks", 1),
        ("threads", 1), ("exit_status", 0), ("restarted_from", ""),
    ):
        report.check(result[key] == expected, f"{key}: {result[key]}, expected {expected}")
    last = result.table("history.csv")[-1]
    for key in ("kinetic", "internal", "total"):
        report.check(result[f"energy.{key}"] == last[f"{key}_energy"], f"energy.{key}: {result[f'energy.{key}']}")
    for key in ("external_work", "contact_dissipation", "viscous_dissipation", "interpolation_error"):
        report.check(result[f"energy.{key}"] == last[key], f"energy.{key}: {result[f'energy.{key}']}, {last[key]}")
    report.check(result["energy.remainder"] == last["energy_remainder"], "energy.remainder")
    report.check(result["time"] == last["time"], f"time {result['time']}")
    start = result.table("history.csv")[0]["total_energy"]
    report.check(
        math.isclose(start, 0.5 * 7.85e-3 * 6 * 0.25, rel_tol=1e-12) and result["energy.initial_total"] == start,
        f"energy at the start {start}",
    )
    log = written(result)
    for words in (
        "gimp-usf", "2D", f"{PARTICLES} particles", f"{result['grid_points']} grid points", "Two blocks of known size",
        "40 steps",
    ):
        report.check(words in log, f"run.log does not say {words}:\n{log}")


def costs(report):
    """Seconds add up; nanoseconds per particle and step are seconds over both."""
    result = run("costs", DECK.format(steps=200), threads=2)
    if not report.finished(result, "costs"):
        return
    seconds, percent = result["phase_seconds"], result["phase_percent"]
    report.check(result["threads"] == 2, f"{result['threads']} threads")
    report.check(abs(sum(percent.values()) - 100) < 1e-6, f"phases: {sum(percent.values())} %")
    total = sum(seconds.values())
    report.check(all(abs(percent[k] - 100*seconds[k]/total) < 1e-6 for k in seconds), f"{percent} of {seconds}")
    report.check(
        0 < result["solve_seconds"] < result["wall_seconds"] < 300,
        f"{result['solve_seconds']} of {result['wall_seconds']} s",
    )
    report.check(
        0.98 * result["wall_seconds"] < total <= (1 + 1e-9) * result["wall_seconds"],
        f"phases: {total} of {result['wall_seconds']} s",
    )
    report.check(seconds["start"] > 0 and seconds["end"] > 0, f"phases: {seconds}")
    report.check(
        0 < result["cpu_seconds"] < 2.1 * result["wall_seconds"] + 1,
        f"{result['cpu_seconds']} s of CPU, {result['wall_seconds']} s",
    )
    report.check(
        math.isclose(result["ns_per_particle_step"], 1e9 * result["solve_seconds"] / (200 * PARTICLES), rel_tol=1e-9),
        f"{result['ns_per_particle_step']} ns per particle and step",
    )
    report.check(1e6 < result["peak_memory_bytes"] < 1e9, f"{result['peak_memory_bytes']} bytes")
    log = written(result)
    shares = [float(share) for share in re.findall(r"([\d.]+) %$", log, re.MULTILINE)]
    report.check(
        len(shares) == len(seconds) + 1 and abs(sum(shares) - 100) < 0.06 * len(shares), f"shares {shares}:\n{log}"
    )
    row = re.search(r"^ +200 .*$", log, re.MULTILINE)
    if report.check(row, f"no row of the last step:\n{log}"):
        words = row.group(0).split()
        numbers = [float(word) for word in (words[1], words[2])]
        report.check(abs(numbers[0] - result["time"]) < 1e-4*result["time"], f"row: time {numbers[0]}")
        report.check("100.0" in words and str(result["grid_points"]) in words and "0:00" in words[-1], f"row: {words}")


def ranks(report):
    """Several ranks: what they sent, who is named; memory and seconds of all."""
    name = "ranks"
    result = execute(command_line(name, DECK.format(steps=40)), name, mpirun(2))
    if not report.finished(result, name):
        return
    report.check(
        result["ranks"] == 2 and result["particle_steps"] == 40 * PARTICLES,
        f"{result['ranks']} ranks, {result['particle_steps']}",
    )
    report.check(1 <= result["halo.messages_per_step"] < 40, f"{result['halo.messages_per_step']} messages a step")
    report.check(
        8 < result["halo.bytes_per_step"] / result["halo.messages_per_step"] < 1e6,
        f"{result['halo.bytes_per_step']} bytes a step",
    )
    for key, phase in (("halo.share", "halo"), ("balance.share", "balancing")):
        expected = result["phase_seconds"][phase]/result["solve_seconds"]
        report.check(
            math.isclose(result[key], expected, rel_tol=1e-6, abs_tol=1e-12), f"{key} {result[key]}, {expected}"
        )
    report.check(
        math.isclose(result["halo.seconds_per_step"], result["phase_seconds"]["halo"] / 40, rel_tol=1e-6),
        "halo.seconds_per_step",
    )
    report.check(
        1 <= result["balance.imbalance"] <= result["balance.largest_imbalance"] <= 2,
        f"imbalance {result['balance.imbalance']}",
    )
    log = written(result)
    said = re.search(
        r"^halo: (\S+) messages and (\S+) bytes per step from the rank that sends most$", log, re.MULTILINE
    )
    if report.check("2 ranks x 1 thread" in log and said, f"run.log of two ranks:\n{log}"):
        for word, key in zip(said.groups(), ("messages", "bytes")):
            report.check(
                math.isclose(float(word), result[f"halo.{key}_per_step"], rel_tol=1e-5),
                f"halo: {word} {key}, {result['halo']}",
            )


def levels(report):
    """--quiet is silent, --verbose shows all values of the deck, and neither changes the file."""
    shown = {}
    for level in ("--quiet", "", "--verbose"):
        words = [word for word in command_line("levels", DECK.format(steps=3)) if word != "--quiet"] + [level] * bool(
            level
        )
        done = subprocess.run(
            words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT, check=False, timeout=60
        )
        shown[level] = done.stdout.decode()
        report.check(done.returncode == 0, f"{level}: exit code {done.returncode}")
    said = [
        line
        for line in shown["--quiet"].splitlines()
        if line.strip() and not line.startswith("warning: verdict: coarse: ")
    ]
    report.check(not said, f"--quiet says {shown['--quiet']}")
    report.check("Two blocks of known size" in shown[""] and "growth" not in shown[""], f"normal: {shown['']}")
    report.check("growth" in shown["--verbose"] and "poisson" in shown["--verbose"], f"--verbose: {shown['--verbose']}")


def shown_by(words, errors_too):
    """What a program writes to a terminal; its errors go there, too, or through a pipe as under mpirun."""
    leader, follower = pty.openpty()
    with subprocess.Popen(
        words, stdout=follower, stderr=follower if errors_too else subprocess.PIPE, env=ENVIRONMENT
    ) as process:
        os.close(follower)
        text = b""
        while True:
            try:
                piece = os.read(leader, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            text += piece
        process.communicate(timeout=60)
    os.close(leader)
    return process.returncode, text.decode()


def terminal(report):
    """One line that is rewritten on a terminal; nothing of it in a pipe, nor where mpirun passes on what its terminals
    show."""
    words = [word for word in command_line("terminal", DECK.format(steps=200)) if word != "--quiet"]
    code, text = shown_by(words, True)
    report.check(code == 0 and "\r[" in text and "\033[K" in text and "ETA" in text, f"terminal: {code} {text!r}")
    code, text = shown_by(words, False)
    report.check(code == 0 and "200 steps" in text and "\033" not in text, f"terminal of mpirun: {code} {text!r}")
    for launcher in ([], mpirun(2)):
        done = subprocess.run(
            launcher + words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT, check=False, timeout=60
        )
        text = done.stdout.decode()
        report.check(
            done.returncode == 0 and "200 steps" in text and "\033" not in text,
            f"pipe {launcher}: {done.returncode} {text!r}",
        )


def warnings(report):
    """Gas between walls all round, with methods whose volumes drift; not with an open side, with sgmp, or where nothing
    is gas."""
    box = (
        DECK.format(steps=2)
        .replace("x=0:open y=0:open", "x=0:10 y=0:10")
        .replace("wall y-=slip", "wall x-=slip x+=slip y-=slip y+=slip")
    )
    gas = box.replace("body light block material=steel", GAS + "body light block material=gas")
    for name, deck, warned in (
        ("gas", gas, True), ("mpm", gas.replace("gimp", "mpm"), True), ("solid", box, False),
        ("open side", gas.replace(" y+=slip", ""), False), ("sgmp", gas.replace("method gimp", "method sgmp"), False),
    ):
        words = [word for word in command_line("warned", deck) if word != "--quiet"]
        done = subprocess.run(
            words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT, check=False, timeout=60
        )
        text = done.stdout.decode()
        report.check(
            done.returncode == 0 and ("drift of volumes" in text) == warned,
            f"{name}: exit code {done.returncode}\n{text}",
        )


def threads_chosen(report):
    """Scenes take no more threads than have enough to do, and no more than they may; log and summary say how many and
    why."""
    exact = ENVIRONMENT.pop("SGMP_THREADS")
    blocks = {
        "small": ("sgmp", 6, 2, 1),
        "enough": ("sgmp", 7, 2, 2),
        "may": ("sgmp", 8, 3, 3),
        "some": ("sgmp", 7, 3, 2),
        "wide_small": ("gimp", 4, 2, 1),
        "wide_enough": ("gimp", 5, 2, 2),
    }
    for name, (method, cells, most, expected) in blocks.items():
        result = run("threads_" + name, "block.inp", threads=most, method=method, cells=cells, steps=1)
        if not report.finished(result, name):
            continue
        found = (result["threads"], result["threads_allowed"], result["threads_reason"] != "")
        report.check(found == (expected, most, expected < most), f"{name}: {found}")
        words = f"{expected} of {most} (about {8*cells**3} particles" if expected < most else f" x {expected} threads\n"
        report.check(
            words.replace("1 of", "1 thread of").replace("2 of", "2 threads of") in written(result), f"{name}: {words}"
        )
    for width, expected in ((3, 1), (4, 2)):
        two = run(f"threads_contact_{width}", "two_blocks.inp", threads=2, width=width, length=20, steps=1)
        report.check(two["threads"] == expected, f"contact: {two['threads']} for {two['particles']}, two bodies")
    ENVIRONMENT["SGMP_THREADS"] = "some"
    wrong = run("threads_wrong", "block.inp", cells=4, steps=1)
    report.check(wrong.code == 2 and "SGMP_THREADS='some'" in wrong.text, f"unknown word: {wrong.code} {wrong.text}")
    ENVIRONMENT["SGMP_THREADS"] = exact


def main():
    """All of it."""
    report = Report()
    for part in (scene, costs, ranks, levels, terminal, warnings, threads_chosen):
        part(report)
    report.end()


main()
