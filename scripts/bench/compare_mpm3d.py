#!/usr/bin/env python3
"""The public code MPM3D-F90 and this one on the same decks, in turns: nanoseconds per particle and step, seconds, and
their ratios.

usage: compare_mpm3d.py SGMP MPM3D [--runs N] [--only TEXT] [--scale PART] [--scratch DIR] [--prefix COMMAND]

MPM3D is the path of an executable of https://github.com/xzhang66/MPM3D-F90 that you have built, with optimisation (-O3
-march=native), which its own build files do not ask for; nothing of it is part of this repository, and nothing is built
here. The script writes each scene as a deck of MPM3D; runs that deck there, and here as `sgmp import` translates it
(directions one cell thick become 1D and 2D), one after the other and in changing order, on one thread. The kinetic
energies at the end stand beside each other, ours times the thickness that was left out, so that everyone sees that it
is the same scene. What ours is at its largest sound step stands in rows of its own.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import shlex
import shutil
import statistics
import subprocess
import sys
import time

METHODS = {"mpm": "", "sgmp": "sgmp", "gimp": "gimp"}


def head(title, particles, materials, bodies, cell, box, faces, end, courant, method):
    """What every deck begins with. For GIMP and SGMP that code holds two layers of nodes: its box reaches a cell beyond
    each wall."""
    wide = [
        place + ((-cell, cell)[side] if method != "mpm" and faces[2 * axis + side] and not thin(box[axis], cell) else 0)
        for axis in range(3)
        for side, place in enumerate(box[axis])
    ]
    return (
        "\n".join(
            [
                f"mpm3d *** {title}",
                f"nbmp {particles}",
                f"nmat {materials}",
                f"nbbo {bodies}",
                "nbco 1",
                *(
                    f"{name} {wide[2 * axis]:.9g} {wide[2 * axis + 1]:.9g}"
                    for axis, name in enumerate(("spx", "spy", "spz"))
                ),
                f"dcell {cell:.9g}",
                f"dtscale {courant}",
                f"endtime {end:.9g}",
                f"outtime {2 * end:.9g}",
                f"rpttime {end / 20:.9g}",
                "musl on",
                METHODS[method],
                "fixed " + " ".join(str(face) for face in faces),
            ]
        )
        + "\n"
    )


def thin(span, cell):
    """Whether a direction is one cell thick: there the box stays as it is."""
    return span[1] - span[0] < 1.5*cell


def taylor(method, courant, scale):
    """The copper bar of input/taylor_bar.inp, particle by particle."""
    cell, radius, length = 0.76/scale, 3.8, 25.4
    spacing = cell/2
    half = int(radius/spacing) + 1
    disc = [((i + 0.5)*spacing, (j + 0.5)*spacing) for i in range(-half, half) for j in range(-half, half)
            if ((i + 0.5)**2 + (j + 0.5)**2)*spacing**2 < radius**2]
    points = [(x, y, (k + 0.5)*spacing) for k in range(int(length/spacing + 0.5)) for x, y in disc]
    side, top = cell*round(11.4/cell), cell*round(26.6/cell)
    text = head(
        "Taylor bar", len(points), 1, 1, cell, ((-side, side), (-side, side), (0, top)), (0, 0, 0, 0, 2, 0), 0.08,
        courant, method,
    )
    text += "material\n1 sjc 8.93e-3 117.0e3 0.35 157.0 425.0 1.0 0.0 1e-3\nseos 1 2 3940 1.49 1.96 0\n"
    text += f"particle point 1 {len(points)}\n"
    mass = 8.93e-3*spacing**3
    text += "".join(f"{n} 1 {mass:.9e} {x:.6e} {y:.6e} {z:.6e}\n" for n, (x, y, z) in enumerate(points, 1))
    return text + "velo\nbody 1 0 0 -190e0\nendv\nendi\n"


def slab(method, courant, scale):
    """The explosive of input/tnt_slab.inp, one cell thick; its row lies in the middle, elsewhere MPM3D is wrong."""
    cell = 0.1/scale
    n = round(100/cell)
    text = head(
        "TNT slab", 2 * n, 1, 1, cell, ((0, 101), (-cell / 2, cell / 2), (-cell / 2, cell / 2)), (2, 0, 2, 2, 2, 2),
        0.005, courant, method,
    )
    text += "bulk 1.5 0.12\nmaterial\n1 hiex 1.63e-3 6930\nseos 1 3 3.712e5 3.21e3 4.15 0.95 0.3 6993\ndeto 0 0 0\n"
    return text + f"particle block 1\n1 1.63e-3 {cell/2:.9g} 0 {-cell/4:.9g} {-cell/4:.9g} {2*n} 1 1\nendi\n"


def beam(method, courant, scale):
    """A soft elastic beam, 24 x 2 and one cell thick, 4 particles per cell, that starts with v_x = sin(pi y/6)."""
    cell = 0.1/scale
    along, across = round(48/cell), round(4/cell)
    text = head(
        "soft beam", along * across, 1, 1, cell, ((-4, 6), (-2, 26), (-cell / 2, cell / 2)), (0, 0, 0, 0, 2, 2), 0.5,
        courant, method,
    )
    text += "material\n1 elas 1000 1e6 0.3\n"
    return (
        text + f"particle block 1\n1 1000 {cell / 2:.9g} 0 0 {-cell / 4:.9g} {across} {along} 1\nvelo\nvsin "
        f"1.0\nendv\nendi\n"
    )


def plate(method, courant, scale):
    """A quarter of a block of TNT on steel, scripts/bench/tnt_steel.inp: 23 040 particles."""
    cell = 2.0/scale
    spacing = cell/2
    n, tall, thick = round(24/spacing), round(20/spacing), round(20/spacing)
    text = head(
        "TNT on steel", n * n * (tall + thick), 2, 2, cell, ((0, 48), (0, 48), (-40, 48)), (2, 0, 2, 0, 0, 0), 0.006,
        courant, method,
    )
    text += (
        "bulk 1.5 0.06\nmaterial\n1 hiex 1.63e-3 6930\n2 john 7.83e-3 207e3 0.29 792.0 510.0 0.26 0.014 1.03 293.0 "
        "1793.0 477.0 1e-3\n"
        "seos 1 3 3.712e5 3.21e3 4.15 0.95 0.3 6993\nseos 2 2 4569 1.49 2.17 0\ndeto 0 0 10\n"
    )
    return text + (f"particle block 1\n1 1.63e-3 {spacing:.9g} 0 0 0 {n} {n} {tall}\n"
                   f"particle block 1\n2 7.83e-3 {spacing:.9g} 0 0 -20 {n} {n} {thick}\nendi\n")


# Name, deck, method, Courant number there, and here.
SCENES = [
    *((f"taylor bar, {method}", taylor, method, 0.8, 0.8) for method in METHODS),
    ("taylor bar at its largest step", taylor, "sgmp", 1.8, 2.2),
    ("TNT slab, sgmp", slab, "sgmp", 0.1, 0.1),
    ("soft beam, sgmp", beam, "sgmp", 0.8, 0.8),
    ("TNT on steel, sgmp", plate, "sgmp", 0.3, 0.3),
]


def executable(path):
    """The path of an executable, or the end."""
    if not (path.is_file() and os.access(path, os.X_OK)):
        sys.exit(
            f"compare_mpm3d: '{path}' is no executable: build MPM3D-F90 yourself, with optimisation, and give the "
            f"path of its program"
        )
    return path.resolve()


def run(command, folder):
    """Output, wall and CPU seconds of a process in a folder."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, env=dict(os.environ, OMP_NUM_THREADS="1")
    )
    wall, after = time.monotonic() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"compare_mpm3d: {shlex.join(command)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout, wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def theirs(program, deck, prefix):
    """A run of MPM3D-F90: it wants its deck in the current folder, and times itself in CPU seconds."""
    text, wall, cpu = run([*prefix, str(program), deck.stem], deck.parent)
    cost = re.search(r"Time per particle cycle:\s*([\d.]+)", text)
    seconds = re.search(r"Total CPU Time is\s*([\d.]+)", text)
    rows = re.findall(r"Step=\s*(\d+)\s+T=\s*\S+\s+(?:DT=\s*\S+\s+)?K\.E\.=\s*(\S+)", text)
    if not (cost and seconds and rows):
        sys.exit(f"compare_mpm3d: {program} did not say what it cost:\n{text[-2000:]}")
    return {
        "ns": float(cost[1]),
        "solve": float(seconds[1]),
        "wall": wall,
        "cpu": cpu,
        "steps": int(rows[-1][0]),
        "kinetic": float(rows[-1][1]),
    }


