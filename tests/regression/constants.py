#!/usr/bin/env python3
"""Constants of materials: every one outside of the range that the reference states is an error of the deck that names
it, and within the ranges nothing that a die throws ends a run without a word.

usage: constants.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math
import os
import random
import re
import sys

from _runs import FULL, SOURCE, Report, run

sys.path.insert(0, os.path.join(SOURCE, "scripts", "dev"))
from material_models import EQUATIONS, LAWS, cards_of  # noqa: E402

DECK = """
dimension 1
grid cell=1
time cfl=0.3 steps=5
{cards}
body b block material=m lower=0 upper=4 ppc=2
velocity b x="-0.01*x"
output csv fields=stress,density
"""
TOGETHER = 40  # materials in a deck of values that are refused
THROWS = 12 if FULL else 5  # of each law and equation of state
# Kinds of the cards that have other keys for each kind; the others have the same keys for all.
CARDS = {"material": LAWS, "eos": EQUATIONS, "failure": {"": None}, "viscosity": {"": None}}


def reference():
    """(card, key, range, kinds) of the numbers in the deck reference."""
    with open(os.path.join(SOURCE, "doc", "deck-reference.md"), encoding="utf-8") as file:
        chapters = dict(re.findall(r"^## (\w+)\n(.*?)(?=^## |\Z)", file.read(), re.MULTILINE | re.DOTALL))
    for card in CARDS:
        for line in chapters[card].splitlines():
            cells = [cell.strip() for cell in line.split("|")[1:-1]]
            if len(cells) == 7 and cells[1] == "number":
                yield card, cells[0].split("`")[1], cells[4].strip("`"), cells[5].split()


def bounds(interval):
    """Ends of (a,b], and whether they belong to it."""
    low, high = (float(end) for end in interval[1:-1].split(","))
    return low, high, interval[0] == "[", interval[-1] == "]"


def outside(interval):
    """Numbers that an interval does not hold: beyond its ends, and the ends that it leaves out."""
    low, high, with_low, with_high = bounds(interval)
    values = []
    if low > -math.inf:
        values += [low - 0.7] + ([] if with_low else [low])
    if high < math.inf:
        values += [high + 0.7] + ([] if with_high else [high])
    return values


def base(card, kind):
    """Cards of a deck in which a key of this card and kind may stand."""
    if card == "material":
        return cards_of("law", kind)
    if card == "eos":
        return cards_of("eos", kind)
    return cards_of("law", "j2") + ("\nfailure m pmin=-1" if card == "failure" else "\nviscosity m")


def with_key(cards, card, key, value):
    """The cards with another value of a key."""
    lines = cards.splitlines()
    for i, line in enumerate(lines):
        if line.split()[0] == card:
            lines[i] = re.sub(rf" {key}=\S+", "", line) + f" {key}={value}"
    return "\n".join(lines)


def ranges(report):
    """Each key with a range, in every kind that has it."""
    tried = [(card, kind, key, value)
             for card, key, interval, kinds in reference() if interval
             for kind in kinds or list(CARDS[card])[:1] if kind in CARDS[card]
             for value in [*outside(interval), "1e70", "nan"]]
    report.check(len(tried) > 150, f"{len(tried)} values out of range")
    for start in range(0, len(tried), TOGETHER):
        refused(report, tried[start:start + TOGETHER])


def refused(report, tried):
    """A deck with a material for each of the values: the line of each has an error that names the key, or says what is
    wrong with the number."""
    lines, places = [], []
    for number, (card, kind, key, value) in enumerate(tried):
        own = with_key(base(card, kind), card, key, value).splitlines()
        places += [len(lines) + next(i for i, line in enumerate(own, 1) if line.split()[0] == card)]
        lines += [re.sub(r"^(\w+) m\b", rf"\1 m{number}", line) for line in own]
    result = run("range", "\n".join([*lines, DECK.format(cards=cards_of("law", "j2"))]), options=["--check"])
    report.check(result.code == 3, f"exit code {result.code}\n{result.text}")
    said = {}
    for line, text in re.findall(r"^\S+:(\d+):\d+: error: (.*)$", result.text, re.MULTILINE):
        said.setdefault(int(line), []).append(text)
    for (card, kind, key, value), place in zip(tried, places):
        words = {"1e70": "beyond all measure", "nan": "nan"}.get(value, f"'{key}' =")
        report.check(any(words in text for text in said.get(place, [])),
                     f"{card} {kind} {key}={value}: {said.get(place)} of line {place}: {lines[place - 1]}")


def throws(report):
    """Random constants within their ranges: a run ends well with finite numbers, or says why not."""
    die = random.Random(20)
    keys = list(reference())
    ended = {}
    for card, table in (("material", LAWS), ("eos", EQUATIONS)):
        for kind in table:
            for _ in range(THROWS):
                cards = base(card, kind)
                for _, key, interval, kinds in [
                    entry for entry in keys if entry[0] == card and (not entry[3] or kind in entry[3])
                ]:
                    if key in ("energy0", "pressure0") or die.random() < 0.5:
                        continue
                    low, high, *_ = bounds(interval) if interval else (-math.inf, math.inf, False, False)
                    size = 10**die.uniform(-4, 4)
                    value = (
                        low + size
                        if low > -math.inf
                        else high - size
                        if high < math.inf
                        else die.choice((-1, 1)) * size
                    )
                    if low > -math.inf and high < math.inf:
                        value = die.uniform(low, high)
                    cards = with_key(cards, card, key, f"{value:.6g}")
                result = run("thrown", DECK.format(cards=cards))
                ended[result.code] = ended.get(result.code, 0) + 1
                if result.code == 0:
                    rows = result.table("particles_end.csv")
                    finite = all(
                        math.isfinite(value) for row in rows for value in row.values() if isinstance(value, float)
                    )
                    report.check(finite and rows, f"{kind}: numbers that are none\n{cards}")
                else:
                    report.check(
                        result.code in (3, 4) and re.search(r"error: .{10}", result.text),
                        f"{kind}: exit code {result.code}\n{cards}\n{result.text}",
                    )
    report.check(ended.get(0, 0) > sum(ended.values())/2, f"ended with {ended}")


if __name__ == "__main__":
    REPORT = Report()
    ranges(REPORT)
    throws(REPORT)
    REPORT.end()
