#!/usr/bin/env python3
"""What is warned of before the first step (sgmp --check): each on both sides of its limit, with the numbers that the
deck gives.

usage: forewarnings.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import subprocess

from _restarts import ENVIRONMENT, mpirun
from _runs import SCRATCH, SGMP, Report

# Two blocks, the one on the right at rest.
BLOCKS = """
dimension 2
grid cell=1
method {method}
time {time}
material m elastic density=2 young=50 poisson=0.3
body left block material=m lower=(0,0) upper=({left},4) {particles}
body right block material={what} lower=({right},0) upper=(20,4) ppc=2
velocity left x={speed}
{more}
"""
USUAL = {"method": "sgmp", "time": "dt=0.1 end=2", "left": 4, "right": 10, "particles": "ppc=2", "speed": 0, "more": "",
         "what": "m"}
CHARGE = """
dimension 2
grid cell=1
time end={end} cfl=0.4
material tnt explosive density=1 detonation_speed=5
eos tnt jwl a=3 b=0.1 r1=4 r2=1 omega=0.3 energy0=0.3
body charge block material=tnt lower=(0,0) upper=(4,1) ppc=1
detonation point=(-7.5,0.5)
"""
RIGID = "rigid left x={} {}\nrigid right x=0\n"
WALLS = """
dimension 2
grid cell=1 x=0:4 y=0:4
wall x-=fixed
wallmotion x- {axis}=0.1
time dt=0.1 steps=3
material m elastic density=1 young=50 poisson=0.3
body b block material=m lower=(0,0) upper=(4,4) ppc=2
velocity b y={speed}
"""
UNIT = "is every= in the deck's unit of time?"
STICK = "'left' and 'right' move towards each other and will stick together"
BONDED = "'left' and 'right' share a surface at the start and are bonded"
# The right block is of gas, which sticks to solids that it is blown at.
GAS = {"more": "material gas fluid density=1\neos gas ideal_gas gamma=1.4 energy0=2.5", "what": "gas"}
RIGID_BOTH = "'left' and 'right' are both rigid"

# Changes of the deck of two blocks, and the one warning that they bring, if any.
CASES = [
    ({}, None),
    # A step of 0.1, the end before or behind it.
    ({"time": "dt=0.1 end=0.09"}, "the run ends within its first step: end=0.09, and the step may be 0.1;"),
    ({"time": "dt=0.1 end=0.11"}, None),
    # More dumps than 10000, by the end or by the number of steps, whichever comes first.
    ({"more": "output vtkhdf every=1.9e-4"}, "output every=0.00019 makes 10526 dumps; " + UNIT),
    ({"more": "output vtkhdf every=2.1e-4"}, None),
    ({"time": "dt=0.1 steps=20", "more": "output vtkhdf every=1.9e-4"},
     "output every=0.00019 makes 10526 dumps; " + UNIT),
    ({"time": "dt=0.1 steps=20", "more": "output vtkhdf every=2.1e-4"}, None),
    ({"time": "dt=0.1 steps=20 end=100", "more": "output vtkhdf every=2.1e-4"}, None),
    ({"time": "dt=0.1 steps=2000 end=2", "more": "output vtu every=9\noutput tecplot every=1.9e-4"},
     "makes 10526 dumps"),
    # Courant numbers beyond what the methods bear at rest.
    ({"time": "end=2 cfl=2.5"}, None),
    ({"time": "end=2 cfl=2.6"}, "cfl=2.6 is above 2.54, the most"),
    ({"time": "end=2 cfl=1.9", "method": "gimp"}, None),
    ({"time": "end=2 cfl=2.1", "method": "gimp"}, "cfl=2.1 is above 2, the most"),
    ({"time": "end=2 cfl=auto"}, None),
    # Particles a cell apart, or more; 4 whole columns of them are 3.4 % less than 4.14, 4.8 % less than 4.2.
    ({"particles": "spacing=1"}, None),
    ({"particles": "spacing=2"}, "the particles of body 'left' are 2 apart, more than a cell of 1"),
    ({"left": 4.14, "particles": "spacing=1 fit=cubes"}, None),
    ({"left": 4.2, "particles": "spacing=1"}, None),
    ({"left": 4.2, "particles": "spacing=1 fit=cubes"},
     "the particles of body 'left' have a mass of 32, its shapes of 33.6"),
    # Gauges: the nearest particle is half a spacing inside, a cell's diagonal is 1.414.
    ({"more": "gauge g point=(-1.1,0.25)"}, None),
    ({"more": "gauge g point=(-1.25,0.25)"}, "gauge 'g' is 1.5 cells from the nearest particle"),
    ({"more": "gauge g point=(-1.25,0.25) radius=3"}, None),
    # A solid and a gas meet after 6/speed, at 3 they do not within 2; not where there is contact, nor where one moves
    # away, nor beside each other; solids stick that are so fast.
    ({"speed": 2.9, **GAS}, None),
    ({"speed": 3.1, **GAS}, STICK),
    ({"speed": 3.1}, None),
    ({"speed": -9, **GAS}, None),
    ({"speed": 3.1, "time": "dt=0.1 end=2", **GAS, "more": GAS["more"] + "\ncontact all"}, None),
    ({"speed": 0.1, "time": "dt=0.1 steps=3", **GAS}, STICK),
    ({"speed": 9, **GAS, "more": GAS["more"] + "\nvelocity right y=9"}, None),
    ({"speed": 9, **GAS, "more": GAS["more"] + "\nvelocity right y=5"}, STICK),
    # Solids that share a surface, unless a card says what they are.
    ({"left": 10}, BONDED + ": contact left right lets them"),
    ({"left": 10, "more": "contact all"}, None),
    ({"left": 10, "more": "group one left,right"}, None),
    ({"left": 10, "more": "body third block material=m lower=(10,4) upper=(20,8) ppc=2"},
     BONDED + " (3 such in all)"),
    # Gases that do not touch the same others, and so have different fields.
    ({**GAS, "more": GAS["more"] + "\nbody third block material=gas lower=(30,0) upper=(34,4) ppc=2\n"
      "contact left right friction=0.1"}, "no card `contact` is for 'right' and 'third' (1 such in all)"),
    # Rigid bodies: prescribed ones that meet, a free one wherever it goes.
    ({"more": RIGID.format(2.9, "")}, None),
    ({"more": RIGID.format(3.1, "")}, RIGID_BOTH),
    ({"more": "rigid left free=yes\nrigid right x=0\n"}, RIGID_BOTH),
]


def warnings_of(report, name, deck, launcher=()):
    """The warnings of a deck that is only checked."""
    path = os.path.join(SCRATCH, "deck.inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(deck)
    environment = dict(ENVIRONMENT)
    if launcher:
        environment.pop("OMPI_MCA_ess_singleton_isolated", None)
    done = subprocess.run([*launcher, SGMP, path, "--check"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          check=False, timeout=60, env=environment)
    text = done.stdout.decode()
    report.check(done.returncode == 0, f"{name}: exit code {done.returncode}\n{text}")
    return [line for line in text.splitlines() if line.startswith("warning:")]


def expect(report, name, found, words):
    """One warning with these words, or none."""
    report.check(len(found) == (words is not None) and all(words in line for line in found),
                 f"{name}: {found}, expected {words}")


def main():
    """All of them."""
    report = Report()
    for changes, words in CASES:
        expect(report, str(changes), warnings_of(report, str(changes), BLOCKS.format(**{**USUAL, **changes})), words)
    # The nearest particle is 8 away from where it is lit: 8/5 = 1.6.
    for end, words in ((1.55, "the detonation reaches body 'charge' at 1.6, after the end of the run"), (1.65, None)):
        expect(report, f"lit until {end}", warnings_of(report, "lit", CHARGE.format(end=end)), words)
    near = CHARGE.replace("(-7.5,0.5)", "(0,0.5)")
    for end, sides, words in ((2.39, "", None), (2.41, "", "products of the explosive 'charge' are followed through "
                                                           "the open sides"),
                              (2.41, " x=-4:8 y=-4:5", None),
                              (2.41, " x=-4:8 y=-4:open", "products of the explosive 'charge'")):
        deck = near.format(end=end).replace("grid cell=1", "grid cell=1" + sides)
        expect(report, f"products until {end}, grid{sides}", warnings_of(report, "products", deck), words)
    for axis, speed, words in (("y", 0, None), ("y", 1, "walls are at rest before t = 0")):
        expect(report, f"wall along {axis}, {speed}", warnings_of(report, "wall", WALLS.format(axis=axis, speed=speed)),
               words)
    line = ("dimension 1\ngrid cell=1\ntime dt=0.1 steps=3\nmaterial m elastic density=1 young=50 poisson=0\n"
            "body b block material=m lower=0 upper=4 ppc=2\n")
    expect(report, "a line", warnings_of(report, "a line", line), None)
    expect(report, "a line on two ranks", warnings_of(report, "two ranks", line, mpirun(2)),
           "a scene in 1D is not divided")
    report.end()


main()
