#!/usr/bin/env python3
"""The documents: links lead somewhere, commands are understood, tables that the program writes are as it writes them.

usage: documents.py SGMP SOURCE_DIR SCRATCH_DIR

Every `sgmp …` of README.md, the user guide and other pages is given to the program with --check, every `sgmp-view …` to
its parser; words like DECK, NAME or … mark what is no command. Tecplot's macro is compared with what it reads.
"""
import contextlib
import glob
import importlib.util
import io
import os
import re
import shlex
import shutil
import subprocess
import sys

from _runs import ENVIRONMENT, SCRATCH, SGMP, SOURCE, Report

COMMANDS = [
    "README.md", "doc/methods.md", "doc/tasks.md", "doc/user-guide.md", "doc/damping.md", "doc/contact.md",
    "doc/rotation.md", "doc/time-step.md", "doc/results.md", "input/gallery/README.md", "packaging/README.md",
]
OWN = """
parameter h = 0.25
parameter cfl = 0.5
parameter method = sgmp
parameter speed = 1
dimension 2
grid cell=h
method $method
time end=1 cfl=$cfl
material m elastic density=1 young=1 poisson=0.2
body b block lower=(0,0) upper=(1,1) material=m ppc=2
"""
PLACEHOLDER = re.compile(r"…|\.\.\.|\[|\b(DECK|NAME|CARD|COMMAND|X|DIR|FILE|SCRATCH)\b|\$")


def read(name):
    with open(os.path.join(SOURCE, name), encoding="utf-8") as file:
        return file.read()


def anchors(text):
    """What GitHub makes of headings."""
    found = set()
    for line in re.sub(r"^    .*$", "", text, flags=re.MULTILINE).splitlines():
        heading = re.match(r"#+ +(.*)", line)
        if heading:
            words = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading.group(1)).replace("`", "").lower()
            anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
            count = sum(1 for name in found if re.fullmatch(re.escape(anchor) + r"(-\d+)?", name))
            found.add(f"{anchor}-{count}" if count else anchor)
    return found


def links(report):
    """Files and headings that pages of this project point to."""
    names = [
        os.path.relpath(path, SOURCE)
        for pattern in (
            "*.md", "doc/**/*.md", "input/**/*.md", "tests/*.md", "python/*.md", "packaging/*.md",
            "verification/**/*.md",
        )
        for path in glob.glob(os.path.join(SOURCE, pattern), recursive=True)
    ]
    report.check(len(names) > 20, f"only {len(names)} pages")
    for name in names:
        prose = re.sub(r"`[^`\n]*`", "", re.sub(r"^    .*$", "", read(name), flags=re.MULTILINE))
        for target in re.findall(r"\]\(([^)\s]+)\)", prose):
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            path = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
            if not report.check(os.path.exists(os.path.join(SOURCE, path)), f"{name}: no {target}"):
                continue
            if anchor and path.endswith(".md"):
                report.check(anchor in anchors(read(path)), f"{name}: no heading {target}")


def commands(name):
    """Commands of code blocks and of code within lines."""
    text = read(name)
    lines = re.findall(r"^    +(.*)$", text, flags=re.MULTILINE) + re.findall(r"`([^`\n]+)`", text)
    for line in lines:
        line = re.sub(r"\s(#|!) .*$", "", line).strip()
        line = re.sub(r"^mpirun .*?(?=\S*sgmp )", "", line)
        line = re.sub(r"^(build/release/|build/venv/bin/python +)?(scripts/)?(sgmp(-view)?) ", r"\3 ", line)
        if re.match(r"sgmp(-view)? [^\s=]+(\s|$)", line) and not PLACEHOLDER.search(line):
            yield line


def call(words, folder):
    done = subprocess.run(
        words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT, timeout=300, check=False
    )
    return done.returncode, done.stdout.decode("utf-8", "replace")


def help_of(name):
    """Exit code and text of a command of sgmp-view; all in this process, whose modules are loaded once."""
    sys.path.insert(0, os.path.join(SOURCE, "python"))
    from sgmp_view import command

    printed, code = io.StringIO(), 0
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        try:
            command.main([name, "--help"])
        except SystemExit as end:
            code = end.code
    return code or 0, printed.getvalue()


def checked(words):
    """A command of sgmp that runs nothing; None where there is no such deck."""
    if words[0] in ("new", "help", "completion", "materials"):
        return words
    deck = words[0]
    if deck.startswith("-"):
        return words
    if os.path.exists(os.path.join(SOURCE, deck)):
        deck = os.path.join(SOURCE, deck)
    elif not os.path.exists(os.path.join(SCRATCH, deck)):
        return None
    rest = words[1:]
    for option in ("--restart", "--output"):
        if option in rest:
            at = rest.index(option)
            rest = rest[:at] + rest[at + 2:]
    return [deck] + [word for word in rest if word != "--check"] + ["--check"]


