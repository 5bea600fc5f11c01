#!/usr/bin/env python3
"""`sgmp-view impact` and `sgmp-view fragments` on dumps with holes, craters, bulges and fragments that are known.

Expected: the shapes from which the dumps are made, closed forms of volumes and speeds, clusters by comparing all pairs.

usage: impact.py SGMP SOURCE_DIR SCRATCH_DIR
"""

import argparse
import contextlib
import importlib.util
import io
import json
import os
import sys
from pathlib import Path
from types import SimpleNamespace

from _runs import SCRATCH, SOURCE, Report, run

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
    print("skipped: numpy and matplotlib are not installed")
    sys.exit(77)
sys.path.insert(0, os.path.join(SOURCE, "python"))
import numpy as np  # noqa: E402
from _dumps import Cloud, lattice, write_run  # noqa: E402
from sgmp_view import command  # noqa: E402
from sgmp_view.files import SgmpFileError, read_units  # noqa: E402
from sgmp_view.matter import planes_of, shares_of  # noqa: E402
from sgmp_view.picture import loose_of, section_of  # noqa: E402
from sgmp_view.pieces import pieces_of  # noqa: E402
from sgmp_view.quantities import keep_impact, quantity_of, unit_of  # noqa: E402

# Aluminium on aluminium: a disc of 2 mm hits a plate of 4 mm.
SPALL = """
parameter pmin = -1100
units mm g ms
dimension axisymmetric
grid cell=0.5 r=0:open
method sgmp
time end=0.003 cfl=0.4
material al j2 density=2.7e-3 young=70e3 poisson=0.33 yield=100
eos al gruneisen c0=5240 s=1.4 gamma0=1.97
failure al pmin=pmin
viscosity al
body flyer cylinder material=al centre=(0,0) axis=(0,1) radius=12 length=2 spacing=0.25
body plate cylinder material=al centre=(0,-4) axis=(0,1) radius=20 length=4 spacing=0.25
velocity flyer z=-300
contact all
output vtu every=0.001 fields=damage,mass
"""
S, H = 0.5, 1.0  # spacing, cell
TOP, BOTTOM = 0.0, -4.0  # of the plate; the shot goes along -z


def view(*words):
    """Runs a command in the scratch folder; its exit code and what it prints."""
    printed = io.StringIO()
    code = 0
    with contextlib.redirect_stdout(printed):
        try:
            command.main(list(words))
        except SystemExit as end:
            code = end.code
    if isinstance(code, str):
        return 1, printed.getvalue() + code
    return code or 0, printed.getvalue()


def near(report, found, expected, tolerance, what):
    """Notes a number that is off."""
    return report.check(abs(found - expected) <= tolerance, f"{what}: {found}, expected {expected} within {tolerance}")


def measured(report, name, start, now, *options, **how):
    """Writes a run of two dumps, measures it; the first wall."""
    folder = os.path.join(SCRATCH, name)
    write_run(folder, [(0, start), (1, now)], spacing=S, cell=H, **how)
    code, text = view("impact", folder, "--json", folder + ".json", *options)
    if not report.check(code == 0, f"{name}: {text}"):
        sys.exit(1)
    with open(folder + ".json", encoding="utf-8") as file:
        result = json.load(file)
    result["walls"][0]["text"] = text
    result["walls"][0]["notes"] = result["notes"]
    return result["walls"][0]


def plate(half=15.0):
    """A square plate."""
    return lattice((-half, -half, BOTTOM), (half, half, TOP), S)


def ball(velocity=(0, 0, -100)):
    """What flies: a cube above the plate."""
    return Cloud(lattice((-1, -1, 1), (1, 1, 3), S), velocity)


def passed():
    """The same behind the plate, at half the speed."""
    return Cloud(lattice((-1, -1, -20), (1, 1, -18), S), (0, 0, -50))


