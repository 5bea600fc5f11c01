"""What an impact has done to a wall: perforated or not, opening, crater, bulge, spall, debris behind it.

    sgmp-view impact perforation.out
    sgmp-view impact whipple.out --wall bumper --step 4
    sgmp-view impact perforation.out --json impact.json --csv impact.csv

Walls are the bodies that rest while others fly; each is measured along its normal in the direction of the shot
(--along, --wall choose others). The wall is the largest connected piece of its body that has not failed; particles at
most a cell apart are connected. It is perforated where there is a straight way through it that is at least two cells
wide. "Failed inside" is a wall whose layers have come apart. Behind planes of symmetry the wall is completed; masses,
momenta and energies are those of the model. --csv has a row for each dump. Without damage among the fields of the
dumps all matter counts as whole.
"""

import csv
import json
from pathlib import Path

import numpy as np

from .compare import flat
from .files import SgmpFileError, dumps_of, folder_of, read_units
from .matter import matter_of, start_and_dump
from .wall import Shot, cloud_before, wall_of


def measured(start, now, shot, walls=None):
    """All walls, as a dict that goes into JSON."""
    if len(now.axes) < 2:
        raise SgmpFileError("walls are measured in two and three dimensions")
    names = walls or shot.targets(start)
    if not names:
        raise SgmpFileError("no body is at rest while others fly: name the wall by --wall")
    return {
        "time": now.time,
        "shot": {"bodies": shot.bodies, "speed": shot.speed, "velocity": [float(v) for v in shot.velocity]},
        "axisymmetric": now.is_round,
        "dimension": now.dimension,
        "symmetric_about": ["xyz"[k] for k in sorted(now.planes)],
        "cell": now.cell,
        "walls": [wall_of(start, now, name, shot) for name in names],
        "notes": now.notes,
    }


def number(value, unit=""):
    """A number with four digits and its unit."""
    return f"{value:{'.0f' if 1e4 <= abs(value) < 1e6 else '.4g'}} {unit}".strip()


def lines_of(wall, units, plane):
    """Label and words of what was measured of a wall. `plane`: a scene in two dimensions, whose openings are slots."""

    def length(value):
        return number(value, units["length"])

    def mass(value):
        return number(value, units["mass"])

    if not wall["hit"]:
        yield "state", "not hit"
        return
    if wall.get("broken_up"):
        yield "perforated", "yes: nothing of it has not failed"
        return
    opening, crater, bulge, thickness = wall["opening"], wall["crater"], wall["bulge"], wall["thickness"]
    if wall["perforated"]:
        what = f"{length(opening['diameter'])} wide" if plane else f"of {length(opening['diameter'])} in diameter"
        if not plane and opening["circle"] < 0.98 * opening["diameter"]:
            what += f" by its area; the largest circle in it has {length(opening['circle'])}"
        more = f"; {wall['openings']} openings, this is the largest" if wall["openings"] > 1 else ""
        yield "perforated", f"yes: opening {what}{more}"
    else:
        inside = [body for body, striker in wall["shot"].items() if striker["inside"]]
        words = "no" + ("; broken to its edge" if wall["open_to_edge"] else "")
        if inside and wall["openings"]:
            failed = what_failed(wall, length)
            words = f"not yet: {' and '.join(inside)} is inside; failed matter goes through, {failed}"
        yield "perforated", words
    for body, striker in wall["shot"].items():
        depth, speed = length(striker["depth"]), number(striker["velocity"], units["velocity"])
        where = f"its nose is {depth} deep" if striker["inside"] else f"its nose is {depth} behind the front face"
        if striker["through"]:
            where = f"has passed, at {number(striker['speed'], units['velocity'])}"
        elif striker["depth"] <= 0:
            where = "has come back, or has not arrived"
        yield f"  {body}", f"{where}; velocity along the shot {speed}"
    if crater["radius"] > 0:
        depth = "through" if wall["perforated"] else length(crater["depth"])
        yield "crater", f"depth {depth}, radius {length(crater['radius'])}, lip {length(crater['lip'])}"
        power = "²" if plane else "³"
        yield "crater, volume", number(crater["volume"], units["length"] and units["length"] + power)
    if not wall["perforated"]:
        yield "least thickness left", f"{length(thickness['least'])} of {length(thickness['start'])}"
    if wall["failed_inside"]["area"] > 0:
        across = wall["failed_inside"]["diameter"]
        size = f"{length(across)} wide" if plane else f"{length(across)} in diameter by its area"
        yield "failed inside, between its faces", f"{size}: the wall is in layers there, and the rear one may come off"
    swollen = f"{length(bulge['height'])} high, radius {length(bulge['radius'])}"
    yield "bulge at the rear", swollen if bulge["radius"] > 0 else "none"
    yield "whole piece that is left", f"{mass(wall['mass_left'])} of {mass(wall['mass_at_start'])}"
    if wall["failed_mass"]:
        yield "failed", mass(wall["failed_mass"])
    for key, words in (("spall", "detached pieces, forwards (spall)"), ("backwards", "detached pieces, backwards")):
        off, what = wall["detached"][key], "none"
        if off["pieces"]:
            speed = number(off["velocity"], units["velocity"])
            what = f"{off['pieces']}, {mass(off['mass'])} in all, the largest {mass(off['largest'])}, at {speed}"
        yield words, what
    for key, words, way in (("cloud", "behind the wall", "along"), ("ejecta", "thrown back", "against")):
        if wall[key]:
            yield from cloud_lines(wall[key], words, units, way)
    before = wall.get("cloud_before")
    if before:
        yield from cloud_lines(
            before, f"behind it before it met {before['next']}, {number(before['time'], units['time'])}", units
        )