def ours(program, deck, courant, prefix):
    """A run of the same deck here."""
    folder = deck.parent/"ours"
    shutil.rmtree(folder, ignore_errors=True)
    _, wall, cpu = run(
        [
            *prefix, str(program), str(deck), "--threads", "1", "--quiet", "--set", f"cfl={courant}", "--output",
            str(folder),
        ],
        deck.parent,
    )
    summary = json.loads((folder/"summary.json").read_text())
    report = (folder/f"{deck.stem}.import.txt").read_text()
    left_out = re.search(r"are those there over (\S+);", report)
    thickness = float(left_out[1]) if left_out else 1.0
    return {
        "ns": summary["ns_per_particle_step"],
        "solve": summary["solve_seconds"],
        "wall": wall,
        "cpu": cpu,
        "steps": summary["steps"],
        "kinetic": summary["energy"]["kinetic"] * thickness,
        "particles": summary["particles"],
    }


def compare(name, make, method, there, here, options, program):
    """Both on one scene, in turns; a line of the table."""
    prefix = shlex.split(options.prefix)
    deck = options.scratch/"scene.mpm"
    deck.write_text(make(method, there, options.scale))
    pairs = []
    for turn in range(options.runs):
        pair = [None, None]
        for side in (0, 1) if turn % 2 else (1, 0):
            pair[side] = ours(options.sgmp, deck, here, prefix) if side else theirs(program, deck, prefix)
        pairs.append(pair)
    row = {"scene": name, "particles": pairs[0][1]["particles"]}
    for side, who in enumerate(("theirs", "ours")):
        for key in ("ns", "solve", "wall", "cpu", "steps", "kinetic"):
            row[f"{who}_{key}"] = statistics.median(pair[side][key] for pair in pairs)
    for key in ("ns", "solve", "cpu"):
        row[f"ratio_{key}"] = statistics.median(pair[0][key]/pair[1][key] for pair in pairs)
    print(
        f"{name:38s} {row['particles']:7d} {row['theirs_steps']:6.0f} {row['ours_steps']:6.0f} "
        f"{row['theirs_ns']:8.1f} {row['ours_ns']:7.1f} {row['ratio_ns']:6.2f}"
        f" {row['theirs_solve']:8.2f} {row['ours_solve']:7.2f} {row['ratio_solve']:6.2f} {row['theirs_cpu']:8.2f} "
        f"{row['ours_cpu']:7.2f} {row['ratio_cpu']:6.2f}"
        f"  {row['theirs_kinetic']:.4g} {row['ours_kinetic']:.4g}",
        flush=True,
    )
    return row