def holes(report):
    """A round hole of known radius: whole, of a quarter, with the plate turned; two holes that do not meet."""
    points, radius = plate(), 6.0
    hole = np.hypot(points[:, 0], points[:, 1]) < radius
    start = {"ball": ball(), "plate": Cloud(points)}
    wall = measured(report, "hole", start, {"ball": passed(), "plate": Cloud(points).kept(~hole)})
    report.check(wall["perforated"] and wall["openings"] == 1 and wall["hit"], f"a hole: {wall}")
    near(report, wall["opening"]["diameter"], 2 * radius, S, "its diameter by area")
    near(report, wall["opening"]["circle"], 2 * radius, H, "the largest circle in it")
    near(report, wall["opening"]["area"], np.pi * radius**2, 2 * np.pi * radius * S / 2, "its area")
    near(report, wall["cloud"]["mass"], 8.0, 1e-9, "mass behind the wall")
    near(report, wall["cloud"]["momentum"], 400.0, 1e-6, "momentum behind the wall")
    near(report, wall["mass_left"], 30 * 30 * 4 - hole.sum() * S**3, 1e-9, "mass of the wall")
    struck = wall["shot"]["ball"]
    report.check(struck["through"] and struck["speed"] == 50, f"what has passed: {struck}")
    report.check("perforated:                             yes: opening of 1" in wall["text"], wall["text"])

    quarter = {name: cloud.kept((cloud.points[:, 0] > 0) & (cloud.points[:, 1] > 0)) for name, cloud in start.items()}
    for cloud in quarter.values():
        cloud.ids = np.arange(1, len(cloud.points) + 1)
    gone = np.hypot(*quarter["plate"].points[:, :2].T) < radius
    log = "grid cell=1 x=0:open y=0:open z=open\nwall x-=slip x+=free y-=slip &\n    y+=free z-=free z+=free"
    after = {"ball": Cloud(quarter["ball"].points - (0, 0, 21), (0, 0, -50)), "plate": quarter["plate"].kept(~gone)}
    part = measured(report, "quarter", quarter, after, log=log)
    for key in ("diameter", "circle", "area"):
        near(report, part["opening"][key], wall["opening"][key], 1e-9, f"a quarter of it, {key}")
    near(report, part["cloud"]["mass"], 2.0, 1e-9, "mass behind the quarter")
    report.check("modelled quarter" in part["text"], part["text"])

    turn = np.array([[1, 0, 0], [0, np.cos(0.5), -np.sin(0.5)], [0, np.sin(0.5), np.cos(0.5)]])
    turned = measured(
        report,
        "turned",
        {"ball": ball(), "plate": Cloud(points @ turn.T)},
        {"ball": passed(), "plate": Cloud(points @ turn.T).kept(~hole)},
    )
    near(report, abs(np.dot(turned["normal"], turn @ (0, 0, 1))), 1.0, 1e-6, "normal of a turned plate")
    near(report, turned["opening"]["diameter"], 2 * radius, S, "hole in a turned plate")

    oblique = Cloud(ball().points - (0, 4, 0), (0, 100, -100))  # meets the middle of the plate at y = 0
    after = Cloud(oblique.points + (0, 21, -21), (0, 50, -50))
    part = measured(
        report,
        "oblique",
        {"ball": oblique, "plate": Cloud(points)},
        {"ball": after, "plate": Cloud(points).kept(~hole)},
    )
    report.check(part["normal"] == [0.0, 0.0, -1.0], f"normal of a wall that is hit at 45 degrees: {part['normal']}")
    near(report, part["opening"]["diameter"], 2 * radius, S, "hole of a shot at 45 degrees")
    near(report, part["cloud"]["momentum"], 400.0, 1e-6, "momentum along the normal")
    near(report, part["cloud"]["radius"], 17.0, 1.1, "distance from where the shot met the plate")

    upper = points[:, 2] > -2
    staggered = np.where(
        upper, np.hypot(points[:, 0] - 4, points[:, 1]) < 3, np.hypot(points[:, 0] + 4, points[:, 1]) < 3
    )
    wall = measured(report, "staggered", start, {"ball": ball(), "plate": Cloud(points).kept(~staggered)})
    report.check(
        not wall["perforated"] and wall["opening"]["area"] == 0,
        f"holes from both sides that do not meet: {wall['opening']}",
    )
    wall = measured(report, "failed", start, {"ball": ball(), "plate": Cloud(points, failed=hole)})
    near(report, wall["opening"]["diameter"], 2 * radius, S, "matter that has failed closes no hole")
    near(report, wall["failed_mass"], hole.sum() * S**3, 1e-9, "failed mass")
    stuck = Cloud(np.vstack([ball().points - (0, 0, 4), [(0.0, 0.0, -40.0)]]), (0, 0, -5))  # and one stray particle
    begin = Cloud(np.vstack([ball().points, [(0.0, 0.0, 1.25)]]), (0, 0, -100))
    wall = measured(
        report, "stuck", {"ball": begin, "plate": Cloud(points)}, {"ball": stuck, "plate": Cloud(points, failed=hole)}
    )
    struck = wall["shot"]["ball"]
    report.check(not wall["perforated"] and struck["inside"] and not struck["through"], f"stuck: {struck}")
    near(report, struck["depth"], 3.0, S / 2, "depth of what is stuck, without the stray particle")
    near(report, wall["crater"]["depth"], struck["depth"], 1e-9, "the crater is as deep as the nose")
    near(report, struck["velocity"], 5.0, 1e-9, "velocity of what is stuck")
    report.check("not yet: ball is inside" in wall["text"] and "nose is" in wall["text"], wall["text"])
    wall = measured(
        report, "small_hole", start, {"ball": ball(), "plate": Cloud(points).kept(np.hypot(*points[:, :2].T) > 0.6 * H)}
    )
    report.check(not wall["perforated"], "a hole narrower than two cells is not seen")
    two = (np.hypot(points[:, 0] - 7, points[:, 1]) < 4) | (np.hypot(points[:, 0] + 7, points[:, 1]) < 3)
    wall = measured(report, "two_holes", start, {"ball": ball(), "plate": Cloud(points).kept(~two)})
    report.check(wall["openings"] == 2, f"two holes: {wall['openings']}")
    near(report, wall["opening"]["diameter"], 8.0, S, "the larger of two holes")
    notch = (np.abs(points[:, 0]) < 3) & (points[:, 1] > 0)
    wall = measured(report, "notch", start, {"ball": ball(), "plate": Cloud(points).kept(~notch)})
    report.check(not wall["perforated"] and wall["open_to_edge"], "a notch is no opening, it reaches the edge")
    wall = measured(report, "moved", start, {"ball": ball(), "plate": Cloud(points - (0, 0, 1.3))})
    report.check(
        not wall["hit"] and not wall["perforated"] and "not hit" in wall["text"],
        f"a plate that moves as a whole: {wall['text']}",
    )
    near(report, wall["moved"], 1.3, 1e-9, "how far it has moved")


