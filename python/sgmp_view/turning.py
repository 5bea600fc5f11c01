"""A scene turned against the grid: the copy of its deck, and what its run says in the axes of the deck.

Only scenes whose every card can be turned are: no walls, no ends of the grid, no forces with a place or a direction of
their own. The folder of the run has turned.json, the matrix from the deck's axes to those of the run.
"""

import json
import math
import re
from dataclasses import replace

import numpy as np

from .deck_text import bare
from .files import read_table
from .deck_variations import axes_of, extents_of

DEGREES = 17.0
AXIS = np.array([1.0, 2.0, 2.0]) / 3                    # in space: no plane of the scene stays one of the grid
STAMP = "turned.json"
UNTURNED = {
    "title",
    "units",
    "dimension",
    "table",
    "grid",
    "method",
    "time",
    "stop",
    "material",
    "eos",
    "failure",
    "erode",
    "viscosity",
    # nothing in them has a direction
    "contact",
    "damping",
    "output",
    "history",
    "checkpoint",
    "balance",
    "parameter",
    "include",
    "lost",
}
TURNED = {"body", "add", "subtract", "intersect", "velocity", "gravity", "gauge", "detonation"}


def rotation(degrees, axis):
    """The matrix of a rotation (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.radians(degrees)
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def hindrance(deck):
    """Why a scene cannot be turned, in words; None where it can."""
    if axes_of(deck) not in (("x", "y"), ("x", "y", "z")):
        return "axisymmetric scenes have their axis on the grid" if "r" in axes_of(deck) else "a line cannot be turned"
    if deck.all("wall") or any(extent.lower is not None or extent.upper is not None for extent in extents_of(deck)):
        return "its grid has walls or ends, which hold it"
    other = sorted({card.keyword for card in deck.cards} - UNTURNED - TURNED)
    if other:
        return f"the card {other[0]} has a place or a direction of its own"
    for card in deck.all("body"):
        if bare(card.words[1]).lower() == "file" or (card.get("layout") or "uniform") != "uniform":
            return f"the particles of {card.words[0]} are not laid out by a lattice of their own"
        if len(axes_of(deck)) == 3 and card.get("rotation"):
            return f"body {card.words[0]} is turned already"
    return None


def with_turn(deck):
    """The scene turned by an angle about z, in space about an oblique axis; None where it cannot be."""
    if hindrance(deck):
        return None
    plane = len(axes_of(deck)) == 2
    matrix = rotation(DEGREES, (0, 0, 1) if plane else AXIS)
    for card in deck.cards:
        if card.keyword == "body":
            turn_body(deck, card, plane)
        elif card.keyword == "velocity":
            turn_velocity(deck, card, matrix)
        elif card.keyword == "gravity":
            card.words = [
                written(matrix @ vector(deck, " ".join(card.words).partition("=")[2] or " ".join(card.words)))
            ]
        elif card.keyword in ("gauge", "detonation"):
            for key in ("point", "normal"):
                if card.get(key) or (key == "point" and card.keyword == "gauge"):
                    card.set(key, written(matrix @ vector(deck, card.get(key))))
    return f"the scene turned by {DEGREES:g} degrees"


def vector(deck, text):
    """A vector of the deck; components that are missing are zero."""
    parts = split_top(bare(text).strip()[1:-1])
    return np.array([deck.number(part) for part in parts] + [0.0] * (3 - len(parts)))


def split_top(text):
    """Parts of a list between commas that stand in no brackets."""
    return [part.strip() for part in re.split(r",(?![^()]*\))", text)]


def written(values):
    """A vector for a deck."""
    return "(" + ",".join(repr(float(value)) for value in values) + ")"


def turn_body(deck, card, plane):
    """Turns shapes and lattice of a body; in the plane on top of a rotation that it has."""
    own, pivot = deck.number(card.get("rotation") or "0"), vector(deck, card.get("pivot") or "(0,0,0)")
    card.set("rotation", repr(own + DEGREES))
    if not plane:
        card.set("rotation_axis", written(AXIS))
        card.set("pivot", "(0,0,0)")
        return
    first, both = rotation(own, (0, 0, 1)), rotation(own + DEGREES, (0, 0, 1))
    moved = rotation(DEGREES, (0, 0, 1)) @ (pivot - first @ pivot)
    place = (
        np.linalg.solve((np.eye(3) - both)[:2, :2], moved[:2])
        if abs(math.remainder(own + DEGREES, 360)) > 1e-9
        else [0.0, 0.0]
    )
    card.set("pivot", written([*place, 0.0]))


def turn_velocity(deck, card, matrix):
    """Turns the components and the places that their formulas name."""
    axes = axes_of(deck)
    place = [weighted(matrix[:len(axes), i], axes) for i in range(len(axes))]
    components = [spelt_out(deck, card.get(axis) or "0") for axis in axes]
    components = [
        re.sub(r"(?<![\w.$])[xyz](?![\w(])", lambda found: place[axes.index(found[0])], text) for text in components
    ]
    for row, axis in zip(matrix, axes):
        card.set(axis, weighted(row, components))
    spin = matrix @ [deck.number(card.get(f"omega_{axis}") or "0") for axis in "xyz"]
    for axis, value in zip("xyz", spin):
        if value:
            card.set(f"omega_{axis}", repr(float(value)))
    if card.get("about"):
        card.set("about", written(matrix @ vector(deck, card.get("about"))))


def weighted(factors, texts):
    """A sum of formulas with factors, in brackets."""
    return "(" + "+".join(f"({float(factor)!r})*({text})" for factor, text in zip(factors, texts)) + ")"


def spelt_out(deck, text):
    """A formula in which no parameter stands for a text any more."""
    for _ in range(50):
        further = deck.word(text)
        if further == text:
            return text
        text = further
    return text


# ---------------------------------------------------------------- results in the axes of the deck

def keep_matrix(folder, plane):
    """Notes in the folder of a run how its scene was turned."""
    (folder / STAMP).write_text(json.dumps(rotation(DEGREES, (0, 0, 1) if plane else AXIS).tolist()) + "\n")


def matrix_of(folder):
    """The matrix from the deck's axes to those of the run; None where the scene was not turned."""
    path = folder / STAMP
    return np.array(json.loads(path.read_text())) if path.exists() else None


