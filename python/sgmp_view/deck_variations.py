"""Copies of a deck that should give the same result: other cells, another step, place of the grid, method, number of
particles.

Each procedure changes a deck in place and says in words what it has done, or None where the scene leaves no room for
it.
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
    walls = {
        word.split("=")[0].lower()
        for card in deck.all("wall")
        for word in card.words
        if not word.lower().endswith("=free")
    }
    walls |= {
        bare(card.words[0]).lower()
        for keyword in ("wallfriction", "wallmotion")
        for card in deck.all(keyword)
        if card.words
    }
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


def between_walls(deck):
    """Lengths of the axes with walls at both ends, where cells must fit."""
    return [
        extent.upper - extent.lower
        for extent in extents_of(deck)
        if None not in (extent.lower, extent.upper) and all(extent.walls)
    ]


def whole(length, cell):
    """Whether a length is a whole number of cells, as the program has it."""
    return round(length / cell) > 0 and abs(length / cell - round(length / cell)) < 1e-6


def fits(deck, low, high):
    """Sides of cells between two that fit between all walls, the largest first."""
    lengths = between_walls(deck)
    counts = range(max(1, math.ceil(min(lengths) / high - 1e-9)), math.floor(min(lengths) / low + 1e-9) + 1)
    return [
        cell for cell in (min(lengths) / count for count in counts) if all(whole(length, cell) for length in lengths)
    ]


def with_own_cell(deck):
    """The cell that fits between the walls and is nearest to the deck's, which does not; None where it does or none is
    near."""
    cell, lengths = cell_of(deck), between_walls(deck)
    if cell <= 0 or all(whole(length, cell) for length in lengths):
        return None
    near = sorted(fits(deck, 0.5 * cell, 2 * cell), key=lambda each: abs(math.log(each / cell)))
    return with_cells(deck, near[0] / cell) if near else None


def common_count(deck):
    """Largest number that divides the numbers of cells between walls on both sides, on all axes; 0: there are none."""
    return math.gcd(*(round(length / cell_of(deck)) for length in between_walls(deck)))


def walled(deck):
    """The largest factors of the cell size with which walls at both ends of an axis stay on the grid."""
    return [common_count(deck) / m for m in range(1, 6)]


def fitting(deck, target, close=False):
    """Factors of the cell size near a target with which walls stay on the grid, the nearest first; close: only the
    nearest."""
    if not between_walls(deck):
        return [
            target * factor
            for factor in (1, 20 / 21, 21 / 20, 14 / 15, 15 / 14, 0.98, 1.02, 1.036, 0.9, 1.1)[: 1 if close else 10]
        ]
    cell = cell_of(deck)
    factors = [
        each / cell for each in fits(deck, 0.8 * target * cell, 1.25 * target * cell) if abs(each / cell - 1) > 1e-9
    ]
    return sorted(factors, key=lambda factor: abs(math.log(factor / target)))[:1 if close else 8]


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
    keep_extents(deck, extents)
    return f"cell {cell * factor:.4g}"


def with_other_lines(deck, factor):
    """Lines of the grid that lie differently in the bodies where walls hold it: slightly other cells, the same
    particles."""
    cell, extents = cell_of(deck), list(extents_of(deck))
    bodies = [
        card
        for card in deck.all("body")
        if bare(card.words[1]).lower() != "file" and (card.get("layout") or "uniform") == "uniform"
    ]
    particles = [
        deck.number(card.get("spacing")) if card.get("spacing") else cell / deck.number(card.get("ppc") or "2")
        for card in bodies
    ]
    deck.scale(deck.one("grid"), "cell", factor)
    for card, spacing in zip(bodies, particles):
        card.drop("ppc")
        card.set("spacing", repr(spacing))
    keep_extents(deck, extents)
    return f"cell {cell * factor:.4g}, the same particles"


def keep_extents(deck, extents):
    """Leaves the ends of the grid where the deck has them, which may have said it by the cell; the program moves those
    without a wall to the grid."""
    grid = deck.one("grid")
    for extent in extents:
        if grid.get(extent.axis):
            lower, _, upper = grid.get(extent.axis).partition(":")
            ends = [
                text or "open" if value is None else repr(value)
                for text, value in ((lower, extent.lower), (upper, extent.upper))
            ]
            grid.set(extent.axis, ":".join(ends))


def on_grid(extent, cell):
    """The lower end of an extent without walls as the program has it: an extent that is symmetric stays so."""
    more = cell * math.ceil((extent.upper - extent.lower) / cell - 1e-6) - (extent.upper - extent.lower)
    return extent.lower - (0.5 * more if abs(extent.lower + extent.upper) <= 1e-6 * cell else 0)


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
            grid.set(extent.axis, f"{on_grid(extent, cell) - cell + part!r}:{extent.upper + part!r}")
        moved.append(extent.axis)
    return f"grid moved{'' if sign > 0 else ' further'} along {', '.join(moved)}" if moved else None


def with_other_method(deck, allowed, courant, tried=()):
    """The next best method that `allowed` accepts for the scene, other than those tried, at a step that any method
    bears."""
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
    cell, done, bodies = (
        cell_of(deck), set(), [card for card in deck.all("body") if bare(card.words[1]).lower() != "file"],
    )
    fixed = {deck.root(deck.one("grid").get("cell"))}
    counts = [
        max(1, round(cell / deck.number(card.get("spacing"))))
        if card.get("spacing")
        else int(deck.number(card.get("ppc") or "2"))
        for card in bodies
    ]
    for card, count in zip(bodies, counts):
        if card.get("spacing"):
            deck.scale(card, "spacing", count / (count + 1), fixed, done)
        else:
            card.set("ppc", count + 1)
    return (
        f"{' or '.join(str(count + 1) for count in sorted(set(counts)))} particles per cell and axis"
        if bodies
        else None
    )


def with_final_state(deck):
    """Asks for the final state with the particles' volumes, from which extents are taken."""
    deck.cards.append(Card(["output", "csv", "at=end", "fields=volume"]))