def craters(report):
    """A spherical crater of known depth, a bulge of known height, metal stretched to gaps of more than a spacing."""
    points = plate()
    start = {"ball": ball(), "plate": Cloud(points)}
    radius, depth = 6.5, 2.5  # of the sphere; centre above the plate
    centre = radius - depth
    bowl = (points**2)[:, :2].sum(axis=1) + (points[:, 2] - centre) ** 2 < radius**2
    wall = measured(report, "crater", start, {"ball": ball(), "plate": Cloud(points).kept(~bowl)})
    rim = np.sqrt(radius**2 - centre**2)
    report.check(not wall["perforated"], "a crater is no opening")
    near(report, wall["crater"]["depth"], depth, 0.5 * S + 1e-9, "its depth")
    near(report, wall["crater"]["radius"], rim, S, "its radius")
    near(
        report,
        wall["crater"]["volume"],
        np.pi * depth**2 * (3 * radius - depth) / 3,
        0.1 * np.pi * depth**2 * (3 * radius - depth) / 3,
        "its volume",
    )
    near(report, wall["thickness"]["least"], 4 - depth, 0.5 * S + 1e-9, "thickness that is left")
    near(report, wall["thickness"]["start"], 4.0, 1e-9, "thickness")
    raised = points.copy()
    r = np.hypot(points[:, 0], points[:, 1])
    raised[:, 2] -= np.where(r < 8, 1.6 * np.cos(np.pi * r / 16) ** 2, 0) * (points[:, 2] < -2)
    wall = measured(report, "bulge", start, {"ball": ball(), "plate": Cloud(raised)})
    near(report, wall["bulge"]["height"], 1.6, 0.05, "height of a bulge")
    near(
        report,
        wall["bulge"]["radius"],
        16 / np.pi * np.arccos(np.sqrt(0.5 * S / 1.6)),
        S,
        "radius where it is higher than half a spacing",
    )
    report.check(
        wall["crater"]["depth"] < 0.01 and not wall["perforated"], f"no crater on the other side: {wall['crater']}"
    )
    stretched = points.copy()
    stretched[:, :2] *= 1.9  # gaps of nearly a cell along each axis, lines of particles behind each other
    wall = measured(
        report, "stretched", {"ball": ball(), "plate": Cloud(stretched)}, {"ball": ball(), "plate": Cloud(stretched)}
    )
    report.check(
        not wall["perforated"] and wall["crater"]["depth"] < 1e-9,
        f"stretched metal has no holes: {wall['opening']} {wall['crater']}",
    )


