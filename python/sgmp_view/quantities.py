"""Numbers that a run has: by names, with units.

    bodies.NAME.COLUMN, gauges.NAME.COLUMN, sections.NAME.COLUMN, history.COLUMN    the last row of bodies.csv,
    gauges.csv, …
    … with :max, :min, :mean, :integral, :time_of_max, :change (last less first), :largest_change of all rows instead
    (gauges.foot.pressure:max)
    extent.NAME.x_max (x_min, x_length, y…, z…, r…)           reach of a body at the end, half a particle beyond the
    centres
    acceleration.NAME.cfc180, acceleration.NAME.unfiltered    largest acceleration of a body (m/s²), filtered by a class
    impact.NAME.crater.depth, impact.NAME.opening.diameter, … what `sgmp-view impact` measures of a wall at the end
    shape.NAME.mean, shape.NAME.largest                       distance of a body's surface at the end to that in another
    run
    energy.internal, end_state.largest_pressure, …            numbers of summary.json
"""

import csv
import json
import re

import numpy as np

from .acceleration import accelerations, in_si, peaks_of
from .compare import flat
from .files import (
    SgmpFileError, field_unit, folder_of, read_dump, read_history, read_particles_csv, read_summary, read_table,
)
from .shapes import Shape, distance
from .turning import cloud_of, table_of

OF_ROWS = ("max", "min", "mean", "integral", "time_of_max", "change", "largest_change")
KEYS = {"bodies": "body", "gauges": "gauge", "sections": "section"}
NO_RESULTS = ("step", "time", "body", "gauge", "section", "particle", "particles", "name", "dt")
ENDS = ("min", "max", "length")
DISTANCES = ("mean", "largest")                         # of surfaces: root mean square and largest
KEPT = "impact.json"
CLOUD = (
    "mass", "momentum", "velocity", "kinetic_energy", "front_speed", "rear_speed", "front", "rear", "radius",
    "largest_radius", "failed_share", "beyond_edge_mass",
)
LENGTHS = (
    "depth", "diameter", "circle", "radius", "height", "least", "start", "lip", "front", "rear", "largest_radius",
    "moved",
)


def reduced(time, values, how):
    """One number of a column: the last, or what `how` says."""
    if not how:
        return float(values[-1])
    if how in ("mean", "integral"):
        area = float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))
        return area if how == "integral" else area / float(time[-1] - time[0])
    if how == "change":
        return float(values[-1] - values[0])
    if how == "largest_change":
        change = values - values[0]
        return float(change[np.argmax(np.abs(change))])
    if how == "time_of_max":
        return float(time[np.argmax(values)])
    if how in OF_ROWS:
        return float(np.max(values) if how == "max" else np.min(values))
    raise SgmpFileError(f"':{how}' is none of {', '.join(OF_ROWS)}")


def column_of(folder, file, name, column):
    """Times and values of a column of a body or a gauge."""
    table = table_of(folder, f"{file}.csv")
    rows = (
        np.ones(len(table["time"]), bool)
        if name is None
        else (
            table["name"] == name
            if "name" in table and not name.isdigit()
            else table[KEYS[file]] == float(name)
            if name.isdigit()
            else np.zeros(len(table["time"]), bool)
        )
    )
    if column not in table or not rows.any():
        raise SgmpFileError(f"{folder}: {file}.csv has no '{name}' with a column '{column}'")
    return table["time"][rows], table[column][rows]


def body_names(folder):
    """Names of the bodies, in the order of their numbers."""
    table = read_table(folder / "bodies.csv")
    return list(dict.fromkeys(str(name) for name in table["name"]))


def matter_at_end(folder, name):
    """Places of a body's particles at the end, and their sizes (length, area, volume); those of the start without
    volumes in the file."""
    names = body_names(folder)
    if name not in names:
        raise SgmpFileError(f"{folder}: no body '{name}'; there are: {', '.join(names)}")
    full = folder / "particles_end.csv"
    cloud, summary = (
        cloud_of(folder, read_particles_csv(full) if full.exists() else read_dump(folder)),
        read_summary(folder),
    )
    own = cloud.fields["body"] == names.index(name) + 1
    sizes, axes = sizes_of(cloud, own, summary)
    return cloud.points[own], sizes, axes, summary["dimension"] == "axisymmetric"


def sizes_of(cloud, own, summary):
    """Sizes of the particles `own` (length, area, volume; about an axis the area of the section), and along how many
    axes."""
    is_round = summary["dimension"] == "axisymmetric"
    axes = 2 if is_round else int(summary["dimension"])
    if "volume" in cloud.fields:
        return cloud.fields["volume"][own] / (2 * np.pi * cloud.points[own, 0] if is_round else 1), axes
    return np.full(np.count_nonzero(own), float(summary["spacing"]) ** axes), axes


