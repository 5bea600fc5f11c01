#!/usr/bin/env python3
"""Damaged checkpoints: a restart must say what is wrong (exit code 5, or 3 where the deck recorded in it is another),
or end with the bits of the run that was not interrupted. Bits, bytes, runs of bytes, cut and lengthened files, pieces
moved within the file; the headers of HDF5 more often than the numbers.

usage: checkpoints.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S]
"""
import json
import os
import random
import re
import shutil
import subprocess
import sys

from _driver import CRASH, HANGS, Driver, Findings, arguments

# A few particles each; contact, a gauge and a gas, so that most kinds of data are in the files.
DECKS = (
    """
dimension 1
grid cell=0.25 x=0:1
wall x-=fixed
time dt=1e-3 steps=20
material m elastic density=25 young=50 poisson=0
body bar block material=m lower=0 upper=1 ppc=1
velocity bar x=0.1
checkpoint every=10 keep=9
""",
    """
dimension 2
grid cell=1 x=open y=0:open
wall y-=slip
method sgmp rotation=exact
time cfl=auto steps=20
material m johnson_cook density=1 young=10 poisson=0.3 yield=0.01 hardening_modulus=1 thermal=yes &
  melt_temperature=1000 specific_heat=1
body a block material=m lower=(0,0) upper=(2,2) ppc=1
body b block material=m lower=(0,2) upper=(2,3) ppc=1
velocity b y=-0.3
contact all friction=0.2
gauge g point=(1,1)
history steps=3
checkpoint every=10 keep=9
""",
)
FINISHED, WRONG_DECK, WRONG_FILE = 0, 3, 5


def damage(luck, good):
    """A changed copy of a file."""
    wrong = bytearray(good)
    kind = luck.randrange(8)
    if kind == 0:
        return bytes(wrong[:luck.randrange(len(wrong))])
    if kind == 1:
        return bytes(wrong) + luck.randbytes(luck.choice((1, 8, 4096)))
    heads = [found.start() for found in re.finditer(rb"OHDR|TREE|SNOD|HEAP|FRHP|BTHD|OCHK|\x89HDF", good)]
    for _ in range(luck.choice((1, 1, 2, 5))):
        if kind < 5:
            at = min(luck.choice(heads) + luck.randrange(96), len(wrong) - 1)
        else:
            at = luck.randrange(len(wrong))
        if kind in (2, 5):
            wrong[at] ^= 1 << luck.randrange(8)
        elif kind in (3, 6):
            wrong[at] = luck.choice((0, 1, 127, 128, 255, luck.randrange(256)))
        elif kind == 4:
            length = min(luck.choice((2, 4, 8, 512)), len(wrong) - at)
            wrong[at:at + length] = luck.choice((bytes(length), b"\xff"*length, luck.randbytes(length)))
        else:
            length = min(luck.choice((8, 64, 1024)), len(wrong) - at)
            start = luck.randrange(len(good))
            piece = good[start:start + length]
            wrong[at:at + len(piece)] = piece
    return bytes(wrong)


class Scene:
    """A run to its end with checkpoints on the way."""

    def __init__(self, chosen, number):
        self.deck = os.path.join(chosen.scratch, f"deck_{number}.inp")
        self.folder = os.path.join(chosen.scratch, f"run_{number}")
        shutil.rmtree(self.folder, ignore_errors=True)
        with open(self.deck, "w", encoding="ascii") as file:
            file.write(DECKS[number])
        subprocess.run([chosen.sgmp, self.deck, "--quiet", "--threads", "1", "--output", self.folder], check=True)
        self.expected = self.checksum()
        self.wrong = os.path.join(self.folder, "wrong.h5")
        with open(os.path.join(self.folder, "checkpoint_0000010.h5"), "rb") as file:
            self.good = file.read()

    def checksum(self):
        """That of the run in the folder."""
        with open(os.path.join(self.folder, "summary.json"), encoding="utf-8") as file:
            return json.load(file)["checksum"]

    def restart(self, driver, content):
        """Goes on from a file with this content: exit code, what was printed, and what is wrong with that."""
        with open(self.wrong, "wb") as file:
            file.write(content)
        code, printed = driver.run(
            [self.deck, "--quiet", "--threads", "1", "--output", self.folder, "--restart", self.wrong]
        )
        if code in HANGS:
            return code, printed, "hang"
        if code < 0 or CRASH.search(printed):
            return code, printed, f"crash {code}"
        if code == FINISHED:
            return code, printed, "" if self.checksum() == self.expected else "other bits without a word"
        if code not in (WRONG_DECK, WRONG_FILE):
            return code, printed, f"exit code {code}"
        return code, printed, "" if "error: " in printed and "wrong.h5" in printed else "refused without a word"


def main():
    """So many files of a seed."""
    chosen = arguments(__doc__, 600)
    luck = random.Random(chosen.seed)
    scenes = [Scene(chosen, number) for number in range(len(DECKS))]
    driver, findings, codes = Driver(chosen.sgmp, chosen.scratch), Findings(chosen.scratch), {}
    for scene in scenes:
        code, printed, problem = scene.restart(driver, scene.good)
        if code or problem:
            sys.exit(f"the whole file is refused: {code} {problem}\n{printed}")
    for number in range(chosen.inputs):
        scene = luck.choice(scenes)
        content = damage(luck, scene.good)
        code, printed, problem = scene.restart(driver, content)
        codes[code] = codes.get(code, 0) + 1
        if problem:
            findings.add(problem, f"checkpoint_{number}.h5", content, printed)
    driver.close()
    findings.end(chosen.inputs, "checkpoints", chosen.seed, codes)


main()