def what_failed(wall, length):
    """How wide the way through failed matter is."""
    return f"{length(wall['opening']['diameter'])} in diameter"


def cloud_lines(cloud, words, units, way="along"):
    """Label and words of a cloud of debris."""

    def of(key, kind):
        return number(cloud[key], units[kind])

    shares = ", ".join(f"{number(mass, units['mass'])} of {name}" for name, mass in cloud["mass_of"].items())
    yield words, f"{of('mass', 'mass')} ({shares}); {100 * cloud['failed_share']:.3g} % of it failed"
    yield "  momentum", f"{of('momentum', 'momentum')} {way} the shot, kinetic energy {of('kinetic_energy', 'energy')}"
    speeds = (of(key, "velocity") for key in ("front_speed", "rear_speed", "velocity"))
    words = "foremost {}, rearmost {}, mean of all {}".format(*speeds)
    ends = sorted(cloud[key] for key in ("front_speed", "rear_speed"))
    if not ends[0] <= cloud["velocity"] <= ends[1]:
        words += ": what lies at its ends has met something"
    yield "  speed", words
    yield "  radius", f"{of('radius', 'length')} holds 95 % of the mass, the farthest {of('largest_radius', 'length')}"
    if cloud["beyond_edge_mass"]:
        yield "  beyond the edge of the wall", f"{of('beyond_edge_mass', 'mass')}, which may have passed round the wall"


def model_note(planes):
    """Which part of a scene that is symmetric about planes the masses are of."""
    if not planes:
        return []
    part = {1: "half", 2: "quarter", 3: "eighth"}[len(planes)]
    return [
        f"symmetric about {' and '.join(planes)}: masses, momenta and energies are those of the modelled {part};"
        " openings and craters those of the whole"
    ]


def along_of(text):
    """A direction written -z."""
    sign, axis = (-1.0, text[1:]) if text.startswith("-") else (1.0, text.lstrip("+"))
    if axis not in ("x", "y", "z"):
        raise ValueError(f"--along={text}: expected x, y, z or -x, -y, -z")
    return sign * np.eye(3)["xyz".index(axis)]


def of_folder(folder):
    """What was measured of the walls of a run at its end."""
    start, now = start_and_dump(folder)
    return measured(start, now, Shot(start))


def with_clouds_before(result, folder, start, shot):
    """The same with the clouds before they met the next wall, of walls that have one behind them."""
    dumps = dumps_of(folder)
    first = dumps[0].read()
    for wall in result["walls"]:
        if wall.get("cloud") or wall.get("broken_up"):
            wall["cloud_before"] = cloud_before(
                dumps, first, start, wall["name"], shot, lambda cloud, first: matter_of(folder, cloud, first)
            )
    return result


def write_series(folder, start, shot, options):
    """A row for each wall of each dump."""
    rows = []
    dumps = dumps_of(folder)
    first = dumps[0].read()
    for dump in dumps:
        result = measured(start, matter_of(folder, dump.read(), first), shot, options.wall)
        for wall in result["walls"]:
            values = flat({key: value for key, value in wall.items() if key != "normal"})
            rows.append(
                {
                    "time": result["time"],
                    **{
                        key: int(value) if isinstance(value, bool) else value
                        for key, value in values.items()
                        if value is not None and "mass_of" not in key
                    },
                }
            )
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(options.csv, "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, columns, restval="")
        writer.writeheader()
        writer.writerows(rows)


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("source", type=Path, metavar="OUT_DIR|FILE", help="output folder, or a dump in it")
    parser.add_argument(
        "--step", default="last", metavar="last|N", help="which dump of a folder, counted from 0 (default: last)"
    )
    parser.add_argument(
        "--wall",
        action="append",
        metavar="BODY",
        help="a body that is the wall; may be repeated (default: all that rest at the start)",
    )
    parser.add_argument(
        "--along", metavar="AXIS", help="direction of the shot, as --along=-z (default: that of what flies)"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write a row for each dump")


def run(options):
    """Prints what was measured."""
    folder = folder_of(options.source)
    start, now = start_and_dump(options.source, options.step)
    shot = Shot(start, None if options.along is None else along_of(options.along))
    result = with_clouds_before(measured(start, now, shot, options.wall), folder, start, shot)
    units = read_units(folder)
    if now.time is not None:
        print(f"at {number(now.time, units['time'])}")
    for wall in result["walls"]:
        print(wall["name"])
        for label, words in lines_of(wall, units, now.dimension == 2 and not now.is_round):
            print(f"  {label + ':':40}{words}")
    for note in [*model_note(result["symmetric_about"]), *result["notes"]]:
        print(f"note: {note}")
    if options.json:
        options.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
        print(options.json)
    if options.csv:
        write_series(folder, start, shot, options)
        print(options.csv)
