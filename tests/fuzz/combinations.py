#!/usr/bin/env python3
"""What goes with what: `sgmp --check` of all combinations of method, update, stress, volumes, rotation, mass, drift,
splitting, flip and space against the table that `sgmp help --json` writes. Each is accepted where the table names no
refusal, and refused with the reasons of the table and nothing else where it does.

usage: combinations.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S]

N of them, drawn with the seed, are checked; 0: all. The count that the table accepts is that of ACCEPTED: a change of
the table changes it here, too.
"""
import itertools
import json
import os
import random
import subprocess
import sys

from _driver import Driver, Findings, arguments

SPACES = ("1D", "2D", "3D", "axisymmetric", "swirl")
CHOICES = (
    ("mpm", "gimp", "cpgimp", "sgmp", "bspline"), ("musl", "usf", "usl", "usavg"), ("", "normalised"), ("", "kept"),
    ("", "rotation"), ("", "consistent"), ("", "drift"), ("", "split"), ("", "flip<1"), SPACES,
)
ACCEPTED = 1128
WORDS = {
    "normalised": "stress=normalised",
    "kept": "volumes=kept",
    "rotation": "rotation=exact",
    "consistent": "mass=consistent",
    "drift": "drift=remapped",
    "split": "split=0.75",
    "flip<1": "flip=0.9",
}
DECK = """dimension {space}
grid cell=1 {extents}
method {method}
time steps=1
material m elastic density=1 young=1 poisson=0.3
body a block material=m lower=({lower}) upper=({upper}) ppc=2
"""


def deck(combination):
    """The deck that asks for a combination."""
    method, update, space = combination[0], combination[1], combination[-1]
    axes = {"1D": "x", "2D": "xy", "3D": "xyz"}.get(space, "rz")
    words = {"axisymmetric": "axisymmetric", "swirl": "axisymmetric swirl=yes"}.get(space, space[0])
    asked = " ".join([method, f"update={update}"] + [WORDS[name] for name in combination[2:-1] if name])
    return DECK.format(
        space=words, extents=" ".join(f"{axis}=0:4" for axis in axes), method=asked, lower=",".join("1" * len(axes)),
        upper=",".join("3" * len(axes)),
    )


def refusals(table, combination):
    """Labels of the features of each refusal that a combination meets, with the reason."""
    asked = set(combination) - {""} | ({"axisymmetric"} if "swirl" in combination else set())
    labels = {feature["name"]: feature["label"] for feature in table["features"]}
    for refusal in table["refusals"]:
        if refusal["feature"] in asked and refusal["unless"] not in asked:
            for other in set(refusal["with"]) & asked:
                yield f"{labels[refusal['feature']]} does not go with {labels[other]}: {refusal['reason']}"


def main():
    chosen = arguments(__doc__, 400)
    table = json.loads(
        subprocess.run([chosen.sgmp, "help", "--json"], stdout=subprocess.PIPE, check=True, timeout=60).stdout
    )
    every = list(itertools.product(*CHOICES))
    goes = sum(not any(refusals(table, combination)) for combination in every)
    print(f"{goes} of {len(every)} combinations go together")
    picked = random.Random(chosen.seed).sample(every, chosen.inputs) if chosen.inputs else every
    driver, findings, codes = Driver(chosen.sgmp, chosen.scratch), Findings(chosen.scratch), {}
    if goes != ACCEPTED:
        findings.add(f"the table accepts {goes}, the test {ACCEPTED}", "count", b"", "")
    path = os.path.join(chosen.scratch, "deck.inp")
    for number, combination in enumerate(picked):
        text = deck(combination)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        code, printed = driver.run([path, "--check"])
        codes[code] = codes.get(code, 0) + 1
        expected = sorted(set(refusals(table, combination)))
        found = sorted({line.split(" error: ", 1)[1] for line in printed.splitlines() if ": error: " in line})
        if code != (3 if expected else 0) or found != expected:
            findings.add(
                "not as the table says", f"{number}.inp", text.encode(), printed + "\nexpected: " + "\n".join(expected)
            )
    driver.close()
    findings.end(len(picked), "combinations", chosen.seed, codes)


if __name__ == "__main__":
    sys.exit(main())
