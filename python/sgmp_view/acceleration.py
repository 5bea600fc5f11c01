"""Accelerations of bodies and the forces that go with them, filtered as crash tests are (SAE J211-1, ISO 6487).

The acceleration is the change of the mean velocity in bodies.csv over the time between rows, brought to equal steps.
The filter of a channel frequency class (CFC 60, 180, 600, 1000) is a Butterworth filter with two poles that runs
forwards and backwards, so that nothing is shifted in time; its limit frequency is CFC times 1.65. The resultant is that
of the filtered components. Times are turned into seconds by the units of the deck.
"""

import re

import numpy as np

from .files import SgmpFileError, read_summary_if_any, read_table, read_units

SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6}
KILOGRAMS = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3}
GRAVITY = 9.80665
AXES = "xyz"


def cfc_filtered(values, step, channel_class):
    """A signal in steps of `step` seconds through the filter of a class: SAE J211-1, appendix C."""
    if step * channel_class * 2.0775 >= 0.25:
        raise SgmpFileError(
            f"CFC {channel_class:g} needs rows at most {1 / (8.31 * channel_class):.3g} s apart,"
            f" better {0.1 / channel_class:.3g} s; they are {step:.3g} s apart: write more by `history every=…`"
        )
    w = np.tan(np.pi * channel_class * 2.0775 * step)
    scale = 1 + np.sqrt(2) * w + w * w
    a = w * w / scale
    b1, b2 = 2 * (1 - w * w) / scale, -(1 - np.sqrt(2) * w + w * w) / scale
    reach = min(len(values) - 1, int(np.ceil(3 / (channel_class * step))))
    values = np.concatenate(  # mirrored about its ends: a filter that starts from nothing would bend them
        [2 * values[0] - values[reach:0:-1], values, 2 * values[-1] - values[-2 : -2 - reach : -1]]
    )
    for _ in range(2):
        x = values - values[0]
        y = np.zeros(len(x))
        for k in range(2, len(x)):
            y[k] = a * (x[k] + 2 * x[k - 1] + x[k - 2]) + b1 * y[k - 1] + b2 * y[k - 2]
        values = (y + values[0])[::-1]
    return values[reach : len(values) - reach]


def in_si(folder):
    """Seconds, metres and kilograms of the units of the deck."""
    units = read_units(folder)
    try:
        return SECONDS[units["time"]], METRES[units["length"]], KILOGRAMS[units["mass"]]
    except KeyError:
        raise SgmpFileError(
            f"{folder}: filters need the deck's units of time, length and mass (card `units`)"
        ) from None


def in_even_steps(folder, time, means, channel_class):
    """Means between times, put in the middle of them and brought to equal steps; filtered where a class is given."""
    if read_summary_if_any(folder).get("dimension") == "axisymmetric":
        means = means * (0, 1, 1)  # sums of radial components are no resultants
    middle, step = 0.5 * (time[1:] + time[:-1]), float(np.median(np.diff(time)))
    even = np.arange(middle[0], middle[-1] + 1e-6 * step, step)
    values = np.column_stack([np.interp(even, middle, column) for column in means.T])
    if channel_class:
        values = np.column_stack([cfc_filtered(column, step, channel_class) for column in values.T])
    return even, values


def contact_forces(folder, channel_class=None, bodies=None):
    """Of each pair in contact.csv: name, time (deck's units), force on its first body (N, 3 columns), ones."""
    table = read_table(folder / "contact.csv")
    second, metre, kilogram = in_si(folder)
    for pair in np.unique(table["pair"]):
        rows = table["pair"] == pair
        name = str(table["bodies"][rows][0])
        if bodies and not any(body in re.split(r"[ +]", name) for body in bodies):
            continue
        time = table["time"][rows] * second
        if len(time) < 4:
            raise SgmpFileError(
                f"{folder}: contact.csv has {len(time)} rows of '{name}'; write more by `history every=…`"
            )
        for words, column in ((name, "force"), (f"{name}, friction", "friction")):
            if f"{column}_x" not in table or (
                column == "friction" and not any(np.any(table[f"friction_{axis}"][rows]) for axis in AXES)
            ):
                continue
            force = np.column_stack([table[f"{column}_{axis}"][rows] for axis in AXES]) * kilogram * metre / second**2
            even, values = in_even_steps(folder, time, force[1:], channel_class)
            yield words, even / second, values, np.ones(len(even))


