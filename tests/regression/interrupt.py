#!/usr/bin/env python3
"""Runs that are stopped, killed, starved of space, or go on from damaged files lose nothing and change nothing.

usage: interrupt.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import random
import resource
import shutil
import signal
import subprocess
import time

from _restarts import (
    ENVIRONMENT, FULL, Going, checkpoints, clear, command, deck, execute, mpirun, path_of, same_files, straight,
)
from _runs import INPUT, SCRATCH, Report

DECK = deck("block.inp", "output vtkhdf every=0.002 fields=stress\noutput vtu every=0.002\ngauge g point=(1,1,1)\n"
            "checkpoint every=20\n")
SETTINGS = {"cells": 8, "steps": 300, "drift": 0.1, "jitter": 0.3}
ENDLESS = {**SETTINGS, "steps": 1000000}
STOPPED, WRONG_DECK, WRONG_FILE = 6, 3, 5


def line(name, *options, settings=None, text=DECK, threads=1):
    """The command line of the scene."""
    return command(name, text, options, SETTINGS if settings is None else settings, threads)


def finish(report, reference, name, title, threads=1, layouts=False):
    """Goes on to the end and compares with the straight run; with `layouts` it was stopped on other ranks."""
    result = execute(line(name, "--restart", "latest", threads=threads), name)
    if report.finished(result, title):
        report.check(result["checksum"] == reference["checksum"], f"{title}: other bits than the straight run")
        same_files(report, reference.folder, result.folder, title, layouts)
    return result


def stops(report, reference, title, stop, launcher=(), options=(), threads=1):
    """A run that is asked to stop ends with code 6 after a checkpoint, and goes on as if nothing had happened."""
    name = f"stop_{title}"
    clear(name)
    going = Going(line(name, *options, threads=threads), name, launcher)
    report.check(going.wait_for(lambda: going.has_steps(4)), f"{name}: never got going")
    asked = time.monotonic()
    result = stop(going)
    report.check(time.monotonic() - asked < 20, f"{name}: took {time.monotonic() - asked:.1f} s to stop")
    report.check(result.code == STOPPED, f"{name}: exit code {result.code}\n{result.text}")
    report.check(
        result.summary.get("exit_status") == STOPPED, f"{name}: summary.json says {result.summary.get('exit_status')}"
    )
    report.check("stopped by" in result.text and "--restart latest" in result.text, f"{name}: says only {result.text}")
    saved = checkpoints(result.folder)
    if report.check(
        saved and saved[-1] == result.summary.get("steps"), f"{name}: {saved}, last step {result.summary.get('steps')}"
    ):
        report.check(saved[-1] < SETTINGS["steps"], f"{name}: stopped only at the end")
        finish(report, reference, name, name, layouts=bool(launcher))


def by_file(going):
    """The stop file."""
    with open(os.path.join(going.folder, "stop"), "w", encoding="ascii"):
        pass
    result = going.end()
    return result


def requests(report, reference):
    """Signals, through a launcher too, the time limit, the stop file."""
    stops(report, reference, "sigterm", lambda going: going.end(signal.SIGTERM))
    stops(report, reference, "sigint", lambda going: going.end(signal.SIGINT))
    stops(report, reference, "sigusr1", lambda going: going.end(signal.SIGUSR1), threads=2)
    stops(report, reference, "sigxcpu", lambda going: going.end(signal.SIGXCPU))
    stops(report, reference, "mpirun", lambda going: going.end(signal.SIGTERM), mpirun(1))
    stops(report, reference, "ranks", lambda going: going.end(signal.SIGTERM), mpirun(2))
    stops(report, reference, "file", by_file)
    report.check(not os.path.exists(os.path.join(SCRATCH, "stop_file", "stop")), "the stop file is still there")
    name, seconds = "time_limit", []
    # a machine with other work may hold one up; without its reserve none stops before
    while len(seconds) < 3 and min(seconds, default=3) >= 3:
        clear(name)
        result = execute(line(name, "--time-limit", "0:00:03", settings=ENDLESS), name)
        report.check(
            result.code == STOPPED and "time limit" in result.text, f"{name}: exit code {result.code}\n{result.text}"
        )
        seconds.append(result.summary.get("wall_seconds", 9))
    report.check(min(seconds) < 3, f"{name}: stopped after {seconds} s")


def killed(report, reference):
    """kill -9 at random moments, every other time while a checkpoint is being written, until one has hit that."""
    name = "killed"
    folder = clear(name)
    luck = random.Random(20240607)
    writing = 0
    for round_ in range(100):
        if writing and round_ >= (20 if FULL else 4):
            break
        if checkpoints(folder)[-1:] == [SETTINGS["steps"]]:
            clear(name)
        going = Going(line(name, "--restart", "latest", threads=1 + round_ % 2), name)
        if round_ % 2:
            going.wait_for(going.writes_checkpoint, 10.0)
        else:
            going.wait_for(lambda: False, luck.uniform(0.05, 0.6))
        result = going.kill()
        writing += going.writes_checkpoint()
        report.check(result.code in (-signal.SIGKILL, 0), f"{name} {round_}: exit code {result.code}\n{result.text}")
    report.check(writing > 0, "no kill hit the writing of a checkpoint")
    finish(report, reference, name, name)
    print(f"{writing} kills while a checkpoint was being written")


def damaged(report, reference):
    """Damaged and foreign files are refused; `latest` takes the one before."""
    name = "damaged"
    folder = clear(name)
    shutil.copytree(reference.folder, folder)
    newest, before = path_of(folder, checkpoints(folder)[-1]), path_of(folder, checkpoints(folder)[-2])
    with open(newest, "rb") as file:
        good = file.read()
    middle = good.find(b"\x00"*4, len(good)//3)
    foreign = os.path.join(reference.folder, "particles.vtkhdf")
    with open(foreign, "rb") as file:
        other = file.read()
    flipped = bytearray(good)
    flipped[len(good)//2] ^= 1
    zeroed = bytearray(good)
    zeroed[middle - 512:middle] = bytes(512)
    for title, contents in (
        ("cut short", good[: len(good) * 2 // 3]), ("bit flipped", bytes(flipped)), ("zeroed", bytes(zeroed)),
        ("empty", b""), ("text", b"step,time\n" * 99), ("another HDF5 file", other),
    ):
        with open(newest, "wb") as file:
            file.write(contents)
        result = execute(line(name, "--restart", newest), name)
        report.check(
            result.code == WRONG_FILE
            and newest in result.text
            and "remedy" in result.text
            and "HDF5-DIAG" not in result.text,
            f"{title}: exit code {result.code}\n{result.text}",
        )
        report.check(
            title != "another HDF5 file" or "is not a checkpoint of sgmp" in result.text, f"{title}: {result.text}"
        )
        result = execute(line(name, "--restart", "latest"), name)
        report.finished(result, f"latest, {title}")
        report.check("warning" in result.text and newest in result.text, f"{title}: no warning\n{result.text}")
        report.check(result.summary.get("restarted_from") == before, f"{title}: {result.summary.get('restarted_from')}")
        report.check(result.summary.get("checksum") == reference["checksum"], f"{title}: other bits")
        aside = newest + ".old"
        if report.check(os.path.exists(aside), f"{title}: the damaged file has not been set aside"):
            os.remove(aside)
        same_files(report, reference.folder, folder, title)
    for path in (newest, before):
        with open(path, "wb") as file:
            file.write(good[:999])
    result = execute(line(name, "--restart", "latest"), name)
    report.check(
        result.code == WRONG_FILE and "is whole" in result.text, f"none whole: exit code {result.code}\n{result.text}"
    )
    result = execute(line(name, "--restart", "nothing.h5"), name)
    report.check(
        result.code == WRONG_FILE and "nothing.h5" in result.text, f"missing: exit code {result.code}\n{result.text}"
    )


def any_bit(report, reference):
    """Whatever byte of a small checkpoint is changed: the file is refused, or the result has the right bits."""
    name = "any_bit"
    text = deck("bar.inp", "checkpoint every=10 keep=9\n")
    settings = {"cells": 4, "steps": 20, "dt": 1e-3}
    whole = straight(report, name, text, **settings)
    path = path_of(whole.folder, 10)
    with open(path, "rb") as file:
        good = file.read()
    luck = random.Random(7)
    refused = 0
    for _ in range(200 if FULL else 12):
        place, bit = luck.randrange(len(good)), luck.randrange(8)
        wrong = bytearray(good)
        wrong[place] ^= 1 << bit
        with open(path, "wb") as file:
            file.write(wrong)
        result = execute(command(name, text, ["--restart", path], settings), name)
        refused += result.code == WRONG_FILE
        report.check(result.code == WRONG_FILE or (result.code == 0 and result["checksum"] == whole["checksum"]),
                     f"byte {place}, bit {bit}: exit code {result.code}\n{result.text}")
    report.check(refused > 0, "no changed byte was noticed")
    del reference


def limited(bytes_):
    """Lets files grow so far and no further."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_, bytes_))


