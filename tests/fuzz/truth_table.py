#!/usr/bin/env python3
"""The verdict against the truth, by class of scenes (tests/fuzz/_truths.py) and method: right and sound, wrong and sound, right and doubted, wrong and doubted, refused.

usage: truth_table.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S] [--default] [--jobs J]
       truth_table.py SGMP SOURCE_DIR SCRATCH_DIR --show S

Scenes of the seeds S, S+1, …; half of them with `method sgmp` alone, with --default all. Writes table.md and the ten worst of what is sound and wrong as decks into
SCRATCH_DIR. The exit code is 1 if more than one in a hundred of the sound runs is wrong that have `method sgmp` and bodies of four cells and more, or if fewer than a half of all runs
are right and sound.
"""
import argparse
import concurrent.futures
import csv
import json
import os
import re
import shutil
import subprocess
import sys
import time

from _truths import scene

ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_ess_singleton_isolated": "1",
               "OMP_WAIT_POLICY": "passive"}
ENDS = ("right and sound", "wrong and sound", "right and doubted", "wrong and doubted", "stopped", "refused")


def real(text):
    """A number, or what it is."""
    try:
        return float(re.sub(r"(\d)([+-]\d{3})$", r"\1E\2", text))
    except ValueError:
        return text


def table(path):
    """Rows of a file of columns."""
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as file:
        return [{key: real(value) for key, value in row.items()} for row in csv.DictReader(file)]


class Result:
    """The end of a run."""

    def __init__(self, sgmp, folder, name, text):
        deck, out = os.path.join(folder, name + ".inp"), os.path.join(folder, name + ".out")
        with open(deck, "w", encoding="utf-8") as file:
            file.write(text)
        shutil.rmtree(out, ignore_errors=True)
        try:
            done = subprocess.run([sgmp, deck, "--quiet", "--threads", "1", "--output", out], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=ENVIRONMENT, timeout=900,
                                  check=False)
            self.code, self.printed = done.returncode, done.stdout.decode("utf-8", "replace")
        except subprocess.TimeoutExpired:
            self.code, self.printed = -14, "took too long"
        self.verdict, self.history, self.bodies, self.rows = "", [], [], []
        if self.code == 0:
            with open(os.path.join(out, "summary.json"), encoding="utf-8") as file:
                self.verdict = json.load(file)["verdict"]
            self.history, self.bodies, self.rows = (table(os.path.join(out, name)) for name in ("history.csv", "bodies.csv", "particles_end.csv"))
        shutil.rmtree(out, ignore_errors=True)


def judge(chosen, seed):
    """Class, card, end, and the worst error over what is allowed with its word, of one seed."""
    name, truth, card = scene(seed)
    if chosen.default:
        card = "method sgmp"
    folder = os.path.join(chosen.scratch, f"run_{seed}")
    os.makedirs(folder, exist_ok=True)
    results = [Result(chosen.sgmp, folder, f"scene_{i}", deck.replace("METHOD", card)) for i, deck in enumerate(truth.decks)]
    texts = [deck.replace("METHOD", card) for deck in truth.decks]
    shutil.rmtree(folder)
    if any(result.code == 2 for result in results):
        return seed, name, card, truth.cells, "refused", 0.0, results[0].printed + results[-1].printed, texts
    if any(result.code != 0 for result in results):
        return seed, name, card, truth.cells, "stopped", 0.0, next(result.printed for result in results if result.code), texts
    errors = truth.errors(results)
    what, error, allowed = max(errors, key=lambda one: abs(one[1])/one[2])
    size = abs(error)/allowed
    doubt = next((line for result in results for line in result.printed.splitlines() if "verdict" in line), "")
    sound = all(result.verdict == "sound" for result in results)
    end = f"{'right' if size <= 1 else 'wrong'} and {'sound' if sound else 'doubted'}"
    return seed, name, card, truth.cells, end, size, f"{what} {error:+.3g} {doubt.partition('verdict: ')[2][:100]}", texts


def rates(rows):
    """Wrong among the sound, doubted among the right."""
    count = {end: sum(row[4] == end for row in rows) for end in ENDS}
    sound, right = count[ENDS[0]] + count[ENDS[1]], count[ENDS[0]] + count[ENDS[2]]
    return count, count[ENDS[1]]/max(1, sound), count[ENDS[2]]/max(1, right)


def main():
    """So many scenes from a seed on."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sgmp")
    parser.add_argument("source")
    parser.add_argument("scratch")
    parser.add_argument("--inputs", type=int, default=24)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--show", type=int)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--default", action="store_true")
    chosen = parser.parse_args()
    if chosen.show is not None:
        name, truth, card = scene(chosen.show)
        print(f"! {name}")
        sys.exit(print("\n! ----\n".join(deck.replace("METHOD", "method sgmp" if chosen.default else card) for deck in truth.decks)))
    os.makedirs(chosen.scratch, exist_ok=True)
    started = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(chosen.jobs) as pool:
        rows = list(pool.map(lambda seed: judge(chosen, seed), range(chosen.seed, chosen.seed + chosen.inputs)))
    plain = [row for row in rows if row[2] == "method sgmp"]
    lines = ["| class | " + " | ".join(ENDS) + " |", "|---|" + "---|"*len(ENDS)]
    for name in sorted({row[1] for row in rows}):
        count, _, _ = rates([row for row in rows if row[1] == name])
        lines.append(f"| {name} | " + " | ".join(str(count[end]) for end in ENDS) + " |")
    for title, some in (("all", rows), ("`method sgmp`", plain), ("the same, 4 cells and more", [row for row in plain if row[3] >= 4])):
        count, wrong, doubted = rates(some)
        lines.append(f"| **{title}**: wrong among sound {100*wrong:.1f} %, doubted among right {100*doubted:.1f} % | " + " | ".join(str(count[end]) for end in ENDS) + " |")
    print("\n".join(lines))
    with open(os.path.join(chosen.scratch, "table.md"), "w", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
    bad = sorted((row for row in rows if row[4] == "wrong and sound"), key=lambda row: -row[5])
    for row in bad + [row for row in rows if row[4] in ("refused", "stopped", "right and doubted", "wrong and doubted")]:
        print(f"{row[4]}: seed {row[0]}, {row[1]}, {row[2]}, {row[3]} cells: {row[6].strip().splitlines()[-1] if row[6].strip() else ''}")
    for row in bad[:10]:
        for i, text in enumerate(row[7]):
            with open(os.path.join(chosen.scratch, f"worst_{row[0]}_{row[1]}_{i}.inp"), "w", encoding="utf-8") as file:
                file.write(text)
    print(f"{len(rows)} scenes of the seeds {chosen.seed} to {chosen.seed + chosen.inputs - 1} in {time.monotonic() - started:.0f} s")
    bad = rates([row for row in plain if row[3] >= 4])[1] > 0.01 or rates(rows)[0][ENDS[0]] < 0.5*len(rows)
    sys.exit(1 if bad else 0)


main()
