#!/usr/bin/env python3
"""Decks of fast scenes that leave cards out (doc/materials.md, Fast scenes): a bird before a wall against Bernoulli,
plates of copper against the Hugoniot, a plate that a shock in water throws off against Taylor, a ball of hot gas
against the largest compression by a shock; a slow scene gets nothing, and the deck's own words win.

usage: fast_scenes.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import csv
import json
import math
import subprocess
import sys
from pathlib import Path

from _runs import Report

BIRD = """
units m kg s
parameter h = 2.5e-3
dimension axisymmetric
grid cell=h r=0:open z=0:open
wall z-=slip
method sgmp
time end=1e-3
material bird fluid density=950
eos bird gruneisen c0=1480 s=2 gamma0=0.1
body bird block material=bird lower=(0,0) upper=(0.05,0.2)
velocity bird z=-120
history steps=10
gauge middle point=(0,0.002) radius=0.008
"""
PLATES = """
units mm g ms
parameter speed = 500
dimension 1
grid cell=0.1 x=open
method sgmp
time end=1e-3
material cu j2 density=8.93e-3 young=117e3 poisson=0.35 yield=90
eos cu gruneisen c0=3940 s=1.49 gamma0=1.99
body left block material=cu lower=-10 upper=0
body right block material=cu lower=0 upper=10
velocity left x=speed
velocity right x=-speed
output csv at=end fields=pressure
"""
FLASH = """
dimension axisymmetric
grid cell=0.05 r=0:2 z=0:2
wall z-=slip z+=slip r+=slip
method sgmp
time end=0.15
material hot fluid density=1
eos hot ideal_gas gamma=1.4 energy0=250
material cold fluid density=1
eos cold ideal_gas gamma=1.4 energy0=2.5
body hot sphere material=hot centre=(0,0) radius=0.4
intersect hot block lower=(0,0) upper=(2,2)
body cold block material=cold lower=(0,0) upper=(2,2)
subtract cold sphere centre=(0,0) radius=0.4
"""
# A shock in water throws off a plate with nothing behind it, at most 10 MPa.
THROWN = """
units mm g ms
parameter h = 1
dimension 1
grid cell=h
time end=0.4
material water fluid density=1e-3
eos water tait c0=1480 exponent=7.15
material steel elastic density=7.85e-3 young=210e3 poisson=0
body water block material=water lower=0 upper=300
body plate block material=steel lower=300 upper=305
pressure water face=x- p="10*exp(-t/0.1)"
history steps=5
"""
# The same on end, under gravity, which is nothing beside the shock.
HEAVY = THROWN.replace("time end", "gravity -9.8e-3\ntime end")
report = Report()
sgmp, scratch = str(Path(sys.argv[1]).resolve()), Path(sys.argv[3])
scratch.mkdir(parents=True, exist_ok=True)


def run(name, text, *sets):
    """Folder and summary of a run."""
    deck = scratch/f"{name}.inp"
    deck.write_text(text, encoding="utf-8")
    folder = scratch/f"{name}.out"
    words = [sgmp, deck, "--quiet", "--threads", "1", "--output", folder]
    done = subprocess.run(words + [word for text in sets for word in ("--set", text)],
                          capture_output=True, text=True, check=False)
    report.check(done.returncode == 0, f"{name}: {done.stderr}")
    return folder, json.loads((folder/"summary.json").read_text(encoding="utf-8"))


def table(path):
    """Columns of a file of rows."""
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {key: [row[key] for row in rows] for key in rows[0]}


def numbers(path, *keys):
    """Some columns as numbers."""
    found = table(path)
    return [[float(text) for text in found[key]] for key in keys]


def bird():
    """The force of a jet on a wall is rho v^2 A, the pressure in its middle rho v^2/2, and nothing is pulled."""
    folder, summary = run("bird", BIRD)
    report.check(summary["volumes"] == "kept", f"bird: volumes {summary['volumes']}")
    time, momentum = numbers(folder/"history.csv", "time", "momentum_z")
    first, last = (min(range(len(time)), key=lambda i, at=at: abs(time[i] - at)) for at in (4e-4, 9e-4))
    force = (momentum[last] - momentum[first])/(time[last] - time[first])
    jet = 950*120**2*3.14159265*0.05**2
    report.check(abs(force/jet - 1) < 0.05, f"bird: force {force/jet:.4f} of rho v^2 A")
    time, pressure = numbers(folder/"gauges.csv", "time", "pressure")
    late = [p for t, p in zip(time, pressure) if t > 6e-4]
    mean = sum(late)/len(late)/(0.5*950*120**2)
    report.check(0.75 < mean < 1.2, f"bird: pressure {mean:.3f} of rho v^2/2")
    report.check(min(pressure) >= 0, f"bird: pressure {min(pressure)}")


def behind(name, *sets):
    """Mean pressure around the plane where plates meet, and the largest anywhere."""
    folder, summary = run(name, PLATES, *sets)
    place, pressure = numbers(folder/"particles_end.csv", "x", "pressure")
    near = [p for x, p in zip(place, pressure) if abs(x) < 1.4]
    return sum(near)/len(near), max(pressure), summary


def plates():
    """Pressure behind the front by the Hugoniot, and how far it is surpassed."""
    hugoniot = 8.93e-3*(3940 + 1.49*500)*500
    mean, most, summary = behind("plates")
    report.check(abs(mean/hugoniot - 1) < 0.015, f"plates: mean {mean/hugoniot:.4f} of the Hugoniot's")
    report.check(most < 1.25*mean, f"plates: peak {most/mean:.3f}")
    report.check(summary["end_state"]["viscous_share"] > 0, "plates: no viscosity")
    summary = behind("slow", "speed=190")[2]
    report.check(not summary["end_state"]["viscous_share"] > 0, "slow plates have got a viscosity")


def thrown():
    """The velocity of the plate by Taylor (1941), until nothing presses on it any more: then it flies on, for water
    bears no tension; a card `failure` that lets it bear some draws the plate back. Sound of little pressure is left
    alone."""
    peak, theta, mass, impedance = 10, 0.1, 5*7.85e-3, 1.48
    z = impedance*theta/mass
    leaves = theta*math.log(z)/(z - 1)

    def taylor(t):
        return 2*peak*theta/(mass*(1 - z))*(math.exp(-z*t/theta) - math.exp(-t/theta))

    plane = THROWN
    for old, new in (("dimension 1", "dimension 2"), ("grid cell=h", "grid cell=h y=0:4\nwall y-=slip y+=slip"),
                     ("lower=0 upper=300", "lower=(0,0) upper=(300,4)"),
                     ("lower=300 upper=305", "lower=(300,0) upper=(305,4)")):
        plane = plane.replace(old, new)
    for name, deck in (("thrown", THROWN), ("thrown_heavy", HEAVY), ("thrown_plane", plane)):
        found = table(run(name, deck)[0]/"bodies.csv")
        times, speeds = ([float(text) for text, body in zip(found[key], found["name"]) if body == "plate"]
                         for key in ("time", "velocity_x"))
        for after, allowed in ((0.02, 0.05), (0.03, 0.03), (leaves, 0.02), (0.12, 0.02), (0.19, 0.02)):
            i = min(range(len(times)), key=lambda i, at=300/1480 + after: abs(times[i] - at))
            exact = taylor(min(after, leaves))
            report.check(abs(speeds[i]/exact - 1) < allowed, f"{name}: {speeds[i]/exact:.4f} of Taylor's after {after}")
    drawn = table(run("drawn", THROWN + "failure water pmin=-50\n")[0]/"bodies.csv")
    report.check(float(drawn["velocity_x"][-1]) < 0.5*taylor(leaves), "drawn: water that bears tension lets go")
    sound = THROWN.replace("body plate", "velocity water x=\"0.1*cos(pi*x/300)\"\nbody plate")
    least = run("whisper", "".join(line for line in sound.splitlines(True) if "pressure" not in line))[1]
    report.check(least["end_state"]["least_pressure"] < -0.05, f"whisper: {least['end_state']['least_pressure']}")


def words():
    """What a deck says stays."""
    text = PLATES + "viscosity all quadratic=0 linear=0\n"
    _, summary = run("bare", text)
    report.check(not summary["end_state"]["viscous_share"] > 0, "a viscosity of nothing is one")
    text = BIRD.replace("method sgmp", "method sgmp volumes=plain") + "failure bird pmin=-50e6\n"
    folder, summary = run("pulled", text, "h=5e-3")
    report.check(summary["volumes"] == "plain", f"pulled: volumes {summary['volumes']}")
    least = summary["end_state"]["least_pressure"]
    pressure = numbers(folder/"gauges.csv", "pressure")[0]
    report.check(min(*pressure, least) < -1e6, f"pulled: least pressure {min(*pressure, least)}, pmin is -50 MPa")


def flash():
    """A shock makes a gas of gamma = 1.4 at most six times as dense; what runs inwards meets in the middle."""
    summary = run("flash", FLASH)[1]
    most = summary["end_state"]["largest_compression"]
    report.check(most < 12, f"flash: {most} times as dense")
    report.check(summary["end_state"]["viscous_share"] > 0, "flash: no viscosity")


def told():
    """--check says what the deck has not, and nothing of it where the deck has."""
    for name, text, count in (("check", BIRD, 2), ("check_given", BIRD + "viscosity all\nfailure bird pmin=0\n", 0)):
        deck = scratch/f"{name}.inp"
        deck.write_text(text, encoding="utf-8")
        done = subprocess.run([sgmp, deck, "--check"], capture_output=True, text=True, check=False)
        report.check(done.stdout.count("  default   ") == count, f"{name}: {done.stdout}{done.stderr}")


bird()
told()
plates()
thrown()
words()
flash()
report.end()
