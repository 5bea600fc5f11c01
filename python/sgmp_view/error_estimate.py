"""The interval of a number from runs that should have given the same: cells, step, place of the grid, method,
particles."""

import math

from .grid_convergence import IRREGULAR, REGULAR, convergence_of

PARTS = ("cells", "step", "grid's place", "method", "particles")


def half_widths(values):
    """Half-width of each part, nan where it is not known, and what the cells say.

    values: by part, pairs (setting, value); 'cells' has sides of cells, the deck's own run among them as the pair
    'deck'.
    """
    cell, own = values["deck"][0]
    found = convergence_of([(cell, own), *values.get("cells", [])], cell)
    widths = {"cells": found.half_width}
    for part in PARTS[1:]:
        factor = IRREGULAR if part == "step" else 1.0  # two steps of ratio 2, first order: Roache's index of two sizes
        differences = [abs(value - own) for _, value in values.get(part, [])]
        widths[part] = factor * max(differences) if differences else math.nan
    return widths, found


def total_of(widths):
    """All parts together; they are independent of each other."""
    return math.sqrt(sum(width**2 for width in widths.values() if not math.isnan(width)))


def errors_of_runs(values, widths, found):
    """By part and setting: the error to be expected of each run, as of the deck's own."""
    own = values["deck"][0][1]
    finest = min([*values.get("cells", []), *values["deck"]])[1]
    rest = total_of({part: width for part, width in widths.items() if part != "cells"})
    for part, pairs in values.items():
        for setting, value in pairs:
            away = abs(value - finest)
            cells = (
                REGULAR * abs(value - found.limit)
                if found.limit is not None
                else max(away, widths["cells"] + away - abs(own - finest))
            )
            yield (part, setting), math.hypot(cells, rest)


def needed_cell(cell, widths, found, tolerance):
    """Cell with which the tolerance would be reached by the order that the runs show; None where they show none or
    other parts are larger."""
    rest = total_of({part: width for part, width in widths.items() if part != "cells"})
    if found.order is None or rest >= tolerance or widths["cells"] == 0:
        return None
    return cell * (math.sqrt(tolerance**2 - rest**2) / widths["cells"]) ** (1 / found.order)


def verdict_of(widths, tolerance, spoken, sound):
    """In words: whether the number may be quoted. tolerance: absolute; spoken: as it was given."""
    if math.isnan(widths["cells"]):
        return "cells not varied: nothing can be said"
    missing = [part for part, width in widths.items() if math.isnan(width)]
    looked = f", and not looked at: {', '.join(missing)}" if missing else ""
    if total_of(widths) > tolerance:
        return f"not converged{looked}; do not quote"
    if not sound:
        return f"within {spoken}, but the run is doubtful; do not quote"
    return f"converged to {spoken}" + (f" as far as was looked, not at: {', '.join(missing)}" if missing else "")


def rounded(value, width):
    """A value with as many digits as its error leaves, and the error with two."""
    if math.isnan(width) or math.isinf(width):
        return f"{value:.4g}", "unknown"
    if width == 0:
        return f"{value:.6g}", "0"
    if width < 1e-12 * abs(value):
        return f"{value:.6g}", f"{width:.1g}"
    digits = 1 - math.floor(math.log10(width))
    if -4 <= math.floor(math.log10(max(abs(value), width))) < 6:
        places = max(0, digits)
        return f"{round(value, digits):.{places}f}", f"{round(width, digits):.{places}f}"
    power = 10.0 ** math.floor(math.log10(max(abs(value), width)))
    places = max(0, digits + math.floor(math.log10(power)))
    return f"{value / power:.{places}f}e{math.log10(power):.0f}", f"{width / power:.{places}f}e{math.log10(power):.0f}"


def line_of(name, value, unit, widths, words, coarse):
    """The answer in one line. coarse: what is said of parts that were looked at with coarser cells."""
    number, width = rounded(value, total_of(widths))
    parts = ", ".join(f"{part} ±{shortly(part_width)}" + (f" {coarse[part]}" if part in coarse else "")
                      for part, part_width in widths.items() if not math.isnan(part_width))
    return f"{name} = {number}{f' {unit}' if unit else ''} ± {width} ({parts}): {words}"


def shortly(width):
    """A half-width with two digits, without exponents where they can be read."""
    if width == 0:
        return "0"
    digits = 1 - math.floor(math.log10(width))
    return f"{round(width, digits):.{max(0, digits)}f}" if 1e-4 <= width < 1e6 else f"{width:.2g}"
