"""Numbers that a run has: by names, with units.

    bodies.NAME.COLUMN, gauges.NAME.COLUMN, history.COLUMN    the last row of bodies.csv, gauges.csv, history.csv
    … with :max, :min, :mean, :integral, :time_of_max         of all rows instead (gauges.foot.pressure:max)
    extent.NAME.x_max (x_min, x_length, y…, z…, r…)           reach of a body's matter at the end, half a particle around its centres with it
    energy.internal, end_state.largest_pressure, …            numbers of summary.json
"""

import csv

import numpy as np

from .compare import flat
from .files import SgmpFileError, field_unit, folder_of, read_dump, read_history, read_particles_csv, read_summary, read_table

OF_ROWS = ("max", "min", "mean", "integral", "time_of_max")
KEYS = {"bodies": "body", "gauges": "gauge"}
NO_RESULTS = ("step", "time", "body", "gauge", "particle", "particles", "name", "dt")
ENDS = ("min", "max", "length")


def reduced(time, values, how):
    """One number of a column: the last, or what `how` says."""
    if not how:
        return float(values[-1])
    if how in ("mean", "integral"):
        area = float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))
        return area if how == "integral" else area / float(time[-1] - time[0])
    if how == "time_of_max":
        return float(time[np.argmax(values)])
    if how in OF_ROWS:
        return float(np.max(values) if how == "max" else np.min(values))
    raise SgmpFileError(f"':{how}' is none of {', '.join(OF_ROWS)}")


def column_of(folder, file, name, column):
    """Times and values of a column of a body or a gauge."""
    table = read_table(folder / f"{file}.csv")
    rows = np.ones(len(table["time"]), bool) if name is None else (
        table["name"] == name if "name" in table and not name.isdigit() else table[KEYS[file]] == float(name) if name.isdigit() else
        np.zeros(len(table["time"]), bool))
    if column not in table or not rows.any():
        raise SgmpFileError(f"{folder}: {file}.csv has no '{name}' with a column '{column}'")
    return table["time"][rows], table[column][rows]


def body_names(folder):
    """Names of the bodies, in the order of their numbers."""
    table = read_table(folder / "bodies.csv")
    return list(dict.fromkeys(str(name) for name in table["name"]))


def extent_of(folder, rest):
    """Reach of a body's matter along an axis at the end."""
    name, _, side = rest.rpartition(".")
    axis, _, end = side.partition("_")
    names = body_names(folder)
    if name not in names or axis not in ("x", "y", "z", "r") or end not in ENDS:
        raise SgmpFileError(f"extent.{rest}: expected extent.BODY.AXIS_END with a body of {', '.join(names)}, an axis and an end of {', '.join(ENDS)}")
    full = folder / "particles_end.csv"
    cloud, summary = read_particles_csv(full) if full.exists() else read_dump(folder), read_summary(folder)
    own = cloud.fields["body"] == names.index(name) + 1
    half = 0.5 * float(summary["spacing"])
    if "volume" in cloud.fields:
        dimension = summary["dimension"]
        area = cloud.fields["volume"][own] / (cloud.points[own, 0] if dimension == "axisymmetric" else 1)
        half = 0.5 * area ** (1 / {"axisymmetric": 2}.get(dimension, dimension))
    along = cloud.points[own, "xyz".index("x" if axis == "r" else axis)]
    low, high = float(np.min(along - half)), float(np.max(along + half))
    return {"min": low, "max": high, "length": high - low}[end]


def quantity_of(folder, quantity):
    """Its value at the end of a run, or of all of it."""
    folder = folder_of(folder)
    quantity, _, how = quantity.partition(":")
    file, _, rest = quantity.partition(".")
    if file in KEYS:
        name, _, column = rest.rpartition(".")
        return reduced(*column_of(folder, file, name, column), how)
    if file == "extent":
        return extent_of(folder, rest)
    if file == "history":
        history = read_history(folder)
        if rest not in history:
            raise SgmpFileError(f"{folder}: history.csv has no column '{rest}'; there are: {', '.join(history)}")
        return reduced(history["time"], history[rest], how)
    values = flat(read_summary(folder))
    if not isinstance(values.get(quantity), (int, float)):
        numbers = ", ".join(name for name, value in values.items() if isinstance(value, (int, float)) and not name.startswith("phase"))
        raise SgmpFileError(f"{folder}: summary.json has no number '{quantity}'; there are: {numbers}")
    return float(values[quantity])


def unit_of(quantity, units):
    """Unit of a quantity, '' where none is known."""
    quantity, _, how = quantity.partition(":")
    column = quantity.rpartition(".")[2]
    if how == "time_of_max":
        return units["time"]
    if quantity.startswith("extent."):
        return units["length"]
    unit = field_unit(column, units)
    if column.startswith(("kinetic_energy", "internal_energy", "total_energy", "external_work", "energy_remainder")) or column.endswith("dissipation"):
        unit = units["energy"]
    elif column.startswith("momentum"):
        unit = units["momentum"]
    elif column.endswith("pressure") or column == "von_mises":
        unit = units["stress"]
    elif quantity.startswith("energy.") and column != "drift":
        unit = units["energy"]
    return f"{unit} {units['time']}" if how == "integral" and unit else unit


def short_name(quantity):
    """How people say it: v_z of core."""
    bare, _, how = quantity.partition(":")
    parts = bare.split(".")
    if len(parts) < 3:
        return quantity.replace("history.", "")
    column = parts[-1].replace("velocity_", "v_").replace("_", " ") if not parts[-1].startswith("velocity_") else parts[-1].replace("velocity", "v")
    words = f"{column} of {'.'.join(parts[1:-1])}"
    return f"{'time of max' if how == 'time_of_max' else how} of {words}" if how else words


def listed(folder):
    """Names of the quantities of a run that are results."""
    for file in KEYS:
        path = folder / f"{file}.csv"
        if path.exists():
            with open(path, newline="") as stream:
                columns = next(csv.reader(stream))
            table = read_table(path)
            names = dict.fromkeys(str(name) for name in table["name"]) if "name" in table else dict.fromkeys(str(int(k)) for k in table[KEYS[file]])
            yield from (f"{file}.{name}.{column}" for name in names for column in columns if column not in NO_RESULTS)
    axes = "xyz"[:3 if read_summary(folder)["dimension"] == "axisymmetric" else int(read_summary(folder)["dimension"])]
    yield from (f"extent.{name}.{axis}_{end}" for name in body_names(folder) for axis in axes for end in ENDS)
    yield from (f"history.{column}" for column in read_history(folder) if column not in NO_RESULTS)
    yield from (name for name, value in flat(read_summary(folder)).items()
                if name.startswith(("energy.", "end_state.")) and isinstance(value, (int, float)))
