#!/usr/bin/env python3
"""Damaged MPM3D decks: each must be imported or refused with a word at its place; no crash, no hang.

usage: mpm3d.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S]

Mutates the decks of tests/decks/mpm: letters, words, lines, numbers, pieces of other decks. Whatever is imported must
be a deck that sgmp reads: every tenth is checked (it may be refused with exit code 3, for a mutation makes any number).
"""
import os
import random
import re
import shutil

from _driver import CRASH, HANGS, Driver, Findings, arguments

NUMBERS = (
    "0", "-1", "1e300", "1e-300", "1d3", "nan", "inf", "99999999999", "0.1", "2", ".5", "+1", "1e", "--1", "1.2.3",
    "2147483647", "-0", "1e999", "7",
)
WORDS = (
    "part", "block", "point", "sphere", "blod", "cicle", "velo", "load", "endl", "endv", "endi", "mate", "seos", "spx",
    "off", "on", "sgmp", "gimp", "curv", "pres", "curx", "deto", "cont", "lagr", "!", "\x00", "\xff", "\t", "mpm3d",
    "nuli", "ksin", "vsin", "fixed", "grid", "poin", "qulo",
)


class Mutator:
    """Decks from decks."""

    def __init__(self, seed, decks):
        self.luck = random.Random(seed)
        self.decks = decks

    def new(self):
        text = self.luck.choice(self.decks)
        for _ in range(self.luck.choice((1, 1, 1, 2, 3, 8))):
            text = self.luck.choice(
                (self.letter, self.word, self.word, self.number, self.number, self.line, self.splice)
            )(text)
        return text

    def letter(self, text):
        at = self.luck.randrange(len(text) + 1)
        kind = self.luck.randrange(4)
        if kind == 0:
            return text[:at] + chr(self.luck.randrange(256)) + text[at:]
        if kind == 1:
            return text[:at]
        return text[:at] + (chr(self.luck.randrange(32, 127)) if kind == 2 else "") + text[at + 1:]

    def pick(self, text, pattern):
        found = list(re.finditer(pattern, text))
        return self.luck.choice(found).span() if found else (0, 0)

    def word(self, text):
        first, last = self.pick(text, r"\S+")
        return (
            text[:first]
            + self.luck.choice(("", self.luck.choice(WORDS), text[first:last] + " " + text[first:last]))
            + text[last:]
        )

    def number(self, text):
        first, last = self.pick(text, r"(?<=\s)-?[\d.]\S*")
        new = self.luck.choice(NUMBERS)
        if self.luck.random() < 0.5 and re.fullmatch(r"-?\d+", text[first:last]):
            new = str(int(text[first:last]) + self.luck.choice((-1, 1, 3)))
        return text[:first] + new + text[last:]

    def line(self, text):
        lines = text.split("\n")
        at = self.luck.randrange(len(lines))
        lines.insert(self.luck.randrange(len(lines)), lines[at] if self.luck.random() < 0.5 else lines.pop(at))
        return "\n".join(lines)

    def splice(self, text):
        other = self.luck.choice(self.decks)
        return text[:self.luck.randrange(len(text) + 1)] + other[self.luck.randrange(len(other)):]


def wrong(code, printed, text, path):
    """What is not as it should be with the end of an import."""
    if code in HANGS:
        return "hang"
    if code < 0 or CRASH.search(printed):
        return f"crash {code}"
    if code not in (0, 3):
        return f"exit code {code}"
    if code == 3:
        places = [int(line) for line in re.findall(re.escape(path) + r":(\d+):\d+: error: .", printed)]
        if not places and ": error: the deck ends" not in printed:
            return "refused without a place"
        if any(line > text.count("\n") + 1 for line in places):
            return "refused at a line that is not there"
    return ""


def main():
    """So many decks of a seed."""
    chosen = arguments(__doc__, 1000)
    folder = os.path.join(chosen.source, "tests", "decks", "mpm")
    decks = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".mpm"):
            with open(os.path.join(folder, name), encoding="latin-1", newline="") as file:
                decks.append(file.read())
    mutator, driver, findings, codes = (
        Mutator(chosen.seed, decks), Driver(chosen.sgmp, chosen.scratch), Findings(chosen.scratch), {},
    )
    path, out = os.path.join(chosen.scratch, "deck.mpm"), os.path.join(chosen.scratch, "out")
    native = os.path.join(out, "deck.inp")
    for number in range(chosen.inputs):
        text = mutator.new()
        with open(path, "w", encoding="latin-1", newline="") as file:
            file.write(text)
        if os.path.exists(native):
            os.remove(native)
        code, printed = driver.run(["import", path, "--output", out])
        codes[code] = codes.get(code, 0) + 1
        problem = wrong(code, printed, text, path)
        if not problem and code == 0 and number % 10 == 0:
            code, printed = driver.run([native, "--check", "--output", os.path.join(out, "checked")])
            if code not in (0, 3) or CRASH.search(printed):
                problem = f"the native deck ends with {code}"
        if problem:
            findings.add(problem, f"deck_{number}.mpm", text.encode("latin-1"), printed)
    driver.close()
    shutil.rmtree(out, ignore_errors=True)
    findings.end(chosen.inputs, "MPM3D decks", chosen.seed, codes)


main()
