#!/usr/bin/env python3
"""What walls, contact and planes through bodies bear: reactions, friction and section forces against closed forms, any
layout, restarts.

usage: reactions.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import contextlib
import importlib.util
import io
import json
import os
import sys
from math import pi

from _restarts import goes_on, mpirun, straight
from _runs import SCRATCH, SOURCE, Report, run

# Into two walls, without gravity: what they give is the change of the momentum, to round-off.
BOUNCING = """
parameter method = sgmp
parameter update = musl
parameter wall = slip
dimension {dimension}
grid cell=0.5 {grid}
wall {walls} reactions=yes
{more}
method $method update=$update
time end=0.5 cfl=0.4
material m elastic density=0.008 young=10 poisson=0.3
body bar block material=m lower=({lower}) upper=({upper})
velocity bar {velocity}
history steps=3
"""
SPACES = {
    "1D": dict(dimension=1, grid="x=0:open", walls="x-=$wall", lower="0.3", upper="3", velocity="x=-2", more=""),
    "plane": dict(
        dimension=2, grid="x=-1:open y=0:open", walls="x-=fixed y-=$wall", lower="-0.9,0.3", upper="2,4",
        velocity='y=-2 x="-1+0.2*y"', more="",
    ),
    "rubbing": dict(
        dimension=2, grid="x=-1:open y=0:open", walls="x-=slip y-=slip", lower="-0.9,0.3", upper="2,4",
        velocity='y=-2 x="-1+0.2*y"', more="wallfriction y- friction=0.4",
    ),
    "space": dict(
        dimension=3, grid="x=open y=-1:open z=0:open", walls="z-=$wall y-=slip", lower="0,-0.8,0.3", upper="2,1,2",
        velocity="z=-2 y=-1 x=0.5", more="",
    ),
    "rings": dict(
        dimension="axisymmetric", grid="r=0:open z=0:open", walls="z-=slip", lower="0,0.3", upper="2,3",
        velocity="z=-2", more="",
    ),
}
WAYS = (
    [(method, "musl") for method in ("sgmp", "mpm", "gimp", "cpgimp", "bspline")]
    + [("sgmp", update) for update in ("usf", "usl", "usavg")]
    + [("gimp", "usavg")]
)
# A bar at rest under its weight: the wall bears it, a plane what is above.
STANDING = """
parameter method = sgmp
dimension {dimension}
grid cell=0.5 {grid}
wall {walls} reactions=yes
method $method
time steps=40 cfl=0.5
gravity ({gravity})
material m elastic density=0.008 young=1000 poisson=0
body bar block material=m lower=({lower}) upper=({upper})
initial_stress bar surface=10
section middle point=({middle}) normal=({normal})
section upper point=({above}) normal=({normal}) body=bar
section twice point=({above}) normal=({normal}) width=1
history steps=1
"""
STANDS = {  # text of the scene, area of the bar, axis of gravity
    "plane": (
        dict(
            dimension=2, grid="x=0:2 y=0:open", walls="x-=slip x+=slip y-=slip", gravity="0,-0.01", lower="0,0",
            upper="2,10", middle="1,5", above="0,7.3", normal="0,1",
        ),
        2.0,
        "y",
    ),
    "space": (
        dict(
            dimension=3, grid="x=0:1 y=0:1 z=0:open", walls="x-=slip x+=slip y-=slip y+=slip z-=slip",
            gravity="0,0,-0.01", lower="0,0,0", upper="1,1,10", middle="0,0,5", above="0,0,7.3", normal="0,0,3",
        ),
        1.0,
        "z",
    ),
    "rings": (
        dict(
            dimension="axisymmetric", grid="r=0:2 z=0:open", walls="r+=slip z-=slip", gravity="0,-0.01", lower="0,0",
            upper="2,10", middle="0,5", above="0,7.3", normal="0,1",
        ),
        4 * pi,
        "z",
    ),
}
# A brick slides on a rigid floor.
SLIDING = """
parameter method = sgmp
dimension 2
grid cell=0.25
method $method
time end=4 cfl=0.5
gravity (0,-0.01)
material m elastic density=0.008 young=100 poisson=0
body floor block material=m lower=(-2,-0.5) upper=(8,0)
body brick block material=m lower=(0,0) upper=(2,1)
rigid floor
velocity brick x=0.02
contact brick floor friction=0.3
section waist point=(0,0.5) normal=(0,1) body=brick
section higher point=(0,0.6) normal=(0,-1) body=brick
history steps=2
"""
# Bent and sheared by the stress of its start, in a plane that is oblique to the axes.
BENT = """
dimension 2
grid cell=0.5
method sgmp
time steps=1 dt=1e-9
material m elastic density=0.008 young=1000 poisson=0
body beam block material=m lower=(0,0) upper=(8,2) spacing=0.125
initial_stress beam xx="3*(y-1)+0.5" xy=0.2
section across point=(4,0) normal=(1,0)
section along point=(0,1) normal=(0,1)
"""


def means(result, name, column):
    """Mean of a column of a section over its rows."""
    rows = [row[column] for row in result.table("sections.csv") if row["name"] == name]
    return sum(rows)/len(rows)


def bouncing(report, space, method, update, wall):
    """Impulses of the walls are the change of the momentum."""
    name = f"bouncing_{space}_{method}_{update}_{wall}"
    result = run(name, BOUNCING.format(**SPACES[space]), method=method, update=update, wall=wall)
    if not report.finished(result, name):
        return
    first, last = result.table("history.csv")[0], result.table("history.csv")[-1]
    size = max(abs(first[f"momentum_{axis}"]) for axis in "xyz")
    for axis in "yz" if space == "rings" else "xyz":
        gained = last[f"momentum_{axis}"] - first[f"momentum_{axis}"]
        given = sum(value for column, value in last.items() if column.endswith(f"impulse_{axis}"))
        report.check(
            abs(gained - given) <= 1e-12 * size, f"{name}: walls give {given} along {axis}, the momentum gains {gained}"
        )
    report.check(
        max(abs(last[column]) for column in last if "impulse" in column) > 0.2 * size, f"{name}: it has met no wall"
    )


def standing(report, space, method):
    """Weight of all on the wall, of what is above on a plane."""
    card, area, axis = STANDS[space]
    name = f"standing_{space}_{method}"
    result = run(name, STANDING.format(**card), method=method)
    if not report.finished(result, name):
        return
    weight, rows = 0.008*area*10*0.01, result.table("history.csv")
    found = (rows[-1][f"wall_{axis}-_impulse_{axis}"] - rows[1][f"wall_{axis}-_impulse_{axis}"]) / (
        rows[-1]["time"] - rows[1]["time"]
    )
    report.check(abs(found/weight - 1) < 1e-3, f"{name}: the wall bears {found} of {weight}")
    for section, share in (("middle", 0.5), ("upper", 0.27), ("twice", 0.27)):
        force = means(result, section, f"force_{axis}")
        report.check(abs(force/(-share*weight) - 1) < 2e-3, f"{name}: {section} bears {force} of {-share*weight}")
        report.check(
            abs(means(result, section, "area") / area - 1) < 1e-6,
            f"{name}: area {means(result, section, 'area')} of {area}",
        )


def sliding(report, method):
    """Friction is Coulomb's part of what presses."""
    result = run(f"sliding_{method}", SLIDING, method=method)
    if not report.finished(result, f"sliding_{method}"):
        return
    rows = result.table("contact.csv")
    impulse = {
        key: sum(b[key] * (b["time"] - a["time"]) for a, b in zip(rows, rows[1:]))
        for key in ("force_x", "force_y", "friction_x", "friction_y")
    }
    weight = 0.008*2*0.01
    report.check(
        abs(impulse["force_y"] / (4 * weight) - 1) < 5e-3,
        f"sliding, {method}: weight {impulse['force_y']} of {4 * weight}",
    )
    report.check(
        abs(impulse["friction_x"] / (-0.3 * impulse["force_y"]) - 1) < 2e-3,
        f"sliding, {method}: friction {impulse['friction_x']}",
    )
    report.check(
        abs(impulse["friction_x"] - impulse["force_x"]) < 1e-3 * weight and abs(impulse["friction_y"]) < 1e-3 * weight,
        f"sliding, {method}: the rest presses {impulse}",
    )
    for section, share in (("waist", -0.5), ("higher", 0.4)):
        force = means(result, section, "force_y")
        # a brick of four cells; normalised and corrected stresses are not those of the particles
        report.check(
            abs(force / (share * weight) - 1) < (0.08 if method == "sgmp" else 0.02),
            f"sliding, {method}: {section} bears {force} of {share * weight}",
        )