def layers(report):
    """Matter between the faces that has failed over a disc: no opening, but the wall is not of one piece there. What
    has failed at a face is none of it, nor is a failed spot narrower than two cells."""
    points = plate()
    start = {"ball": ball(), "plate": Cloud(points)}
    r = np.hypot(points[:, 0], points[:, 1])
    inside = np.abs(points[:, 2] - 0.5 * (TOP + BOTTOM)) < 0.9 * S
    wall = measured(report, "layers", start, {"ball": ball(), "plate": Cloud(points, failed=inside & (r < 7))})
    report.check(not wall["perforated"], "a failed layer is no opening")
    near(report, wall["failed_inside"]["diameter"], 14.0, 2 * S, "diameter of a failed layer")
    report.check("failed inside" in wall["text"], f"a failed layer is said: {wall['text']}")
    for name, failed in (("skin", (points[:, 2] > TOP - S) & (r < 7)), ("spot", inside & (r < 0.4 * H))):
        wall = measured(report, name, start, {"ball": ball(), "plate": Cloud(points, failed=failed)})
        report.check(failed.any(), f"{name}: nothing has failed")
        report.check(
            wall["failed_inside"]["area"] == 0 and "failed inside" not in wall["text"],
            f"{name}: {wall['failed_inside']}",
        )


def spalled(report):
    """A disc throws a plate apart where its waves meet, in the middle: the pressure rho c v/2 is 2.1 GPa, so that metal
    which bears 4 GPa stays whole. The releases of the disc's rim come 6 mm far until the waves that part it meet 2 mm
    below the middle of the plate: it is parted between sqrt(6^2 - 2^2) mm within the rim and the rim."""
    for pmin, least, most in ((-1100, 24 - 2 * np.sqrt(32), 24 + 2 * 0.5), (-4000, 0, 0)):
        found = run(f"spall{-pmin}", SPALL, pmin=pmin)
        if not report.finished(found, f"spall at {pmin} MPa"):
            continue
        words = ("impact", found.folder, "--json", f"spall{-pmin}.json")
        _, text = view(*words)
        with open(f"spall{-pmin}.json", encoding="utf-8") as file:
            wall = json.load(file)["walls"][0]
        width = wall["failed_inside"]["diameter"]
        report.check(least <= width <= most, f"failed inside at {pmin} MPa: {width}, not {least} to {most}")
        report.check(("failed inside" in text) == (most > 0) and not wall["perforated"], f"spall at {pmin}: {text}")
        os.remove(os.path.join(found.folder, "summary.json"))  # a run that has not ended: its log has the units
        report.check(view(*words)[1] == text, f"spall at {pmin}, without a summary")


