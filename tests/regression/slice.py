#!/usr/bin/env python3
"""A slice of space between walls that slip is the plane: with contact, where bodies are curved, and with walls that
rub.

usage: slice.py SGMP SOURCE_DIR SCRATCH_DIR

The reference is the same scene in the plane; particles of all layers must move as those of the plane.
"""
from _runs import Report, run

METHODS = (
    "sgmp", "sgmp stress=plain rotation=plain surfaces=plain", "gimp", "cpgimp update=usavg", "bspline update=usf",
    "mpm",
)
HITS = """dimension {space}
grid cell=0.25 {grid} y=-1:open
wall y-=slip {walls}
method {method}
time end=20 cfl=0.3
material m neo_hookean density=1 young=1 poisson=0.3
body ball {ball} material=m radius=0.75 spacing=0.125
body block block material=m lower=(-2,0{low}) upper=(2,2{high}) spacing=0.125
velocity ball x=0.0334 y=-0.0539
contact all
history steps=50
output csv at=end fields=initial_position,velocity,body
"""
RUBS = """dimension {space}
grid cell=0.25 y=0:open {grid}
wall y-=slip {walls}
wallfriction y- friction=0.2
method {method}
time end=0.5 cfl=0.5
gravity (0.34,-0.94{low})
material m elastic density=1 young=1e2 poisson=0.3
body block block material=m lower=(0,0{low}) upper=(2,1{high}) ppc=2
history steps=50
output csv at=end fields=initial_position,velocity,body
"""


def end_of(report, name, text):
    """Velocities at the end by body and place at the start; those of the layers of a slice together."""
    result = run(name, text)
    found = {}
    if report.finished(result, name):
        for row in result.table("particles_end.csv"):
            found.setdefault((row["body"], round(row["x0"], 6), round(row["y0"], 6)), []).append(
                (row["velocity_x"], row["velocity_y"])
            )
    return found


def compare(report, name, scene, method, allowed):
    """All layers against the plane, over the largest velocity there."""
    plane = end_of(
        report, name + "_plane",
        scene.format(space=2, grid="", walls="", method=method, low="", high="", ball="sphere centre=(-0.25,3.25)"),
    )
    space = end_of(
        report,
        name + "_slice",
        scene.format(
            space=3, grid="z=0:0.5", walls="z-=slip z+=slip", method=method, low=",0", high=",0.5",
            ball="cylinder centre=(-0.25,3.25,0) axis=(0,0,1) length=0.5",
        ),
    )
    report.check(set(plane) == set(space) and len(plane) > 30, f"{name}: other particles")
    largest = max(abs(v) for row in plane.values() for v in row[0])
    worst = max(
        (abs(v - w) for place, row in plane.items() for layer in space.get(place, []) for v, w in zip(row[0], layer)),
        default=0.0,
    )
    report.check(
        worst < allowed * largest,
        f"{name}: particles of the slice move otherwise, by {worst / largest:.3g} of the largest velocity",
    )


def main():
    """All methods."""
    report = Report()
    for method in METHODS:
        word = method.replace(" ", "_").replace("=", "_")
        compare(report, f"hits_{word}", HITS, method, 2e-3)  # the line between bodies is sought to 3e-4 of an angle
        compare(report, f"rubs_{word}", RUBS, method, 1e-12)  # 1.4e-15 measured
    report.end()


main()