def starve(report, name, text, bytes_, what):
    """Goes on under a limit on the size of files: exit code 5, and the checkpoints from before are as they were."""
    folder = os.path.join(SCRATCH, name)
    before = {}
    for step in checkpoints(folder):
        with open(path_of(folder, step), "rb") as file:
            before[step] = file.read()
    done = subprocess.run(
        line(name, "--restart", "latest", text=text), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
        timeout=300, env=ENVIRONMENT, preexec_fn=limited(bytes_),
    )
    words = done.stdout.decode("utf-8", "replace")
    report.check(done.returncode == WRONG_FILE and "too large" in words and what in words,
                 f"{name}: exit code {done.returncode}, not about {what}\n{words}")
    for step, contents in before.items():
        with open(path_of(folder, step), "rb") as file:
            report.check(file.read() == contents, f"{name}: the checkpoint of step {step} has changed")
    report.check(not any(left.endswith(".part") for left in os.listdir(folder)), f"{name}: {os.listdir(folder)}")


def no_space(report, reference):
    """Limits on the size of files; full_disk.py has the other end of room."""
    bare = deck("block.inp", "checkpoint every=20\n")
    wordy = bare.replace("checkpoint", "output vtkhdf every=1e-4\ncheckpoint")
    size = os.path.getsize(path_of(reference.folder, checkpoints(reference.folder)[-1]))
    for title, text, bytes_, what in (("checkpoint", bare, size - 4096, "checkpoint_"),
                                      ("dump", wordy, size + 4096, "particles.vtkhdf")):
        name = f"limit_{title}"
        whole = straight(report, name + "_straight", text, **SETTINGS)
        clear(name)
        going = Going(line(name, text=text), name)
        going.wait_for(lambda going=going: len(checkpoints(going.folder)) > 1)
        going.kill()
        if title == "dump":  # as if the kill had come while the file was made larger
            with open(os.path.join(going.folder, "particles.vtkhdf.part"), "w", encoding="utf-8") as file:
                file.write("torn")
        starve(report, name, text, bytes_, what)
        result = execute(line(name, "--restart", "latest", text=text), name)
        if report.finished(result, name):
            same_files(report, whole.folder, result.folder, name)


