#!/usr/bin/env python3
"""Loads (doc/loads.md): tables, forces that particles share, pressure and traction on faces; the ledger, the same bits.

usage: loads.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: a pulse p(t) on the end of a rod is the stress -p(t - x/c) in it and the work of p^2/(rho c);
momentum is the force times the time; a block that is pressed all around keeps its momentum; the same pulse on a face of
a block between slip walls, in the plane, in space and along an axis, is that of the rod.
"""
import math
import os

from _restarts import checkpoints, command, execute, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

PEAK, LASTS, END = 1e-3, 0.4, 0.7
PULSE = f"{PEAK}*sin(pi*t/{LASTS})^2*(t<{LASTS})"
ROD = f"""
parameter method = sgmp
parameter update = musl
parameter cells = 64
dimension 1
grid cell=1/cells x=-0.25:1.25
method $method update=$update
time end={END} dt=0.1/cells
material rubber elastic density=2 young=2 poisson=0 strain=small
body rod block lower=0 upper=1 material=rubber ppc=2
pressure rod face=x- p="{PULSE}"
output csv at=end fields=stress,initial_position
"""
# The same along the last axis of other spaces, four cells wide; about an axis along z.
BLOCKS = {
    "plane": ("2", "x=0:4/cells y=-0.25:1.25", "x-=slip x+=slip", "(0,0)", "(4/cells,1)", "y"),
    "space": (
        "3", "x=0:2/cells y=0:2/cells z=-0.25:1.25", "x-=slip x+=slip y-=slip y+=slip", "(0,0,0)",
        "(2/cells,2/cells,1)", "z",
    ),
    "rings": ("axisymmetric", "r=0:4/cells z=-0.25:1.25", "r+=slip", "(0,0)", "(4/cells,1)", "z"),
}
# What moves through many cells while it is loaded in every way: by tables, on faces that turn, on a part of it.
MOVING = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=1
method $method update=$update
time dt=0.1 steps=80
table pull file="pull.csv"
table push rows=(0,0),(2,1),(3,0.5)
material rubber neo_hookean density=1 young=20 poisson=0.3
body block block lower=(0,0) upper=(7,5) material=rubber ppc=2 rotation=20
body ball sphere centre=(20,0) radius=3 material=rubber ppc=2
velocity block x=1.5 y=0.7 omega_z=0.1
velocity ball x=-1 y=0.9
load block where="x0>4" x="2*pull(t)" y="0.1*x"
pressure block face=y+ p="0.3*push(t)*(1+0.1*x)"
traction block face=x- where="y<3" x="-0.2*pull(t)" y="0.1*y0"
pressure ball p="0.2*push(t)"
history steps=5
gauge middle point=(3,3,0)
output csv at=end fields=stress,displacement
"""


# At rest under a pressure on all sides.
PRESSED = """
parameter method = sgmp
dimension 2
grid cell=1 x=0:open y=0:open
method $method
time dt=0.05 steps=1600
material rubber elastic density=1 young=10 poisson=0.25 strain=small
body block block lower=(10,10) upper=(16,14) material=rubber ppc=2
$more
pressure block p=0.01
damping rate=2
output csv at=end fields=stress
"""
FACES = "".join(f"pressure block face={axis}{side} p=0.01\n" for axis in "xy" for side in "-+")

# The same of what is round.
ROUND = """
parameter method = sgmp
dimension 3
grid cell=1
method $method
time dt=0.05 steps=800
material rubber elastic density=1 young=10 poisson=0.25 strain=small
body round $shape rotation_axis=(1,1,0) material=rubber ppc=2
pressure round p=0.01
damping rate=2
output csv at=end fields=stress
"""


# What cuts the cubes of its lattice.
CUT = """
dimension {dimension}
grid cell=1 {open}
method {method}
time dt=0.05 steps={steps}
material rubber elastic density=2 young=10 poisson=0.25 strain=small
body block {shape} material=rubber ppc=2
{trim}
{load}
output csv at=end fields=stress,volume,velocity,mass
"""
OBLIQUE = ("turned", "rings")  # to the grid, or longer outside than inside
# Space, shape, volume, axis and area of its upper face.
CUTS = {
    "bar": ("1", "block lower=10 upper=16.13", 6.13, "x", 1),
    "plane": ("2", "block lower=(10,10) upper=(16.13,13.8)", 6.13*3.8, "y", 6.13),
    "trimmed": ("2", "block lower=(10,10) upper=(18,13.8)", 6.13*3.8, "y", 6.13),
    "shifted": ("2", "block lower=(10.1,10.15) upper=(16.13,13.8) lattice_origin=(0,0)", 6.03*3.65, "y", 6.03),
    "turned": ("2", "block lower=(10,10) upper=(16.2,13.85) rotation=23", 6.2*3.85, "y", 6.2),
    "space": ("3", "block lower=(0,0,0) upper=(3.2,4.35,3.8)", 3.2*4.35*3.8, "z", 3.2*4.35),
    "rings": ("axisymmetric", "block lower=(3,10) upper=(7.2,13.8)", math.pi*(7.2**2 - 9)*3.8, "z",
              math.pi*(7.2**2 - 9)),
    "disk": ("3", "cylinder centre=(4,4,0) radius=3.1 length=3.8", math.pi*3.1**2*3.8, "z", math.pi*3.1**2),
}
# A cantilever under a pressure, fixed in a wall.
CANTILEVER = """
parameter thickness = 4
dimension 2
grid cell=1 x=0:open y=-10:open
wall x-=fixed
method sgmp
time end=1500
material rubber elastic density=1 young=1000 poisson=0.25
body beam block lower=(0,0) upper=(40,thickness) material=rubber ppc=2
pressure beam face=y+ p=0.002*min(t/200,1)
damping kinetic=yes
output csv at=end fields=displacement
"""


def exact(x):
    """Stress of the pulse at a place of the rod, whose speed of sound is 1."""
    t = END - x
    return -PEAK*math.sin(math.pi*t/LASTS)**2 if 0 < t < LASTS else 0.0


def ledger(report, name, result):
    """Kinetic energy to round-off."""
    energy = result["energy"]
    report.check(
        abs(energy["remainder"]) < 1e-12 * energy["supplied"],
        f"{name}: kinetic identity {energy['remainder'] / energy['supplied']}",
    )


def rod_error(rows, axis="x"):
    """Of the stress along an axis, relative to the norm of the exact one."""
    places = [(row[f"stress_{axis}{axis}"], exact(row[f"{axis}0"])) for row in rows]
    return math.sqrt(sum((here - there)**2 for here, there in places)/sum(there**2 for _, there in places))


def pulse(report):
    """The stress in the rod, the work done on it and the momentum that it gets."""
    work = PEAK**2*LASTS*3/8/2  # the integral of p^2/(rho c)
    for method, update, most in (
        ("sgmp", "musl", 0.05), ("sgmp", "usf", 0.05), ("sgmp", "usavg", 0.05), ("mpm", "musl", 0.03),
        ("gimp", "usl", 0.03), ("bspline", "musl", 0.05),
    ):
        errors = []
        for cells in (64, 128):
            name = f"rod_{method}_{update}_{cells}"
            result = run(name, ROD, method=method, update=update, cells=cells)
            if not report.finished(result, name):
                return
            ledger(report, name, result)
            errors.append(rod_error(result.table("particles_end.csv")))
            report.check(
                abs(result["energy.external_work"] / work - 1) < 0.02,
                f"{name}: work {result['energy.external_work']}, not {work}",
            )
            # The pressure of a step is that of its beginning; the first lasts half a step.
            dt = 0.1/cells
            impulse = sum(
                dt * (0.5 if k == 0 else 1) * PEAK * math.sin(math.pi * k * dt / LASTS) ** 2
                for k in range(math.ceil(LASTS / dt))
            )
            momentum = result.table("history.csv")[-1]["momentum_x"]
            report.check(abs(momentum/impulse - 1) < 1e-9, f"{name}: momentum {momentum}, not {impulse}")
        report.check(errors[1] < most, f"{name}: stress is off by {errors}")


def spaces(report):
    """A face between slip walls is the end of the rod, in every space."""
    for method in ("sgmp", "mpm"):
        # About an axis the program takes plain stress, on a line not.
        scene = ROD.replace("method $method", "method $method stress=plain")
        rod = run(f"rod_{method}", scene, method=method, cells=32)
        if not report.finished(rod, f"rod_{method}"):
            return
        line = sorted((row["x0"], row["stress_xx"]) for row in rod.table("particles_end.csv"))
        for space, (dimension, extent, walls, lower, upper, axis) in BLOCKS.items():
            text = (
                scene.replace("dimension 1", f"dimension {dimension}")
                .replace("x=-0.25:1.25", extent)
                .replace("lower=0 upper=1", f"lower={lower} upper={upper}")
            )
            text = text.replace("face=x-", f"face={axis}-").replace("\ntime", f"\nwall {walls}\ntime")
            result = run(f"{space}_{method}", text, method=method, cells=32)
            if not report.finished(result, f"{space}_{method}"):
                continue
            ledger(report, f"{space}_{method}", result)
            rows = result.table("particles_end.csv")
            worst = max(abs(row[f"stress_{axis}{axis}"] - stress) for row in rows
                        for place, stress in [min(line, key=lambda pair, row=row: abs(pair[0] - row[f"{axis}0"]))])
            report.check(worst < 1e-9*PEAK, f"{space}_{method}: {worst/PEAK} of the peak off the rod")


def forces(report):
    """A force that all particles share moves a body as a whole; that on a part is the same momentum; about an axis it
    is that on whole rings."""
    scene = """