def bent(report):
    """Normal force, shear, moment of a linear stress, of a lattice of 16 rows: h^3/12 (1 - 1/16^2)."""
    result = run("bent", BENT)
    report.finished(result, "bent")
    expected = {"across": dict(area=2, x=4, y=1, force_x=1, force_y=0.4, moment_z=-3*8/12*(1 - 1/256), moment_x=0),
                "along": dict(area=8, x=4, y=1, force_x=1.6, force_y=0, moment_z=0)}
    for section, values in expected.items():
        first = next(row for row in result.table("sections.csv") if row["name"] == section)
        for column, value in values.items():
            report.check(
                abs(first[column] - value) < 1e-9, f"bent: {column} of {section} is {first[column]}, not {value}"
            )


def layouts(report):
    """The same bits of all tables with threads, ranks, after a restart."""
    text = (
        BOUNCING.format(**SPACES["rubbing"])
        + "section low point=(0,1.1) normal=(1,2)\ncontact bar lid friction=0.3\n"
        + "body lid block material=m lower=(-0.9,4) upper=(2,5)\nvelocity lid y=-3\ncheckpoint every=10 keep=99\n"
    )
    whole = straight(report, "whole", text)
    for name, how in (("threads", dict(threads=2)), ("ranks", dict(launcher=mpirun(2)))):
        other = straight(report, f"whole_{name}", text, **how)
        for table in ("history.csv", "sections.csv", "contact.csv"):
            with open(f"{whole.folder}/{table}", encoding="utf-8") as a, open(
                f"{other.folder}/{table}", encoding="utf-8"
            ) as b:
                report.check(a.read() == b.read(), f"{table} has other bits with {name}")
    goes_on(report, whole, "whole_again", text, 20)