def other_decks(report, reference):
    """A restart may change some cards, and is refused where it changes others."""
    name = "deck"
    folder = clear(name)
    shutil.copytree(reference.folder, folder)
    with open(os.path.join(INPUT, "block.inp"), encoding="utf-8") as file:
        body = next(number for number, card in enumerate(file, 1) if card.startswith("body "))
    refused = execute(line(name, "--restart", "latest", settings={**SETTINGS, "material": "j2"}), name)
    report.check(refused.code == WRONG_DECK and "material=j2" in refused.text and "material=elastic" in refused.text and
                 f"block.inp:{body}:1" in refused.text, f"other material: exit code {refused.code}\n{refused.text}")
    for wrong in (
        DECK + "gravity (0,0,-1)\n", DECK.replace("gauge g point=(1,1,1)\n", ""), DECK + "gauge g2 point=(2,2,2)\n",
    ):
        refused = execute(line(name, "--restart", "latest", text=wrong), name)
        report.check(refused.code == WRONG_DECK and "checkpoint, balance, stop" in refused.text,
                     f"other cards: exit code {refused.code}\n{refused.text}")
    free = DECK.replace("every=20\n", "every=50 keep=3\n").replace(
        "output vtu every=0.002", "output tecplot every=0.002"
    )
    longer = execute(line(name, "--restart", "latest", text=free + "stop energy_growth=20\n",
                          settings={**SETTINGS, "steps": 320}), name)
    if report.finished(longer, "free cards changed"):
        report.check(longer["steps"] == 320, f"longer run: {longer['steps']} steps")
        rows = [row["step"] for row in longer.table("history.csv")]
        report.check(rows == [*range(0, 321, 10)], f"history of the longer run: {rows}")


def sets_aside(report, reference):
    """A new run in a used folder does not leave checkpoints of the old one where `latest` finds them."""
    name = "aside"
    folder = clear(name)
    shutil.copytree(reference.folder, folder)
    old = checkpoints(folder)
    result = execute(
        line(name, settings={**SETTINGS, "steps": 5}, text=DECK.replace("checkpoint every=20\n", "")), name
    )
    report.finished(result, name)
    report.check(not checkpoints(folder), f"{name}: {checkpoints(folder)}")
    report.check(os.path.exists(path_of(folder, old[-1]) + ".old"), f"{name}: the old checkpoints are gone")


def main():
    """All of it."""
    report = Report()
    reference = straight(report, "reference", DECK, **SETTINGS)
    for part in (requests, killed, damaged, any_bit, no_space, other_decks, sets_aside):
        started = time.monotonic()
        part(report, reference)
        print(f"{part.__name__}: {time.monotonic() - started:.1f} s")
    report.end()


main()
