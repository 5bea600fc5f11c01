#!/usr/bin/env python3
"""What the program says of itself: options, exit codes and cards are those it knows, in help, documents and shell.

usage: help.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import re
import shutil
import subprocess
import sys

from _runs import ENVIRONMENT, SGMP, SOURCE, Report


def say(*words):
    """Exit code and output of a call."""
    done = subprocess.run([SGMP, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT, timeout=60,
                          check=False)
    return done.returncode, done.stdout.decode()


def document(name):
    """Text of a file of doc/."""
    with open(os.path.join(SOURCE, "doc", name), encoding="utf-8") as file:
        return file.read()


def complete(words):
    """What bash offers for the last of the words."""
    script = ('PATH=$1:$PATH; eval "$(sgmp completion bash)"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _sgmp; '
              'echo "${COMPREPLY[@]}"')
    done = subprocess.run(["bash", "-c", script, "bash", os.path.dirname(SGMP), *words], stdout=subprocess.PIPE,
                          env=ENVIRONMENT, cwd=os.path.join(SOURCE, "input"), timeout=60, check=False)
    return done.stdout.decode().split()


def main():
    report = Report()
    code, usage = say("--help")
    report.check(code == 0, "--help ends with an error")
    options = re.findall(r"^  (--[a-z0-9-]+)", usage, re.MULTILINE)
    report.check(len(options) >= 10, f"--help lists no options: {options}")
    for option in options:  # each of them is understood: no option is called unknown
        report.check("unknown option" not in say(option)[1], f"{option} is listed and unknown")
    for option in ("--check", "--set", "--threads", "--restart", "--time-limit", "--output", "--quiet", "--verbose"):
        report.check(option in options, f"--help does not list {option}")
    report.check(say("help", "options") == (code, usage), "help options says something else than --help")
    report.check("material" in say("help")[1] and "--help" in say("help")[1], "help lists no cards or hides --help")
    for name, words in (
        ("user-guide.md", ("help", "options", "--markdown")),
        ("deck-reference.md", ("help", "--markdown")),
    ):
        report.check(say(*words)[1].strip() in document(name), f"doc/{name} is not what sgmp {' '.join(words)} says")
    report.check(say("completion", "zsh")[0] == 2, "a shell that is not supported is accepted")
    if shutil.which("bash"):
        for words, expected in ((("sgmp", "--th"), ["--threads"]), (("sgmp", "help", "mater"), ["material"]),
                                (("sgmp", "bar.i"), ["bar.inp"]), (("sgmp", "comp"), ["completion"]),
                                (("sgmp", "a", "--restart", "lat"), ["latest"]), (("sgmp", "a", "--threads", ""), [])):
            report.check(complete(words) == expected, f"{words}: bash offers {complete(words)}, expected {expected}")
    return report.end()


if __name__ == "__main__":
    sys.exit(main())
