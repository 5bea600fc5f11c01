#!/usr/bin/env python3
"""Import of MPM3D decks, card by card: small decks, each with the cards, notes and particles that it must become, or the error at its place.

usage: import_cards.py SGMP SOURCE_DIR SCRATCH_DIR

What is expected is worked out by hand, or here from the particles that the deck describes.
"""
import os
import shutil
import subprocess

from _runs import ENVIRONMENT, SCRATCH, SGMP, Report

DECK = """mpm3d cards
nbco 1
nbbo 1
nmat 1
nbmp 8
grid 0 4 0 4 0 4
dcell 1
endtime 1
material
1 elas 1 100 0.3
part block 1 1 1.0 1 1 1 1 2 2 2
endi
"""
PART = "part block 1 1 1.0 1 1 1 1 2 2 2\n"
MATERIAL = "material\n1 elas 1 100 0.3\n"
# Of a deck: texts and what stands there instead; what must be printed.
REFUSED = [
    ("2 2 2\nendi\n", "2 2", ":11:1: error: the deck ends where a number is expected"),
    ("nmat 1", "nmat 1.5", ":4:6: error: the number of materials must be a whole number"),
    ("nmat 1", "nmat 0", ":4:6: error: the number of materials is too small"),
    ("100", "100/2", ":10:10: error: '100/2' is not a number"),
    ("100", "2*100", ":10:10: error: '2*100' is not a number"),
    ("100", "1e2/", ":10:10: error: '1e2/' is not a number"),
    ("100", "1e00002", ":10:10: error: '1e00002' is not a number"),
    ("100", "1e61", ":10:10: error: '1e61' is not a number"),
    ("100", "inf", ":10:10: error: 'inf' is not a number"),
    ("100", "100." + 37*"0", ":10:10: error: '100." + 37*"0" + "' is not a number"),
    ("endtime", "emdtime", "did you mean 'endt'?"),
    ("material", "matrial_of_all", "did you mean 'mate'?"),
    ("dcell 1", "dcell 0", ":7:7: error: the side of a cell is not positive"),
    ("dcell 1\n", "", ":11:1: error: the deck has no cell size"),
    ("endtime 1\n", "", ":11:1: error: the deck has no end time"),
    ("grid 0 4 0 4 0 4", "spy 1 4", ":12:1: error: the deck has no box along xz\n"),
    ("nbmp 8\n", "", ":11:1: error: the deck has no nbmp"),
    ("nmat 1\n", "", ":8:1: error: there is no nmat before material"),
    (PART, "", ":11:1: error: the deck has no particles"),
    (PART, "part sphere 1 1 1.0 1 2 2 2 2001\n", ":11:29: error: the radius in spacings is too large"),
    (PART, "part block 2 1 1.0 1 1 1 1 2 2 2\n", ":11:1: error: the body is of component 2, nbco is 1"),
    (PART, "part block 1 1 1.0 1 1 1 1 2 2 3\n", ":11:1: error: there are more particles than nbmp says (8)"),
    (PART, "part blod 1 1 1.0 1 1 1 1 2 2 2 2 2 0 2\n", ":11:1: error: the body has no particles"),
    (PART, "part blod 1 1 1.0 1 1 1 1 1001 1000 100 0 0 0 1500\n", ":11:1: error: there are more particles"),
    ("nbmp 8\n", "", PART, "part point 1 2\n1 1 1 1 1 1\n2 1 1 2 1 1\n", ":10:14: error: the number of particles of the body is too large"),
    ("nbmp 8\n", "", "endi", "load part 2 1 0 0 endl endi", ":11:11: error: the number of the particle is too large"),
    ("nbmp 8\n", "", "endi", "curv pres 2\nendi", ":11:11: error: the number of the particle is too large"),
    ("endi", "load part 0 1 0 0 endl endi", ":12:11: error: the number of the particle is too small"),
    ("endi", "cont lagr 0 3 endi", ":12:13: error: the choice of the normal is too large"),
    ("endi", "material 1 elas 1 100 0.3 endi", ":12:1: error: material is given twice"),
    ("elas 1 ", "elas 0 ", ":10:8: error: the density is not positive"),
    (MATERIAL, "seos 1 4 2\n" + MATERIAL, ":9:1: error: seos stands before material"),
    ("endi", "seos 1 1 0 0 0 0 0 0 0 0\nseos 1 4 2\nendi", ":13:8: error: this material has an equation of state already"),
    (PART, "load endl\n" + PART, ":11:1: error: loads stand before the bodies"),
    ("endi", "load part 1 0 0 1", ":12:1: error: the deck ends within a block", "add endl"),
    ("endi", "velo body 1 0 0 1", "add endv"),
    ("endi\n", "outr", ":12:1: error: the deck ends where a variable is expected"),
    ("endi", "fixed 0 0 0 1 0 0\ngrid 0 4 0 2 0 4\nendi", ":11:1: error: the body has particles beyond the wall y+, which is at 2.0"),
    ("nbmp 8", "nbmp 21", PART, "part block 1 1 1.0 1 1 1 1 21 1 1\n", "endi",
     "load " + " ".join(f"part {n} {n} 0 0" for n in range(1, 22)) + " endl endi", ":11:1: error: load puts more than 20 different forces"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 0 1 0 1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 0.5 -0.1 0.1 1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 0.5 1 0.1 -1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 1.74 1 0.1 1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "hiex 1 100", "endi", "seos 1 2 1 1 1 1\nendi", ":12:1: error: seos 2: this equation is not available here for hiex"),
]


def changed(changes):
    """The deck with texts replaced, each of which it has once."""
    text = DECK
    for was, now in zip(changes[::2], changes[1::2]):
        assert text.count(was) == 1, was
        text = text.replace(was, now)
    return text


def imported(name, text, *options):
    """Exit code and what is printed; cards, notes and the text of files of particles by name."""
    deck, out = os.path.join(SCRATCH, name + ".mpm"), os.path.join(SCRATCH, name)
    shutil.rmtree(out, ignore_errors=True)
    with open(deck, "w", encoding="latin-1") as file:
        file.write(text)
    done = subprocess.run([SGMP, "import", deck, "--output", out, *options], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120,
                          check=False, env=ENVIRONMENT)
    code, printed = done.returncode, done.stdout.decode("utf-8", "replace")
    files = {}
    for file in os.listdir(out) if os.path.isdir(out) else []:
        with open(os.path.join(out, file), encoding="utf-8") as lines:
            files[file] = lines.read()
    return code, printed, files


def refusals(report):
    """Decks with one mistake."""
    for number, (*changes, last) in enumerate(REFUSED):
        expected = [last]
        if len(changes) % 2:
            expected.insert(0, changes.pop())
        code, printed, files = imported(f"refused_{number}", changed(changes))
        report.check(code == 3 and not files and all(words in printed for words in expected), f"{changes}: {code}, not {expected} in\n{printed}")
    code, printed, files = imported("nothing", "")
    report.check(code == 3 and "nothing.mpm:" in printed and "error: the deck ends before endi" in printed, f"an empty file: {code} {printed}")


def main():
    report = Report()
    refusals(report)
    report.end()


main()