def wall_forces(folder, channel_class=None, faces=None):
    """Of each wall whose reaction is in history.csv: name, time (deck's units), force on the matter (N, 3 columns),
    ones."""
    table = read_table(folder / "history.csv")
    second, metre, kilogram = in_si(folder)
    walls = [column[5:-10] for column in table if column.startswith("wall_") and column.endswith("_impulse_x")]
    if not walls:
        raise SgmpFileError(f"{folder}: history.csv has no reactions of walls: write `wall … reactions=yes`")
    time = table["time"] * second
    for wall in walls:
        if faces and wall not in faces:
            continue
        impulse = np.column_stack([table[f"wall_{wall}_impulse_{axis}"] for axis in AXES]) * kilogram * metre / second
        even, values = in_even_steps(folder, time, np.diff(impulse, axis=0) / np.diff(time)[:, None], channel_class)
        yield f"wall {wall}", even / second, values, np.ones(len(even))


def section_forces(folder, channel_class=None, names=None):
    """Of each plane in sections.csv: name, time (deck's units), force through it (N, 3 columns), ones."""
    table = read_table(folder / "sections.csv")
    second, metre, kilogram = in_si(folder)
    for name in dict.fromkeys(str(name) for name in table["name"]):
        if names and name not in names:
            continue
        rows = table["name"] == name
        force = np.column_stack([table[f"force_{axis}"][rows] for axis in AXES]) * kilogram * metre / second**2
        time = table["time"][rows] * second
        even, values = in_even_steps(folder, time, 0.5 * (force[1:] + force[:-1]), channel_class)
        yield f"section {name}", even / second, values, np.ones(len(even))


def accelerations(folder, channel_class=None, bodies=None):
    """Of each body: name, time (deck's units), acceleration (m/s², 3 columns), mass (kg); filtered by a class."""
    table = read_table(folder / "bodies.csv")
    second, metre, kilogram = in_si(folder)
    names = list(dict.fromkeys(str(name) for name in table["name"]))
    for name in bodies or names:
        if name not in names:
            raise SgmpFileError(f"{folder}: no body '{name}'; there are: {', '.join(names)}")
        rows = table["name"] == name
        time = table["time"][rows] * second
        if len(time) < 4:
            raise SgmpFileError(
                f"{folder}: bodies.csv has {len(time)} rows of '{name}'; write more by `history every=…`"
            )
        velocity = np.column_stack([table[f"velocity_{axis}"][rows] for axis in AXES]) * metre / second
        even, values = in_even_steps(folder, time, np.diff(velocity, axis=0) / np.diff(time)[:, None], channel_class)
        yield name, even / second, values, np.interp(even, time, table["mass"][rows]) * kilogram


def peaks_of(time, values, mass):
    """Largest resultant with its time, largest values along each axis, largest force; impulse (N, the deck's time)."""
    size = np.linalg.norm(values, axis=1)
    at = int(np.argmax(size))
    signed = [float(column[np.argmax(np.abs(column))]) for column in values.T]
    force = mass[:, None] * values
    return {
        "peak": float(size[at]),
        "peak_g": float(size[at] / GRAVITY),
        "time": float(time[at]),
        "along": dict(zip(AXES, signed)),
        "force": float(np.max(np.linalg.norm(force, axis=1))),
        "impulse": [float(v) for v in np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(time)[:, None], axis=0)],
    }
