#!/usr/bin/env python3
"""A wall that nothing touches at the start is put a cell farther out: what is slow turns there where the deck has the
wall (doc/loads.md, Bodies near walls); what touches one, flows or is fast has its wall where the deck says.

usage: walls_apart.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import Report, run

# An elastic bar without Poisson's ratio: it rests for an instant when the wave has come back to its middle.
BAR = """
parameter n = 16
parameter v = 0.003
parameter gap = 0.4
parameter d = 1               ! -1: towards the wall on the other side
dimension {space}
grid cell=1/n {grid}
wall {walls} shift=$shift
method $method
time end=2+2*gap/v cfl=0.4
material m elastic density=1 young=1 poisson=0
body a block material=m {block} ppc=2
velocity a {along}=-d*v
history steps=1
"""
SHIFT = "parameter shift = auto\nparameter method = sgmp\n"
SPACES = {
    1: ("x=0:3", "x-=slip x+=slip", "lower=d>0?gap:3-gap-1 upper=d>0?gap+1:3-gap", "x"),
    2: ("x=0:3 y=0:3/n", "x-=slip x+=fixed y-=slip y+=slip",
        "lower=(d>0?gap:3-gap-1,0) upper=(d>0?gap+1:3-gap,3/n)", "x"),
    3: ("x=0:2/n y=0:2/n z=0:3", "x-=slip x+=slip y-=slip y+=slip z-=slip z+=slip",
        "lower=(0,0,d>0?gap:3-gap-1) upper=(2/n,2/n,d>0?gap+1:3-gap)", "z"),
    "axisymmetric": ("r=0:3/n z=0:3", "r+=slip z-=slip z+=slip",
                     "lower=(0,d>0?gap:3-gap-1) upper=(3/n,d>0?gap+1:3-gap)", "z"),
}
FLOOR = """
dimension 2
grid cell=1 x=0:12 y=0:open
wall x-=slip x+=slip y-=slip
method sgmp
time end=20 cfl=0.4
material m elastic density=1 young=1 poisson=0
{more}
body a block material={matter} lower=(2,6) upper=(10,10) ppc=2
velocity a y={speed}
history steps=20
"""
WATER = "material w fluid density=1\neos w gruneisen c0=1 s=2 gamma0=0.1"
report = Report()


def early(result, settings, along):
    """Cells by which a bar turns too early."""
    rows = [row for row in result.table("bodies.csv") if row["name"] == "a"]
    up = settings.get("d", 1)
    turned = next(row["time"] for row in rows if up*row[f"velocity_{along}"] >= 0)
    return 16*0.003*(0.4/0.003 + 1 - turned)


def bars():
    """Within a third of a cell by all methods, in all spaces, at both ends; without the shift three quarters early."""
    for space, (grid, walls, block, along) in SPACES.items():
        deck = SHIFT + BAR.format(space=space, grid=grid, walls=walls, block=block, along=along)
        for settings in ({}, {"d": -1}, {"shift": "none"}) if space != 3 else ({}, {"d": -1}):
            for method in ("sgmp", "gimp", "mpm", "bspline") if space == 1 else ("sgmp",):
                name = f"bar_{space}_{method}_" + "_".join(f"{key}{value}" for key, value in settings.items())
                result = run(name, deck, method=method, **settings)
                if report.finished(result, name):
                    cells = early(result, settings, along)
                    right = 0.6 < cells < 1.2 if "shift" in settings else abs(cells) < 0.33
                    report.check(right, f"{name}: turns {cells:.2f} cells early")


def left_alone():
    """Walls that something touches, liquids, what is fast, other words: as with shift=none."""
    seat = "body b block material=m lower=(2,0) upper=(10,4) ppc=2"
    for name, more, matter, speed, moved in (
        ("flies", "", "m", -0.03, True), ("touched", seat, "m", -0.03, False), ("liquid", WATER, "w", -0.01, False),
        ("fast", "", "m", -0.11, False), ("beside", seat.replace("(2,0)", "(2,0.3)"), "m", -0.03, True),
        ("close", seat.replace("(2,0)", "(2,0.2)"), "m", -0.03, False),
    ):
        deck = FLOOR.format(more=more, matter=matter, speed=speed)
        text = run(f"check_{name}", deck, options=("--check",)).text
        report.check(("wall y- is a cell outside of 0" in text) == moved, f"{name}: {text}")
        result = run(name, deck)
        plain = run(f"{name}_plain", deck.replace("y-=slip", "y-=slip shift=none").replace("x-=slip x+=slip ", ""))
        sides = run(f"{name}_sides", deck.replace("x-=slip x+=slip ", ""))
        if report.finished(result, name) and report.finished(plain, name) and report.finished(sides, name):
            report.check((plain["checksum"] == sides["checksum"]) != moved, f"{name}: shifted or not")
            told = sides["walls_shifted"], plain["walls_shifted"]
            report.check(told == (int(moved), 0), f"{name}: summary.json says {told}")


bars()
left_alone()
report.end()
