#!/usr/bin/env python3
"""Gauges: means over the particles within a radius, against means worked out from the table of all particles; the same
rows for threads, ranks and restarts.

usage: gauges.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, SPLIT, Report, run

# Two bodies that hit each other, one of which heats, hardens and is damaged.
SCENE = """
dimension {dimension}
grid cell=1
method sgmp
time cfl=0.4 steps=60
material metal johnson_cook density=2 young=100 poisson=0.3 yield=0.5 hardening_modulus=3 failure=yes d1=9 &
  thermal=yes specific_heat=4 melt_temperature=1000
material rubber elastic density=1 young=50 poisson=0.4
body left block material=metal lower=({left}) upper=({middle}) ppc=2 jitter=0.2
body right block material=rubber lower=({middle_low}) upper=({right}) ppc=2
velocity left {axis}=2
gauge nearest point=({point})
gauge behind point=({point}) radius=2 fields=stress,temperature,damage,plastic_strain
gauge here point=({point}) radius=1.5 frame=fixed
gauge later point=({away}) radius=1 frame=fixed fields=energy
history steps=7
output csv &
  fields=initial_position,stress,pressure,von_mises,density,mass,volume,plastic_strain,temperature,damage,energy
checkpoint every=25 keep=9
"""
SCENES = {
    "line": SCENE.format(
        dimension=1, left="-9", middle="0", middle_low="0", right="9", axis="x", point="-1.2", away="11"
    ),
    "plane": SCENE.format(
        dimension=2, left="-9,0", middle="0,6", middle_low="0,1", right="9,5", axis="x", point="-1.2,3", away="10.5,3"
    ),
    "space": SCENE.format(
        dimension=3, left="-5,0,0", middle="0,4,4", middle_low="0,1,1", right="5,4,4", axis="x", point="-1,2,2.5",
        away="6.5,2,2",
    ),
    "rings": SCENE.format(
        dimension="axisymmetric", left="0,-9", middle="5,0", middle_low="1,0", right="5,9", axis="z", point="2,-1",
        away="3,10.5",
    ),
}
COLUMNS = {
    "behind": ("stress_xx", "stress_yy", "stress_zz", "temperature", "damage", "plastic_strain"),
    "here": (),
    "later": ("energy",),
}


def mean(rows, column, weight):
    return sum(row[column]*row[weight] for row in rows)/sum(row[weight] for row in rows)


def values(report, name, deck):
    """The last rows are the means of the particles at the end."""
    result = run(name, deck)
    if not report.finished(result, name):
        return
    particles = result.table("particles_end.csv")
    gauges = [row for row in result.table("gauges.csv") if row["step"] == result["steps"]]
    point = {"line": (-1.2, 0, 0), "plane": (-1.2, 3, 0), "space": (-1, 2, 2.5), "rings": (2, 0, -1)}[name]
    away = {"line": (11, 0, 0), "plane": (10.5, 3, 0), "space": (6.5, 2, 2), "rings": (3, 0, 10.5)}[name]
    spheres = {"behind": (point, 2, "0"), "here": (point, 1.5, ""), "later": (away, 1, "")}
    for gauge, (centre, radius, start) in spheres.items():
        members = [
            row for row in particles if sum((row[axis + start] - c) ** 2 for axis, c in zip("xyz", centre)) <= radius**2
        ]
        row = next((row for row in gauges if row["name"] == gauge), None)
        if not report.check(members and row, f"{name}: {len(members)} particles in gauge {gauge}, row {row}"):
            continue
        report.check(
            row["particles"] == len(members), f"{name}: {gauge} has {row['particles']} particles, not {len(members)}"
        )
        wanted = {
            column: mean(members, column, "mass")
            for column in ("x", "y", "z", "velocity_x", "velocity_y", "velocity_z")
        }
        wanted |= {
            column: mean(members, column, "volume")
            for column in ("pressure", "von_mises", *COLUMNS[gauge])
            if column in members[0]
        }
        wanted["density"] = sum(row["mass"] for row in members)/sum(row["volume"] for row in members)
        for column, value in wanted.items():
            scale = max(abs(other[column]) for other in members) or 1.0
            report.check(
                abs(row[column] - value) <= 1e-12 * scale,
                f"{name}: {gauge}: {column} = {row[column]}, the mean is {value}",
            )
    first = [row["name"] for row in result.table("gauges.csv") if row["step"] == 0]
    # nothing is where `later` looks
    report.check(first == ["nearest", "behind", "here"], f"{name}: at the start there are {first}")
    nearest = next(row for row in gauges if row["name"] == "nearest")
    own = next(row for row in particles if row["id"] == nearest["particle"])
    report.check(
        all(nearest[column] == own[column] for column in ("x", "velocity_x", "pressure", "density")),
        f"{name}: {nearest}, {own}",
    )


def halves(report):
    """Where particles are split, their halves stay with the gauge: mass is kept, and with it the centre."""
    deck = SPLIT.replace("fields=density,mass,volume,path,displacement", "fields=initial_position,mass,volume").replace(
        "gauge middle point=(0.5,0.5,0)", "gauge middle point=(0.5,0.5,0) radius=0.2")
    result = run("halves", deck)
    if report.finished(result, "halves"):
        rows = result.table("gauges.csv")
        members = [
            row for row in result.table("particles_end.csv") if (row["x0"] - 0.5) ** 2 + (row["y0"] - 0.5) ** 2 <= 0.04
        ]
        report.check(
            rows[-1]["particles"] == len(members) > rows[0]["particles"],
            f"halves: {rows[0]['particles']}, {rows[-1]['particles']}, {len(members)}",
        )
        report.check(abs(rows[-1]["x"] - mean(members, "x", "mass")) < 1e-12, f"halves: {rows[-1]['x']}")


def many(report):
    """Gauges that share particles, in bodies that fly through many cells and in part out of the grid: each has its
    particle's row, at each step that the table of all particles is written."""
    deck = (
        SCENES["plane"]
        .replace("grid cell=1", "grid cell=1 x=-12:10 y=-4:12\nlost remove\nvelocity right x=9")
        .replace("steps=7", "steps=1")
        .replace("checkpoint every=25 keep=9", "")
    )
    deck = "\n".join(line for line in deck.splitlines() if not line.startswith("gauge "))
    points = [(-8.7 + 0.31*i, 0.2 + 0.29*j) for i in range(25) for j in range(8)]
    deck += (
        "\n"
        + "\n".join(f"gauge g_{n} point=({x:.3f},{y:.3f})" for n, (x, y) in enumerate(points))
        + "\ngauge far point=(8.8,3)\n"
    )
    result = run("many", deck)
    if not report.finished(result, "many"):
        return
    own = {row["id"]: row for row in result.table("particles_end.csv")}
    last = {row["name"]: row for row in result.table("gauges.csv") if row["step"] == result["steps"]}
    gone = [row for row in result.table("gauges.csv") if row["name"] == "far"]
    report.check(
        len(gone) < result["steps"] and "far" not in last,
        f"many: the particle of gauge far has {len(gone)} rows, it left the grid",
    )
    kept = [name for name in last if name != "far"]
    report.check(
        len(kept) > 150 and len({last[name]["particle"] for name in kept}) < len(kept),
        f"many: {len(kept)} gauges have rows at the end",
    )
    for name in kept:
        row, particle = last[name], own.get(last[name]["particle"])
        report.check(
            particle
            and all(
                row[column] == particle[column]
                for column in ("x", "y", "velocity_x", "velocity_y", "pressure", "density")
            ),
            f"many: {name}: {row}, {particle}",
        )


