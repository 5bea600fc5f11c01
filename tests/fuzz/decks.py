#!/usr/bin/env python3
"""Damaged decks: `sgmp --check` must accept or refuse each in words. Decks of input/ and tests/decks are changed by
byte, by word and by grammar. A finding is a crash, a hang (30 s of the processor), an exit code that --check does not
have, a refusal without a place, a report about a line that does not exist, or a deck that is accepted with a card, a
key or a number that the deck reference does not allow.

usage: decks.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S]
"""
import os
import random
import re

from _deck_language import objections, reference
from _driver import CRASH, HANGS, Driver, Findings, arguments

NUMBERS = [
    "0", "-0", "1", "-1", "2", "3", "0.5", "1e-3", "1e3", "1e-12", "1e12", "1e-60", "1e60", "1e-300", "1e300", "1e999",
    "-1e999", "nan", "inf", "2147483647", "2147483648", "-2147483649", "9223372036854775808", "0x10", "1d3", "1e", "1.",
    ".5", ".", "-", "1,5", "1e5e5", "1/0", "0/0", "sqrt(-1)", "(1", "1)", "((1))", "1^1000", "10^10^10", "log(0)", "t",
    "x", "x0", "pi", "h", "h/0", "1;2", "1?2:3", "1 2", "$h", "${h}", "$", "${", "$nothing", "auto", "open", "0:1",
    "1:0", ":", "0:", "::", "open:open", "1:open", "nan:inf", "yes", "no", "all", "''", '""', "\"x y\"", "(0,0,0)",
    "(1,1,1)", "(0,0)", "(1)", "()", "(,)", "(1,2,3,4)", "(nan,0,0)", "0,0,1", "1e-9*(1+1)", "a=b", "9" * 400,
    "(" * 200, "-" * 300 + "1", "sin(" * 60 + "1" + ")" * 60,
]
SIGNS = list("\t !#&=\"'()$,:;{}\\/.-+*^%\x00\x01\x7f\xff\xc3\xa9") + [
    "\r\n", "\n", "\n\n", "&\n", "$h", "**", "\xef\xbb\xbf",
]
# Quickly built, with most cards.
SMALL = """title "Small"
units mm g ms
parameter h = 0.5
dimension 2
grid cell=h x=0:8 y=0:open
wall x-=slip y-=fixed
lost remove
method sgmp update=usavg stress=plain
time end=1 cfl=auto growth=1.1
material m johnson_cook density=1 young=10 poisson=0.3 yield=0.1 thermal=yes melt_temperature=900 specific_heat=1
eos m gruneisen c0=3 s=1.5 gamma0=2
material n explosive density=1 detonation_speed=3
eos n jwl a=371 b=3 r1=4 r2=1 omega=0.3 energy0=7
detonation point=(0,0) time=0.1
viscosity m linear=0.1
body a block material=m lower=(0,0) upper=(4,2) ppc=2
subtract a sphere centre=(2,1) radius=0.5
add a ring centre=(6,1) radius=1 inner=0.5
body b cylinder material=n centre=(2,4) radius=1.5 spacing=0.3 jitter=0.1
velocity b y="-0.1*x"
gravity (0,-0.1)
bodyforce a x="sin(t)*x0"
contact a b friction=0.3 normal=average
rigid b y=-0.1
gauge g point=(1,1)
history every=0.1
output vtu every=0.5 fields=stress,pressure
checkpoint every=100 keep=3
balance every=8
stop energy_growth=2
"""
NAMES = ["a", "m", "bar", "block", "steel", "all", "x", "file", "wall", "B" * 40, "9a", "a-b", "é", "title", "end"]


