#!/usr/bin/env python3
"""Every file of a folder must be rejected by the preprocessor as its first line says: `! LINE: part of the message`.

usage: rejected.py PF_PREPROCESS.py FOLDER
"""
import pathlib
import re
import subprocess
import sys
import tempfile

preprocessor, folder = sys.argv[1], pathlib.Path(sys.argv[2])
files = sorted(folder.glob("*.pf"))
wrong = [] if files else [f"no .pf file in {folder}"]
with tempfile.TemporaryDirectory() as scratch:
    for source in files:
        line, message = re.match(r"! (\d+): (.*)", source.read_text().splitlines()[0]).groups()
        target = pathlib.Path(scratch, "out.F90")
        run = subprocess.run([sys.executable, preprocessor, source, target], capture_output=True, text=True)
        said = run.stderr.strip()
        if run.returncode != 1 or not said.startswith(f"{source}:{line}: ") or message not in said or target.exists():
            wrong.append(
                f"{source.name}: expected line {line}, ...{message}...; exit code {run.returncode}, said: {said}"
            )
print(f"{len(files)} files, {len(wrong)} wrong")
sys.exit("\n".join(wrong) or 0)
