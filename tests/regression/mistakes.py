#!/usr/bin/env python3
"""Mistakes that people make, each in a deck that is right but for it: what the program says of them is in mistakes.txt,
word for word.

No mistake may pass in silence: a deck ends with an error, or the check warns. The decks without a mistake must do
neither.

usage: mistakes.py SGMP SOURCE_DIR SCRATCH_DIR [--record]
"""
import difflib
import os
import subprocess
import sys

from _runs import ENVIRONMENT, SCRATCH, SGMP, SOURCE, Report

GOLDEN = os.path.join(SOURCE, "tests", "regression", "mistakes.txt")

ROD = """title "Rod on a plate"
units mm g ms
parameter h     = 1.5
parameter speed = 500
dimension 3
grid cell=h x=0:open y=0:open
wall x-=slip y-=slip
method sgmp update=musl
time end=0.012 cfl=0.5
material steel  johnson_cook density=7.83e-3 young=207e3 poisson=0.29 &
  yield=792 hardening_modulus=510 hardening_exponent=0.26 rate_coefficient=0.014 reference_rate=1e-3
material copper j2 density=8.93e-3 young=117e3 poisson=0.35 yield=90 hardening_modulus=292
eos steel  gruneisen c0=4569 s=1.49 gamma0=2.17
viscosity all
body plate block material=copper lower=(0,0,-9) upper=(15,15,0) ppc=2
body rod cylinder material=steel centre=(0,0,0) axis=(0,0,1) radius=3 length=9 ppc=2
intersect rod block lower=(0,0,0) upper=(6,6,9)
velocity rod z=-speed
contact rod plate friction=0.1
gauge tip point=(0.4,0.4,1)
history every=1e-4
output csv at=end
"""
TNT = """title "Explosive beside a wall"
units mm g ms
dimension 1
grid cell=1 x=0:open
wall x-=slip
method sgmp update=musl
time end=0.01 cfl=0.5
material tnt explosive density=1.63e-3 detonation_speed=6930
eos tnt jwl a=371200 b=3210 r1=4.15 r2=0.95 omega=0.3 energy0=6993
body charge block material=tnt lower=0 upper=60 ppc=2
detonation point=0
history steps=5
"""
FILE = """title "Particles from a file"
dimension 3
grid cell=0.1 x=0:1 y=0:1 z=0:1
method sgmp
time end=1e-4
material steel elastic density=7850 young=210e9 poisson=0.3
body bar file material=steel file="particles.txt"
history steps=5
"""