def understood(report):
    """sgmp checks what it is given; sgmp-view knows the commands and options."""
    for name in ("my.inp", "scene.inp"):
        with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
            file.write(OWN)
    helps, known, count = {}, {}, 0
    draws = all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib"))
    for page in COMMANDS:
        for line in commands(page):
            program, *words = shlex.split(line)
            if program == "sgmp-view" and not draws:
                continue
            if program == "sgmp-view":
                if words[0] not in helps:
                    helps[words[0]] = help_of(words[0])
                code, text = helps[words[0]]
                report.check(code == 0, f"{page}: {line}: {text[-200:]}")
                for option in [word.split("=")[0] for word in words if word.startswith("--")]:
                    report.check(re.search(re.escape(option) + r"\b", text), f"{page}: {line}: no {option}")
            else:
                if words[0] == "new" and os.path.exists(os.path.join(SCRATCH, words[-1] + ".inp")):
                    continue
                words = checked(words)
                if words is None:
                    named = line.split()[2 if line.split()[1] == "import" else 1]
                    report.check(named.endswith((".mpm", ".inp")), f"{page}: {line}: no such deck")
                    continue
                if words[0] == "new" or tuple(words) not in known:
                    known[tuple(words)] = call([SGMP, *words], SCRATCH)
                code, text = known[tuple(words)]
                report.check(code == 0, f"{page}: {line}: exit code {code}: {text[-300:]}")
            count += 1
    report.check(count > (30 if draws else 20), f"only {count} commands")


def lines(report):
    """No line of a page is longer than 120 letters, but for rows of tables; `make wrap` wraps them. doc/verification is
    written by a program."""
    sys.path.insert(0, os.path.join(SOURCE, "scripts", "dev"))
    from wrap import too_long

    pages = [
        path
        for pattern in (
            "*.md", "doc/*.md", "input/**/*.md", "tests/**/*.md", "python/*.md", "packaging/*.md",
            "verification/**/*.md",
        )
        for path in glob.glob(os.path.join(SOURCE, pattern), recursive=True)
    ]
    report.check(len(pages) > 40, f"only {len(pages)} pages")
    report.check(
        too_long("a " * 61) == [1] and not too_long("| " + "a " * 80),
        "wrap.py does not see a long line, or counts rows of tables",
    )
    for path in pages:
        name = os.path.relpath(path, SOURCE)
        report.check(
            not too_long(read(name)), f"{name}: more than 120 letters in lines {too_long(read(name))}: make wrap"
        )


def tasks(report):
    """Each task of doc/tasks.md has a command, what to look at, how accurate it is, and a page to go on with; `sgmp
    new` knows its decks."""
    parts = re.split(r"^### ", read("doc/tasks.md"), flags=re.MULTILINE)[1:]
    report.check(len(parts) >= 20, f"doc/tasks.md: {len(parts)} tasks")
    known = call([SGMP, "new"], SCRATCH)[1]
    for part in parts:
        name = part.splitlines()[0]
        part = re.split(r"^## ", part, flags=re.MULTILINE)[0]
        report.check(
            re.search(r"^    (sgmp|build/venv)", part, flags=re.MULTILINE), f"doc/tasks.md: {name}: no command"
        )
        for word in ("*Look at*", "*Accuracy*"):
            report.check(word in part, f"doc/tasks.md: {name}: nothing about {word}")
        report.check(re.search(r"\]\([^)]*\.md", part), f"doc/tasks.md: {name}: no page to go on with")
        for deck in re.findall(r"^    sgmp new (\w+)", part, flags=re.MULTILINE):
            report.check(
                re.search(rf"^  {deck} ", known, flags=re.MULTILINE), f"doc/tasks.md: {name}: sgmp new knows no {deck}"
            )
            report.check(
                re.search(rf"\b{deck}\.(inp|out)|SCRATCH", part), f"doc/tasks.md: {name}: {deck} is copied and not used"
            )
        for script in re.findall(r"(?:python|sbatch) (scripts/\S+)", part):
            report.check(os.path.exists(os.path.join(SOURCE, script)), f"doc/tasks.md: {name}: no {script}")


def tecplot(report):
    """The macro for Tecplot names the variables of particles.dat in their order, and colours by the plastic strain."""
    macro = read("scripts/taylor_bar_tecplot.mcr")
    names = re.search(r"VarNameList = '(.*)'", macro).group(1)
    report.check(
        shlex.split(names)[int(re.search(r"\|FIELD\| = (\d+)", macro).group(1)) - 1] == "plastic_strain",
        "the macro colours by another variable",
    )
    code, text = call(
        [
            SGMP, os.path.join(SOURCE, "input", "taylor_bar.inp"), "--quiet", "--output", "bar.out",
            *(word for setting in ("format=tecplot", "h=3.8", "t_end=1e-3") for word in ("--set", setting)),
        ],
        SCRATCH,
    )
    report.check(code == 0, f"Taylor bar with format=tecplot: {text}")
    with open(os.path.join(SCRATCH, "bar.out", "particles.dat"), encoding="utf-8") as file:
        head = file.read(2000)
    report.check(f"VARIABLES = {names}\n" in head, f"the macro names other variables than particles.dat: {head[:300]}")


def main():
    report = Report()
    for old in glob.glob(os.path.join(SCRATCH, "*.inp")):
        os.remove(old)
    for old in glob.glob(os.path.join(SCRATCH, "*.out")):
        shutil.rmtree(old)
    links(report)
    understood(report)
    tasks(report)
    lines(report)
    tecplot(report)
    return report.end()


if __name__ == "__main__":
    main()