def debris(report):
    """A plug, spall, ejecta, and a cloud that flies apart from a point; one that has not met the next wall yet."""
    points = plate()
    r = np.hypot(points[:, 0], points[:, 1])
    plug, rear = r < 4, (r > 6) & (r < 9) & (points[:, 2] < -3)
    up = (np.abs(points[:, 0]) > 12) & (np.abs(points[:, 1]) > 12) & (points[:, 2] > -1)
    after = Cloud(points)
    after.points[plug] -= (0, 0, 12)
    after.velocity[plug] = (0, 0, -30)
    after.points[rear] -= (0, 0, 5)
    after.velocity[rear] = (0, 0, -12)
    after.points[up] += (0, 0, 6)
    after.velocity[up] = (0, 0, 9)
    wall = measured(
        report,
        "plug",
        {"ball": ball(), "plate": Cloud(points)},
        {"ball": Cloud(ball().points + (0, 0, 5), (0, 0, 4)), "plate": after},
    )
    spall, back = wall["detached"]["spall"], wall["detached"]["backwards"]
    expected = (plug.sum() + rear.sum()) * S**3
    report.check(
        wall["perforated"] and spall["pieces"] == 2 and back["pieces"] == 4,
        f"plug, ring and four corners: {wall['detached']}",
    )
    near(report, spall["mass"], expected, 1e-9, "mass of the spall")
    near(report, spall["largest"], plug.sum() * S**3, 1e-9, "the plug is the heaviest")
    near(report, spall["velocity"], (30 * plug.sum() + 12 * rear.sum()) * S**3 / expected, 1e-9, "its velocity")
    near(
        report,
        wall["ejecta"]["mass"],
        8 + up.sum() * S**3,
        1e-9,
        "the ball that bounces and the corners are thrown back",
    )
    near(report, wall["ejecta"]["momentum"], 32 + 9 * up.sum() * S**3, 1e-6, "momentum against the shot")

    rng = np.random.default_rng(3)
    direction = rng.normal(size=(4000, 3))
    unit = direction / np.linalg.norm(direction, axis=1)[:, None] * rng.random((4000, 1)) ** (1 / 3)
    velocity = (0, 0, -500) + 200 * unit
    flying = Cloud(lattice((-5, -5, 1), (5, 5, 6), S), (0, 0, -1000))
    rear_wall = Cloud(lattice((-15, -15, -60), (15, 15, -58), S))
    dumps = [
        (
            time,
            {
                "ball": flying if time == 0 else Cloud((0, 0, -5) + velocity * time, velocity, failed=True),
                "bumper": Cloud(points),
                "wall": rear_wall,
            },
        )
        for time in (0, 0.05, 0.074, 0.2)
    ]
    back = Cloud((0, 0, -20) - 0.01 * velocity, -velocity, failed=True)  # what has bounced is not the cloud that came
    dumps.append((0.3, {"ball": back, "bumper": Cloud(points), "wall": rear_wall}))
    folder = os.path.join(SCRATCH, "cloud")
    write_run(folder, dumps, spacing=S, cell=H)
    code, text = view("impact", folder, "--step", "1", "--json", "cloud.json", "--csv", "cloud.csv")
    report.check(code == 0, text)
    with open("cloud.json", encoding="utf-8") as file:
        bumper, last = json.load(file)["walls"]
    cloud = bumper["cloud"]
    # a ball of uniform density in velocity: the foremost 2 % lie beyond the height c of the cap with that volume
    heights = np.linspace(0, 1, 100001)
    cap = (2 - 3 * heights + heights**3) / 4
    c = np.interp(-0.02, -cap, heights)
    mean = 0.25 * (1 - c**2) ** 2 / ((2 - 3 * c + c**3) / 3)
    fastest = np.sort(-velocity[:, 2])
    near(report, cloud["front_speed"], fastest[-80:].mean(), 1e-6, "speed of its foremost 80 particles")
    near(report, cloud["rear_speed"], fastest[:80].mean(), 1e-6, "speed of its hindmost 80 particles")
    near(report, cloud["velocity"], 500, 8, "mean speed of the cloud")
    near(report, cloud["front_speed"], 500 + 200 * mean, 8, "speed of its front")
    near(report, cloud["rear_speed"], 500 - 200 * mean, 8, "speed of its rear")
    radii = np.linspace(0, 1, 100001)
    near(
        report,
        cloud["radius"],
        200 * 0.05 * np.interp(0.95, 1 - (1 - radii**2) ** 1.5, radii),
        0.15,
        "radius that holds 95 % of it",
    )
    near(report, cloud["failed_share"], 1.0, 1e-12, "all of it has failed")
    near(report, cloud["kinetic_energy"], 0.5 * (velocity**2).sum() * S**3, 1e-3, "its kinetic energy")
    report.check(
        bumper["cloud_before"]["time"] == 0.074 and bumper["cloud_before"]["next"] == "wall",
        f"before the next wall: {bumper['cloud_before']}",
    )
    near(report, bumper["cloud_before"]["mass"], 4000 * S**3, 1e-9, "all of it is behind the bumper then")
    report.check(not last["hit"] and last["cloud"] is None, "the rear wall has not been hit")
    with open("cloud.csv", encoding="utf-8") as file:
        rows = file.read().splitlines()
    report.check(
        len(rows) == 1 + 2 * 5 and rows[0].startswith("time,name,") and "cloud.front_speed" in rows[0],
        f"a row for each wall of each dump: {rows[:2]}",
    )


