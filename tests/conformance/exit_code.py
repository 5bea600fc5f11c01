#!/usr/bin/env python3
"""A failing unit test must end with exit code 2 and say so. usage: exit_code.py TEST_PROGRAM"""
import subprocess
import sys

MESSAGE = "*** Encountered 1 or more failures/errors during testing ***"

run = subprocess.run([sys.argv[1]], capture_output=True, text=True)
if run.returncode != 2 or MESSAGE not in run.stdout + run.stderr or " OK\n" in run.stdout:
    sys.exit(f"exit code {run.returncode}, expected 2 and the line {MESSAGE!r}:\n{run.stdout[-2000:]}")
