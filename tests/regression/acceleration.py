#!/usr/bin/env python3
"""Filtered accelerations of `sgmp-view history --cfc`: the filter against its transfer function, a block on a cushion.

Expected: the gain of a Butterworth filter that runs twice, the limits of SAE J211-1, the half sine of a mass on a
spring.

usage: acceleration.py SGMP SOURCE_DIR SCRATCH_DIR
"""

import contextlib
import importlib.util
import io
import json
import math
import os
import pathlib
import subprocess
import sys

from _runs import ENVIRONMENT, SCRATCH, SGMP, SOURCE, Report

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
    print("skipped: numpy and matplotlib are not installed")
    sys.exit(77)
sys.path.insert(0, os.path.join(SOURCE, "python"))
import numpy as np  # noqa: E402
from sgmp_view import command  # noqa: E402
from sgmp_view.acceleration import cfc_filtered  # noqa: E402
from sgmp_view.files import SgmpFileError  # noqa: E402
from sgmp_view.quantities import listed, quantity_of, unit_of  # noqa: E402

# A block of 0.4 g per mm² on a cushion of 1 MPa and 100 mm that is hardly compressed: a spring.
CUSHION = """
units mm g ms
parameter speed = 0.2
dimension 1
grid cell=2 x=0:open
wall x-=fixed
method sgmp stress=plain
time end=25 cfl=0.5
material foam elastic density=0.05e-3 young=1 poisson=0
material metal elastic density=8e-3 young=2000 poisson=0
body cushion block material=foam lower=(0,0,0) upper=(100,0,0) ppc=2
body head block material=metal lower=(100,0,0) upper=(150,0,0) ppc=2
velocity head x=-speed
contact all
history every=0.01
"""


def view(*words):
    """Runs a command in the scratch folder; its exit code and what it prints."""
    printed, code = io.StringIO(), 0
    with contextlib.redirect_stdout(printed):
        try:
            command.main(list(words))
        except SystemExit as end:
            code = end.code
    return (1, printed.getvalue() + code) if isinstance(code, str) else (code or 0, printed.getvalue())


