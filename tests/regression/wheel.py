#!/usr/bin/env python3
"""The viewer as a wheel: built from python/, installed into a fresh environment, imported there, and its command run.

usage: wheel.py SGMP SOURCE_DIR SCRATCH_DIR

Nothing is fetched: setuptools and wheel are those of the test environment, and so are numpy and matplotlib, which the
fresh environment borrows by a path file.
"""
import glob
import importlib.util
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile

from _runs import ENVIRONMENT, SCRATCH, SGMP, SOURCE, Report

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib", "setuptools", "wheel", "pip")):
    print("skipped: numpy, matplotlib, setuptools, wheel or pip is not installed (scripts/setup/setup.sh --test)")
    sys.exit(77)


def call(*words, folder=SCRATCH):
    environment = {name: value for name, value in ENVIRONMENT.items() if name != "PYTHONPATH"}
    done = subprocess.run(
        words, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment, timeout=300, check=False
    )
    return done.returncode, done.stdout.decode("utf-8", "replace")


def main():
    report = Report()
    sources, wheels, place = (os.path.join(SCRATCH, name) for name in ("sources", "wheels", "fresh"))
    for folder in (sources, wheels, place):
        shutil.rmtree(folder, ignore_errors=True)
    # A copy: setuptools leaves build/ and an egg-info beside what it builds.
    shutil.copytree(
        os.path.join(SOURCE, "python"), sources, ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info")
    )
    code, text = call(
        sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-index", "--no-build-isolation", "--wheel-dir", wheels,
        sources,
    )
    built = glob.glob(os.path.join(wheels, "sgmp_view-*.whl"))
    if not report.check(code == 0 and len(built) == 1, f"pip wheel: {text[-600:]}"):
        return report.end()
    version = call(SGMP, "--version")[1].split()[1]
    report.check(
        os.path.basename(built[0]).startswith(f"sgmp_view-{version}-py3-none-any"),
        f"sgmp is {version}, the wheel {built}",
    )
    modules = sorted(os.path.basename(name) for name in glob.glob(os.path.join(SOURCE, "python", "sgmp_view", "*.py")))
    inside = sorted(
        os.path.basename(name) for name in zipfile.ZipFile(built[0]).namelist() if name.startswith("sgmp_view/")
    )
    report.check(inside == modules, f"the wheel has other files: {set(inside) ^ set(modules)}")
    code, text = call(sys.executable, "-m", "venv", "--without-pip", place)
    if not report.check(code == 0, f"venv: {text}"):
        return report.end()
    python = os.path.join(place, "bin", "python")
    site = call(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")[1].strip()
    code, text = call(sys.executable, "-m", "pip", "--python", python, "install", "--no-deps", "--no-index", built[0])
    report.check(code == 0, f"pip install: {text[-600:]}")
    with open(os.path.join(site, "borrowed.pth"), "w", encoding="utf-8") as file:
        file.write(sysconfig.get_path("purelib") + "\n")
    code, text = call(python, "-c", "import sgmp_view; print(sgmp_view.__file__, sgmp_view.__version__)")
    report.check(
        code == 0 and text.split() == [os.path.join(site, "sgmp_view", "__init__.py"), version], f"import: {text}"
    )
    folder = os.path.join(SCRATCH, "bar.out")
    code, text = call(
        SGMP, os.path.join(SOURCE, "input", "bar.inp"), "--set", "cells=16", "--set", "steps=10", "--output", folder,
        "--quiet",
    )
    report.check(code == 0, f"bar.inp: {text}")
    code, text = call(os.path.join(place, "bin", "sgmp-view"), "status", folder)
    report.check(code == 0 and "10" in text, f"the wheel's sgmp-view status: {code} {text[-300:]}")
    return report.end()


if __name__ == "__main__":
    main()
