#!/usr/bin/env python3
"""The program where it is installed: it finds its decks, other projects find it, the manual page and the completion are
there.

usage: installed.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import re
import shutil
import subprocess
import sys

from _runs import ENVIRONMENT, INPUT, SCRATCH, SGMP, Report

PREFIX = os.path.join(SCRATCH, "prefix")
PROJECT = """
cmake_minimum_required(VERSION 3.21)
project(consumer NONE)
find_package(sgmp 1.0 REQUIRED)
enable_testing()
add_test(NAME deck COMMAND sgmp::sgmp ${sgmp_INPUT_DIR}/bar.inp --check)
"""


def call(*words, folder=SCRATCH):
    done = subprocess.run(words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT,
                          timeout=300, check=False)
    return done.returncode, done.stdout.decode("utf-8", "replace")


def fresh(name):
    folder = os.path.join(SCRATCH, name)
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    return folder


def decks(report, program):
    """Every deck that `sgmp new` lists can be copied and checked; no copy takes the place of a file."""
    folder = fresh("new")
    code, text = call(program, "new", folder=folder)
    names = [line.split()[0] for line in text.split("decks:")[-1].splitlines() if line.strip()]
    report.check(code == 0 and len(names) >= 10 and "penetration" in names, f"sgmp new: {text}")
    for name in names:
        code, text = call(program, "new", name, folder=folder)
        report.check(code == 0 and os.path.exists(os.path.join(folder, name + ".inp")), f"sgmp new {name}: {text}")
        code, text = call(program, name + ".inp", "--check", folder=folder)
        report.check(code == 0, f"{name}.inp: {text}")
    for words, expected, part in ((("new", names[0]), 5, "already"),
                                  (("new", names[0], "--output", "there"), 0, "there/"),
                                  (("new", "penetratoin"), 2, "did you mean 'penetration'"),
                                  (("new", names[0], "--check"), 2, "--output only")):
        code, text = call(program, *words, folder=folder)
        report.check(code == expected and part in text, f"{words}: exit code {code}: {text}")
    lonely = shutil.copy(program, os.path.join(fresh("lonely"), "sgmp"))
    code, text = call(lonely, "new", names[0], folder=folder + "/there/..")
    report.check(code == 5, f"overwritten by {text}")
    code, text = call(lonely, "new", names[0], folder=os.path.dirname(lonely))
    report.check(code == 5 and "are not in" in text, f"without decks: {code} {text}")


LIBRARY_DECK = """
units mm g ms
dimension 1
grid cell=1 x=open
time steps=1
include "{file}"
body bar block material={name} lower=0 upper=4 ppc=2
"""


def written(folder, file, text):
    os.makedirs(os.path.dirname(os.path.join(folder, file)), exist_ok=True)
    with open(os.path.join(folder, file), "w", encoding="utf-8") as out:
        out.write(text)


def materials(report, program):
    """The library from a folder far from it: listed, shown, included; what stands beside the deck goes first, then
    SGMP_PATH."""
    folder = fresh("far/away")
    code, text = call(program, "materials", folder=folder)
    names = [line.split()[0] for line in text.split("materials:")[-1].splitlines() if line.strip()]
    there = sorted(name[:-4] for name in os.listdir(os.path.join(INPUT, "materials")) if name.endswith(".inp"))
    report.check(code == 0 and names == there, f"sgmp materials: {code} {text}")
    code, text = call(program, "materials", "copper", folder=folder)
    with open(os.path.join(INPUT, "materials", "copper.inp"), encoding="utf-8") as file:
        report.check(code == 0 and text.split("\n", 1)[1] == file.read(), f"sgmp materials copper: {code} {text}")
    written(folder, "library.inp", LIBRARY_DECK.format(file="materials/copper.inp", name="copper"))
    code, text = call(program, "library.inp", "--check", folder=folder)
    report.check(code == 0, f"the library's copper: {code} {text}")
    for words, part in ((("materials", "coper"), "did you mean 'copper'"),
                        (("materials", "rock"), "no constants of rock with a source"),
                        (("materials", "--check"), "takes no options")):
        code, text = call(program, *words, folder=folder)
        report.check(code == 2 and part in text, f"{words}: {code} {text}")
    written(folder, "mine/materials/copper.inp", "material mine elastic density=1e-3 young=1 poisson=0\n")
    written(folder, "own.inp", LIBRARY_DECK.format(file="materials/copper.inp", name="mine"))
    code, text = call(program, "own.inp", "--check", folder=folder)
    report.check(code == 3 and "mine" in text, f"material mine without SGMP_PATH: {code} {text}")
    ENVIRONMENT["SGMP_PATH"] = "/nowhere:" + os.path.join(folder, "mine")
    code, text = call(program, "own.inp", "--check", folder=folder)
    report.check(code == 0, f"material mine by SGMP_PATH: {code} {text}")
    del ENVIRONMENT["SGMP_PATH"]
    shutil.copytree(os.path.join(folder, "mine", "materials"), os.path.join(folder, "materials"))
    code, text = call(program, "own.inp", "--check", folder=folder)
    report.check(code == 0, f"material mine beside the deck: {code} {text}")
    written(folder, "missing.inp", LIBRARY_DECK.format(file="materials/coper.inp", name="copper"))
    code, text = call(program, "missing.inp", "--check", folder=folder)
    report.check(code == 3 and "looked for beside" in text and "share/sgmp/input" in text,
                 f"missing include: {code} {text}")


def what_else(report):
    """The viewer, the job scripts, the documents and the gallery."""
    code, text = call(sys.executable, os.path.join(PREFIX, "bin", "sgmp-view"), "--help")
    missing = "numpy and matplotlib are missing" in text
    report.check(code == 0 and "sgmp-view" in text or missing, f"installed sgmp-view: {code} {text[-300:]}")
    for place in ("share/sgmp/python/sgmp_view/command.py", "share/sgmp/hpc/slurm.sh",
                  "share/sgmp/scripts/ballistic_limit.py",
                  "share/sgmp/input/gallery/README.md", "share/sgmp/input/gallery/whipple.inp",
                  "share/doc/sgmp/README.md",
                  "share/doc/sgmp/CHANGELOG.md", "share/doc/sgmp/doc/tasks.md",
                  "share/doc/sgmp/doc/images/taylor_bar.png"):
        report.check(os.path.exists(os.path.join(PREFIX, place)), f"not installed: {place}")
    report.check(os.access(os.path.join(PREFIX, "share/sgmp/hpc/slurm.sh"), os.X_OK),
                 "slurm.sh is installed without its permission")
    page = open(os.path.join(PREFIX, "share/doc/sgmp/README.md"), encoding="utf-8").read()
    for target in re.findall(r"\]\((doc/[^)#]+)|^\[\w+\]: (doc/\S+)", page, flags=re.MULTILINE):
        target = "".join(target)
        report.check(os.path.exists(os.path.join(PREFIX, "share/doc/sgmp", target)),
                     f"README.md where it is installed: no {target}")


def main():
    report = Report()
    build = os.path.dirname(SGMP)
    decks(report, SGMP)
    materials(report, SGMP)
    if not (os.path.exists(os.path.join(build, "generated", "sgmp.1")) and shutil.which("cmake")):
        return report.end()
    shutil.rmtree(PREFIX, ignore_errors=True)
    code, text = call("cmake", "--install", build, "--prefix", PREFIX)
    report.check(code == 0, f"cmake --install: {text}")
    program = os.path.join(PREFIX, "bin", "sgmp")
    decks(report, program)
    materials(report, program)
    what_else(report)
    with open(os.path.join(PREFIX, "share", "man", "man1", "sgmp.1"), encoding="utf-8") as page:
        manual = page.read()
    for word in call(program, "help", "options")[1].split():
        if word.startswith("--"):
            report.check(word.replace("-", "\\-") in manual, f"{word} is not in the manual page")
    with open(os.path.join(PREFIX, "share", "bash-completion", "completions", "sgmp"), encoding="utf-8") as file:
        report.check(file.read() == call(program, "completion", "bash")[1], "the completion is another")
    folder = fresh("consumer")
    with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
        file.write(PROJECT)
    code, text = call("cmake", "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={PREFIX}", folder=folder)
    report.check(code == 0, f"find_package: {text}")
    code, text = call("ctest", "--test-dir", "build", "--no-tests=error", folder=folder)
    report.check(code == 0, f"sgmp::sgmp: {text}")
    return report.end()


if __name__ == "__main__":
    main()
