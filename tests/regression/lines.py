#!/usr/bin/env python3
"""Lines of source are at most 120 letters long. Fortran of src/ has its own limit of 100 (`make lint`); pages of
documents: documents.py.

What may be longer: decks of tests/decks and of tests/conformance/rejected, which are wrong on purpose or made by
programs; a directive of a unit test, which must be one line (132, tests/README.md); a formula of a deck or a list of
names that cannot be divided.

usage: lines.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import glob
import os
import re

from _runs import SOURCE, Report

LETTERS, DIRECTIVE = 120, 132
FOLDERS = ("cmake", "packaging", "python", "scripts", "src", "tests", "verification")
KINDS = (".c", ".cmake", ".cpp", ".f90", ".F90", ".h", ".inc", ".inp", ".mcr", ".pf", ".py", ".sh")
ELSEWHERE = re.compile(r"tests/decks/.*\.inp$|tests/conformance/rejected/")
UNDIVIDED = re.compile(r"\"[^\"]{90,}\"|^ *VarNameList = ")


def too_long(name, text):
    """Numbers of the lines that are."""
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        directive = name.endswith(".pf") and line.lstrip().startswith("@")
        if len(line) > (DIRECTIVE if directive else LETTERS):
            if not (name.endswith((".inp", ".mcr")) and UNDIVIDED.search(line)):
                found.append(number)
    return found


def sources():
    """Files of the project, by their names in it."""
    for folder in FOLDERS:
        for path in glob.glob(os.path.join(SOURCE, folder, "**", "*"), recursive=True):
            name = os.path.relpath(path, SOURCE)
            kind = name.endswith(KINDS) or os.path.basename(name) == "CMakeLists.txt"
            if kind and os.path.isfile(path) and not ELSEWHERE.match(name):
                yield name
    yield "CMakeLists.txt"


def main():
    """All of it, and that a long line is seen."""
    report = Report()
    report.check(too_long("a.py", "x" * 120 + "\n" + "x" * 121) == [2], "a long line is not seen")
    report.check(too_long("a.pf", "@" + "x" * 131 + "\n@" + "x" * 132) == [2], "a long directive is not seen")
    report.check(too_long("a.inp", "x" * 121) == [1], "a long line of a deck is not seen")
    names = list(sources())
    report.check(len(names) > 800, f"only {len(names)} files")
    for name in names:
        with open(os.path.join(SOURCE, name), encoding="utf-8") as file:
            found = too_long(name, file.read())
        report.check(not found, f"{name}: more than {LETTERS} letters in lines {found[:8]}")
    report.end()


main()
