"""Copies of a deck that should give the same result: other cells, another step, place of the grid, method, number of particles.

Each procedure changes a deck in place and says in words what it has done, or None where the scene leaves no room for it.
"""

import math
from typing import NamedTuple, Optional

from .deck_text import Card, bare

AXES = "xyz"
FAR = 2000                                              # cells from the particles to an end of the grid that was open
METHODS = ("gimp", "bspline", "sgmp", "cpgimp", "mpm")  # by how little they mind where the grid lies
GENERAL = ("update", "flip", "split", "split_most")     # keys of `method` that all methods know
SAFE = 0.8                                              # Courant number for any method
PARTS = {"x": 0.37, "y": 0.41, "z": 0.29, "r": 0.0}     # of a cell, by which the grid is shifted


class Extent(NamedTuple):
    """Extent of the grid along an axis; None: open. walls: whether a wall stands at the lower and the upper end."""

    axis: str
    lower: Optional[float]
    upper: Optional[float]
    walls: tuple


def axes_of(deck):
    """Names of the axes of the scene."""
    card = deck.all("dimension")
    word = bare(deck.word(card[0].words[0])) if card else "3"
    return ("r", "z") if word == "axisymmetric" else tuple(AXES[:int(deck.number(word))])


def extents_of(deck):
    """The extents of the grid and where walls stand."""
    walls = {word.split("=")[0].lower() for card in deck.all("wall") for word in card.words if not word.lower().endswith("=free")}
    walls |= {bare(card.words[0]).lower() for keyword in ("wallfriction", "wallmotion") for card in deck.all(keyword) if card.words}
    grid = deck.one("grid")
    for axis in axes_of(deck):
        lower, _, upper = deck.word(grid.get(axis) or "open:open").partition(":")
        ends = [None if end in ("open", "") else deck.number(end) for end in (lower, upper or "open")]
        yield Extent(axis, *ends, (axis == "r" or f"{axis}-" in walls, f"{axis}+" in walls))


def cell_of(deck):
    """Side of a cell."""
    cell = deck.number(deck.one("grid").get("cell") or "")
    if cell is None:
        raise ValueError(f"{deck.path}: the side of a cell is no number: 'grid cell={deck.one('grid').get('cell')}'")
    return cell


def common_count(deck):
    """Largest number that divides the numbers of cells between walls on both sides, on all axes; 0: there are none."""
    cell = cell_of(deck)
    return math.gcd(*(round((extent.upper - extent.lower) / cell) for extent in extents_of(deck)
                      if None not in (extent.lower, extent.upper) and all(extent.walls)))


def walled(deck):
    """The largest factors of the cell size with which walls at both ends of an axis stay on the grid."""
    return [common_count(deck) / m for m in range(1, 6)]


def fitting(deck, target, close=False):
    """Factors of the cell size near a target with which walls stay on the grid, the nearest first; close: only the nearest."""
    common = common_count(deck)
    if not common:
        return [target * factor for factor in (1, 20 / 21, 21 / 20, 14 / 15, 15 / 14, 0.98, 1.02, 1.036, 0.9, 1.1)[:1 if close else 10]]
    factors = [common / m for m in range(1, 4 * common + 1) if m != common]
    return [factor for factor in sorted(factors, key=lambda f: abs(math.log(f / target))) if 0.8 < factor / target < 1.25][:1 if close else 8]


def with_cells(deck, factor):
    """Cells, and distances of particles that do not follow by themselves, multiplied by a factor."""
    grid, before = deck.one("grid"), spacings(deck)
    cell, extents, step = cell_of(deck), list(extents_of(deck)), step_of(deck)
    deck.scale(grid, "cell", factor)
    done = set()
    for card, spacing in before:
        if spacing is not None and math.isclose(deck.number(card.get("spacing")) or 0.0, spacing, rel_tol=1e-9):
            deck.scale(card, "spacing", factor, done=done)
    if step is not None and factor < 1 and math.isclose(step_of(deck), step, rel_tol=1e-9):
        deck.scale(deck.one("time"), "dt", factor)
    widen_all(deck, extents, cell * factor)
    return f"cell {cell * factor:.4g}"


def with_other_lines(deck, factor):
    """Lines of the grid that lie differently in the bodies where walls hold it: slightly other cells, the same particles."""
    cell, extents = cell_of(deck), list(extents_of(deck))
    bodies = [card for card in deck.all("body") if bare(card.words[1]).lower() != "file" and (card.get("layout") or "uniform") == "uniform"]
    particles = [deck.number(card.get("spacing")) if card.get("spacing") else cell / deck.number(card.get("ppc") or "2") for card in bodies]
    deck.scale(deck.one("grid"), "cell", factor)
    for card, spacing in zip(bodies, particles):
        card.drop("ppc")
        card.set("spacing", repr(spacing))
    widen_all(deck, extents, cell * factor)
    return f"cell {cell * factor:.4g}, the same particles"