def other_spaces(report):
    """A scene about an axis, with and without masses in the dump; one in the plane; what cannot be measured."""
    points = lattice((0, 0, -4), (20, 0, 0), S)
    hole = points[:, 0] < 6
    shot = Cloud(lattice((0, 0, 1), (1, 0, 3), S), (0, 0, -100))
    behind = Cloud(shot.points - (0, 0, 20), (0, 0, -50))
    for with_mass in (True, False):
        wall = measured(
            report,
            "rings",
            {"ball": shot, "plate": Cloud(points)},
            {"ball": behind, "plate": Cloud(points).kept(~hole)},
            dimension="axisymmetric",
            with_mass=with_mass,
        )
        near(report, wall["opening"]["diameter"], 12.0, 0.5 * S, "hole about an axis")
        near(report, wall["mass_left"], np.pi * (20**2 - 6**2) * 4, 1e-6, "mass of rings")
        near(report, wall["cloud"]["mass"], np.pi * 2, 1e-9, "mass of the ball about an axis")
        report.check(bool(wall["notes"]) != with_mass, f"{wall['notes']}")
    moved = points - np.column_stack(
        [0 * points[:, 0], 0 * points[:, 0], np.where(points[:, 0] < 6, 2.0, 0.0) * (points[:, 2] > -2)]
    )
    wall = measured(
        report,
        "step",
        {"ball": shot, "plate": Cloud(points)},
        {"ball": shot, "plate": Cloud(moved)},
        dimension="axisymmetric",
    )
    near(report, wall["crater"]["radius"], 6.0, 0.5 * S, "radius of a flat crater about an axis")
    near(report, wall["crater"]["depth"], 2.0, 1e-9, "its depth")
    near(report, wall["crater"]["volume"], np.pi * 36 * 2, 0.05 * np.pi * 72, "its volume")
    flat = lattice((-10, -4, 0), (10, 0, 0), S)
    cube = Cloud(lattice((-1, 1, 0), (1, 3, 0), S), (0, -100, 0))
    wall = measured(
        report,
        "plane",
        {"ball": cube, "plate": Cloud(flat)},
        {"ball": cube, "plate": Cloud(flat).kept(np.abs(flat[:, 0]) > 3)},
        dimension=2,
    )
    report.check("yes: opening 5.875 mm wide" in wall["text"], wall["text"])
    near(report, wall["opening"]["area"], 6.0, 0.5 * S, "width of a slot")
    near(report, wall["opening"]["circle"], 6.0, 0.5 * S, "what passes through it")
    wall = measured(
        report,
        "no_damage",
        {"ball": cube, "plate": Cloud(flat)},
        {"ball": cube, "plate": Cloud(flat)},
        dimension=2,
        with_damage=False,
        log="failure steel pmin=-1",
    )
    report.check("no field damage" in wall["text"], wall["text"])
    rest = os.path.join(SCRATCH, "rest")
    write_run(rest, [(0, {"plate": Cloud(flat)}), (1, {"plate": Cloud(flat)})], spacing=S, cell=H, dimension=2)
    for words, saying in (
        (("impact", rest), "give the direction by --along"),
        (("impact", "plane", "--wall", "q"), "no body 'q'"),
        (("impact", "plane", "--along=q"), "expected x, y, z"),
        (("fragments", "plane", "--body", "q"), "no body 'q'"),
        (("impact", "nowhere"), "no such file"),
    ):
        code, text = view(*words)
        report.check(code == 1 and saying in text and "Traceback" not in text, f"{' '.join(words)}: {text}")
    code, text = view("impact", rest, "--along=-y", "--wall", "plate")
    report.check(code == 0 and "not hit" in text, text)


def named(report):
    """Numbers by name for studies, kept where dumps are gone."""
    run, units = os.path.join(SCRATCH, "hole"), read_units(os.path.join(SCRATCH, "hole"))
    with open("hole.json", encoding="utf-8") as file:
        wall = json.load(file)["walls"][0]
    for name, expected, unit in (
        ("opening.diameter", wall["opening"]["diameter"], "mm"),
        ("opening.area", wall["opening"]["area"], "mm²"),
        ("perforated", 1.0, ""),
        ("cloud.momentum", 400.0, "mN s"),
        ("ejecta.mass", 0.0, "g"),
        ("cloud.front_speed", 50.0, "m/s"),
        ("shot.ball.speed", 50.0, "m/s"),
        ("shot.ball.depth", 20.0, "mm"),
    ):
        found = quantity_of(run, f"impact.plate.{name}")
        report.check(abs(found - expected) < 1e-6, f"{name}: {found}, expected {expected}")
        report.check(
            unit_of(f"impact.plate.{name}", units) == unit, f"{name}: unit {unit_of(f'impact.plate.{name}', units)}"
        )
    keep_impact(Path(run))
    for path in Path(run).glob("particles*"):
        path.unlink()
    report.check(quantity_of(run, "impact.plate.crater.lip") == wall["crater"]["lip"], "kept without dumps")
    try:
        seen = quantity_of(run, "impact.plate.width")
    except SgmpFileError as problem:
        seen = str(problem)
    report.check("nothing is known of" in str(seen), f"an unknown number: {seen}")