def filters(report):
    """The gain of sines; limits of the standard; no shift in time; constants and lines stay."""
    step = 1e-5
    time = np.arange(0, 0.4, step)
    middle = slice(len(time) // 4, 3 * len(time) // 4)
    for channel_class in (60, 180, 600, 1000):
        for ratio in (0.1, 0.5, 1.0, 1.65, 3.0, 6.0):
            f = ratio * channel_class
            found = cfc_filtered(np.sin(2 * np.pi * f * time), step, channel_class)[middle]
            waves = np.column_stack([np.sin(2 * np.pi * f * time), np.cos(2 * np.pi * f * time)])[middle]
            gain, shifted = np.linalg.lstsq(waves, found, rcond=None)[0]
            omega = math.tan(math.pi * f * step) / math.tan(math.pi * 2.0775 * channel_class * step)
            what = f"CFC {channel_class} at {f:g} Hz: {gain}"
            report.check(abs(gain - 1 / (1 + omega**4)) < 1e-6, f"{what}, expected {1 / (1 + omega**4)}")
            report.check(abs(shifted) < 1e-6, f"{what}: shifted {shifted}")
            decibels = 20 * math.log10(gain)
            limits = {0.1: (-0.5, 0.5), 1.0: (-1, 0.5), 1.65: (-4, 0.5), 6.0: (-100, -30)}.get(ratio)
            if limits:
                report.check(limits[0] <= decibels <= limits[1], f"{what}: {decibels} dB, allowed {limits}")
    line = 3 - 40 * time
    report.check(np.abs(cfc_filtered(line, step, 180) - line).max() < 1e-9, "a line passes, its ends too")
    around = np.arange(-0.2, 0.2, step)
    for length, left in ((0.25, 0.62), (0.6, 0.95)):  # half sines, by the gain of each of their frequencies
        pulse = np.where((around > 0) & (around < length / 180), np.sin(np.pi * around * 180 / length), 0)
        omega = np.tan(np.pi * np.fft.rfftfreq(len(pulse))) / math.tan(math.pi * 2.0775 * 180 * step)
        expected = np.fft.irfft(np.fft.rfft(pulse) / (1 + omega**4), len(pulse)).max()
        found = cfc_filtered(pulse, step, 180).max()
        report.check(
            abs(found - expected) < 1e-6 and abs(found - left) < 0.005, f"half sine: {found}, expected {expected}"
        )
    short = cfc_filtered(np.array([1.0, 1.0, 1.0, 1.0]), step, 60)
    report.check(np.abs(short - 1).max() < 1e-12, f"four rows: {short}")


def cushion(report):
    """A block on a spring: peak and time of the half sine; without a filter the cushion's own waves are on top."""
    with open("cushion.inp", "w", encoding="utf-8") as deck:
        deck.write(CUSHION)
    subprocess.run([SGMP, "cushion.inp", "--quiet", "--output", "cushion.out"], check=True, env=ENVIRONMENT, timeout=60)
    omega = math.sqrt(1 / (100 * (0.4 + 0.005 / 3)))  # 1/ms; a third of the spring's mass moves with the block
    peak = 0.2 * omega * 1000  # m/s²
    code, text = view("history", "cushion.out", "--cfc", "180", "--body", "head", "--json", "cushion.json")
    report.check(code == 0 and "CFC 180" in text and os.path.getsize("cushion.out/acceleration.png") > 1000, text)
    with open("cushion.json", encoding="utf-8") as file:
        result = json.load(file)
    head = result["bodies"]["head"]
    report.check(result["cfc"] == 180 and list(result["bodies"]) == ["head"], f"{result}")
    report.check(abs(head["peak"] - peak) < 0.02 * peak, f"peak {head['peak']} m/s², expected {peak}")
    report.check(abs(head["along"]["x"] - head["peak"]) < 1e-9 and head["along"]["y"] == 0, f"along x alone: {head}")
    report.check(abs(head["peak_g"] - head["peak"] / 9.80665) < 1e-12, "in multiples of g")
    report.check(abs(head["time"] - math.pi / 2 / omega) < 0.5, f"at {head['time']}, expected {math.pi / 2 / omega}")
    report.check(abs(head["force"] - 4e-4 * head["peak"]) < 1e-9, f"force of 0.4 g: {head['force']}")
    for kind, wanted in (("cfc180", head["peak"]), ("unfiltered", None)):
        found = quantity_of("cushion.out", f"acceleration.head.{kind}")
        report.check(found == wanted if wanted else found > 1.05 * peak, f"as a quantity, {kind}: {found}, {wanted}")
    names = list(listed(pathlib.Path("cushion.out")))
    report.check("acceleration.head.cfc180" in names and unit_of("acceleration.head.cfc180", {}) == "m/s²", f"{names}")
    for name in ("acceleration.head.cfc", "acceleration.hed.cfc180"):
        try:
            found = quantity_of("cushion.out", name)
        except SgmpFileError as problem:
            found = str(problem)
        report.check("expected" in str(found) or "no body" in str(found), f"{name}: {found}")
    code, text = view("history", "cushion.out", "--contact", "--cfc", "180", "--json", "contact.json")
    with open("contact.json", encoding="utf-8") as file:
        pair = json.load(file)["pairs"]["cushion head"]
    report.check(
        code == 0 and abs(pair["peak"] - head["force"]) < 0.01 * head["force"], f"Newton: {pair}, {head['force']}"
    )
    change = head["impulse"][0]
    report.check(
        abs(pair["impulse"][0] + change) < 0.01 * abs(change), f"impulse on the cushion: {pair['impulse']}, {change}"
    )
    report.check(
        abs(change - 2 * 4e-4 * 0.2 * 1000) < 0.02 * 0.16, f"the block bounces with its speed: impulse {change}"
    )
    code, text = view("history", "cushion.out", "--acceleration", "--json", "raw.json")
    with open("raw.json", encoding="utf-8") as file:
        raw = json.load(file)["bodies"]
    report.check(
        code == 0 and set(raw) == {"head", "cushion"} and raw["head"]["peak"] > 1.05 * peak, f"not filtered: {raw}"
    )
    for words, saying in (
        (("--cfc", "180", "--body", "q"), "no body 'q'"),
        (("--cfc", "0"), "is not positive"),
        (("--cfc", "1e6"), "rows at most"),
    ):
        code, text = view("history", "cushion.out", *words)
        report.check(code == 1 and saying in text and "Traceback" not in text, f"{words}: {text}")
    with open("cushion.inp", "w", encoding="utf-8") as deck:
        deck.write(CUSHION.replace("units mm g ms\n", "").replace("end=25", "end=0.5"))
    subprocess.run([SGMP, "cushion.inp", "--quiet", "--output", "bare.out"], check=True, env=ENVIRONMENT, timeout=60)
    code, text = view("history", "bare.out", "--cfc", "60")
    report.check(code == 1 and "units" in text, text)


def main():
    """All of it."""
    report = Report()
    os.chdir(SCRATCH)
    filters(report)
    cushion(report)
    report.end()


main()