def widen_all(deck, extents, cell):
    """Moves ends without walls to where the grid has lines."""
    for extent in extents:
        if None not in (extent.lower, extent.upper) and not all(extent.walls):
            widen(deck, extent, cell)


def widen(deck, extent, cell):
    """Moves an end without a wall outwards to where the grid has a line."""
    length = cell * math.ceil((extent.upper - extent.lower) / cell - 1e-9)
    ends = (extent.upper - length, extent.upper) if extent.walls[1] else (extent.lower, extent.lower + length)
    deck.one("grid").set(extent.axis, f"{ends[0]!r}:{ends[1]!r}")


def spacings(deck):
    """Bodies that give a distance of particles, with its value."""
    return [(card, deck.number(card.get("spacing"))) for card in deck.all("body") if card.get("spacing")]


def step_of(deck):
    """A fixed time step, if there is one."""
    return deck.number(deck.one("time").get("dt")) if deck.one("time").get("dt") else None


def until(deck, end):
    """Lets it end at a time instead of after a number of steps."""
    time = deck.one("time")
    if time.get("steps"):
        time.drop("steps")
        time.set("end", repr(end))


def with_half_step(deck, courant):
    """Half the fixed step, or half the Courant number."""
    time = deck.one("time")
    if time.get("dt"):
        deck.scale(time, "dt", 0.5)
        return "half the time step"
    time.set("cfl", repr(0.5 * courant))
    return f"Courant number {0.5 * courant:.3g}"


def with_shift(deck, lowest, sign):
    """The grid moved by a part of a cell along all axes that walls leave free; lowest: a point below all particles."""
    grid, cell, moved = deck.one("grid"), cell_of(deck), []
    for extent, low in zip(extents_of(deck), lowest):
        part = cell * (PARTS[extent.axis] if sign > 0 else 1 - 0.6 * PARTS[extent.axis])
        if any(extent.walls) or (extent.lower is None) != (extent.upper is None):
            continue
        if extent.lower is None:
            grid.set(extent.axis, f"{cell * (math.floor(low / cell) - FAR) + part!r}:open")
        else:
            grid.set(extent.axis, f"{extent.lower - cell + part!r}:{extent.upper + part!r}")
        moved.append(extent.axis)
    return f"grid moved{'' if sign > 0 else ' further'} along {', '.join(moved)}" if moved else None


def with_other_method(deck, allowed, courant, tried=()):
    """The next best method that `allowed` accepts for the scene, other than those tried, at a step that any method bears."""
    card = deck.one("method")
    own = bare(deck.word(card.words[0])).lower() if card.words and "=" not in card.words[0] else "sgmp"
    keys = [word for word in card.words if "=" in word]
    few = [word for word in keys if word.partition("=")[0].lower() in GENERAL]
    for name in METHODS:
        for words in (keys, few, []):
            card.words = [name, *words]
            if name not in (own, *tried) and allowed(deck):
                return f"method {name}" + slower(deck, courant)
    return None


def slower(deck, courant):
    """Takes the Courant number down to one that any method bears."""
    time = deck.one("time")
    if time.get("dt") or courant <= SAFE:
        return ""
    time.set("cfl", repr(SAFE))
    return f", Courant number {SAFE}"


def with_more_particles(deck):
    """One more particle per cell and axis."""
    cell, done, bodies = cell_of(deck), set(), [card for card in deck.all("body") if bare(card.words[1]).lower() != "file"]
    fixed = {deck.root(deck.one("grid").get("cell"))}
    counts = [max(1, round(cell / deck.number(card.get("spacing")))) if card.get("spacing") else int(deck.number(card.get("ppc") or "2")) for card in bodies]
    for card, count in zip(bodies, counts):
        if card.get("spacing"):
            deck.scale(card, "spacing", count / (count + 1), fixed, done)
        else:
            card.set("ppc", count + 1)
    return f"{' or '.join(str(count + 1) for count in sorted(set(counts)))} particles per cell and axis" if bodies else None


def with_final_state(deck):
    """Asks for the final state with the particles' volumes, from which extents are taken."""
    deck.cards.append(Card(["output", "csv", "at=end", "fields=volume"]))
