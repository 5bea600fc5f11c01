#!/usr/bin/env python3
"""What scripts/bench/bench.py compares the solver with: the plain loop of the same method, a second implementation,
must keep the same part of the kinetic energy to 1e-6, or `make bench` measures nothing.

usage: bench.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import subprocess
import sys
from pathlib import Path

from _runs import Report

report = Report()
sgmp, source = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
if not (sgmp.parent/"bench"/"reference").exists():
    sys.exit(77)
done = subprocess.run(
    [sys.executable, source/"scripts"/"bench"/"bench.py", sgmp, "--check"], capture_output=True, text=True, check=False
)
report.check(done.returncode == 0, f"{done.stdout}{done.stderr}")
report.end()
