"""Decks of scenes whose truth is known, on grids with unequal cells: half of the side within an interval of a body, and
up to the side that the deck has elsewhere (doc/grids.md)."""
import random
import re

# Scenes that compare decks which must be cut alike, or take means over particles of one size.
LEFT_OUT = {"angle", "boost", "column", "halves", "mirror", "order", "place", "quarter", "sector", "shift", "slab",
            "twin", "units"}


def numbers(text):
    """Components of a vector, or none where they are no numbers."""
    try:
        return [float(part) for part in text.strip("()").split(",")]
    except ValueError:
        return []


def boxes(deck):
    """Lower and upper corners of bodies that are plain blocks or balls, turned or not."""
    for card in re.findall(r"^body .*$", deck, re.M):
        words = dict(re.findall(r"(\w+)=(\([^)]*\)|\S+)", card))
        lower, upper, radius = (numbers(words.get(key, "")) for key in ("lower", "upper", "radius"))
        if lower and upper:
            yield lower, upper
        elif radius:
            centre = numbers(words.get("centre", "")) or [0.0]*3
            yield [x - radius[0] for x in centre], [x + radius[0] for x in centre]


def interval(luck, low, high, cell, extent):
    """Part of a body along an axis, within the extent of the grid and, where cells are to grow, some away from its
    ends."""
    ends = [float(end) if end not in ("", "open") else None for end in (extent or "open:open").split(":")]
    if ends[0] is not None:
        low = max(low, ends[0])
    start = low + (high - low)*luck.choice((0, 0.25, 0.5))
    stop = start + max((high - low)*luck.choice((0.2, 0.4)), 1.5*cell)
    if ends[0] is not None and start < ends[0] + 6*cell:
        start = ends[0]
    if len(ends) == 2 and ends[1] is not None and stop > ends[1] - 6*cell:
        stop = ends[1]
    return f"({start:.12g},{stop:.12g})"


def unequal(deck, seed):
    """The deck with unequal cells along some axes; as it is where nothing can be said of its bodies."""
    luck = random.Random(f"unequal {seed}")
    grid = re.search(r"^grid cell=(\S+)(.*)$", deck, re.M)
    found = list(boxes(deck))
    if not found or " dt=" in deck or re.search(r"^detonation ", deck, re.M):
        return deck
    rings = "dimension axisymmetric" in deck
    axes = "rz" if rings else "xyz"[:int(re.search(r"^dimension (\d)", deck, re.M)[1])]
    extents = dict(re.findall(r"\b([xyzr])=(\S+)", grid[2]))
    words = ""
    for a in sorted(luck.sample(range(len(axes)), luck.randint(1, len(axes)))):
        lower, upper = luck.choice(found)
        if a < len(lower):
            low = max(lower[a], 0.0) if axes[a] == "r" else lower[a]
            words += f" fine_{axes[a]}=" + interval(luck, low, upper[a], float(grid[1]), extents.get(axes[a]))
    ratio = luck.choice((1.05, 1.1, 1.2))
    return deck.replace(grid[0], f"grid cell={float(grid[1])/2!r}{grid[2]}{words} ratio={ratio} "
                                 f"largest={float(grid[1])!r}")