dimension {dimension}
grid cell=0.5
table ramp rows=(0,0),(0.5,1)
time dt=0.05 steps=40
material rubber elastic density=2 young=50 poisson=0.3
body ball sphere centre={centre} radius=1.5 material=rubber ppc=2 jitter={jitter}
load ball where="{where}" {axis}="3*ramp(t)"
history steps=1
"""
    for dimension, centre, axis, jitter in (
        (1, "0", "x", 0.3), (2, "(0,0)", "y", 0.3), (3, "(0,0,0)", "z", 0.3), ("axisymmetric", "(0,0)", "z", 0),
    ):
        for part, where in (("all", "1"), ("part", f"{axis} > 0.4")):
            name = f"force_{dimension}_{part}"
            result = run(name, scene.format(dimension=dimension, centre=centre, axis=axis, jitter=jitter, where=where))
            if not report.finished(result, name):
                continue
            ledger(report, name, result)
            momentum = result.table("history.csv")[-1][f"momentum_{axis}"]
            impulse = sum(0.05*(0.5 if k == 0 else 1)*3*min(k*0.05/0.5, 1) for k in range(40))
            report.check(abs(momentum/impulse - 1) < 1e-11, f"{name}: momentum {momentum}, not {impulse}")
            if part == "all":  # work is what the body has
                kinetic = result["energy.kinetic"]
                report.check(
                    abs(result["energy.external_work"] / kinetic - 1) < 1e-9,
                    f"{name}: work {result['energy.external_work']}, energy {kinetic}",
                )


def patch(report):
    """A uniform pressure all around is in equilibrium with the stress behind it, at edges and corners too."""
    for name, method, more, allowed in (
        ("sgmp", "sgmp", "", 5e-3), ("mpm", "mpm", "", 5e-3), ("gimp", "gimp", "", 5e-3),
        ("angle", "sgmp", "add block block lower=(10,14) upper=(13,18)", 0.07),  # 0.06 at the inner corner
        # It makes steps, which cut cubes would not bear: it is made of whole ones.
        ("hole", "sgmp", "subtract block block lower=(12.2,11.1) upper=(14.1,12.7)", 0.08),
    ):
        text = PRESSED.replace("$more", more)
        result = run(f"patch_{name}", text, method=method)
        if not report.finished(result, f"patch_{name}"):
            continue
        rows = result.table("particles_end.csv")
        for field, expected in (("stress_xx", -0.01), ("stress_yy", -0.01), ("stress_xy", 0)):
            worst = max(abs(row[field] - expected) for row in rows)
            report.check(worst < allowed*0.01, f"patch_{name}: {field} is off by {worst/0.01} of the pressure")
        each = run(f"patch_{name}_each", text.replace("pressure block p=0.01\n", FACES), method=method)
        for field in ("stress_xx", "stress_yy", "stress_xy"):
            worst = max(abs(a[field] - b[field]) for a, b in zip(rows, each.table("particles_end.csv")))
            report.check(worst < 1e-12*0.01, f"patch_{name}: cards for each face give another {field}, by {worst/0.01}")
    for name, shape, method, allowed in (
        ("ball", "sphere radius=2.5", "sgmp", 0.02), ("turned", "sphere radius=2.5 rotation=25", "sgmp", 0.2),
        ("ball_gimp", "sphere radius=2.5 rotation=25", "gimp", 0.4),
        ("column", "cylinder radius=2 length=4 rotation=25", "sgmp", 0.2),
    ):
        result = run(f"patch_{name}", ROUND.replace("$shape", shape), method=method)
        if not report.finished(result, f"patch_{name}"):
            continue
        rows = result.table("particles_end.csv")
        for field in ("stress_xx", "stress_yy", "stress_zz"):
            mean = sum(row[field] for row in rows)/len(rows)
            report.check(abs(mean + 0.01) < 2e-3*0.01, f"patch_{name}: {field} is {-mean/0.01} of the pressure")
        worst = max(abs(row[field] + 0.01) for row in rows for field in ("stress_xx", "stress_yy", "stress_zz"))
        report.check(worst < allowed*0.01, f"patch_{name}: stresses are off by {worst/0.01} of the pressure")
    # A tip one particle wide shows opposite faces, and others: it is no error.
    corners = "polygon corners=(0,0),(6,0),(3,6)"
    tip = run("patch_tip", PRESSED.replace("$more", "").replace("block lower=(10,10) upper=(16,14)", corners))
    report.finished(tip, "patch_tip")


def cut_deck(name, **more):
    """The deck of one of CUTS."""
    dimension, shape = CUTS[name][:2]
    trim = "intersect block block lower=(9,9) upper=(16.13,14)" if name == "trimmed" else ""
    opened = " ".join(f"{axis}=0:open" for axis in ("z" if dimension == "axisymmetric" else "xyz"[:int(dimension)]))
    return CUT.format(dimension=dimension, shape=shape, open=opened, trim=trim, **more)


def cut_pressed(report):
    """Faces are where the shapes end, not where cubes do: a pressure all around is in equilibrium."""
    for name, (dimension, _, volume, _, _) in CUTS.items():
        if name == "disk":  # it is round: its sides are those of cubes
            continue
        for method, worst in (("sgmp", 0.2), ("mpm", 0.5)) if name in OBLIQUE else (("sgmp", 0.06), ("mpm", 0.03)):
            title = f"cut_{name}_{method}"
            text = cut_deck(name, method=method, load="pressure block p=0.01\ndamping rate=2", steps=1600)
            result = run(title, text)
            if not report.finished(result, title):
                continue
            rows = result.table("particles_end.csv")
            whole = sum(row["volume"] for row in rows)
            report.check(abs(whole/volume - 1) < 1e-9, f"{title}: volume {whole}, not {volume}")
            for axis in {"1": "x", "2": "xy"}.get(dimension, "xyz"):
                stress = [row[f"stress_{axis}{axis}"] for row in rows]
                mean = sum(row["volume"]*here for row, here in zip(rows, stress))/volume
                off = max(abs(here + 0.01) for here in stress)
                report.check(abs(mean + 0.01) < 8e-3*0.01, f"{title}: stress along {axis} is {-mean/0.01} of p")
                report.check(off < worst*0.01, f"{title}: stress along {axis} is off by {off/0.01} of p")


def cut_pushed(report):
    """A pressure on one face is that on the area of the shape's face, and what it pushes has the shape's mass."""
    for name, (_, _, volume, axis, area) in CUTS.items():
        title = f"cut_{name}_pushed"
        result = run(title, cut_deck(name, method="sgmp", load=f"pressure block face={axis}+ p=0.01", steps=20))
        if not report.finished(result, title):
            continue
        rows = result.table("particles_end.csv")
        mass = sum(row["mass"] for row in rows)
        report.check(abs(mass/(2*volume) - 1) < 2e-3, f"{title}: mass {mass}, not {2*volume}")
        axes = [axis] if name == "rings" else [axis for axis in "xyz" if f"velocity_{axis}" in rows[0]]
        momentum = math.hypot(*(sum(row["mass"]*row[f"velocity_{axis}"] for row in rows) for axis in axes))
        impulse = 0.01*area*0.05*19.5  # the first step is half a step of force
        report.check(abs(momentum/impulse - 1) < 2e-3, f"{title}: momentum {momentum}, not {impulse}")


def cantilevers(report):
    """A cantilever bends as thick as it is (Timoshenko), whatever its lattice."""
    modulus, shear = 1000/(1 - 0.25**2), 1000/2/1.25
    for thickness in (3.4, 4.2):
        result = run(f"cantilever_{thickness}", CANTILEVER, thickness=thickness)
        if not report.finished(result, f"cantilever_{thickness}"):
            continue
        rows = result.table("particles_end.csv")
        last = max(row["x"] for row in rows)
        tip = [-row["displacement_y"] for row in rows if row["x"] > last - 0.3]
        bent = 0.002*40**4/8/(modulus*thickness**3/12) + 0.002*40**2/2/(shear*thickness*5/6)
        way = sum(tip)/len(tip)
        report.check(abs(way/bent - 1) < 0.03, f"cantilever_{thickness}: {way}, not {bent}")


def tables(report):
    """A table is the formula that it is made from; one that has changed is refused, also by a restart."""
    path = os.path.join(SCRATCH, "pull.csv")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\N{BYTE ORDER MARK}t,value  # how hard\n0,0\n2, 1\n5,0.25\n")
    formula = (
        MOVING.replace('table pull file="pull.csv"\n', "")
        .replace("pull(t)", "(t<2 ? t/2 : 1-0.25*(t-2))")
        .replace("steps=80", "steps=45")
    )
    first, second = run("by_table", MOVING.replace("steps=80", "steps=45")), run("by_formula", formula)
    if report.finished(first, "by_table") and report.finished(second, "by_formula"):
        for key in ("energy.external_work", "energy.kinetic", "energy.internal"):
            report.check(
                abs(first[key] / second[key] - 1) < 1e-12, f"tables: {key} {first[key]}, by formula {second[key]}"
            )
    with open(os.path.join(SCRATCH, "by_table", "run.log"), encoding="utf-8") as file:
        said = [line for line in file if line.startswith("table pull")]
    report.check(len(said) == 1 and "checksum=" in said[0], f"tables: the complete deck says {said}")
    for title, before, after, message in (
        ("other_rows", 'pull.csv"', 'pull.csv" checksum="0123456789ABCDEF"', "have the checksum"),
    ):
        result = run(title, MOVING.replace(before, after))
        report.check(result.code == 3 and message in result.text, f"{title}: exit code {result.code}: {result.text}")


def changed_table(report, name, text, **settings):
    """A restart with other rows is refused."""
    path = os.path.join(SCRATCH, "pull.csv")
    with open(path, encoding="utf-8") as file:
        rows = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(rows.replace("0.25", "0.5"))
    result = execute(command(name, text, ["--restart", "latest"], settings), name)
    report.check(
        result.code == 3 and "table pull" in result.text,
        f"{name}: exit code {result.code} with other rows: {result.text}",
    )
    with open(path, "w", encoding="utf-8") as file:
        file.write(rows)


def mistakes(report):
    """What a deck must not say, and what it is told."""
    cases = (
        ("a face beyond the dimension", "face=y+ p=", "face=z+ p=", "there is no face 'z+' in 2D"),
        ("no such face", 'where="y<3"', 'where="y<-300"', "there are no such faces"),
        ("nobody bears the load", 'where="x0>4"', 'where="x0>400"', "the load acts on no particle"),
        ("time chooses", 'where="x0>4"', 'where="x0>t"', "'where' cannot depend on t"),
        ("a load on all", 'load block', 'load all', "a load acts on one body"),
        (
            "no lattice", "radius=3 material=rubber ppc=2", "radius=3 material=rubber ppc=2 layout=gauss",
            "have no known faces",
        ),
        ("a rigid body", "history", "rigid ball x=1\nhistory", "is rigid"),
        ("a table without rows", "rows=(0,0),(2,1),(3,0.5)", "", "either a file or rows"),
        ("rows that do not grow", "(2,1),(3,0.5)", "(2,1),(2,0.5)", "t = 2 does not follow t = 2"),
        ("a table twice", "table push", "table pull", "'pull' is defined twice"),
        (
            "opposite faces", "pressure ball",
            "body web block lower=(30,0) upper=(30.5,4) material=rubber ppc=2\npressure web p=1\npressure ball",
            "show opposite faces",
        ),
        ("a wrong row alone", "(3,0.5)", "(3,1e99)", "beyond all measure"),
        ("a wrong row alone", "(3,0.5)", "(3,1e99)", "1 error(s) in the deck"),
        ("a table without an argument", '"2*pull(t)"', '"2*pull"', "'pull' is a function: write pull(…)"),
        ("a spoilt row", "pull.csv", "spoilt.csv", "'O' is not a number"),
        ("a sum", "pull.csv", "sum.csv", "'1+2' is not a number"),
        ("no such file", "pull.csv", "pul.csv", "cannot be opened"),
        (
            "a checksum of other rows", "rows=(0,0),(2,1),(3,0.5)",
            "rows=(0,0),(2,1),(3,0.5) checksum=00000000000000AB", "have the checksum",
        ),
        (
            "where the load acts is no number", 'where="x0>4"', 'where="sqrt(x0-4)"',
            "is not a number at some places of body 'block'",
        ),
        (
            "where the faces are is no number", 'where="y<3"', 'where="sqrt(y-3)"',
            "is not a number at some places of body 'block'",
        ),
    )
    with open(os.path.join(SCRATCH, "spoilt.csv"), "w", encoding="utf-8") as file:
        file.write("O,0\n1,1\n2,1\n")
    with open(os.path.join(SCRATCH, "sum.csv"), "w", encoding="utf-8") as file:
        file.write("0,0\n1+2,1\n1.5+100,1\n")
    for title, before, after, message in cases:
        name = title.replace(" ", "_")
        result = run(name, MOVING.replace(before, after))
        report.check(result.code == 3, f"{title}: exit code {result.code}")
        report.check(message in result.text, f"{title}: says {result.text}")


def bits(report):
    """The same for threads, ranks and restarts."""
    for method, update in (("sgmp", "musl"), ("gimp", "usl"), ("mpm", "usf")):
        name, text = f"moving_{method}", MOVING + "checkpoint every=30 keep=9\n"
        reference = straight(report, name, text, method=method, update=update)
        ledger(report, name, reference)
        for title, threads, launcher in ((f"{name}_threads", 3, ()), (f"{name}_ranks", 1, mpirun(2))):
            other = straight(report, title, text, threads=threads, launcher=launcher, method=method, update=update)
            for key in ("checksum", "energy.external_work", "energy.total"):
                report.check(other[key] == reference[key], f"{title}: {key} {other[key]}, not {reference[key]}")
        goes_on(
            report, reference, f"{name}_again", text, checkpoints(os.path.join(SCRATCH, name))[0], method=method,
            update=update,
        )
    changed_table(report, f"{name}_again", text, method=method, update=update)


if __name__ == "__main__":
    REPORT = Report()
    tables(REPORT)
    pulse(REPORT)
    spaces(REPORT)
    forces(REPORT)
    patch(REPORT)
    cut_pressed(REPORT)
    cut_pushed(REPORT)
    cantilevers(REPORT)
    mistakes(REPORT)
    bits(REPORT)
    REPORT.end()