def cuts(report):
    """The section that `picture --cut` shows: the cut face of half models, the middle of whole ones; what is alone."""
    points = lattice((-3, -4, -3), (3, 0, 3), S)
    log = "grid cell=1 y=open:0\nwall x-=free x+=free y-=free y+=slip z-=free z+=free"
    options = argparse.Namespace(axis="y")
    for name, deck, side in (
        ("above", log.replace("y=open:0", "y=0:open").replace("y+=slip", "y+=free y-=slip"), -1),
        ("below", log, 1),
    ):
        own = points * (1, side, 1) if side < 0 else points
        folder = Path(SCRATCH) / name
        write_run(folder, [(0, {"body": Cloud(own)})], spacing=S, cell=H, log=deck)
        report.check(planes_of(folder, own, S) == {1: (0.0, side)}, f"plane of symmetry: {planes_of(folder, own, S)}")
        values = own[:, 1].copy()
        shown, seen, place = section_of(folder, own, own, values, "velocity_y", options, S)
        # the viewer looks along y from below: the plane must be the foremost of it, and nothing is taken away
        report.check(
            abs(shown[:, 1].min() - 0.5 * S) < 1e-12 and np.all(-shown[:, 1] <= -place),
            f"{name}: cut face {shown[:, 1].min()}",
        )
        report.check(np.allclose(seen, shown[:, 1]), f"{name}: velocities are turned with the half")
        report.check(view("picture", str(folder), "--cut", "--field", "velocity", "-o", f"{name}.png")[0] == 0, name)
    whole = np.vstack([points, points * (1, -1, 1)])
    _, _, place = section_of(Path(SCRATCH) / "hole", whole, whole + (0, 1, 0), whole[:, 0], "pressure", options, S)
    report.check(abs(place - 1) < 1e-12, f"a whole model is cut in its middle at the start: {place}")
    walls = log.replace("y-=free", "y-=slip").replace("y=open:0", "y=-4:0")
    write_run(Path(SCRATCH) / "channel", [(0, {"body": Cloud(points)})], spacing=S, cell=H, log=walls)
    report.check(not planes_of(Path(SCRATCH) / "channel", points, S), "between two walls there is no plane of symmetry")
    alone = np.column_stack([10 + 3 * np.arange(8), np.zeros(8), np.zeros(8)])
    for cloud, single in ((points, alone), (points[points[:, 1] > -S] * (1, 0, 1), alone * (1, 0, 1))):
        found = loose_of(np.vstack([cloud, single]), S)
        report.check(not found[: len(cloud)].any() and found[len(cloud) :].all(), f"{found.sum()} fly alone")


def clusters(report):
    """Pieces by comparing all pairs; bodies made of known pieces."""
    rng = np.random.default_rng(5)
    for space, reach in ((1, 0.01), (2, 0.05), (3, 0.11), (3, 0.02)):
        points = np.zeros((700, 3))
        points[:, :space] = rng.random((700, space))
        linked = ((points[:, None] - points[None]) ** 2).sum(axis=2) <= reach**2
        expected, number = np.full(700, -1), 0
        for seed in range(700):
            if expected[seed] < 0:
                front = np.zeros(700, bool)
                front[seed] = True
                while front.any():
                    expected[front] = number
                    front = linked[front].any(axis=0) & (expected < 0)
                number += 1
        report.check(
            np.array_equal(pieces_of(points, reach), expected),
            f"pieces in {space}D with {reach}: {number} by all pairs",
        )
    report.check(
        len(pieces_of(np.zeros((0, 3)), 1.0)) == 0 and list(pieces_of(np.ones((3, 3)), 1.0)) == [0, 0, 0],
        "no points, one point",
    )

    sizes = (6, 5, 4, 4, 3, 2)
    blocks = [lattice((20 * k, 0, 0), (20 * k + n * S, n * S, n * S), S) for k, n in enumerate(sizes)]
    speeds = [(k, -2 * k, 3) for k in range(len(sizes))]
    single, dust = np.array([[0, 30, 0], [5, 30, 0.0]]), lattice((40, 30, 0), (42, 32, 2), S)
    body = Cloud(np.vstack([*blocks, single, dust]), density=8.0)
    body.velocity = np.vstack(
        [*(np.broadcast_to(v, block.shape) for v, block in zip(speeds, blocks)), np.zeros((2 + len(dust), 3))]
    ).astype(float)
    body.failed[-len(dust) :] = True
    other = Cloud(blocks[0] + (0, 0, 3.5 - S), density=2.0)  # touches the first block, and is another body
    folder = os.path.join(SCRATCH, "clusters")
    write_run(folder, [(0, {"shell": body, "core": other})], spacing=S, cell=H)
    code, text = view("fragments", folder, "--json", "clusters.json", "-o", "clusters.png")
    report.check(
        code == 0 and all(os.path.getsize(path) > 1000 for path in ("clusters.png", "clusters_masses.png")), text
    )
    with open("clusters.json", encoding="utf-8") as file:
        found = json.load(file)["bodies"]
    shell = found["shell"]
    report.check([piece["particles"] for piece in shell["pieces"]] == [n**3 for n in sizes], f"{shell['pieces']}")
    for piece, n, speed, k in zip(shell["pieces"], sizes, speeds, range(len(sizes))):
        if sizes.count(n) == 1:
            near(report, piece["mass"], n**3 * S**3 * 8, 1e-9, "mass of a piece")
            near(report, float(np.linalg.norm(np.subtract(piece["velocity"], speed))), 0.0, 1e-9, "its velocity")
            near(
                report,
                float(np.linalg.norm(np.subtract(piece["position"], (20 * k + n * S / 2, n * S / 2, n * S / 2)))),
                0.0,
                1e-9,
                "its centre",
            )
            near(report, float(np.linalg.norm(np.subtract(piece["extent"], n * S))), 0.0, 1e-9, "its extent")
    report.check(
        shell["small_pieces"] == 2 and abs(shell["small_mass"] - 2) < 1e-9,
        f"single particles: {shell['small_pieces']} {shell['small_mass']}",
    )
    near(report, shell["failed_mass"], len(dust), 1e-9, "failed mass")
    report.check(len(found["core"]["pieces"]) == 1, "bodies that touch are pieces of their own")
    report.check("shell: 6 pieces of 8 g to 216 g, 2 smaller than a cell (2 g in all), 64 g failed" in text, text)
    gas = "material air fluid density=1 &\n    viscosity=0\nmaterial m elastic density=1\n"
    gas += "body core block material=air\nbody shell block material=m"
    write_run(folder, [(0, {"shell": body, "core": other})], spacing=S, cell=H, log=gas)
    code, text = view("fragments", folder)
    report.check(code == 0 and "shell: 6" in text and "core" not in text, f"fluids have no pieces: {text}")
    code, text = view("fragments", folder, "--body", "core")
    report.check(code == 0 and "core: 1 piece" in text, f"unless they are asked for: {text}")
    code, text = view("fragments", folder, "--reach", "17.7", "--body", "shell")
    report.check("shell: 5 pieces" in text, f"a longer reach joins what is 17.5 apart: {text}")