def table_of(folder, name):
    """A table of a run, its vectors and stresses in the axes of the deck."""
    table, matrix = read_table(folder / name), matrix_of(folder)
    if matrix is None:
        return table
    for base in dict.fromkeys(
        column[:-1] for column in table if column[-1:] in "xyz" and (len(column) == 1 or column[-2] == "_")
    ):
        parts = [f"{base}{axis}" for axis in "xyz"]
        if all(part in table for part in parts):
            table.update(zip(parts, matrix.T @ np.stack([table[part] for part in parts])))
    names = {f"stress_{a}{b}": (i, j) for i, a in enumerate("xyz") for j, b in enumerate("xyz")}
    if "stress_xx" in table:
        tensor = np.zeros((len(table["stress_xx"]), 3, 3))
        for column, (i, j) in names.items():
            if column in table:
                tensor[:, i, j] = tensor[:, j, i] = table[column]
        tensor = np.einsum("ki,nkl,lj->nij", matrix, tensor, matrix)
        table.update({column: tensor[:, i, j] for column, (i, j) in names.items() if column in table})
    return table


def cloud_of(folder, cloud):
    """Particles of a run with places and velocities in the axes of the deck."""
    matrix = matrix_of(folder)
    if matrix is None:
        return cloud
    fields = {
        name: values @ matrix if cloud.components.get(name) == ["x", "y", "z"] else values
        for name, values in cloud.fields.items()
    }
    return replace(cloud, points=cloud.points @ matrix, fields=fields)