def viewed(report):
    """What sgmp-view makes of the tables."""
    if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
        return
    sys.path.insert(0, os.path.join(SOURCE, "python"))
    from sgmp_view import command
    from sgmp_view.energies import energies
    from sgmp_view.files import folder_of
    from sgmp_view.quantities import quantity_of
    units = "units mm g ms\n"
    standing_run = run("viewed_standing", units + STANDING.format(**STANDS["plane"][0]), method="gimp")
    sliding_run = run("viewed_sliding", units + SLIDING, method="gimp")
    weight = 0.008*2*10*0.01*1e-3  # N
    for result, word, name, along, value in (
        (standing_run, "--walls", "wall y-", "y", weight),
        (standing_run, "--sections", "section upper", "y", -0.27 * weight),
        (sliding_run, "--contact", "brick floor, friction", "x", -0.3 * 0.008 * 2 * 0.01 * 1e-3),
    ):
        path = os.path.join(SCRATCH, f"viewed_{word[2:]}.json")
        with contextlib.redirect_stdout(io.StringIO()):
            command.main(["history", result.folder, word, "--json", path])
        with open(path, encoding="utf-8") as file:
            found = next(
                peaks
                for kind in json.load(file).values()
                if isinstance(kind, dict)
                for key, peaks in kind.items()
                if key == name
            )
        impulse = found["impulse"]["xyz".index(along)]
        span = (result.table("history.csv")[-1]["time"])
        report.check(abs(impulse/(value*span) - 1) < 0.05, f"{name}: impulse {impulse} of {value*span}")
    time, series = energies(folder_of(sliding_run.folder))
    last = sliding_run.table("history.csv")[-1]
    whole = sum(both[0][-1] for name, both in series.items() if name.startswith("material"))
    report.check(
        list(series) == ["body floor", "body brick", "material m"]
        and abs(whole / last["kinetic_energy"] - 1) < 1e-12
        and len(time) > 100,
        f"energies by body and material {list(series)} {whole}",
    )
    report.check(
        abs(quantity_of(standing_run.folder, "sections.upper.force_y:mean") / (-0.27 * weight * 1e3) - 1) < 1e-2,
        "a section is a quantity of sgmp-view",
    )


def main():
    report = Report()
    for space in SPACES:
        for method, update in WAYS if space in ("plane", "rubbing") else WAYS[:1] + WAYS[2:3]:
            for wall in ("slip", "fixed") if space not in ("rubbing", "rings") else ("slip",):
                bouncing(report, space, method, update, wall)
    for space in STANDS:
        for method in ("sgmp", "gimp", "mpm", "bspline") if space == "plane" else ("sgmp",):
            standing(report, space, method)
    for method in ("sgmp", "gimp"):
        sliding(report, method)
    bent(report)
    layouts(report)
    viewed(report)
    report.end()


if __name__ == "__main__":
    main()
