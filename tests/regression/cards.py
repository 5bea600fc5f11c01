#!/usr/bin/env python3
"""What is written in decks means what the deck reference says; `sgmp help` explains every card.

The reference is doc/deck-reference.md; two ways to write the same must give the same bits, another meaning other bits.

usage: cards.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import re
import subprocess

from _runs import SGMP, SOURCE, Report, run

DECK = """
dimension 2
grid cell=1 x=0:open
wall x-=slip
method sgmp
time cfl=0.5 steps=20
material steel elastic density=7.85e-3 young=210 poisson=0.3
body bar block material=steel lower=(0,0) upper=(4,4)
velocity bar x="-30" y="x"
"""

def explained(report):
    """Every card of the reference has its help, with each of its keys; an unknown one is an error of usage."""
    with open(os.path.join(SOURCE, "doc", "deck-reference.md"), encoding="utf-8") as file:
        chapters = re.split(r"^## ", file.read(), flags=re.MULTILINE)[1:]
    report.check(len(chapters) > 20, f"{len(chapters)} cards in the reference")
    for chapter in chapters:
        card = chapter.split("\n", 1)[0].strip()
        done = subprocess.run([SGMP, "help", card], capture_output=True, text=True, timeout=60, check=False)
        report.check(
            done.returncode == 0 and not done.stderr.strip(), f"help {card}: exit code {done.returncode}\n{done.stderr}"
        )
        for key in re.findall(r"^\| `([^`]+)`", chapter, re.MULTILINE):
            report.check(
                re.search(rf"(^|\W){re.escape(key)}(\W|$)", done.stdout), f"help {card} has no {key}:\n{done.stdout}"
            )
    for words in (["help", "nothing"], ["help", "velocty"]):
        done = subprocess.run([SGMP, *words], capture_output=True, text=True, timeout=60, check=False)
        report.check(done.returncode == 2, f"{' '.join(words)}: exit code {done.returncode}")


def same_and_other(report):
    """Comments, case, continuation, defaults; and keys that must not be without effect."""
    reference = run("cards_reference", DECK)
    if not report.finished(reference, "reference"):
        return
    same = {
        "hash after a word": DECK.replace("upper=(4,4)", "upper=(4,4)# ppc=3"),
        "hash after a blank": DECK.replace("upper=(4,4)", "upper=(4,4) # ppc=3"),
        "exclamation mark": DECK.replace("upper=(4,4)", "upper=(4,4)! ppc=3"),
        "upper case": DECK.replace("wall x-=slip", "WALL X-=Slip"),
        "continued": DECK.replace("lower=(0,0) upper", "lower=(0,0) & # and so on\n   upper"),
        "formula": DECK.replace("upper=(4,4)", "upper=(2^2,8/2)"),
        "parameter": "parameter n = 4\n" + DECK.replace("upper=(4,4)", "upper=(n,n)"),
        "default ppc": DECK.replace("upper=(4,4)", "upper=(4,4) ppc=2"),
        "default update": DECK.replace("method sgmp", "method sgmp update=musl flip=1"),
        "default growth": DECK.replace("cfl=0.5", "cfl=0.5 growth=1.05"),
        "all bodies": DECK.replace("velocity bar", "velocity"),
        "a light cutoff": DECK.replace("method sgmp", "method sgmp mass_cutoff=1e-12"),
    }
    other = {
        "slip": DECK.replace("wall x-=slip", "wall x-=fixed"),
        "ppc": DECK.replace("upper=(4,4)", "upper=(4,4) ppc=3"),
        "update": DECK.replace("method sgmp", "method sgmp update=usl"),
        "flip": DECK.replace("method sgmp", "method sgmp flip=0.9"),
        "gravity": DECK + "gravity (0,-5)\n",
        "viscosity": DECK + "viscosity\n",
        "small strain": DECK.replace("poisson=0.3", "poisson=0.3 strain=small"),
        "a heavy cutoff": DECK.replace("method sgmp", "method sgmp mass_cutoff=0.5"),
        "cfl": DECK.replace("cfl=0.5", "cfl=0.4"),
        "jitter": DECK.replace("upper=(4,4)", "upper=(4,4) jitter=0.1"),
    }
    for name, deck in same.items():
        result = run("cards_same", deck)
        report.check(
            result.code == 0 and result["checksum"] == reference["checksum"],
            f"{name} should change nothing\n{result.text}",
        )
    for name, deck in other.items():
        result = run("cards_other", deck)
        report.check(
            result.code == 0 and result["checksum"] != reference["checksum"], f"{name} changes nothing\n{result.text}"
        )


def early_ends(report):
    """stop: at the first step whose energies say so, and not before."""
    vibrating = """
dimension 1
grid cell=0.05 x=0:1
wall x-=fixed x+=fixed
time end=1 cfl=0.2
material m elastic density=4 young=16 poisson=0
body b block material=m lower=0 upper=1
velocity b x="1e-4*sin(pi*x)"
stop kinetic_below=0.04
"""
    result = run("cards_quiet", vibrating)
    if report.finished(result, "kinetic_below"):
        kinetic = [row["kinetic_energy"] for row in result.table("history.csv")]
        most = max(kinetic)
        # K = K0 cos^2(2 pi t): 0.04 of it at t = acos(0.2)/(2 pi) = 0.218.
        report.check(kinetic[-1] < 0.04*most <= min(kinetic[:-1]), f"kinetic_below: ended at {kinetic[-2:]} of {most}")
        report.check(abs(result["time"] - 0.2180) < 0.01, f"kinetic_below: ended at {result['time']}")
    # Friction leaves exp(-100 x 0.1) of the momentum: the first step is the last.
    braked = (
        vibrating.replace("time end=1 cfl=0.2", "time dt=0.1 steps=9")
        .replace("cell=0.05", "cell=1")
        .replace("sin(pi*x)", "1")
        + "damping rate=100\n"
    )
    result = run("cards_braked", braked)
    report.check(result.code == 0 and result["steps"] == 1, f"kinetic_below in the first step: {result.text}")
    growing = """
parameter factor=3
dimension 1
grid cell=0.5
time dt={dt} steps=200
material m elastic density=2 young=50 poisson=0 strain=small
body b block material=m lower=0 upper=8
velocity b x="1e-8*sin(2*pi*x)"
stop energy_growth=$factor
"""
    for factor in (3, 30):
        result = run("cards_growing", growing.format(dt=0.3), factor=factor)
        report.check(
            result.code == 4 and "energ" in result.text, f"energy_growth: exit code {result.code}\n{result.text}"
        )
        total = [row["total_energy"] for row in result.table("history.csv")]
        report.check(total[-1] > factor*total[0] and max(total[:-1]) <= factor*total[0],
                     f"energy_growth={factor}: ended at {[t/total[0] for t in total[-2:]]}")


def late_dimension(report):
    """The card dimension may come last, though it names the axes of the others."""
    cards = """grid cell=1 r=0:open z=open
time dt=0.1 steps=5
material m elastic density=1 young=1 poisson=0.3
body b block material=m lower=(0,0) upper=(3,4)
velocity b r="0.01*r" z="0.02*z"
"""
    first = run("dimension_first", "dimension axisymmetric\n" + cards)
    last = run("dimension_last", cards + "dimension axisymmetric\n")
    if report.finished(first, "dimension first") and report.finished(last, "dimension last"):
        report.check(first["checksum"] == last["checksum"], "dimension last is not as dimension first")


def main():
    """All of it."""
    report = Report()
    explained(report)
    same_and_other(report)
    early_ends(report)
    late_dimension(report)
    report.end()


main()