class Mutator:
    """Changes of a deck, all from one stream of random numbers."""

    def __init__(self, seed, good, bad, cards):
        self.luck = random.Random(seed)
        self.good, self.decks, self.cards = good, good + bad, cards

    def new(self):
        """A deck, changed once or a few times."""
        text = self.luck.choice(self.good if self.luck.random() < 0.7 else self.decks)
        for _ in range(self.luck.choice((1, 1, 1, 1, 2, 3, 8))):
            text = self.luck.choice((self.byte, self.word, self.word, self.line, self.grammar, self.grammar))(text)
        return text[:200000]

    def byte(self, text):
        """One place in the text."""
        at = self.luck.randrange(len(text) + 1)
        kind = self.luck.randrange(6)
        if kind == 0:
            return text[:at] + chr(self.luck.randrange(256)) + text[at + 1:]
        if kind == 1:
            return text[:at] + text[at + self.luck.choice((1, 1, 1, 5, 50)):]
        if kind == 2:
            return text[:at] + self.luck.choice(SIGNS) + text[at:]
        if kind == 3:
            return text[:at]
        if kind == 4:
            return text[:at] + text[at:at + 40] * self.luck.choice((1, 2, 30)) + text[at:]
        other = self.luck.choice(self.decks)
        return text[:at] + other[self.luck.randrange(len(other) + 1):]

    def word(self, text):
        """One word."""
        words = re.split(r"(\s+|=)", text)
        at = self.luck.randrange(len(words))
        kind = self.luck.randrange(5)
        if kind == 0:
            words[at] = self.luck.choice(NUMBERS)
        elif kind == 1:
            words[at] = ""
        elif kind == 2:
            other = self.luck.randrange(len(words))
            words[at], words[other] = words[other], words[at]
        elif kind == 3:
            words[at] = words[at] + words[at]
        else:
            values = [i for i in range(2, len(words)) if words[i - 1] == "="]
            if values:
                words[self.luck.choice(values)] = self.luck.choice(NUMBERS)
        return "".join(words)

    def line(self, text):
        """One line."""
        lines = text.split("\n")
        at, other = self.luck.randrange(len(lines)), self.luck.randrange(len(lines))
        kind = self.luck.randrange(5)
        if kind == 0:
            del lines[at]
        elif kind == 1:
            lines.insert(at, lines[other])
        elif kind == 2:
            lines[at], lines[other] = lines[other], lines[at]
        elif kind == 3:
            lines[at] += " " + lines[other]
        else:
            lines[at] = lines[at] * self.luck.choice((2, 3, 40))
        return "\n".join(lines)

    def grammar(self, text):
        """A card of the reference, with some of its keys and more or less fitting values."""
        name = self.luck.choice(list(self.cards))
        keys = self.cards[name]
        words = [name]
        for key in keys:
            if key.default == "*required*" or self.luck.random() < 0.25:
                value = self.value(key)
                words.append(value if key.slot else f"{key.name}={value}")
        lines = text.split("\n")
        lines.insert(self.luck.randrange(len(lines) + 1), " ".join(words))
        return "\n".join(lines)

    def value(self, key):
        """A value for a key: one that fits, mostly."""
        if self.luck.random() < 0.2:
            return self.luck.choice(NUMBERS)
        if key.kind == "number":
            return self.luck.choice(("0.5", "1", "2e3", "0.01", "h"))
        if key.kind == "whole number":
            return self.luck.choice(("1", "2", "3", "10"))
        if key.kind.startswith("vector"):
            return self.luck.choice(("(0,0,0)", "(1,1,1)", "(0,1)", "1", "(-1,0,0)"))
        if key.kind.startswith("formula"):
            return self.luck.choice(('"x"', "0", '"sin(t)"', '"x0*t"', "1"))
        if key.kind in ("name", "text"):
            return self.luck.choice(NAMES)
        return self.luck.choice(key.kind.split() + ["open", "yes"])


def wrong(code, printed, text, cards, path):
    """What is not as it should be with the end of a check; '' where nothing is."""
    if code in HANGS:
        return "hang"
    if code < 0 or CRASH.search(printed):
        return f"crash {code}"
    if code not in (0, 3, 5):
        return f"exit code {code}"
    if code:
        places = [int(line) for line in re.findall(re.escape(path) + r":(\d+):\d+: error", printed)]
        if not re.search(r"^\S.*: error: .", printed, re.MULTILINE):
            return "refused without a word"
        if any(line > text.count("\n") + 1 for line in places):
            return "refused at a line that is not there"
        return ""
    if any("include" in words for words in [text.lower()]):
        return ""
    objection = next(objections(text, cards), "")
    return f"accepted: {objection}" if objection else ""


def coarse(text):
    """A deck with cells four times as long: its particles are counted in each check, and grammar does not depend on
    their number."""
    text = re.sub(r"(?m)^(parameter h *= *)([\d.]+)", lambda found: f"{found[1]}{4*float(found[2]):g}", text)
    return re.sub(r"(?m)^(parameter cells *= *)(\d+)", lambda found: f"{found[1]}{max(1, int(found[2])//4)}", text)


def decks_of(folder):
    """The decks of a folder, made coarse."""
    texts = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".inp"):
            with open(os.path.join(folder, name), encoding="latin-1", newline="") as file:
                texts.append(coarse(file.read()))
    return [text for text in texts if len(text) < 20000]


def main():
    """So many decks of a seed."""
    chosen = arguments(__doc__, 1500)
    cards = reference(chosen.sgmp)
    mutator = Mutator(chosen.seed, decks_of(os.path.join(chosen.source, "input")) + [SMALL]*8,
                      decks_of(os.path.join(chosen.source, "tests", "decks")), cards)
    driver, findings, codes = Driver(chosen.sgmp, chosen.scratch), Findings(chosen.scratch), {}
    path = os.path.join(chosen.scratch, "deck.inp")
    for number in range(chosen.inputs):
        text = mutator.new()
        with open(path, "w", encoding="latin-1", newline="") as file:
            file.write(text)
        code, printed = driver.run([path, "--check"])
        codes[code] = codes.get(code, 0) + 1
        problem = wrong(code, printed, text, cards, path)
        if problem:
            findings.add(problem, f"deck_{number}.inp", text.encode("latin-1"), printed)
    driver.close()
    findings.end(chosen.inputs, "decks", chosen.seed, codes)


main()