def particles(columns):
    """Sixteen particles with those columns: names of what is known, or id."""
    lines = []
    for n in range(16):
        known = {
            "id": n + 1,
            "x": 0.325 + 0.05 * (n // 4),
            "y": 0.525 + 0.05 * (n % 4),
            "z": 0.725,
            "volume": 1.25e-4,
            "mass": 0.98125,
        }
        lines.append(" ".join(f"{known[column]:g}" for column in columns.split()))
    return "\n".join(lines) + "\n"


# What somebody did, the deck, and the text that was put in place of another.
MISTAKES = [
    ("a card misspelt", ROD, "viscosity all", "viscocity all"),
    ("a key misspelt", ROD, "poisson=0.29", "poison=0.29"),
    ("a method misspelt", ROD, "method sgmp", "method smgp"),
    ("an update misspelt", ROD, "update=musl", "update=mulsl"),
    ("a material misspelt where it is used", ROD, "material=copper", "material=coper"),
    ("a body misspelt in a velocity", ROD, "velocity rod", "velocity rood"),
    ("a body misspelt in a contact", ROD, "contact rod plate", "contact rod plat"),
    ("a parameter misspelt", ROD, "z=-speed", "z=-sped"),
    ("an equation of state for nobody", ROD, "eos steel", "eos stel"),
    ("a field of the output misspelt", ROD, "csv at=end", "csv at=end fields=velocity,stres"),
    ("a format that does not exist", ROD, "output csv", "output ensight"),
    ("a unit that does not exist", ROD, "units mm g ms", "units mm g msec"),
    ("a wall of a kind that does not exist", ROD, "y-=slip", "y-=frictionless"),
    ("a wall without its side", ROD, "wall x-=slip", "wall x=slip"),
    ("Young's modulus in Pa where the deck has MPa", ROD, "young=207e3", "young=207e9"),
    ("a density in kg/m3 where the deck has g/mm3", ROD, "density=7.83e-3", "density=7830"),
    ("a yield stress in Pa where the deck has MPa", ROD, "yield=792", "yield=792e6"),
    ("the end in s where the deck has ms", ROD, "end=0.012", "end=12e-6"),
    ("a detonation speed in km/s where the deck has m/s", TNT, "detonation_speed=6930", "detonation_speed=6.93"),
    ("a Poisson's ratio of 0.5", ROD, "poisson=0.29", "poisson=0.5"),
    ("a decimal comma", ROD, "cfl=0.5", "cfl=0,5"),
    ("a Fortran exponent", ROD, "8.93e-3", "8.93d-3"),
    ("per cent", ROD, "friction=0.1", "friction=10%"),
    ("a forgotten &", ROD, "poisson=0.29 &", "poisson=0.29"),
    ("a quote that is not closed", ROD, '"Rod on a plate"', '"Rod on a plate'),
    ("a time without an end", ROD, "time end=0.012 cfl", "time cfl"),
    ("a negative end", ROD, "end=0.012", "end=-0.012"),
    ("a Courant number ten times too large", ROD, "cfl=0.5", "cfl=5"),
    ("gravity as one number", ROD, "viscosity all", "viscosity all\ngravity -9.81e-3"),
    (
        "D3 with the sign of codes in which pressure is positive", ROD, "reference_rate=1e-3",
        "reference_rate=1e-3 failure=yes d1=0.05 d2=3.44 d3=2.12 d4=0.002",
    ),
    ("two methods", ROD, "method sgmp update=musl", "method sgmp update=musl\nmethod gimp"),
    ("two bodies of one name", ROD, "body rod cylinder", "body plate cylinder"),
    ("a scene in 3D called plane", ROD, "dimension 3", "dimension 2"),
    (
        "a plate of two layers that no card says are one", ROD, "contact rod plate friction=0.1\n",
        "body rest block material=copper lower=(0,0,-12) upper=(15,15,-9) ppc=2\n",
    ),
    (
        "a rigid rod on a rigid plate", ROD, "velocity rod z=-speed\ncontact rod plate friction=0.1",
        "rigid plate\nrigid rod z=-speed\ncontact all",
    ),
    (
        "a free rigid rod beside a rigid plate", ROD, "velocity rod z=-speed\ncontact rod plate friction=0.1",
        "velocity rod z=speed\nrigid plate\nrigid rod free=yes\ncontact all",
    ),
    (
        "two bodies in one place", ROD,
        "centre=(0,0,0) axis=(0,0,1) radius=3 length=9 ppc=2\nintersect rod block lower=(0,0,0) upper=(6,6,9)",
        "centre=(5,5,-4) axis=(0,0,1) radius=3 length=9 ppc=2",
    ),
    ("a body astride a wall", ROD, "lower=(0,0,-9)", "lower=(-5,0,-9)"),
    ("a body out of the grid", ROD, "grid cell=h x=0:open", "grid cell=h x=0:12"),
    ("a plate thinner than its particles", ROD, "lower=(0,0,-9)", "lower=(0,0,-0.1)"),
    ("particles farther apart than a cell", ROD, "upper=(15,15,0) ppc=2", "upper=(15,15,0) spacing=3"),
    ("200 particles per cell and axis", ROD, "upper=(15,15,0) ppc=2", "upper=(15,15,0) ppc=200"),
    ("upper below lower", ROD, "upper=(15,15,0)", "upper=(15,15,-10)"),
    (
        "a shape that cuts all of a body away", ROD, "rod block lower=(0,0,0) upper=(6,6,9)",
        "rod block lower=(20,0,0) upper=(26,6,9)",
    ),
    ("a gauge far from any body", ROD, "point=(0.4,0.4,1)", "point=(40,40,100)"),
    ("output every 1e-9", ROD, "csv at=end", "vtu every=1e-9"),
    ("a forgotten detonation", TNT, "detonation point=0\n", ""),
    ("a detonation too far off", TNT, "detonation point=0", "detonation point=-500"),
    ("a forgotten equation of state", TNT, "eos tnt jwl a=371200 b=3210 r1=4.15 r2=0.95 omega=0.3 energy0=6993\n", ""),
    ("a file that is not there", FILE, "particles.txt", "particle.txt"),
]
# The same of particle files: its columns, or its text.
FILES = [
    ("particles without volumes", particles("x y z")),
    ("numbers before the particles", particles("id x y z volume")),
    ("numbers in place of volumes", particles("x y z id")),
    ("volumes before the places", particles("volume x y z")),
    ("masses in place of volumes", particles("x y z mass")),
    ("a misspelt name of a column", "x y z volumes\n" + particles("x y z volume")),
    ("a name for each column but one", "id x y z\n" + particles("id x y z volume")),
]
RIGHT = [
    ("rod", ROD, ""), ("explosive", TNT, ""), ("file", FILE, particles("x y z volume")),
    ("file with a line of names", FILE, "volume z y x\n" + particles("volume z y x")),
    ("file with commas", FILE, particles("x y z volume").replace(" ", ",")),
]


def check(deck, text):
    """Exit code and complaints of `sgmp --check`."""
    for name, content in (("deck.inp", deck), ("particles.txt", text)):
        with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
            file.write(content)
    done = subprocess.run(
        [SGMP, "deck.inp", "--check", "--threads", "1"], cwd=SCRATCH, env=ENVIRONMENT, capture_output=True, text=True,
        check=False,
    )
    return done.returncode, done.stderr


def main():
    report = Report()
    said = ""
    for name, deck, text in RIGHT:
        code, complaints = check(deck, text)
        report.check(code == 0 and not complaints, f"the right deck ({name}) is complained of: {complaints}")
    decks = [
        (what, deck.replace(old, new), particles("x y z volume"), old in deck) for what, deck, old, new in MISTAKES
    ]
    for what, deck, text, found in decks + [(what, FILE, text, True) for what, text in FILES]:
        code, complaints = check(deck, text)
        report.check(found, f"{what}: the deck has no such text")
        report.check(complaints and code in (0, 3, 5), f"{what}: exit code {code}, said: '{complaints}'")
        said += f"== {what}: exit code {code}\n\n{complaints}\n"
    if "--record" in sys.argv:
        with open(GOLDEN, "w", encoding="utf-8") as file:
            file.write(said)
    with open(GOLDEN, encoding="utf-8") as file:
        lines = list(
            difflib.unified_diff(file.read().splitlines(), said.splitlines(), "mistakes.txt", "now", lineterm="", n=1)
        )
    report.check(not lines, "other words:\n" + "\n".join(lines))
    report.end()


main()