def cost(report):
    """A row of each step costs little more than none: CPU seconds with three gauges over those without, least of
    three runs each. It was twice as much when every row took all particles."""
    deck = """
dimension 3
grid cell=1
method sgmp
time cfl=0.5 steps=40
history steps=1
material m elastic density=1 young=1000 poisson=0.3
body b block material=m lower=(0,0,0) upper=(12,12,12) ppc=2
velocity b x="2*sin(y)"
"""
    gauges = "gauge a point=(1,2,3)\ngauge b point=(8,8,8) fields=stress\ngauge c point=(11.5,3,4)\n"
    seconds = {}
    for _ in range(3):
        for name, text in (("rows", deck + gauges), ("no_rows", deck)):
            result = run(name, text)
            if report.finished(result, name):
                seconds[name] = min(seconds.get(name, 1e9), result["cpu_seconds"])
    report.check(seconds["rows"] < 1.4*seconds["no_rows"], f"cost: {seconds}")


def many_spheres(report):
    """2000 gauges with a radius cost about what 2000 of one particle each do: CPU seconds of one over the other. It was
    nine times as much when each gauge looked at all particles."""
    deck = """
dimension 2
grid cell=1
method mpm
time cfl=0.4 steps=8
history steps=1
material m elastic density=1 young=1000 poisson=0.3
body b block material=m lower=(0,0) upper=(60,60) ppc=2
velocity b x=sin(y)
"""
    points = [f"({1 + 58*(0.754877*n % 1):.3f},{1 + 58*(0.569840*n % 1):.3f})" for n in range(2000)]
    seconds = {}
    for name, end in (("single", ""), ("spheres", " radius=0.7"), ("fixed", " radius=0.7 frame=fixed")):
        result = run(
            f"many_{name}", deck + "".join(f"gauge g{n} point={point}{end}\n" for n, point in enumerate(points))
        )
        if report.finished(result, f"many_{name}"):
            seconds[name] = result["cpu_seconds"]
    report.check(
        len(seconds) == 3 and max(seconds["spheres"], seconds["fixed"]) < 3 * seconds["single"],
        f"many spheres: {seconds}",
    )


