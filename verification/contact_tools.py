"""What the contact checks share: run a deck, read its tables, print a finding."""
import csv
import json
import os
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
EXECUTABLE = os.environ.get("SGMP", os.path.join(ROOT, "build", "release", "sgmp"))


def table(path):
    """Rows of a csv file as dictionaries of numbers."""
    with open(path, encoding="utf-8") as file:
        return [{key: float(value) for key, value in row.items()}
                for row in csv.DictReader(line for line in file if not line.startswith("#"))]


def run(deck, **parameters):
    """Runs a deck in a folder of its own; returns its tables and its summary."""
    with tempfile.TemporaryDirectory() as folder:
        command = [EXECUTABLE, deck, "--threads", "1", "--quiet", "--output", folder]
        for name, value in parameters.items():
            command += ["--set", f"{name}={value}"]
        subprocess.run(command, check=True)
        tables = {name[:-4]: table(os.path.join(folder, name)) for name in os.listdir(folder) if name.endswith(".csv")}
        with open(os.path.join(folder, "summary.json"), encoding="utf-8") as file:
            tables["summary"] = json.load(file)
    return tables


def finding(name, measured, limit):
    """A line of the report: what was measured, the largest value allowed, and whether it passes."""
    result = {"name": name, "measured": measured, "limit": limit, "pass": abs(measured) <= limit}
    print(f"{'pass' if result['pass'] else 'MISS'}  {name}: {measured:.3g} (limit {limit:g})", flush=True)
    return result
