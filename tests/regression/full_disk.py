#!/usr/bin/env python3
"""A disk that is full: the run says so, keeps the checkpoints that are whole, and goes on from them elsewhere.

Needs the right to mount a file system in memory; without it the test is skipped (exit code 77).

usage: full_disk.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import shutil
import subprocess
import sys

from _restarts import checkpoints, clear, command, deck, execute, path_of, same_files, straight
from _runs import Report

DECK = deck("block.inp", "checkpoint every=20\n")
SETTINGS = {"cells": 8, "steps": 300, "drift": 0.1, "jitter": 0.3}
WRONG_FILE = 5


def fill(report, folder, size, moved):
    """Runs on a file system with room for two checkpoints, and copies what is left there."""
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={int(2.5*size)}", "none", folder], check=False,
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode == 0
    if not mounted:
        print("SKIPPED: no right to mount a file system")
        sys.exit(77)
    try:
        result = execute(command("disk", DECK, settings=SETTINGS), "disk")
        report.check(
            result.code == WRONG_FILE and "No space left" in result.text, f"exit code {result.code}\n{result.text}"
        )
        report.check(checkpoints(folder) == [20, 40], f"{checkpoints(folder)} {os.listdir(folder)}")
        report.check(not any(left.endswith(".part") for left in os.listdir(folder)), f"{os.listdir(folder)}")
        shutil.copytree(folder, moved)
    finally:
        subprocess.run(["umount", folder], check=False)


def main():
    """A whole run, one that fills its disk, and one that goes on elsewhere."""
    report = Report()
    whole = straight(report, "whole", DECK, **SETTINGS)
    folder, moved = clear("disk"), clear("moved")
    os.makedirs(folder)
    fill(report, folder, os.path.getsize(path_of(whole.folder, checkpoints(whole.folder)[-1])), moved)
    result = execute(command("moved", DECK, ["--restart", "latest"], SETTINGS), "moved")
    if report.finished(result, "moved"):
        same_files(report, whole.folder, result.folder, "moved")
    report.end()


main()
