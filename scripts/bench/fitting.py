#!/usr/bin/env python3
"""Bodies whose sizes are no multiples of their particles: mass and stiffness with whole cubes and by default.

usage: fitting.py SGMP

Prints the tables of doc/user-guide.md, Particles and shapes: mass over that of the shapes, for bodies of random size;
the frequency of a cantilever over that of a slender beam; how far it bends under a pressure over Timoshenko's beam.
Then the seconds that a run of one step takes to start with a million particles in a ball and in a block.
"""
import csv
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile

BODIES = {
    "ball in 3D": (3, "sphere material=m centre=(0,0,0) radius={}", lambda r: 4/3*math.pi*r**3),
    "ball about the axis": ("axisymmetric", "sphere material=m centre=(0,0) radius={}", lambda r: 4/3*math.pi*r**3),
    "disk in the plane": (2, "cylinder material=m centre=(0,0) radius={}", lambda r: math.pi*r*r),
    "plate in 3D": (3, "block material=m lower=(0,0,0) upper=(12.3,11.1,{})", lambda r: 12.3*11.1*r),
    "cone in 3D": (
        3, "cone material=m centre=(0,0,0) radius={} top=0.3 length=9.2",
        lambda r: math.pi*9.2*(r*r + 0.3*r + 0.09)/3,
    ),
}
MASS = """dimension {dimension}
grid cell=1
time steps=1
material m elastic density=1 young=1 poisson=0.3
body b {card} fit={fit}
"""
BEAM = """dimension 2
grid cell=1 x=0:open
wall x-=fixed
time end=40
material m elastic density=1e-3 young=1000 poisson=0.3
body b block material=m lower=(0,0) upper=(40,{thick}) fit={fit}
velocity b y="1e-3*x^2/1600"
history every=0.02
gauge tip point=(39.9,{middle})
"""
BENT = """dimension 2
grid cell=1 x=0:open y=-10:open
wall x-=fixed
time end=1500
material m elastic density=1 young=1000 poisson=0.25
body b block material=m lower=(0,0) upper=(40,{thick}) fit={fit}
pressure b face=y+ p=0.002*min(t/200,1)
damping kinetic=yes
output csv at=end fields=displacement
"""
FITS = ("cubes", "shape")


def deck_of(folder, text):
    """Writes a deck."""
    path = pathlib.Path(folder, "fitting.inp")
    path.write_text(text, encoding="utf-8")
    return str(path)


def masses(sgmp, folder):
    """Errors of the mass."""
    random.seed(3)
    for name, (dimension, card, volume) in BODIES.items():
        for low, high in ((2, 4), (4, 8)):
            errors = {fit: [] for fit in FITS}
            for _ in range(20):
                size = round(random.uniform(low, high), 3)
                for fit, found in errors.items():
                    deck = deck_of(folder, MASS.format(dimension=dimension, card=card.format(size), fit=fit))
                    said = subprocess.run(
                        [sgmp, deck, "--check"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True,
                        text=True,
                    ).stdout
                    found.append(float(re.search(r"mass +([-+.\deE]+);", said).group(1))/volume(size) - 1)
            words = (
                f"{fit} {100*math.sqrt(sum(e*e for e in found)/len(found)):.2f} % ({100*max(map(abs, found)):.2f})"
                for fit, found in errors.items()
            )
            print(f"{name}, {low} to {high} cells:", *words)


def frequency(sgmp, folder, thick, fit):
    """Of a cantilever of 40 cells, from where its tip passes its first place."""
    deck = deck_of(folder, BEAM.format(thick=thick, middle=thick/2, fit=fit))
    output = pathlib.Path(folder, "beam")
    subprocess.run([sgmp, deck, "--quiet", "--output", str(output)], stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL, check=True)
    with open(output/"gauges.csv", encoding="utf-8") as file:
        rows = [(float(row["time"]), float(row["y"])) for row in csv.DictReader(file)]
    start = rows[0][1]
    passes = [
        t - (y - start)*(u - t)/(z - y) for (t, y), (u, z) in zip(rows[1:], rows[2:]) if (y - start)*(z - start) < 0
    ]
    return (len(passes) - 1)/2/(passes[-1] - passes[0])


def beams(sgmp, folder):
    """Errors of the frequency beside Euler and Bernoulli's, plane strain."""
    for thick in (2.7, 3.2, 4.0, 4.1, 4.2, 4.3, 4.4, 4.5, 4.8, 5.0):
        slender = 1.875104**2/(2*math.pi*40**2)*math.sqrt(1000/(1 - 0.3**2)*thick**2/12/1e-3)
        words = (f"{fit} {100*(frequency(sgmp, folder, thick, fit)/slender - 1):+.1f} %" for fit in FITS)
        print(f"cantilever {thick} cells thick:", *words)


def deflection(sgmp, folder, thick, fit):
    """Of the tip of a cantilever of 40 cells that a pressure of 0.002 has bent."""
    output = pathlib.Path(folder, "bent")
    subprocess.run([sgmp, deck_of(folder, BENT.format(thick=thick, fit=fit)), "--quiet", "--output", str(output)],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
    with open(output/"particles_end.csv", encoding="utf-8") as file:
        rows = [(float(row["x"]), -float(row["displacement_y"])) for row in csv.DictReader(file)]
    last = max(x for x, _ in rows)
    tip = [way for x, way in rows if x > last - 0.3]
    return sum(tip)/len(tip)


def bent_beams(sgmp, folder):
    """Errors of the deflection beside Timoshenko's, plane strain."""
    for thick in (3.0, 3.2, 3.4, 3.6, 3.8, 4.0, 4.2, 4.3, 4.7, 5.0):
        exact = 0.002*40**4/8/(1000/(1 - 0.25**2)*thick**3/12) + 0.002*40**2/2/(1000/2/1.25*thick*5/6)
        words = (f"{fit} {100*(deflection(sgmp, folder, thick, fit)/exact - 1):+.1f} %" for fit in FITS)
        print(f"pressed cantilever {thick} cells thick:", *words)


def starts(sgmp, folder):
    """Seconds of the start with a million particles, one thread, medians of three."""
    for name, card in (
        ("ball", "sphere material=m centre=(0,0,0) radius=31"),
        ("block", "block material=m lower=(0,0,0) upper=(50,50,50)"),
    ):
        seconds = {fit: [] for fit in FITS}
        for _ in range(3):
            for fit, found in seconds.items():
                output = pathlib.Path(folder, "start")
                deck = deck_of(folder, MASS.format(dimension=3, card=card, fit=fit))
                subprocess.run([sgmp, deck, "--quiet", "--threads", "1", "--output", str(output)], check=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                summary = json.loads(pathlib.Path(output, "summary.json").read_text(encoding="utf-8"))
                found.append(summary["phase_seconds"]["start"])
        words = (f"{fit} {sorted(found)[1]:.2f} s" for fit, found in seconds.items())
        print(f"start, a million particles in a {name}:", *words)


def main():
    """All of it."""
    sgmp = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        masses(sgmp, folder)
        beams(sgmp, folder)
        bent_beams(sgmp, folder)
        starts(sgmp, folder)


if __name__ == "__main__":
    main()