def reach_of(along, sizes, axes):
    """Where a body begins and ends along an axis: half a particle beyond the centres."""
    half = 0.5 * sizes ** (1 / axes)
    return float(np.min(along - half)), float(np.max(along + half))


def extent_of(folder, rest):
    """Reach of a body along an axis at the end."""
    name, _, side = rest.rpartition(".")
    axis, _, end = side.partition("_")
    if axis not in ("x", "y", "z", "r") or end not in ENDS:
        raise SgmpFileError(
            f"extent.{rest}: expected extent.BODY.AXIS_END with an axis and an end of {', '.join(ENDS)}"
        )
    points, sizes, axes, _ = matter_at_end(folder, name)
    low, high = reach_of(points[:, "xyz".index("x" if axis == "r" else axis)], sizes, axes)
    return {"min": low, "max": high, "length": high - low}[end]


def acceleration_of(folder, rest):
    """The largest acceleration of a body (m/s²), filtered by a channel frequency class or not."""
    name, _, kind = rest.rpartition(".")
    if kind != "unfiltered" and not re.fullmatch(r"cfc\d+", kind):
        raise SgmpFileError(
            f"acceleration.{rest}: expected acceleration.BODY.cfc180, or another class, or acceleration.BODY.unfiltered"
        )
    _, time, values, mass = next(accelerations(folder, float(kind[3:]) if kind != "unfiltered" else None, [name]))
    return peaks_of(time, values, mass)["peak"]


def shape_of(folder, rest, other):
    """Distance of a body's surface at the end to that in another run: root mean square or largest."""
    name, _, how = rest.rpartition(".")
    if how not in DISTANCES:
        raise SgmpFileError(f"shape.{rest}: expected shape.BODY.{' or shape.BODY.'.join(DISTANCES)}")
    if other is None:
        raise SgmpFileError(f"shape.{rest}: beside which run? It is a distance of the surfaces of two")
    shapes = []
    for run in (folder, folder_of(other)):
        points, sizes, axes, is_round = matter_at_end(run, name)
        shapes.append(Shape(points[:, [0, 2] if is_round else slice(axes)], sizes, is_round))
    return distance(*shapes)[DISTANCES.index(how)]


def impact_numbers(folder):
    """What is measured of walls at the end, by name of the wall and of the number; as it was kept where dumps are
    gone."""
    kept = folder / KEPT
    if kept.exists():
        return json.loads(kept.read_text())
    from . import impact                               # here: it draws on much that other quantities do not need
    values = {}
    for wall in impact.of_folder(folder)["walls"]:
        for cloud in ("cloud", "ejecta"):              # nothing there: zeros, so that a number has its name in all runs
            wall[cloud] = wall.get(cloud) or dict.fromkeys(CLOUD, 0.0)
        numbers = flat({key: value for key, value in wall.items() if key not in ("name", "normal", "text")})
        values.update({f"{wall['name']}.{key}": float(value) for key, value in numbers.items()
                       if isinstance(value, (int, float)) and "mass_of" not in key})
    return values


def keep_impact(folder):
    """Writes what was measured of walls, for a folder that loses its dumps; what cannot be measured is left out."""
    try:
        values = impact_numbers(folder)
    except SgmpFileError:
        return
    (folder / KEPT).write_text(json.dumps(values, indent=1) + "\n")


def quantity_of(folder, quantity, other=None):
    """Its value at the end of a run, or of all of it; other: the run that a shape is compared with."""
    folder = folder_of(folder)
    quantity, _, how = quantity.partition(":")
    file, _, rest = quantity.partition(".")
    if file in KEYS:
        name, _, column = rest.rpartition(".")
        return reduced(*column_of(folder, file, name, column), how)
    if file == "extent":
        return extent_of(folder, rest)
    if file == "acceleration":
        return acceleration_of(folder, rest)
    if file == "shape":
        return shape_of(folder, rest, other)
    if file == "impact":
        values = impact_numbers(folder)
        if rest not in values:
            raise SgmpFileError(f"{folder}: nothing is known of '{quantity}'; there are: {', '.join(values)}")
        return values[rest]
    if file == "history":
        history = table_of(folder, "history.csv")
        if rest not in history:
            raise SgmpFileError(f"{folder}: history.csv has no column '{rest}'; there are: {', '.join(history)}")
        return reduced(history["time"], history[rest], how)
    values = flat(read_summary(folder))
    if not isinstance(values.get(quantity), (int, float)):
        numbers = ", ".join(
            name for name, value in values.items() if isinstance(value, (int, float)) and not name.startswith("phase")
        )
        raise SgmpFileError(f"{folder}: summary.json has no number '{quantity}'; there are: {numbers}")
    return float(values[quantity])


