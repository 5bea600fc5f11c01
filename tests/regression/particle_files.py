#!/usr/bin/env python3
"""Particle files: named columns, ids that are kept through the run, a material per particle; what is wrong in one.

A file with a column material gives the same bits as a file for each material, written here.

usage: particle_files.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import glob
import os
import random
import re
from array import array

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

DECK = """
dimension {dimension}
title files
grid cell=0.1 {axes}
time end=0.02 cfl=0.5
method sgmp update=musl
material soft elastic density=1000 young=1e5 poisson=0.3
material hard elastic density=2000 young=1e6 poisson=0.3
body matrix file material=soft file="{soft}"
body core file material=hard file="{hard}"
gravity (0,-10)
gauge middle point=(0.42,0.42)
checkpoint every=5
output csv fields=initial_position
output vtkhdf
output vtu
output tecplot
"""


def particles():
    """Places, volumes, velocities, ids and materials of a block with a core, in an order of their own."""
    rows = []
    for j in range(8):
        for i in range(16):
            core = 4 <= i < 8
            rows.append(
                {
                    "x": 0.025 + 0.05 * i,
                    "y": 0.225 + 0.05 * j,
                    "volume": 0.0025,
                    "velocity_x": 1.5 if core else -0.5,
                    "id": (37 * len(rows) + 11) % 1009,
                    "material": "hard" if core else "soft",
                }
            )
    random.Random(4).shuffle(rows)
    return rows


def write(name, rows, columns, head=True):
    """A particle file with these columns, separated by commas where they are named."""
    with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
        if head:
            file.write(",".join(columns) + "\n")
        for row in rows:
            file.write(("," if head else " ").join(str(row.get(column, 0)) for column in columns) + "\n")


def deck(soft, hard, dimension="2", axes="x=0:2 y=0:1"):
    """A deck with its files."""
    return DECK.format(soft=soft, hard=hard, dimension=dimension, axes=axes)


def kept(report):
    """Ids and materials through a run, on ranks and behind a restart; the order of lines does not matter."""
    rows = particles()
    write("all.csv", rows, ("id", "material", "volume", "y", "x", "velocity_x"))
    text = deck("all.csv", "all.csv")
    one = straight(report, "all", text)
    known = {row["id"]: row for row in rows}
    table = one.table("particles_end.csv")
    report.check(sorted(row["id"] for row in table) == sorted(known), "particles_end.csv has other ids than the file")
    for row in table:
        given = known[row["id"]]
        report.check(
            abs(row["x0"] - given["x"]) < 1e-12 and abs(row["y0"] - given["y"]) < 1e-12,
            f"id {row['id']} began elsewhere",
        )
        report.check(row["body"] == (2 if given["material"] == "hard" else 1), f"id {row['id']} is of another material")
    gauge = one.table("gauges.csv")[0]
    nearest = min(rows, key=lambda row: (row["x"] - 0.42)**2 + (row["y"] - 0.42)**2)
    report.check(
        gauge["particle"] == nearest["id"], f"the gauge follows particle {gauge['particle']}, not {nearest['id']}"
    )
    order = [int(row["id"]) for row in table]
    with open(os.path.join(one.folder, "particles.dat"), encoding="utf-8") as file:
        ids = [int(line.split()[7]) for line in file if re.match(r"[-\s\d]", line)]
        report.check(ids[-len(rows):] == order, "particles.dat: other ids")
    with open(os.path.join(one.folder, "particles.vtkhdf"), "rb") as file:
        report.check(array("i", order).tobytes() in file.read(), "particles.vtkhdf: other ids")
    with open(sorted(glob.glob(os.path.join(one.folder, "particles_*.vtu")))[-1], "rb") as file:
        report.check(array("i", order).tobytes() in file.read(), "vtu: other ids")
    write(
        "sorted.csv", [{**row, "material": row["material"].upper()} for row in sorted(rows, key=lambda row: row["id"])],
        ("x", "y", "volume", "velocity_x", "id", "material"),
    )
    other = run("sorted", deck("sorted.csv", "sorted.csv"))
    report.check(other["checksum"] == one["checksum"], "the order of the lines changes the bits")
    two = straight(report, "two_ranks", text, launcher=mpirun(2))
    report.check(
        two["checksum"] == one["checksum"] and two.table("particles_end.csv") == table, "two ranks: other ids or bits"
    )
    goes_on(report, one, "again", text, checkpoints(one.folder)[0])


def alone(report):
    """A file for each material, without names or ids."""
    rows = sorted(particles(), key=lambda row: row["id"])
    for material in ("soft", "hard"):
        write(material + ".txt", [row for row in rows if row["material"] == material],
              ("x", "y", "z", "volume", "velocity_x", "velocity_y", "velocity_z"), head=False)
    write("all.csv", rows, ("id", "material", "volume", "y", "x", "velocity_x"))
    first, second = run("alone", deck("soft.txt", "hard.txt")), run("together", deck("all.csv", "all.csv"))
    report.check(first["checksum"] == second["checksum"], "a column material gives other bits than a file for each")
    report.check(
        [row["id"] for row in first.table("particles_end.csv")] == list(range(1, len(rows) + 1)),
        "ids count from 1 without a column",
    )


MISTAKES = [
    # columns, a change to the text, what is said
    ("x,y,volum,material", None, r"bad\.csv:1:5: .*a particle has no 'volum'\s+remedy: did you mean 'volume'\?"),
    ("x,y,volume,material,x", None, r"bad\.csv:1:21: .*two columns 'x'"),
    ("x,volume,material", None, r"bad\.csv:1:1: .*no column 'y'"),
    ("x,y,material", None, r"bad\.csv:1:1: .*no column 'volume'"),
    ("x,y,volume,r,material", None, r"bad\.csv:1:12: .*a particle has no 'r'"),
    ("x,y,volume,id", None, r"deck\.inp:10:1: .*several bodies take their particles from .*bad\.csv"),
    ("x,y,z,volume,velocity_x,velocity_y,velocity_z,id,material,x", None, r"bad\.csv:1:59: .*two columns 'x'"),
    (",".join(["x,y,volume"] + ["x"] * 38), None, r"bad\.csv:1:1: .*there are 41 columns"),
    (
        "x,y,volume,material",
        ("hard", "hrad"),
        r"bad\.csv:\d+:\d+: .*no material 'hrad'\s+remedy: did you mean 'hard'\?",
    ),
    (
        "x,y,volume,material",
        ("hard", "spare"),
        r"bad\.csv:\d+:\d+: .*no body takes the particles of material 'spare'\s+remedy: add a card",
    ),
    ("x,y,volume,material", ("soft", "hard"), r"deck\.inp:10:1: .*has no particles of material 'soft'"),
    ("id,x,y,volume,material", ("\n11,", "\n48,"), r"bad\.csv:\d+:1: .*two particles have the id 48"),
    ("x,y,volume,material,id", (",11\n", ",-11\n"), r"bad\.csv:\d+:\d+: .*an id is a whole number from 0"),
    ("x,y,volume,material,id", (",11\n", ",1.5\n"), r"bad\.csv:\d+:\d+: .*an id is a whole number from 0"),
    ("x,y,volume,material,id", (",11\n", ",2147483648\n"), r"bad\.csv:\d+:\d+: .*an id is a whole number from 0"),
    ("x,y,volume,material", (",soft\n", "\n"), r"bad\.csv:\d+:1: .*not a particle \(3 numbers, not 4\)"),
    ("x,y,volume,material,z", (",0\n", ",0.1\n"), r"bad\.csv:\d+:\d+: .*a component beyond the dimension is not 0"),
    (
        "x,y,volume,material,velocity_z",
        (",0\n", ",0.1\n"),
        r"bad\.csv:\d+:\d+: .*a component beyond the dimension is not 0",
    ),
]


def refused(report):
    """Files that are wrong are refused at the word; so are bodies that take the same particles."""
    text = deck("bad.csv", "bad.csv").replace("method", "material spare elastic density=1 young=1 poisson=0\nmethod", 1)
    text = text.replace("\ngrid", "\n\ngrid", 1).replace("\ndimension", "dimension", 1)
    for columns, change, said in MISTAKES:
        write("bad.csv", particles(), columns.split(","))
        path = os.path.join(SCRATCH, "bad.csv")
        if change:
            with open(path, encoding="utf-8") as file:
                content = file.read()
            report.check(change[0] in content, f"{columns}: the file has no {change[0]!r}")
            with open(path, "w", encoding="utf-8") as file:
                file.write(content.replace(*change))
        result = run("deck", text)
        report.check(
            result.code == 3 and re.search(said, result.text),
            f"{columns} {change}: exit code {result.code}, said: {result.text}",
        )
    result = run("deck", text.replace("body core file material=hard", "body core file material=soft"))
    report.check(
        result.code == 3 and re.search(r"deck\.inp:11:\d+: error: body 'matrix' takes the same particles", result.text),
        f"two bodies of one material: exit code {result.code}, said: {result.text}",
    )


def about_an_axis(report):
    """Columns of an axisymmetric scene are named by its axes."""
    rows = [{**row, "r": row["x"], "z": row["y"], "volume": 2*3.141592653589793*row["x"]*0.0025} for row in particles()]
    write("rings.csv", rows, ("z", "r", "volume", "id", "material"))
    result = run("rings", deck("rings.csv", "rings.csv", "axisymmetric", "r=0:2 z=0:1"))
    if report.finished(result, "rings"):
        known = {row["id"]: row for row in rows}
        for row in result.table("particles_end.csv"):
            report.check(abs(row["z0"] - known[row["id"]]["z"]) < 1e-12, f"rings: id {row['id']} began elsewhere")


def main():
    report = Report()
    kept(report)
    alone(report)
    refused(report)
    about_an_axis(report)
    report.end()


main()
