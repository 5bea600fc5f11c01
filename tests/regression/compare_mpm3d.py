#!/usr/bin/env python3
"""scripts/bench/compare_mpm3d.py with a stand-in for MPM3D-F90: it is built, gets decks that this program can read too, and what it
prints is put beside what ours costs.

usage: compare_mpm3d.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import json
import re
import subprocess
import sys
from pathlib import Path

from _runs import Report

BUILD = "cmake_minimum_required(VERSION 3.2)\nproject(mpm3d Fortran)\nfile(GLOB_RECURSE sources src/*.f90)\nadd_executable(mpm3d ${sources})\n"
# Reads the deck that its argument names, in the current folder, and prints lines of that code's form: 1000 ns.
PROGRAM = """
program stand_in
  character(80) :: job, line
  integer :: unit, status, particles
  call get_command_argument(1, job)
  open (newunit=unit, file=trim(job)//'.mpm', status='old', iostat=status)
  if (status /= 0) stop 3
  do
    read (unit, '(a)', iostat=status) line
    if (status /= 0) stop 4
    if (line(:4) == 'nbmp') exit
  end do
  read (line(5:), *) particles
  write (*, '(1x, a, i6, 1p, a, e10.3, a, e10.3)') 'Step=', 10, '  T=', 1.0, '  K.E.=', 2.5
  write (*, '(a, f12.4, a)') '** Total CPU Time is ', 1.0e-6*particles*10, ' seconds (    0 minutes  0.0 seconds)'
  write (*, '(a, f12.4, a)') '** Time per particle cycle: ', 1000.0, ' nanoseconds'
end program stand_in
"""


def main():
    """All scenes but that of the largest step, coarse."""
    sgmp, source, scratch = (Path(word).resolve() for word in sys.argv[1:4])
    report = Report()
    folder = scratch/"standin"
    (folder/"src").mkdir(parents=True, exist_ok=True)
    (folder/"CMakeLists.txt").write_text(BUILD)
    (folder/"src/stand_in.f90").write_text(PROGRAM)
    script = [sys.executable, str(source/"scripts/bench/compare_mpm3d.py"), str(sgmp)]
    done = subprocess.run([*script, str(folder), "--runs", "1", "--scale", "0.25", "--only", ", ", "--scratch", str(scratch/"compare")],
                          capture_output=True, text=True, timeout=110)
    if report.check(done.returncode == 0, f"exit code {done.returncode}\n{done.stdout}{done.stderr}"):
        rows = json.loads((scratch/"compare/results.json").read_text())
        report.check(len(rows) == 6, f"{len(rows)} rows")
        for row in rows:
            report.check(row["particles"] > 100 and row["theirs_ns"] == 1000 and row["theirs_kinetic"] == 2.5, f"{row}")
            report.check(abs(row["ratio_ns"]*row["ours_ns"] - 1000) < 1e-6, f"ratio: {row}")
            report.check(re.search(rf"^{row['scene']} ", done.stdout, re.MULTILINE), f"no row of {row['scene']}:\n{done.stdout}")
    empty = subprocess.run([*script, str(scratch), "--scratch", str(scratch/"compare")], capture_output=True, text=True, timeout=60)
    report.check(empty.returncode != 0 and "is no copy of MPM3D-F90" in empty.stderr, f"{empty.returncode} {empty.stderr}")
    report.end()


if __name__ == "__main__":
    main()