def unit_of(quantity, units):
    """Unit of a quantity, '' where none is known."""
    quantity, _, how = quantity.partition(":")
    column = quantity.rpartition(".")[2]
    if how == "time_of_max":
        return units["time"]
    if quantity.startswith(("extent.", "shape.")):
        return units["length"]
    if quantity.startswith("acceleration."):
        return "m/s²"
    if quantity.startswith("impact."):
        kind = {"area": "²", "volume": "³"}.get(column)
        if kind:
            return units["length"] and units["length"] + kind
        return units["length"] if column in LENGTHS else impact_unit(column, quantity, units)
    unit = field_unit(column, units)
    if column.startswith(
        ("kinetic_energy", "internal_energy", "total_energy", "external_work", "energy_remainder")
    ) or column.endswith("dissipation"):
        unit = units["energy"]
    elif column.startswith("force_"):
        unit = units["momentum"] and f"{units['momentum']}/{units['time']}"
    elif column.startswith("momentum") or "_impulse_" in column:
        unit = units["momentum"]
    elif column.endswith("pressure") or column == "von_mises":
        unit = units["stress"]
    elif quantity.startswith("energy.") and column != "drift":
        unit = units["energy"]
    return f"{unit} {units['time']}" if how == "integral" and unit else unit


def impact_unit(column, quantity, units):
    """Units of what is no length."""
    if "mass" in column or quantity.endswith((".spall.largest", ".backwards.largest")):
        return units["mass"]
    if "speed" in column or column == "velocity":
        return units["velocity"]
    return {"momentum": units["momentum"], "kinetic_energy": units["energy"]}.get(column, "")


def short_name(quantity):
    """How people say it: v_z of core."""
    bare, _, how = quantity.partition(":")
    parts = bare.split(".")
    if len(parts) < 3:
        return quantity.replace("history.", "")
    column = (
        parts[-1].replace("velocity_", "v_").replace("_", " ")
        if not parts[-1].startswith("velocity_")
        else parts[-1].replace("velocity", "v")
    )
    if parts[0] == "shape":
        return f"distance of the surface of {'.'.join(parts[1:-1])} ({column})"
    if parts[0] == "acceleration":
        return f"largest acceleration of {'.'.join(parts[1:-1])} ({parts[-1].replace('cfc', 'CFC ')})"
    words = f"{column} of {'.'.join(parts[1:-1])}"
    return f"{'time of max' if how == 'time_of_max' else how} of {words}" if how else words


def known_in_si(folder):
    """Whether the units of the deck can be turned into seconds, metres and kilograms."""
    try:
        in_si(folder)
        return True
    except SgmpFileError:
        return False


def listed(folder):
    """Names of the quantities of a run that are results."""
    for file in KEYS:
        path = folder / f"{file}.csv"
        if path.exists():
            with open(path, newline="") as stream:
                columns = next(csv.reader(stream))
            table = read_table(path)
            names = (
                dict.fromkeys(str(name) for name in table["name"])
                if "name" in table
                else dict.fromkeys(str(int(k)) for k in table[KEYS[file]])
            )
            yield from (f"{file}.{name}.{column}" for name in names for column in columns if column not in NO_RESULTS)
    try:
        yield from (f"impact.{name}" for name in impact_numbers(folder))
    except SgmpFileError:
        pass                                           # no walls, or no dumps
    if known_in_si(folder):
        yield from (
            f"acceleration.{name}.{kind}" for name in body_names(folder) for kind in ("unfiltered", "cfc180", "cfc1000")
        )
    dimension = read_summary(folder)["dimension"]
    axes = "rz" if dimension == "axisymmetric" else "xyz"[:int(dimension)]
    yield from (f"extent.{name}.{axis}_{end}" for name in body_names(folder) for axis in axes for end in ENDS)
    yield from (f"shape.{name}.{how}" for name in body_names(folder) for how in DISTANCES)
    yield from (f"history.{column}" for column in read_history(folder) if column not in NO_RESULTS)
    yield from (name for name, value in flat(read_summary(folder)).items()
                if name.startswith(("energy.", "end_state.")) and isinstance(value, (int, float)))