def page(report):
    """The report begins with the answer."""
    code, text = view("report", "hole", "-o", "hole.html")
    report.check(code == 0, text)
    with open("hole.html", encoding="utf-8") as file:
        text = file.read()
    places = [
        text.find(words)
        for words in (
            "<h1>",
            "What came out",
            "perforated</td><td>yes: opening of",
            "<th>ball</th>",
            "<h2>State",
            "id=verdict",
            "<h2>Energy",
            "<h2>Scene",
            "<h2>Deck",
        )
    ]
    report.check(min(places) >= 0 and places == sorted(places), f"order of the report: {places}")
    report.check(
        "made &lt;by&gt; hand &amp; known" in text and "100 m/s at the start, <b>50 m/s</b>" in text, text[:1500]
    )
    code, text = view("report", "clusters", "-o", "clusters.html")
    with open("clusters.html", encoding="utf-8") as file:
        text = file.read()
    report.check(code == 0 and "<h2>State" in text, "a report of one dump")
    view("report", "cloud", "-o", "cloud.html")
    for name, words in (("cloud", "No piece of it is whole."), ("hole", "% lost.</p>")):
        with open(f"{name}.html", encoding="utf-8") as file:
            report.check(words in file.read(), f"what is left of the projectile in {name}: {words}")
    view("report", "plug", "-o", "plug.html")
    with open("plug.html", encoding="utf-8") as file:
        text = file.read()
    report.check(
        "<h2>Fragments" in text and "7 pieces" in text and "detached pieces, forwards (spall)</td><td>2, " in text,
        "fragments of the plug",
    )


def halves(report):
    """Without the field mass a particle that has been split has the share of one, however many its parts are."""
    ids = np.array([1, 2, 2, 3, 3, 3, 3])
    cloud = SimpleNamespace(fields={"id": ids}, points=np.zeros((len(ids), 3)))
    shares, is_given = shares_of(cloud, None, False)
    found = [shares[ids == number].sum() for number in (1, 2, 3)]
    report.check(not is_given and np.allclose(found, found[0]), f"shares of split particles: {found}")
    first = SimpleNamespace(fields={"id": np.array([1, 2, 3])}, points=np.array([[1.0, 0, 0], [2, 0, 0], [4, 0, 0]]))
    shares, _ = shares_of(cloud, first, True)
    found = [shares[ids == number].sum() for number in (1, 2, 3)]
    report.check(np.allclose(found, np.array([1, 2, 4])*found[0]), f"shares of split rings: {found}")
    whole = shares_of(SimpleNamespace(fields={}, points=np.zeros((2, 3))), None, False)[0]
    report.check(np.allclose(whole, whole[0]), f"without ids: {whole}")


def main():
    """All of it."""
    report = Report()
    os.chdir(SCRATCH)
    for part in (clusters, holes, craters, layers, spalled, debris, other_spaces, page, named, cuts, halves):
        part(report)
    report.end()


main()
