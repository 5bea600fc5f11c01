#!/usr/bin/env python3
"""Bodies that fly at a rigid frictionless wall: the part of their velocity with which they come back, by finite
elements (elements.py) and by the program; and what a wall that lets go costs (doc/loads.md, Bodies near walls).

    build/venv/bin/python verification/surfaces/recoil.py [SGMP]       # a minute
"""
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from elements import block_nodes, bounce, bounce_yielding, disk

# name, shape, Poisson's ratio, yield stress (0: elastic), velocity; Young's modulus, density and width are 1
BODIES = (
    ("square, Poisson's ratio 0.3", "block lower=(0.3,-0.5) upper=(1.3,0.5)", 0.3, 0, 0.03),
    ("square, 0", "block lower=(0.3,-0.5) upper=(1.3,0.5)", 0.0, 0, 0.03),
    ("disk, 0.3", "sphere centre=(0.8,0) radius=0.5", 0.3, 0, 0.03),
    ("square that yields at 0.02 E", "block lower=(0.3,-0.5) upper=(1.3,0.5)", 0.3, 0.02, 0.0718),
    ("disk that yields at 0.02 E", "sphere centre=(0.8,0) radius=0.5", 0.3, 0.02, 0.0718),
)
WALLS = {
    "lets go": "wall x-=slip", "plane of symmetry": "wall x-=slip shift=none",
    "rigid plate": "body plate block material=m lower=(-0.5,-1) upper=(0,1)\nrigid plate x=0\ncontact all",
}
DECK = """
dimension 2
grid cell=1/{cells}{grid}
method sgmp
time end={end} cfl=0.4
material m {law} density=1 young=1 poisson={poisson}
body a {shape} material=m ppc=3
velocity a x=-{speed}
{wall}
history steps=20
"""
PRICE = """
dimension 3
grid cell=0.05 z=0:open
wall z-=slip{shift}
method sgmp
time end=0.6 cfl=0.4
material m elastic density=1 young=1 poisson=0.3
body a block material=m lower=(0,0,0.1) upper=(1,1,1.1) ppc=2
velocity a z=-0.05
"""


def run(sgmp, deck):
    """The last row of the first body, and the summary."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.inp").write_text(deck)
        subprocess.run([sgmp, "a.inp", "--quiet", "--threads", "1", "--output", "out"], cwd=folder, capture_output=True)
        with open(Path(folder) / "out/bodies.csv", encoding="utf-8") as file:
            last = [row for row in csv.DictReader(file) if row["name"].strip() == "a"][-1]
        return last, json.loads((Path(folder) / "out/summary.json").read_text())


def elements(shape, poisson, strength, speed, n=16):
    """The same by finite elements, n over half of the body."""
    if shape.startswith("block"):
        x, y = np.meshgrid(np.linspace(-1.05, -0.05, 2*n + 1), np.linspace(0, 0.5, n + 1), indexing="ij")
        mesh = block_nodes(x, y)
    else:
        mesh = disk(-0.55, 0.5, n)
    if strength:
        return -bounce_yielding(*mesh, 1.0, 1.0, poisson, strength, speed, 12.0)[0]
    return -bounce(*mesh, 1.0, 1.0, poisson, speed, 8 + 0.1/speed)[-1, 2]


def main():
    sgmp = str(Path(sys.argv[1] if len(sys.argv) > 1 else "build/release/sgmp").resolve())
    print("| body | velocity over c | finite elements | 10 | 20 | 40 cells | "
          "plane of symmetry (20) | rigid plate (20) |")
    for name, shape, poisson, strength, speed in BODIES:
        found = [elements(shape, poisson, strength, speed)]
        for wall, cells in (("lets go", 10), ("lets go", 20), ("lets go", 40), ("plane of symmetry", 20),
                            ("rigid plate", 20)):
            last, _ = run(sgmp, DECK.format(
                cells=cells, grid="" if wall == "rigid plate" else " x=0:open", end=0.6/speed + 8, poisson=poisson,
                law=f"j2 yield={strength}" if strength else "elastic", shape=shape, speed=speed, wall=WALLS[wall]))
            found.append(float(last["velocity_x"])/speed)
        print(f"| {name} | {speed:.2g} | " + " | ".join(f"{back:.3f}" for back in found) + " |", flush=True)
    ratios = []
    for _ in range(3):
        seconds = [run(sgmp, PRICE.format(shift=shift))[1]["solve_seconds"] for shift in ("", " shift=none")]
        ratios.append(seconds[0]/seconds[1])
    print("a wall that lets go over one that does not, solve_seconds of three pairs:", *(f"{r:.3f}" for r in ratios))


main()
