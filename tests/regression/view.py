#!/usr/bin/env python3
"""The commands of sgmp-view on small runs: what they print against closed forms, that files come, what they say of
missing ones.

usage: view.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import contextlib
import csv
import importlib.util
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time

from _runs import ENVIRONMENT, INPUT, SCRATCH, SGMP, SOURCE, Report

if not all(importlib.util.find_spec(name) for name in ("numpy", "matplotlib")):
    print("skipped: numpy and matplotlib are not installed")
    sys.exit(77)
sys.path.insert(0, os.path.join(SOURCE, "python"))
import numpy as np  # noqa: E402
import sgmp_view  # noqa: E402
from matplotlib import pyplot as plt  # noqa: E402
from matplotlib.text import Text  # noqa: E402
from sgmp_view import command  # noqa: E402
from sgmp_view.files import KNOWN_UNITS  # noqa: E402
from sgmp_view.gauges import summary_of  # noqa: E402
from sgmp_view.grid_convergence import richardson  # noqa: E402
from sgmp_view.movie import add_scale_bar, round_length  # noqa: E402
from sgmp_view.picture import choose_norm, draw_particles  # noqa: E402
from sgmp_view.profile import layers  # noqa: E402
from sgmp_view.revolve import revolve  # noqa: E402
from sgmp_view.slice_ import mirrored  # noqa: E402

# A block that flies without strain: everything about it is known.
FLYING = """
parameter speed = 2
parameter h = 1
units mm g ms
dimension 2
grid cell=h x=open y=open
method sgmp
time end=4 dt=0.1*h
material m elastic density=3 young=100 poisson=0
body arrow block material=m lower=(0,0) upper=(6,4) ppc=2
velocity arrow x=speed y=1
history steps=1
gauge corner point=(0,0)
output vtu every=1 fields=stress,pressure
output csv at=end fields=stress
"""


def view(*words):
    """Runs a command in the scratch folder; its exit code and what it prints. Importing matplotlib each time would take
    most of the time."""
    printed = io.StringIO()
    code = 0
    with contextlib.redirect_stdout(printed):
        try:
            command.main(list(words))
        except SystemExit as end:
            code = end.code
    if isinstance(code, str):  # what sys.exit prints
        return 1, printed.getvalue() + code
    return code or 0, printed.getvalue()


def check(report, condition, what, seen=""):
    """Notes a failure with what was seen."""
    report.check(condition, f"{what}\n{seen}")


def rows(path):
    """A csv file as dictionaries, read as any reader does."""
    with open(os.path.join(SCRATCH, path), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def study(report):
    """A sweep: where the block is after flying, each combination once, again only what changed."""
    shutil.rmtree(os.path.join(SCRATCH, "flying.sweep"), ignore_errors=True)
    words = (
        "sweep", "flying.inp", "--vary", "speed=1,2,3", "--vary", "h=1,2", "--jobs", "2", "--quantity",
        "bodies.arrow.x", "--quantity", "gauges.corner.velocity_x",
    )
    code, text = view(*words)
    check(report, code == 0, "sweep ends well", text)
    table = rows("flying.sweep/sweep.csv")
    check(
        report, [(row["speed"], row["h"]) for row in table] == [(v, h) for v in "123" for h in "12"],
        "all combinations", str(table),
    )
    for row in table:
        place = 3 + 4*float(row["speed"])  # centroid at the start, four units of time
        check(report, abs(float(row["bodies.arrow.x"]) - place) < 1e-9, f"the block is at {place}", str(row))
        check(
            report, abs(float(row["gauges.corner.velocity_x"]) - float(row["speed"])) < 1e-9,
            "its corner flies as fast", str(row),
        )
    code, text = view(*words)
    check(report, text.count("done before") == 6, "nothing is run twice", text)
    with open(os.path.join(SCRATCH, "flying.inp"), "a", encoding="utf-8") as deck:
        deck.write("title changed\n")
    code, text = view(*words)
    check(report, text.count("done before") == 0, "a changed deck is run again", text)
    code, text = view("sweep", "flying.inp", "--vary", "sped=1,2")
    check(
        report,
        code == 1
        and "did you mean 'speed'" in text
        and not os.path.exists(os.path.join(SCRATCH, "flying.sweep", "sped=1")),
        "a misspelt parameter",
        text,
    )
    code, text = view(
        "convergence", "flying.sweep/speed=1,h=1", "flying.sweep/speed=1,h=2", "--quantity", "bodies.arrow.x",
        "--exact", "6",
    )
    check(report, code == 0 and text.count("1.000e+00") == 2, "errors against the exact value", text)
    code, text = view(
        "work-precision", "flying.sweep/speed=1,h=1", "flying.sweep/speed=1,h=2", "--quantity", "bodies.arrow.x",
        "--exact", "6", "--cost", "steps",
    )
    table = [line.split() for line in text.splitlines()]
    check(
        report,
        code == 0
        and table[1:3] == [["sgmp", "musl", "2", "20", "1.000e+00"], ["sgmp", "musl", "1", "40", "1.000e+00"]],
        "errors against what the runs cost",
        text,
    )


def door(report):
    """Runs from Python: values go in, numbers come out; what is there is taken, what fails says why."""
    deck = os.path.join(SCRATCH, "flying.inp")
    folder = os.path.join(SCRATCH, "door")
    shutil.rmtree(folder, ignore_errors=True)
    run = sgmp_view.run(deck, folder, program=SGMP, speed=3)
    body = run.bodies["arrow"]
    check(
        report, abs(body.velocity_x - 3) < 1e-9 and abs(body.x - 15) < 1e-9 and abs(body.start["x"] - 3) < 1e-12,
        "the block flies", str(body.end),
    )
    check(
        report, run.verdict == run.summary["verdict"] and abs(run.history["time"][-1] - 4) < 1e-12,
        "summary and history", str(run.summary),
    )
    check(report, len(run.dump().points) == 96, "particles", str(len(run.dump().points)))
    before = os.stat(os.path.join(folder, "summary.json")).st_mtime_ns
    sgmp_view.run(deck, folder, program=SGMP, speed=3)
    check(report, os.stat(os.path.join(folder, "summary.json")).st_mtime_ns == before, "the same run is not run twice")
    other = sgmp_view.run(deck, folder, program=SGMP, speed=2.5)
    check(report, abs(other.bodies["arrow"].velocity_x - 2.5) < 1e-9, "another speed is another run")
    for error, words, values in (
        (sgmp_view.RunError, "did you mean 'speed'", {"sped": 1}),
        (sgmp_view.RunError, "", {"h": -1}),
    ):
        try:
            sgmp_view.run(deck, folder, program=SGMP, **values)
            seen = "no error"
        except error as problem:
            seen = str(problem)
        check(report, seen != "no error" and words in seen, f"{values}", seen)
    try:
        seen = body.velocity_w
    except AttributeError as problem:
        seen = str(problem)
    check(report, "no 'velocity_w'" in str(seen), "an unknown column", str(seen))
    if importlib.util.find_spec("scipy"):
        limit(report)


def limit(report):
    """The example that finds a ballistic limit: what is slowed by 2 in the time of the run passes above 2."""
    with open(os.path.join(SCRATCH, "slowed.inp"), "w", encoding="utf-8") as deck:
        deck.write(FLYING + "gravity (-0.5,0,0)\n")
    words = [
        sys.executable, os.path.join(SOURCE, "scripts", "ballistic_limit.py"), "slowed.inp", "--body", "arrow",
        "--direction", "x", "--low", "1", "--high", "3.1", "--tolerance", "0.05",
    ]
    done = subprocess.run(
        words, cwd=SCRATCH, env={**ENVIRONMENT, "SGMP": SGMP}, capture_output=True, text=True, timeout=300, check=False
    )
    found = done.stdout.split("ballistic limit")[-1].split(",")[0]
    # velocities are half a step behind: 1.975
    check(report, done.returncode == 0 and abs(float(found) - 2) < 0.08, "ballistic limit 2", done.stdout + done.stderr)


def figures(report):
    """Every command writes what it says it wrote."""
    run = "flying.sweep/speed=2,h=1"
    for words in (
        ("history", run), ("gauges", run, "--column", "velocity_x"), ("picture", run, "--field", "stress"),
        ("movie", run, "--dpi", "40"), ("profile", run, "--field", "velocity_x", "--csv", "profile.csv"),
        ("slice", run, "--plane", "y=6", "--mirror", "x", "--field", "velocity"),
        ("compare", run, "flying.sweep/speed=3,h=1"), ("report", run),
    ):
        code, text = view(*words)
        path = os.path.join(SCRATCH, text.strip().split("\n")[-1])
        check(report, code == 0 and os.path.getsize(path) > 1000, " ".join(words[:2]), text)
    code, text = view("gauges", run, "--column", "velocity_x", "--json", "gauges.json")
    with open("gauges.json", encoding="utf-8") as file:
        found = json.load(file)["gauges"]["corner"]
    check(
        report,
        abs(found["largest"] - 2) < 1e-9 and abs(found["impulse"] - 2 * 4) < 1e-6 and "impulse (m/s ms)" in text,
        "what flies at 2 for 4", text,
    )
    time, saw = np.array([0.0, 1.0, 3.0, 4.0]), np.array([0.0, 6.0, -2.0, 0.0])
    check(
        report,
        summary_of(time, saw)
        == {"largest": 6.0, "time_of_largest": 1.0, "least": -2.0, "time_of_least": 3.0, "impulse": 6.0},
        "peak and impulse of straight lines",
        str(summary_of(time, saw)),
    )
    check(
        report, all(abs(float(row["velocity_x"]) - 2) < 1e-6 for row in rows("profile.csv")),
        "profile of a uniform field", str(rows("profile.csv")[:2]),
    )
    with open(os.path.join(SCRATCH, run, "report.html"), encoding="utf-8") as file:
        page = file.read()
    check(
        report,
        "<b class=\"sound\">sound</b>" in page and "body arrow block" in page and page.count("data:image/png") == 8,
        "the report has verdict, deck, four frames, energies, drift, momentum and gauges",
        str(page.count("data:image/png")),
    )
    for row in (
        "mean velocity, x</td><td>2</td><td>2</td>", "mass</td><td>72</td><td>72</td>",
        "momentum, x</td><td>144</td><td>144</td>", "kinetic energy</td><td>180</td><td>180</td>",
        "extent, x</td><td>0 … 6</td><td>8 … 14</td>",
    ):
        check(report, row in page, f"the report's table of bodies has {row}", page[page.find("<h2>What"):][:3000])
    check(
        report, "2.2361 m/s at the start" in page and "0 % lost" in page, "what flies on loses nothing",
        page[page.find("<h2>What") :][:300],
    )
    for words, saying in (
        (("picture", "nowhere.out"), "no such file"), (("picture", run, "--field", "presure"), "no field 'presure'"),
        (("gauges", run, "--column", "x_y"), "no column 'x_y'"), (("picture", run, "--step", "99"), "no dump '99'"),
        (("slice", run, "--plane", "q=1"), "expected x=PLACE"), (("slice", run, "--plane", "y=99"), "fewer than two"),
    ):
        code, text = view(*words)
        check(
            report, code == 1 and saying in text and "Traceback" not in text, f"{' '.join(words)} is refused in words",
            text,
        )


def drawing(report):
    """Nothing is drawn in the colour of the page; films have a bar of a round length."""
    for norm, colours in (choose_norm(np.array([-1.0, 0.0, 1.0])), choose_norm(np.array([0.0, 1.0]))):
        shades = plt.get_cmap(colours)(np.linspace(0, 1, 201))[:, :3]
        darkest = shades.min(axis=1).max()
        check(
            report, darkest < 0.85, "all colours of a map differ from white", f"{darkest} of {norm.vmin} to {norm.vmax}"
        )
    check(
        report, choose_norm(np.array([1.0]), (-2, 2))[1] is choose_norm(np.array([-1.0, 1.0]))[1],
        "limits that are alike on both sides",
    )
    check(
        report, [round_length(width) for width in (4, 7.9, 8, 20, 100, 0.03)] == [1, 1, 2, 5, 20, 0.005],
        "lengths of scale bars", str([round_length(width) for width in (4, 7.9, 8, 20, 100, 0.03)]),
    )
    figure, axis = plt.subplots()
    axis.set(xlim=(0, 100), ylim=(0, 50))
    add_scale_bar(axis, "mm")
    words = [text.get_text() for text in figure.findobj(Text)]
    check(report, "20 mm" in words, "a bar of 20 mm below a picture of 100 mm", str(words))
    plt.close(figure)
    spots = np.array([(x, y, 0.0) for x in (0.0, 100.0) for y in (0.0, 100.0)])
    figure, axis = plt.subplots()
    draw_particles(axis, spots, np.zeros(4) + [0, 0, 0, 1], 0.5)
    image = axis.get_images()[0].get_array()
    seen = image[image[..., 3] > 0]
    check(
        report, len(seen) > 4 * 50 and len(np.unique(np.round(seen[:, 0], 3))) > 10,
        "single particles in the plane are shaded balls", f"{len(seen)} pixels",
    )
    plt.close(figure)


def units(report):
    """The names of derived units are worth what the base units make them."""
    base = {"m": 1, "cm": 1e-2, "mm": 1e-3, "t": 1e3, "kg": 1, "g": 1e-3, "mg": 1e-6, "s": 1, "ms": 1e-3, "us": 1e-6}
    derived = {
        "J": 1,
        "mJ": 1e-3,
        "MJ": 1e6,
        "100 kJ": 1e5,
        "Pa": 1,
        "MPa": 1e6,
        "GPa": 1e9,
        "Mbar": 1e11,
        "m/s": 1,
        "km/s": 1e3,
        "mm/s": 1e-3,
        "cm/us": 1e4,
        "N s": 1,
        "mN s": 1e-3,
        "kN s": 1e3,
        "g cm/us": 10,
    }
    for (length, mass, time), names in KNOWN_UNITS.items():
        metre, kilogram, second = base[length], base[mass], base[time]
        worth = (kilogram*metre**2/second**2, kilogram/(metre*second**2), metre/second, kilogram*metre/second)
        for name, value in zip(names, worth):
            check(report, abs(derived[name]/value - 1) < 1e-12, f"{length} {mass} {time}: {name}", str(value))


def numbers(report):
    """Closed forms of the arithmetic."""
    cells = (0.1, 0.25, 0.4)
    found = richardson(cells, [5 + 0.3*h**1.7 for h in cells])
    check(
        report, found is not None and abs(found[0] - 1.7) < 1e-6 and abs(found[1] - 5) < 1e-8,
        "Richardson with any ratios", str(found),
    )
    check(report, richardson(cells, [5, 6, 5.5]) is None, "no order where nothing converges")
    places, means = layers(np.array([0.0, 0.4, 2.0]), np.array([1.0, 4.0, 8.0]), np.array([1.0, 2.0, 1.0]), 4)
    check(
        report, list(places) == [0.25, 1.75] and list(means) == [3.0, 8.0],
        "means are weighted by mass, empty layers left out", str((places, means)),
    )
    cloud = sgmp_view.Particles(
        None,
        np.array([[1.0, 2.0, 3.0]]),
        {"velocity": np.array([[1.0, 2.0, 3.0]]), "stress": np.arange(1.0, 7.0)[None]},
        {"velocity": ["x", "y", "z"], "stress": ["xx", "yy", "zz", "xy", "yz", "xz"]},
    )
    whole = mirrored(cloud, "x")
    check(
        report,
        whole.points.tolist() == [[1, 2, 3], [-1, 2, 3]]
        and whole.fields["velocity"].tolist()[1] == [-1, 2, 3]
        and whole.fields["stress"].tolist()[1] == [1, 2, 3, -4, 5, -6],
        "images of vectors and tensors",
        str(whole),
    )
    ring = sgmp_view.Particles(
        None, np.array([[2.0, 0.0, 1.0]]), {"mass": np.array([6.0]), "velocity": np.array([[3.0, 0.0, 1.0]])}
    )
    solid = revolve(ring, 360, 0.1)
    moment = (solid.fields["mass"]*(solid.points[:, :2]**2).sum(axis=1)).sum()
    outward = (solid.points[:, :2]*solid.fields["velocity"][:, :2]).sum(axis=1)
    check(
        report,
        abs(solid.fields["mass"].sum() - 6) < 1e-12
        and abs(moment - 24) < 1e-12
        and np.abs(outward - 6).max() < 1e-12
        and len(solid.points) == 126,
        "a ring as a circle: mass, moment of inertia m r^2, radial velocity",
        str(moment),
    )
    last = sgmp_view.read_dump(os.path.join(SCRATCH, "flying.sweep", "speed=2,h=1"))
    first = sgmp_view.read_dump(os.path.join(SCRATCH, "flying.sweep", "speed=2,h=1"), 0)
    check(
        report, np.abs(last.points - first.points - [8, 4, 0]).max() < 1e-9 and last.time == 4,
        "dumps are read in order", str(last.time),
    )


def states(report):
    """A run at work, killed, and finished."""
    folder = os.path.join(SCRATCH, "long.out")
    shutil.rmtree(folder, ignore_errors=True)
    with subprocess.Popen(
        [
            SGMP, os.path.join(INPUT, "block.inp"), "--quiet", "--threads", "1", "--output", folder, "--set", "cells=8",
            "--set", "steps=10000000",
        ],
        env=ENVIRONMENT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.STDOUT,
    ) as process:
        for _ in range(600):
            time.sleep(0.1)
            if os.path.exists(os.path.join(folder, "history.csv")) and len(rows("long.out/history.csv")) > 2:
                break
        code, text = view("status", "long.out")
        check(report, code == 0 and text.startswith("at work: step "), "a run at work", text)
        process.send_signal(signal.SIGKILL)
    code, text = view("status", "long.out")
    check(report, code == 1 and text.startswith("died 0:0") and "no checkpoint" in text, "a run that was killed", text)
    code, text = view("report", "long.out")
    check(report, code == 0, "a report of it", text)
    code, text = view("status", "flying.sweep/speed=2,h=1")
    check(report, code == 0 and text.startswith("finished, sound: step 40, t = 4 ms"), "a finished run", text)


def main():
    """All of it."""
    with open(os.path.join(SCRATCH, "flying.inp"), "w", encoding="utf-8") as deck:
        deck.write(FLYING)
    report = Report()
    os.chdir(SCRATCH)
    os.environ.update(ENVIRONMENT, SGMP=SGMP)
    done = subprocess.run(
        [sys.executable, os.path.join(SOURCE, "scripts", "sgmp-view"), "--help"], stdout=subprocess.PIPE, check=False
    )
    check(
        report, done.returncode == 0 and all(word.encode() in done.stdout for word in command.COMMANDS), "the script",
        done.stdout,
    )
    study(report)
    door(report)
    figures(report)
    drawing(report)
    units(report)
    numbers(report)
    states(report)
    report.end()


main()
