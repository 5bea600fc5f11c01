#!/usr/bin/env python3
"""scripts/bench/compare_mpm3d.py with a stand-in for MPM3D-F90: it gets decks that this program can read too, and what
it prints is put beside what ours costs.

usage: compare_mpm3d.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

from _runs import Report

# Reads the deck that its argument names, in the current folder, and prints lines of that code's form, DT= among them:
# 1000 ns.
PROGRAM = f"""#!{sys.executable}
import re, sys
text = open(sys.argv[1] + ".mpm").read()
particles = int(re.search(r"^nbmp (\\d+)", text, re.MULTILINE)[1])
for step, kinetic in ((5, 7.5), (10, 2.5)):
    print(f" Step={{step:6d}}   T= {{1.0:9.3E}}   DT= {{0.1:9.3E}}   K.E.= {{kinetic:9.3E}}  T.E.= {{9.0:9.3E}}")
    print(f"              Mx= {{0.0:9.3E}}   My= {{0.0:9.3E}}   Mz= {{0.0:9.3E}}")
print(f"** Total CPU Time is {{1e-6*particles*10:12.4f}} seconds (    0 minutes  0.0000 seconds)")
print(f"** Time per particle cycle: {{1000.0:12.4f}} nanoseconds")
"""


def same_scene(report, script, sgmp, scratch, rows):
    """Kinetic energies of scenes one cell thick are those of three dimensions; their rows lie in the middle, so that
    nothing is warned of."""
    sys.path.insert(0, str(script.parent))
    import compare_mpm3d as scenes
    for name, make in (("soft beam, sgmp", scenes.beam), ("TNT slab, sgmp", scenes.slab)):
        scene = next(scene for scene in scenes.SCENES if scene[0] == name)
        deck = scratch/"thick.mpm"
        deck.write_text(make(scene[2], scene[3], 0.25))
        done = subprocess.run(
            [
                str(sgmp), str(deck), "--keep-3d", "--threads", "1", "--set", f"cfl={scene[4]}", "--output",
                str(scratch / "thick"),
            ],
            capture_output=True,
            text=True,
            timeout=110,
        )
        if not report.check(done.returncode == 0, f"{name}: {done.stdout}{done.stderr}"):
            continue
        there = json.loads((scratch/"thick/summary.json").read_text())["energy"]["kinetic"]
        ours = next(row for row in rows if row["scene"] == name)["ours_kinetic"]
        report.check(abs(ours/there - 1) < 1e-3, f"{name}: kinetic energy {ours}, in three dimensions {there}")
        done = subprocess.run(
            [str(sgmp), "import", str(deck), "--output", str(scratch / f"import_{make.__name__}")], capture_output=True,
            text=True, timeout=60,
        )
        report.check(
            done.returncode == 0 and "warning" not in done.stdout + done.stderr, f"{name}: {done.stdout}{done.stderr}"
        )


def main():
    """All scenes but that of the largest step, coarse."""
    sgmp, source, scratch = (Path(word).resolve() for word in sys.argv[1:4])
    report = Report()
    shutil.rmtree(scratch, ignore_errors=True)  # of an earlier run
    scratch.mkdir(parents=True)
    standin = scratch/"mpm3d"
    standin.write_text(PROGRAM)
    standin.chmod(0o755)
    path = source/"scripts/bench/compare_mpm3d.py"
    script = [sys.executable, str(path), str(sgmp)]
    done = subprocess.run(
        [
            *script, str(standin), "--runs", "1", "--scale", "0.25", "--only", ", ", "--scratch",
            str(scratch / "compare"),
        ],
        capture_output=True,
        text=True,
        timeout=110,
    )
    if report.check(done.returncode == 0, f"exit code {done.returncode}\n{done.stdout}{done.stderr}"):
        rows = json.loads((scratch/"compare/results.json").read_text())
        report.check(len(rows) == 6, f"{len(rows)} rows")
        for row in rows:
            report.check(row["particles"] > 100 and row["theirs_ns"] == 1000 and row["theirs_kinetic"] == 2.5, f"{row}")
            report.check(abs(row["ratio_ns"]*row["ours_ns"] - 1000) < 1e-6, f"ratio: {row}")
            report.check(
                re.search(rf"^{row['scene']} ", done.stdout, re.MULTILINE), f"no row of {row['scene']}:\n{done.stdout}"
            )
        same_scene(report, path, sgmp, scratch, rows)
    empty = subprocess.run(
        [*script, str(scratch), "--scratch", str(scratch / "compare")], capture_output=True, text=True, timeout=60
    )
    report.check(empty.returncode != 0 and "is no executable" in empty.stderr, f"{empty.returncode} {empty.stderr}")
    report.end()


if __name__ == "__main__":
    main()
