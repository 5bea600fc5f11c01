"""What a run has answered: each body at its start and end, and what the projectile has lost."""

import numpy as np

from .files import read_summary_if_any
from .quantities import reach_of, sizes_of
from .runs import Run

AXES = "xyz"


def state_of(at, units, axes, round_axis):
    """Numbers of a body at its start or end: label, value and unit."""
    straight = [(axis, at[f"velocity_{axis}"]) for axis in axes if not (round_axis and axis == "x")]
    yield "mass", at["mass"], units["mass"]
    for axis, value in straight:
        yield f"mean velocity, {axis}", value, units["velocity"]
    yield "kinetic energy", at["kinetic_energy"], units["energy"]
    yield "internal energy", at["internal_energy"], units["energy"]
    for axis, value in straight:
        yield f"momentum, {axis}", at["mass"] * value, units["momentum"]
    yield "particles", at["particles"], ""


def cloud_of(cloud, of_body, axes, units, summary):
    """What a dump says of the particles of a body: extents, share that has failed, temperature."""
    if not np.any(of_body):
        return
    sizes = sizes_of(cloud, of_body, summary)
    for axis in axes:
        low, high = reach_of(cloud.points[of_body, AXES.index(axis)], *sizes)
        name = "r" if summary["dimension"] == "axisymmetric" and axis == "x" else axis
        yield f"extent, {name}", f"{low:.5g} … {high:.5g}", units["length"]
    if "damage" in cloud.fields:
        yield "failed, share of its particles", float(np.mean(cloud.fields["damage"][of_body] >= 1)), ""
    # 0 where the material has none
    if "temperature" in cloud.fields and cloud.fields["temperature"][of_body].max() > 0:
        yield "largest temperature", float(cloud.fields["temperature"][of_body].max()), "K"


def wide_axes(clouds):
    """The axes along which the particles of some dumps lie apart."""
    return [axis for k, axis in enumerate(AXES) if any(np.ptp(cloud.points[:, k]) > 0 for cloud in clouds)]


def no_temperature(cards, clouds):
    """What to add to the deck where materials heat up and the dumps do not say how far; empty where there is nothing to
    add."""
    heats = any(card.startswith("material ") and "thermal=yes" in card for card in cards)
    if heats and clouds and not any("temperature" in cloud.fields for cloud in clouds):
        return "the dumps have no temperature: add temperature to the fields of `output`"
    return ""


def moving_axes(bodies):
    """The axes along which bodies lie or move; those of thin directions are left out."""
    def used(axis):
        return any(np.any(body.series[column] != 0) for body in bodies for column in (axis, f"velocity_{axis}"))
    return [axis for axis in AXES if used(axis)] or ["x"]


def projectile_of(bodies):
    """The body that is fastest at its start, where others are at rest or slower; None where all move alike."""
    def speed(body):
        return np.linalg.norm([body.start[f"velocity_{axis}"] for axis in AXES])
    ordered = sorted(bodies, key=speed)
    if not ordered or speed(ordered[-1]) == 0 or (len(ordered) > 1 and speed(ordered[-2]) > 0.999 * speed(ordered[-1])):
        return None
    return ordered[-1]


def loss_of(body):
    """Velocity along its first direction at start and end, and the share of it that is lost."""
    before = np.array([body.start[f"velocity_{axis}"] for axis in AXES])
    after = np.array([body.end[f"velocity_{axis}"] for axis in AXES])
    speed = np.linalg.norm(before)
    along = float(after @ before / speed)
    return float(speed), along, 1 - along / speed


def bodies_table(folder, units, clouds=()):
    """Per body: rows of label, value at the start, value at the end, unit; `clouds`: first and last dump, where there
    are two or more."""
    bodies = Run(folder).bodies
    summary = read_summary_if_any(folder)
    round_axis = summary.get("dimension") == "axisymmetric"  # the mean of radial velocities says nothing
    axes, wide = moving_axes(bodies.values()), wide_axes(clouds)
    for number, (name, body) in enumerate(bodies.items(), 1):
        sides = [list(state_of(at, units, axes, round_axis)) for at in (body.start, body.end)]
        for side, cloud in zip(sides, clouds if summary.get("spacing") else ()):
            side += cloud_of(cloud, cloud.fields["body"] == number, wide, units, summary)
        then, now = ({label: value for label, value, _ in side} for side in sides)
        unit_of = {label: unit for side in sides for label, _, unit in side}
        rows = [(label, then.get(label, ""), now.get(label, ""), unit) for label, unit in unit_of.items()]
        if body.start["mass"] > 0 and body.end["mass"] != body.start["mass"]:
            rows.append(
                ("mass that is gone (eroded or lost), share", 0.0, 1 - body.end["mass"] / body.start["mass"], "")
            )
        yield name, rows
