#!/usr/bin/env python3
"""Checks the sources against the house style. usage: lint.py [--fortitude PROGRAM] FOLDER

Errors (exit code 1): all that fortitude finds (fortitude.toml); a module not called sgmp_<file>, or a second one in a
file; a stop outside of main.f90. Reported only: files over 400 lines, procedures over
60, and those outside of kernels/ that have more than 7 arguments.

Dimension-generic sources (see cmake/dimension_generic.cmake) are no Fortran before the preprocessor: fortitude gets
their one-, two-, three-dimensional and axisymmetric versions, with the line numbers of the source.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FILE_LINES, PROCEDURE_LINES, ARGUMENTS = 400, 60, 7
LINE_LETTERS = 120

STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
GENERIC = re.compile(r"^! dimension-generic", re.MULTILINE)
AXISYMMETRIC = re.compile(r"^! dimension-generic, axisymmetric", re.MULTILINE)
VARIANTS = (("-DNDIM=3",), ("-DNDIM=2",), ("-DNDIM=1",), ("-DNDIM=2", "-DAXISYMMETRIC"))
MODULE = re.compile(r"^\s*module\s+(?!procedure\b|subroutine\b|function\b)(?:DIM\((\w+)\)|(\w+))\s*$", re.IGNORECASE)
SUBMODULE = re.compile(r"^\s*submodule\s*\(", re.IGNORECASE)
STOP = re.compile(r"^\s*(\d+\s+)?(if\s*\(.*\)\s*)?(error\s*)?stop(\s+[\w'(]|\s*$)", re.IGNORECASE)
START = re.compile(r"^\s*(?!end\b)(?:[\w()=, *]+\s)?(subroutine|function)\s+(\w+)", re.IGNORECASE)
END = re.compile(r"^\s*end\s+(subroutine|function)\b", re.IGNORECASE)
ARGUMENT_LIST = re.compile(START.pattern + r"\s*\(([^()]*)\)", re.IGNORECASE)


def code_of(line):
    """The line without texts and comment."""
    return STRING.sub("''", line).split("!", 1)[0].rstrip()


# -------------------------------------------------------------------------------------------------- own rules
def module_errors(path, lines):
    expected = f"sgmp_{path.stem}"
    names = [(number, match.group(1) or match.group(2))
             for number, line in lines for match in [MODULE.match(line)] if match]
    wrong = [(number, f"the module is called {name}, not {expected}") for number, name in names
             if not re.fullmatch(expected + "(_[123]d)?", name, re.IGNORECASE)]
    if len(set(name[:-3] if name[-1] == "d" else name for _, name in names)) > 1:
        wrong.append((names[1][0], "a second module in this file"))
    if not names and not any(SUBMODULE.match(line) for _, line in lines):
        wrong.append((1, "no module"))
    return wrong


def stop_errors(lines):
    return [(number, "only main.f90 may stop; return an error instead") for number, line in lines if STOP.match(line)]


def long_lines(folder):
    """Lines of sources that are no Fortran (whose lines fortitude counts) and are longer than a screen."""
    for path in sorted(p for p in folder.rglob("*") if p.suffix in (".c", ".cpp", ".h", ".inc")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if len(line) > LINE_LETTERS:
                yield f"{path}:{number}: {len(line)} letters in a line, more than {LINE_LETTERS}"


def procedure_sizes(lines):
    open_ones, sizes = [], []
    for number, line in lines:
        start = START.match(line)
        if END.match(line):
            if open_ones:
                name, first = open_ones.pop()
                sizes.append((number - first + 1, first, name))
        elif start:
            open_ones.append((start.group(2), number))
    return sizes


def long_lists(lines):
    """(arguments, line, name) of the procedures that have too many."""
    whole, first = "", 0
    for number, line in lines:
        first = first if whole else number
        whole += line.strip().lstrip("&")
        if whole.endswith("&"):
            whole = whole[:-1]
            continue
        match = ARGUMENT_LIST.match(whole)
        count = len([word for word in match.group(3).split(",") if word.strip()]) if match else 0
        if count > ARGUMENTS:
            yield count, first, match.group(2)
        whole = ""


def own_rules(paths):
    """(errors, what is large) of all files, as texts."""
    errors, large, many = [], [], []
    for path in paths:
        lines = [(n, code_of(line)) for n, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)]
        found = [] if path.name == "main.f90" else module_errors(path, lines) + stop_errors(lines)
        errors += [f"{path}:{number}: {message}" for number, message in found]
        if len(lines) > FILE_LINES:
            large.append((len(lines), f"{path}: {len(lines)} lines"))
        large += [(size, f"{path}:{first}: {name} has {size} lines")
                  for size, first, name in procedure_sizes(lines) if size > PROCEDURE_LINES]
        if "kernels" not in path.parts:
            many += [
                (count, f"{path}:{first}: {name} has {count} arguments") for count, first, name in long_lists(lines)
            ]
    large.append((0, f"{len(many)} procedures outside of kernels/ have more than {ARGUMENTS} arguments"))
    return errors, [text for _, text in sorted(large, reverse=True) + sorted(many, reverse=True)]


# -------------------------------------------------------------------------------------------------- fortitude
def specialised(path, variant, include_flags):
    """The source after the preprocessor, every line at its place."""
    command = [os.environ.get("FC", "gfortran"), "-E", "-cpp", *variant, *include_flags, str(path)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    lines = [""] * len(path.read_text(encoding="utf-8").splitlines())
    file, number = None, 0
    for line in text.splitlines():
        marker = re.match(r'# (\d+) "(.*?)"', line)
        if marker:
            number, file = int(marker.group(1)), marker.group(2)
            continue
        if file == str(path) and number <= len(lines):
            lines[number - 1] = line
        number += 1
    return "\n".join(lines) + "\n"


def fortitude_errors(program, folder, paths):
    """Runs it over a copy for each variant; what it says of one line is said once."""
    program = str(pathlib.Path(program).absolute())
    generic = [p for p in paths if p.suffix == ".F90" and GENERIC.search(p.read_text(encoding="utf-8"))]
    include_flags = [f"-I{place}" for place in sorted({p.parent for p in folder.rglob("*.inc")})]
    found = {}
    round_about = [p for p in generic if AXISYMMETRIC.search(p.read_text(encoding="utf-8"))]
    for variant in VARIANTS:
        with tempfile.TemporaryDirectory() as scratch:
            for path in paths if variant == VARIANTS[0] else generic if len(variant) == 1 else round_about:
                target = pathlib.Path(scratch, path)
                target.parent.mkdir(parents=True, exist_ok=True)
                if path in generic:
                    target.write_text(specialised(path, variant, include_flags), encoding="utf-8")
                else:
                    shutil.copyfile(path, target)
            shutil.copyfile("fortitude.toml", pathlib.Path(scratch, "fortitude.toml"))
            run = subprocess.run([program, "check", "--output-format", "concise", str(folder)],
                                 cwd=scratch, capture_output=True, text=True)
            diagnostics = [line for line in run.stdout.splitlines() if re.match(r"\S+:\d+:\d+: ", line)]
            if run.returncode not in (0, 1) or (run.returncode == 1 and not diagnostics):
                sys.exit(f"fortitude failed:\n{run.stdout}{run.stderr}")
            # C031, a number as an array's size: in a generic source it was a name (NCORNER) before the preprocessor.
            found.update(dict.fromkeys(line for line in diagnostics
                                       if not (pathlib.Path(line.split(":")[0]) in generic and " C031 " in line)))
        if not generic:
            break
    return sorted(found, key=lambda line: (line.split(":")[0], int(line.split(":")[1])))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--fortitude", help="the program; left out: own rules only")
    arguments = parser.parse_args()
    paths = sorted(p for p in arguments.folder.rglob("*") if p.suffix in (".f90", ".F90"))
    errors, large = own_rules(paths)
    errors += long_lines(arguments.folder)
    if arguments.fortitude:
        errors = fortitude_errors(arguments.fortitude, arguments.folder, paths) + errors
    if large:
        print(f"larger than usual (files {FILE_LINES}, procedures {PROCEDURE_LINES} lines); worth a look, no error:")
        print("\n".join(f"  {text}" for text in large))
    print("\n".join(errors + [f"{len(paths)} files, {len(errors)} errors"]))
    sys.exit(1 if errors else 0)


if __name__ == "__main__":
    main()