def bits(report):
    """Rows are the same, byte for byte, for threads, ranks and after a restart."""
    for name in ("plane", "space"):
        reference = straight(report, f"{name}_straight", SCENES[name])
        folders = [reference.folder]
        for title, threads, launcher in ((f"{name}_threads", 3, ()), (f"{name}_ranks", 1, mpirun(3))):
            folders.append(straight(report, title, SCENES[name], threads=threads, launcher=launcher).folder)
        rows = []
        for folder in folders:
            with open(os.path.join(folder, "gauges.csv"), encoding="utf-8") as file:
                rows.append(file.read())
        report.check(rows[0] == rows[1], f"{name}: threads change gauges.csv")
        report.check(rows[0] == rows[2], f"{name}: ranks change gauges.csv")
        goes_on(
            report, reference, f"{name}_again", SCENES[name], checkpoints(os.path.join(SCRATCH, f"{name}_straight"))[0]
        )


def mistakes(report):
    for change, code, words in (
        ("radius=0", 3, "'radius' = 0 is out of range"),
        ("frame=fixed", 3, "a gauge that stays where it is needs a radius"),
        ("radius=1 frame=foxed", 3, "did you mean 'fixed'"),
        ("radius=0.01", 3, "no particle is within the radius of gauge 'here'"),
        ("radius=1 fields=presure", 3, "'presure' is unknown for 'fields'"),
    ):
        result = run("mistake", SCENES["line"].replace("radius=1.5 frame=fixed", change))
        report.check(result.code == code and words in result.text, f"{change}: exit code {result.code}\n{result.text}")


def main():
    report = Report()
    for name, deck in SCENES.items():
        values(report, name, deck)
    halves(report)
    many(report)
    cost(report)
    many_spheres(report)
    bits(report)
    mistakes(report)
    report.end()


main()
