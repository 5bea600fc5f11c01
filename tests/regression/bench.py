#!/usr/bin/env python3
"""What scripts/bench/bench.py compares the solver with: the plain loop of the same method, a second implementation,
must keep the same part of the kinetic energy to 1e-6, or `make bench` measures nothing; scripts/bench/whole_runs.py has
all its rows.

usage: bench.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import json
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
# Rows of whole runs: start and end on one and two threads, three kinds of files, memory.
for part, rows in (("start", 4), ("output", 3), ("memory", 2)):
    done = subprocess.run(
        [sys.executable, source/"scripts"/"bench"/"whole_runs.py", sgmp, "--runs", "1", "--cells", "8", "--only", part,
         "--output", Path(sys.argv[3])], capture_output=True, text=True, check=False)
    report.check(done.returncode == 0, f"{part}: {done.stdout}{done.stderr}")
    if done.returncode == 0:
        found = json.loads((Path(sys.argv[3])/"whole_runs.json").read_text(encoding="utf-8"))
        report.check(len(found) == rows, f"{part}: {len(found)} rows, {rows} expected")
report.end()