def main():
    """Runs all scenes, prints and writes the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sgmp", type=pathlib.Path, help="our executable")
    parser.add_argument("mpm3d", type=pathlib.Path, help="an executable of MPM3D-F90 that you have built")
    parser.add_argument("--runs", type=int, default=3, help="pairs per scene (default 3)")
    parser.add_argument("--only", default="", help="only scenes whose name contains this text")
    parser.add_argument(
        "--scale", type=float, default=1.0, help="cells are so many times finer (default 1; below 1 for a trial)"
    )
    parser.add_argument(
        "--scratch", type=pathlib.Path, default=pathlib.Path("build/mpm3d"), help="where to run (default build/mpm3d)"
    )
    parser.add_argument("--prefix", default="", help="command to start every run with, such as `taskset -c 2`")
    options = parser.parse_args()
    options.sgmp, options.scratch = executable(options.sgmp), options.scratch.resolve()
    program = executable(options.mpm3d)
    options.scratch.mkdir(parents=True, exist_ok=True)
    print(
        "theirs and ours, one thread; medians of pairs; ns per particle and step (theirs of CPU time, ours of wall "
        "time), s of the solution (the same),\n"
        "CPU s of the whole process; kinetic energy at the end"
    )
    print(
        f"{'scene':38s} {'part.':>7s} {'steps':>6s} {'steps':>6s} {'ns':>8s} {'ns':>7s} {'ratio':>6s} {'solve':>8s} "
        f"{'solve':>7s} {'ratio':>6s} {'CPU':>8s} {'CPU':>7s} {'ratio':>6s}"
    )
    rows = [compare(*scene, options, program) for scene in SCENES if options.only in scene[0]]
    (options.scratch/"results.json").write_text(json.dumps(rows, indent=1))
    print(f"written: {options.scratch/'results.json'}")


if __name__ == "__main__":
    main()
