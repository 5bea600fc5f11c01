#!/usr/bin/env python3
"""A build without MPI beside one with it: the same bits, files and checkpoints; refused under a launcher of several
processes.

usage: serial.py SERIAL_SGMP SOURCE_DIR SCRATCH_DIR SGMP      (`make test-serial` builds the first)
"""
import json
import os
import subprocess
import sys

SERIAL, SOURCE, SCRATCH, PARALLEL = (os.path.abspath(path) for path in sys.argv[1:5])
# Deck and parameters: 1D, plane with contact, axisymmetric with failure and contact, space; one that writes each kind
# of file.
SCENES = {
    "bar": ("bar.inp", {"cells": 32, "steps": 100, "dt": 1e-4}),
    "rings": ("rings.inp", {"h": 4, "t_end": 0.4}),
    "ball": ("gallery/ball_plate.inp", {"h": 0.5}),
    "rod": ("rod_plate.inp", {"h": 1.5, "t_end": 0.002}),
    "vtkhdf": ("taylor_bar_axisymmetric.inp", {"format": "vtkhdf", "h": 0.95, "t_end": 0.01}),
    "tnt": ("tnt_slab.inp", {"h": 1, "t_end": 0.002}),
}
FILES = ("history.csv", "bodies.csv", "contact.csv", "particles_end.csv", "particles.vtkhdf")


def run(program, name, words, **environment):
    """(exit code, what is printed, folder)"""
    folder = os.path.join(SCRATCH, name)
    done = subprocess.run(
        [program, *words, "--output", folder, "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env={**os.environ, "OMP_WAIT_POLICY": "passive", **environment}, timeout=600, check=False,
    )
    return done.returncode, done.stdout.decode(), folder


def checksum(folder):
    with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
        return json.load(file)["checksum"]


def content(path):
    if not os.path.exists(path):
        return None
    with open(path, "rb") as file:
        return file.read()


def main():
    """Compares all scenes, a restart from the other build's checkpoint, and what a launcher gets to hear."""
    os.makedirs(SCRATCH, exist_ok=True)
    failures, checks = [], 0

    def check(good, text):
        nonlocal checks
        checks += 1
        if not good:
            failures.append(text)

    linked = subprocess.run(["ldd", SERIAL], stdout=subprocess.PIPE, check=True).stdout.decode()
    print("linked with MPI (by HDF5)" if "libmpi" in linked else "not linked with MPI")
    check("libmpi_usempif08" not in linked, "the serial build is linked with MPI's Fortran modules")
    for name, (deck, parameters) in SCENES.items():
        words = [os.path.join(SOURCE, "input", deck)]
        words += [word for item in parameters.items() for word in ("--set", "=".join(map(str, item)))]
        runs = [run(program, f"{name}_{kind}", words) for kind, program in (("serial", SERIAL), ("parallel", PARALLEL))]
        check(all(code == 0 for code, _, _ in runs), f"{name}: {[text[-300:] for _, text, _ in runs]}")
        if any(code for code, _, _ in runs):
            continue
        check(checksum(runs[0][2]) == checksum(runs[1][2]), f"{name}: other bits")
        for file in FILES:
            own, other = (content(os.path.join(folder, file)) for _, _, folder in runs)
            check(own == other, f"{name}: {file} differs")
    deck = os.path.join(SCRATCH, "restarted.inp")
    with open(os.path.join(SOURCE, "input", "rings.inp"), encoding="utf-8") as file:
        text = file.read() + "\ncheckpoint every=20\n"
    with open(deck, "w", encoding="utf-8") as file:
        file.write(text)
    settings = [deck, "--set", "h=4", "--set", "t_end=0.4"]
    whole = run(PARALLEL, "whole", settings)
    begun = sorted(name for name in os.listdir(whole[2]) if name.startswith("checkpoint"))[0]
    again = run(SERIAL, "again", [*settings, "--restart", os.path.join(whole[2], begun)])
    check(whole[0] == 0 and again[0] == 0, f"restart: {whole[1][-300:]} {again[1][-300:]}")
    check(
        again[0] == 0 and checksum(whole[2]) == checksum(again[2]),
        "restart from the other build's checkpoint: other bits",
    )
    code, text, _ = run(SERIAL, "launched", settings, OMPI_COMM_WORLD_SIZE="2")
    check(code == 2 and "built without MPI" in text, f"started by a launcher as two: {code} {text[-300:]}")
    code, text, _ = run(SERIAL, "launched", settings, OMPI_COMM_WORLD_SIZE="1")
    check(code == 0, f"started by a launcher as one: {code} {text[-300:]}")
    print("\n".join([*failures, f"{checks} checks, {len(failures)} failures"]))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
