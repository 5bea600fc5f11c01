#!/usr/bin/env python3
"""Burn round obstacles (doc/theory.md 4): a disk and a ball in the way, turned bodies, a charge of two speeds, straight
lines where they do.

usage: burn.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: the third problem of Kenamond, Bement and Shashkov (2014), and head waves by Snell's law.
"""
import math

from _restarts import mpirun, straight
from _runs import Report, run

HE = """
method sgmp
time dt=1e-9 steps=1
material he explosive density=1 detonation_speed=2
eos he jwl a=1 b=0.1 r1=4 r2=1 omega=0.3 energy0=1
output csv at=end fields=lighting_time
"""
DISK = """
dimension 2
grid cell=0.4
""" + HE + """
body charge block material=he lower=(-10,-10) upper=(10,10) spacing=0.2 rotation=30
subtract charge sphere centre=(0,0) radius=3
detonation point=(0,5)
"""
BALL = """
dimension axisymmetric
grid cell=0.4
""" + HE + """
body charge cylinder material=he axis=(0,1) centre=(0,-8) radius=8 length=16 spacing=0.2
subtract charge sphere centre=(0,0) radius=3
detonation point=(0,5)
"""
BOX = """
dimension 3
grid cell=1
""" + HE + """
body charge block material=he lower=(-6,-6,-8) upper=(6,6,8) spacing=0.5
subtract charge sphere centre=(0,0,0) radius=3
detonation point=(0,0,5)
"""
# A slow charge with a fast cord on top of it, and one that nothing leads to.
LAYERS = """
dimension 2
grid cell=0.2
""" + HE + """
material cord explosive density=1 detonation_speed=6
eos cord jwl a=1 b=0.1 r1=4 r2=1 omega=0.3 energy0=1
body slow block material=he lower=(0,0) upper=(12,1) spacing=0.1
body fast block material=cord lower=(0,1) upper=(12,2) spacing=0.1
body alone block material=he lower=(15,0) upper=(16,1) spacing=0.1
detonation point=(0,0.5)
"""
PLAIN = DISK.replace("subtract charge sphere centre=(0,0) radius=3", "").replace(" rotation=30", "")


def round_disk(across, along):
    """Arrival behind a disk of radius 3 at the origin, speed 2, from a distance of 5."""
    r = math.hypot(across, along)
    turn = math.acos(max(-1.0, min(1.0, along/r))) - math.acos(3/5) - math.acos(min(1.0, 3/r))
    return (math.hypot(across, along - 5) if turn <= 0 else 4 + math.sqrt(max(0.0, r*r - 9)) + 3*turn)/2


def compare(report, name, text, cell, place):
    result = straight(report, name, text)
    rows = result.table("particles_end.csv")
    late = max(row["lighting_time"] - round_disk(*place(row)) for row in rows)
    early = max(round_disk(*place(row)) - row["lighting_time"] for row in rows)
    report.check(late < cell/2, f"{name}: a front is late by {late:.4f}, more than a cell's time {cell/2}")
    report.check(early < 0.1*cell/2, f"{name}: a front is early by {early:.4f}")
    return result


def layers(report):
    result = straight(report, "layers", LAYERS)
    for row in result.table("particles_end.csv"):
        x, y, time = row["x"], row["y"], row["lighting_time"]
        if row["body"] == 1 and x % 1 < 0.1:
            expected = min(math.hypot(x, y - 0.5)/2, x/6 + (0.5 + 1 - y)*math.sqrt(1/4 - 1/36))
            report.check(abs(time - expected) < 0.1, f"layers: ({x}, {y}) is lit at {time}, not {expected}")
        elif row["body"] == 3:
            report.check(abs(time - math.hypot(x, y - 0.5)/2) < 1e-12, f"layers: the charge alone is lit at {time}")


if __name__ == "__main__":
    REPORT = Report()
    compare(REPORT, "disk", DISK, 0.4, lambda row: (row["x"], row["y"]))
    compare(REPORT, "ball", BALL, 0.4, lambda row: (row["x"], row["z"]))
    box = compare(REPORT, "box", BOX, 1.0, lambda row: (math.hypot(row["x"], row["y"]), row["z"]))
    for title, threads, launcher in (("box_threads", 2, ()), ("box_ranks", 1, mpirun(3))):
        other = straight(REPORT, title, BOX, threads=threads, launcher=launcher)
        REPORT.check(
            other["checksum"] == box["checksum"], f"{title}: checksum {other['checksum']}, not {box['checksum']}"
        )
    layers(REPORT)
    for row in run("plain", PLAIN).table("particles_end.csv"):
        if abs(row["x"]) < 0.2:
            expected = math.hypot(row["x"], row["y"] - 5)/2
            REPORT.check(
                abs(row["lighting_time"] - expected) < 1e-14,
                f"a block is lit at {row['lighting_time']}, not {expected}",
            )
    REPORT.end()
