#!/usr/bin/env python3
"""What sgmp --check advises to make a scene cheaper, each where it holds and where one word of the deck makes it wrong;
that the decks which follow it have as many particles as it promises; what --suggest writes, and that it runs.

usage: advice.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import json
import os
import re
import subprocess

from _runs import ENVIRONMENT, SCRATCH, SGMP, Report, changed, run

# A ball above a wide plate, four planes' worth of a scene.
SHOT = """
parameter wide = 30
dimension 3
units mm g ms
grid cell=1 x=open y=open z=open
time end=0.01 steps=4 cfl=0.5
material steel j2 density=7.85e-3 young=200e3 poisson=0.3 yield=500
body ball sphere material=steel centre=(0,0,3) radius=3 ppc=2
body plate block material=steel lower=(-wide,-wide,-3) upper=(wide,wide,0) ppc=2
velocity ball z=-400
contact all friction=0.1
"""
# A quarter of it, as the advice has it.
QUARTER = changed(SHOT, ("x=open y=open", "x=0:open y=0:open"), ("time", "wall x-=slip y-=slip\ntime"), ("contact", """
subtract ball halfspace axis=(1,0,0)
subtract ball halfspace axis=(0,1,0)
subtract plate halfspace axis=(1,0,0)
subtract plate halfspace axis=(0,1,0)
contact"""))
# A round bar that hits a wall, and its section.
BAR = """
dimension 3
units mm g ms
grid cell=1 x=open y=open z=0:open
wall z-=slip
time end=0.01 steps=4 cfl=0.5
material steel j2 density=7.85e-3 young=200e3 poisson=0.3 yield=500
body bar cylinder material=steel axis=(0,0,1) radius=6 length=10 ppc=2
velocity bar z=-100
"""
RINGS = changed(BAR, ("dimension 3", "dimension axisymmetric"), ("x=open y=open", "r=0:open"), ("(0,0,1)", "(0,1)"))
# A strip between two walls, as thick as two cells, that is stretched.
STRIP = """
dimension 3
units mm g ms
grid cell=1 x=open y=open z=0:2
wall z-=slip z+=slip
time end=0.01 steps=4 cfl=0.5
material steel elastic density=7.85e-3 young=200e3 poisson=0.3
body strip block material=steel lower=(0,0,0) upper=(12,6,2) ppc=2
velocity strip x="10*x+2*y"
"""
# A round plate under a load.
PRESSED = """
dimension 3
units mm g ms
grid cell=1 x=open y=open z=open
time end=0.01 steps=4 cfl=0.5
material steel elastic density=7.85e-3 young=200e3 poisson=0.3
body plate block material=steel lower=(-6,-4,0) upper=(6,4,2) ppc=2
pressure plate p="10*exp(-(x^2+y^2)/4)" face=z+
"""
WRITES = "writes"
MIRROR, ROUND = "its own image in", "round about one line"
FLAT, FINE = "nothing changes along", "only where bodies meet"
# Deck, what is changed, and the advice with its numbers; all other advice must not be there.
CASES = [
    (SHOT, (), ("image in x = 0, y = 0: compute a quarter of it, grid … x=0:open y=0:open, wall x-=slip y-=slip, "
                "subtract BODY halfspace axis=(1,0,0), subtract BODY halfspace axis=(0,1,0) for each body: 4 times",
                FINE)),
    (SHOT, (("(-wide,-wide", "(-wide-2,-wide"),), ("image in y = 0: compute a half of it", FINE)),
    (SHOT, (("velocity ball", "velocity ball x=10"),), ("image in y = 0: compute a half", FINE)),
    (SHOT, (("velocity ball", "velocity ball y=10 x=10"),), (FINE,)),
    (SHOT, (("centre=(0,0,3)", "centre=(1,-1,3)"),), (FINE,)),
    (SHOT, (("ppc=2\nvelocity", "ppc=2 jitter=0.1\nvelocity"),), ()),
    (SHOT, (("yield=500", "yield=500 yield_weibull=8"),), ()),
    (SHOT, (("x=open", "x=-30:30"), ("time", "wall x-=fixed\ntime")), ("image in y = 0: compute a half", FINE)),
    (SHOT, (("x=open", "x=-30:30"), ("time", "wall x-=fixed x+=fixed\ntime")),
     ("grid … x=0:30 y=0:open, wall x-=slip y-=slip", FINE)),
    (SHOT, (("wide = 30", "wide = 8"),), ("image in x = 0, y = 0",)),          # all of it is near the ball
    (SHOT, (("z=-400", "z=-4000"),), ("image in x = 0, y = 0",)),              # too fast
    (SHOT, (("contact", "gravity (0,0,-1)\ncontact"),), ("image in x = 0, y = 0",)),
    (SHOT, (("contact", "gauge edge point=(29,0,-1)\ncontact"),), ("image in x = 0, y = 0",)),
    (SHOT, (("contact", "gauge near point=(3,0,-1)\ncontact"),), ("image in x = 0, y = 0", FINE)),
    (SHOT, (("time", "method gimp\ntime"),), ("image in x = 0, y = 0",)),
    (SHOT, (("contact", "subtract plate cylinder axis=(0,0,1) centre=(0,0,-3) radius=1 length=3\ncontact"),),
     ("image in x = 0, y = 0",)),                                              # a hole
    (SHOT, (("velocity ball z=-400", 'velocity plate z="x^2*cos(y)"'),), ("image in x = 0, y = 0",)),
    (SHOT, (("velocity ball z=-400", 'velocity plate z="x^3*cos(y)"'),), ("image in y = 0:",)),
    (SHOT, (("velocity ball z=-400", 'velocity plate x="x" y="y^2"'),), ("image in x = 0:",)),
    (QUARTER, (), (FINE,)),
    (BAR, (), (ROUND,)),
    (BAR, (
        ("x=open", "x=0:open"), ("wall", "wall x-=slip"), ("velocity", "subtract bar halfspace axis=(1,0,0)\nvelocity"),
    ), (ROUND,)),
    (BAR, (("x=open", "x=-7:7"), ("wall", "wall x-=slip x+=slip")), ("image in x = 0, y = 0",)),  # a box around it
    (BAR, (("velocity bar", "velocity bar x=1"),), ("image in y = 0: compute a half",)),
    (BAR, (("axis=(0,0,1)", "axis=(0,0.1,1)"), ("z=0:open", "z=open"), ("wall z-=slip", "")), ("image in x = 0:",)),
    (BAR, (("velocity bar z=-100", 'velocity bar x="-y" y="x"'),), ()),        # it spins
    (RINGS, (), ()),
    (STRIP, (), ("nothing changes along z, from wall to wall: dimension 2 in x y: 4.0 times fewer particles",)),
    (STRIP, (("z+=slip", "z+=fixed"),), ()),
    (STRIP, (("upper=(12,6,2)", "upper=(12,6,1)"),), ()),
    (STRIP, (("velocity strip", "velocity strip z=1"),), ()),
    (STRIP, (("10*x+2*y", "10*x+2*y+z"),), ()),
    (STRIP, (("y=open", "y=0:6"), ("wall", "wall y-=slip y+=slip"), ("+2*y", "")),
     ("nothing changes along y and z, from wall to wall: dimension 1 in x: 48 times fewer particles",)),
    (PRESSED, (), ("image in x = 0, y = 0",)),
    (PRESSED, (("x^2+", "x^2+x+"),), ("image in y = 0:",)),
    (PRESSED, (("face=z+", "face=x+"),), ("image in y = 0, z = 1:",)),
    (BAR, (("wall", "output vtu every=1e-5\nwall"), ("steps=4 ", "")),
     (ROUND, "output vtu writes 1000 dumps, which take longer")),
    (BAR, (("wall", "output vtu every=1e-3\nwall"), ("steps=4 ", "")), (ROUND,)),
]


def told(report, name, deck):
    """Lines of advice on a deck."""
    path = os.path.join(SCRATCH, "deck.inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(deck)
    done = subprocess.run([SGMP, path, "--check"], capture_output=True, text=True, check=False, timeout=60,
                          env=ENVIRONMENT)
    report.check(done.returncode == 0, f"{name}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return [line for line in done.stdout.splitlines() if line.startswith("advice")]


def factor(lines, words):
    """The gain that a line promises."""
    line = next((line for line in lines if words in line), "0.0 times fewer")
    return float(re.search(r"([\d.]+) times (fewer|less)", line).group(1))


def particles(report, name, deck):
    """How many particles a deck has."""
    result = run(name, deck)
    return result["particles"] if report.finished(result, name) else 1


def kept(report):
    """As many particles fewer as were promised; of the round bar nearly, whose edge is a staircase."""
    whole = particles(report, "whole", SHOT)
    report.check(whole == 4*particles(report, "quarter", QUARTER), "the quarter is none")
    bar = particles(report, "bar", BAR)
    promised = factor(told(report, "bar", BAR), ROUND)
    rings = particles(report, "rings", RINGS)
    report.check(abs(promised*rings/bar - 1) < 0.05, f"round: {bar/rings} times, promised {promised}")


def suggested(report):
    """The deck that --suggest writes: its words, that it runs, its particles; where nothing is gained it says why."""
    path, new = (os.path.join(SCRATCH, name) for name in ("shot.inp", "shot_graded.inp"))
    if os.path.exists(new):
        os.remove(new)
    with open(path, "w", encoding="utf-8") as file:
        file.write(SHOT)

    def suggest(deck, *more):
        return subprocess.run([SGMP, deck, "--suggest", *more], capture_output=True, text=True, check=False, timeout=60,
                              env=ENVIRONMENT)

    done = suggest(path)
    report.check(done.returncode == 0 and "fine_x=(-5,5) fine_y=(-5,5) ratio=1.1 largest=7.5" in done.stdout,
                 f"suggest: {done.stdout}{done.stderr}")
    with open(new, encoding="utf-8") as file:
        text = file.read()
    report.check(text.replace(" fine_x=(-5,5) fine_y=(-5,5) ratio=1.1 largest=7.5", "") == SHOT,
                 "suggest: more than the grid has changed")
    found = particles(report, "suggested", text)
    promised = int(re.search(r"; (\d+) particles in the place", done.stdout).group(1))
    report.check(abs(found/promised - 1) < 0.1, f"suggest: {found} particles, promised {promised}")
    again = suggest(path)
    report.check(again.returncode == 5 and "already" in again.stderr, f"suggest: writes over a file, {again}")
    for old, words in ((("velocity ball z=-400", ""), "no body flies into another one at rest"),
                       (("time", "method gimp\ntime"), "do not go with what it asks for"),
                       (("wide = 30", "wide = 7"), "small cells are needed all over"),
                       (("z=-400", "z=-4000"), "debris may hit far from where bodies meet")):
        with open(path, "w", encoding="utf-8") as file:
            file.write(changed(SHOT, old))
        done = suggest(path)
        report.check(done.returncode == 0 and "nothing is gained by unequal cells: " in done.stdout
                     and words in done.stdout, f"suggest: {done.stdout}{done.stderr}, expected {words}")
    report.check(suggest(path, "--check").returncode == 2, "suggest: goes with --check")


def main():
    """All of them."""
    report = Report()
    for deck, changes, wanted in CASES:
        lines = told(report, str(changes), changed(deck, *changes))
        right = len(lines) == len(wanted) and all(any(words in line for line in lines) for words in wanted)
        report.check(right, f"{changes}: {json.dumps(lines, indent=1, ensure_ascii=False)}, expected {wanted}")
    kept(report)
    suggested(report)
    report.end()


main()
