#!/usr/bin/env python3
"""Cells that do not divide the extents of the grid: ends without a wall move outwards, between walls it is said which
cells fit.

What an end that has moved does is known: bodies that stay away from it move as with any other extent, to the bit where
the origin of the grid is the same.

usage: any_cell.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import re
import subprocess

from _runs import ENVIRONMENT, SCRATCH, SGMP, Report, run

DECK = """
parameter h = 0.25
dimension 2
grid cell=h {grid}
wall {walls}
time steps=20 cfl=0.5
material steel elastic density=1 young=1 poisson=0.3
body bar block material=steel lower=(0,-0.5) upper=(1,0.5) spacing=0.125
velocity bar x="0.01*(1-x)" y="0.01*y"
output csv at=end
"""
# extents, walls, cell, extents as the log has them (none: as they are)
MOVED = (
    ("x=0:1.1 y=open", "x-=slip", 0.25, "x=0:1.25 in the place of 0:1.1"),                    # symmetry and an open end
    ("x=0:1.1 y=open", "x+=free x-=slip", 0.3, "x=0:1.2 in the place of 0:1.1"),
    ("x=-0.1:1 y=open", "x+=slip", 0.25, "x=-0.25:1 in the place of -0.1:1"),                 # held by the upper end
    ("x=open y=-1.1:1.1", "x+=free", 0.25, "y=-1.125:1.125 in the place of -1.1:1.1"),        # symmetric, and stays so
    ("x=open y=-1:1.1", "x+=free", 0.25, "y=-1:1.25 in the place of -1:1.1"),
    ("x=open y=-0.6:0.6", "x+=free", 5, "y=-2.5:2.5 in the place of -0.6:0.6"),               # less than a cell
    ("x=0:1.1 y=-1.1:1.1", "x-=slip x+=slip", 0.275, None),
    ("x=0:1.1 y=open", "x-=slip x+=slip", 0.22, None),
)
# extents, walls, cell, what is wrong, what fits
REFUSED = (
    (
        "x=0:1.1 y=open", "x-=slip x+=slip", 0.25, r"cell=0\.25 does not divide 1\.1 between the walls x- and x\+",
        r"cell=0\.275 and cell=0\.22 fit$",
    ),
    ("x=0:1.1 y=open", "x-=slip x+=fixed", 3, r"cell=3 does not divide 1\.1", r"cell=1\.1 fits$"),
    (
        "x=0:1.2 y=-1:1", "x-=slip x+=slip y-=fixed y+=slip", 0.15,
        r"cell=0\.15 does not divide 2 between the walls y- and y\+",
        r"cell=0\.2 and cell=0\.1333333333333 fit all axes between walls$",
    ),
    (
        "x=0:1.1 y=-1:1.34567", "x-=slip x+=slip y-=fixed y+=slip", 0.3, r"cell=0\.3 does not divide 1\.1",
        r"no cell near it fits between the walls of all axes",
    ),
)


def checked(name, deck, cell):
    """What --check says."""
    path = os.path.join(SCRATCH, f"{name}.inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(deck)
    done = subprocess.run(
        [SGMP, path, "--check", "--set", f"h={cell}"], capture_output=True, text=True, check=False, env=ENVIRONMENT
    )
    return done.returncode, done.stdout + done.stderr


def main():
    """All of them."""
    report = Report()
    for k, (grid, walls, cell, words) in enumerate(MOVED):
        deck = DECK.format(grid=grid, walls=walls)
        code, text = checked(f"moved_{k}", deck, cell)
        report.check(
            code == 0 and (f"grid {words}:" in text if words else "in the place of" not in text),
            f"{grid} {walls} cell={cell}\n{text}",
        )
    for k, (grid, walls, cell, wrong, remedy) in enumerate(REFUSED):
        code, text = checked(f"refused_{k}", DECK.format(grid=grid, walls=walls), cell)
        report.check(
            code == 3 and re.search(wrong, text) and re.search(remedy, text, re.M),
            f"{grid} {walls} cell={cell}\n{text}",
        )
        for fits in re.findall(r"cell=(\S+)", text.splitlines()[3]):
            report.check(
                checked(f"fits_{k}", DECK.format(grid=grid, walls=walls), fits)[0] == 0,
                f"{grid} {walls}: cell={fits} fits",
            )
    code, text = checked(
        "axis",
        DECK.replace("dimension 2", "dimension axisymmetric")
        .replace("velocity bar x=\"0.01*(1-x)\" y=\"0.01*y\"", "velocity bar z=1")
        .format(grid="r=0:1.1 z=open", walls="z+=free"),
        0.25,
    )
    report.check(code == 0 and "grid r=0:1.25 in the place of 0:1.1:" in text, f"the axis is held\n{text}")
    # the same bits as with the extent that is a whole number of cells, and a log that says it
    moved = run("moved", DECK.format(grid="x=0:1.1 y=-1.1:1.1", walls="x-=slip"))
    whole = run("whole", DECK.format(grid="x=0:1.25 y=-1.125:1.125", walls="x-=slip"))
    report.check(
        moved.code == 0 and whole.code == 0 and moved["checksum"] == whole["checksum"],
        f"the same bits\n{moved.text}{whole.text}",
    )
    with open(f"{moved.folder}/run.log", encoding="utf-8") as file:
        report.check(file.read().count("in the place of") == 2, "the log says it")
    with open(f"{whole.folder}/run.log", encoding="utf-8") as file:
        report.check("in the place of" not in file.read(), "and nothing else does")
    again = run("moved", DECK.format(grid="x=0:1.1 y=-1.1:1.1", walls="x-=slip"), h=0.2)
    report.check(again.code == 0, f"any other cell\n{again.text}")
    report.end()


if __name__ == "__main__":
    main()
