#!/usr/bin/env python3
"""Prescribed motion of parts of bodies (doc/loads.md): waves, work and force of the driver, clamps, grips, rotation;
the ledger, the same bits.

usage: motion.py SGMP SOURCE_DIR SCRATCH_DIR [clamps | carried]

Known from outside: an end that is moved with V(t) sends the stress -rho c V(t - x/c) down a rod and does the work of
rho c A V^2; a rod that is held at one end swings with the period 4 L/c; grips that are apart by dL more pull with E A
dL/L; what is turned as a whole keeps its shape, is where the angle says, and takes the torque I alpha. With `clamps`
and `carried` it prints what doc/loads.md has of parts that end between nodes and of grips that move through cells.
"""
import math
import os
import statistics
import sys

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

PEAK, LASTS, END = 1e-3, 0.4, 0.7
ROD = f"""
parameter method = sgmp
parameter update = musl
parameter cells = 64
dimension 1
grid cell=1/cells x=-0.25:1.75
method $method update=$update
time end={END} dt=0.1/cells
material rubber elastic density=2 young=2 poisson=0 strain=small
body rod block lower=0 upper=1.125 material=rubber ppc=2
motion rod where="x<0.125" x="{PEAK}*sin(pi*t/{LASTS})^2*(t<{LASTS})"
history steps=1
output csv at=end fields=stress,initial_position
"""
# The same along the last axis of other spaces, four cells wide; about an axis along z.
BLOCKS = {"plane": ("2", "x=0:4/cells y=-0.25:1.75", "x-=slip x+=slip", "(0,0)", "(4/cells,1.125)", "y"),
          "space": ("3", "x=0:2/cells y=0:2/cells z=-0.25:1.75", "x-=slip x+=slip y-=slip y+=slip", "(0,0,0)",
                    "(2/cells,2/cells,1.125)", "z"),
          "rings": ("axisymmetric", "r=0:4/cells z=-0.25:1.75", "r+=slip", "(0,0)", "(4/cells,1.125)", "z")}
# The free part is of length and speed of sound 1.
SWING = """
parameter method = sgmp
parameter cells = 32
parameter shift = 0
dimension 1
grid cell=1/cells x=-0.5:1.75
method $method
time end=8.2 dt=0.1/cells
material rubber elastic density=1 young=1 poisson=0 strain=small
body rod block lower=-0.25+shift/cells upper=1+shift/cells material=rubber ppc=2
velocity rod x="1e-3*sin(pi/2*(x-shift/cells))*(x>shift/cells)"
motion rod where="x<shift/cells" x=0
history steps=4
gauge tip point=(1,0,0)
"""
# Six long, two high, between grips; EA/L = 100/3.
PULLED = """
parameter method = sgmp
parameter cells = 2
dimension 2
grid cell=1/cells x=-2:9 y=-2:2
method $method
time end=50 cfl=0.5
material rubber elastic density=1 young=100 poisson=0 strain=small
body bar block lower=(-1,-1) upper=(7,1) material=rubber ppc=2
motion bar where="x<0" x=0
motion bar where="x>6" x="6e-4*pi/40*sin(pi*t/20)*(t<20)"
damping rate=1
history steps=50
output csv at=end fields=stress
"""
# Stretched by 1 %, and then carried through cells.
CARRIED = """
parameter method = sgmp
dimension 1
grid cell=1 x=-12:60
method $method
time end=500 dt=0.2
material rubber elastic density=1 young=1 poisson=0
body bar block lower=-4 upper=28 material=rubber ppc=2
motion bar where="x<0" x="0.01*(1-cos(pi*min(max((t-100)/200,0),1)))"
motion bar where="x>24" x="0.012*(t<20)+0.01*(1-cos(pi*min(max((t-100)/200,0),1)))"
damping rate=0.3 until=100
history every=2
"""
# Turned to and fro about a point that moves.
TURNED = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=0.5
method $method update=$update
time steps=200 dt=0.02
material rubber neo_hookean density=1.5 young=100 poisson=0.3
body bar block lower=(-1,-1) upper=(3,1) material=rubber ppc=2
motion bar omega_z="cos(t)" x=0.3 about=(0,0)
history steps=1
output csv at=end fields=stress,initial_position
"""
# Two bodies, one with a grip that turns and one that lets go, under gravity and a load.
MOVING = """
parameter method = sgmp
parameter update = musl
dimension 2
grid cell=1
method $method update=$update
time dt=0.1 steps=80
material rubber neo_hookean density=1 young=20 poisson=0.3
body block block lower=(0,0) upper=(9,5) material=rubber ppc=2 rotation=20
body ball sphere centre=(20,0) radius=3 material=rubber ppc=2
gravity (0,-0.01)
velocity block x=0.6
velocity ball x=-1 y=0.9
motion block where="x<2" omega_z="0.1*cos(t)" x="0.6+0.1*sin(t)"
motion block where="x>5.5" y="0.2*sin(0.5*t)" until=5
motion ball where="y>1" x=-1
load ball y=0.3
history steps=5
gauge middle point=(3,3,0)
output csv at=end fields=stress,displacement
"""
SPACE = """
parameter method = sgmp
parameter update = musl
dimension 3
grid cell=1
method $method update=$update
time dt=0.1 steps=40
material rubber neo_hookean density=1 young=20 poisson=0.3
body block block lower=(0,0,0) upper=(5,5,9) material=rubber ppc=2 rotation=20
motion block where="z<2" omega_z="0.2*cos(t)" omega_x=0.1 x="0.1*sin(t)"
motion block where="z>7" z="0.2*sin(0.5*t)"
history steps=5
output csv at=end fields=stress,displacement
"""


def speed(t):
    """Of the driven end."""
    return PEAK*math.sin(math.pi*t/LASTS)**2 if 0 < t < LASTS else 0.0


def ledger(report, name, result):
    """Kinetic energy to round-off."""
    energy = result["energy"]
    report.check(abs(energy["remainder"]) < 1e-12*energy["supplied"],
                 f"{name}: kinetic identity {energy['remainder']/energy['supplied']}")


def rod_error(rows):
    """Of the stress in the free part, relative to the norm of the exact one."""
    places = [(row["stress_xx"], -2*speed(END - row["x0"] + 0.125)) for row in rows if row["x0"] > 0.125]
    return math.sqrt(sum((here - there)**2 for here, there in places)/sum(there**2 for _, there in places))


def pulse(report):
    """The stress in the rod, the place of the end, work, force and momentum."""
    work = 2*PEAK**2*LASTS*3/8  # the integral of rho c V^2
    for method, update, most in (("sgmp", "musl", 0.05), ("sgmp", "usf", 0.055), ("sgmp", "usl", 0.05),
                                 ("sgmp", "usavg", 0.055), ("mpm", "musl", 0.025), ("mpm", "usf", 0.03),
                                 ("gimp", "usl", 0.025), ("cpgimp", "usavg", 0.025), ("bspline", "musl", 0.04)):
        name = f"rod_{method}_{update}"
        result = run(name, ROD, method=method, update=update, cells=128)
        if not report.finished(result, name):
            return
        ledger(report, name, result)
        rows = result.table("particles_end.csv")
        error = rod_error(rows)
        report.check(error < most, f"{name}: stress is off by {error}")
        dt = 0.1/128
        way = sum(dt*speed((k + 0.5)*dt) for k in range(round(END/dt)))
        off = max(abs(row["x"] - row["x0"] - way) for row in rows if row["x0"] < 0.125)
        report.check(off < 1e-14, f"{name}: the end is off by {off}")
        drives, history = result.table("motion.csv"), result.table("history.csv")
        report.check(abs(drives[-1]["work"]/work - 1) < 0.003, f"{name}: work {drives[-1]['work']}, not {work}")
        report.check(abs(drives[-1]["work"]/history[-1]["external_work"] - 1) < 1e-12,
                     f"{name}: motion.csv and history.csv do not agree")
        report.check(abs(result["energy.drift"]) < 5e-4, f"{name}: energy drifts by {result['energy.drift']}")
        # The first velocity step is half a step.
        impulse = sum(row["force_x"]*dt for row in drives[1:])
        report.check(abs(impulse - history[-1]["momentum_x"]) < 1e-12*PEAK,
                     f"{name}: impulse {impulse}, momentum {history[-1]['momentum_x']}")
        report.check(abs(drives[26]["x"] - (0.0625 + sum(dt*speed((k + 0.5)*dt) for k in range(26)))) < 1e-14,
                     f"{name}: centre {drives[26]['x']}")
        # The end itself has to be accelerated, too.
        worst = max(abs(row["force_x"] - 2*speed(row["time"])
                        - 0.25*(speed(row["time"] + dt/2) - speed(row["time"] - dt/2))/dt) for row in drives[2:])
        report.check(worst < 0.04*2*PEAK, f"{name}: the force is off by {worst/(2*PEAK)}")


def spaces(report):
    """What is moved between slip walls is the rod, in every space."""
    for method, words in (("sgmp", ""), ("sgmp", " stress=plain"), ("mpm", ""), ("gimp", ""), ("bspline", "")):
        rod_text = ROD.replace("update=$update", "update=$update" + words)
        rod = run(f"rod_{method}", rod_text, method=method, cells=32)
        if not report.finished(rod, f"rod_{method}"):
            return
        line = sorted((row["x0"], row["stress_xx"]) for row in rod.table("particles_end.csv"))
        for space, (dimension, extent, walls, lower, upper, axis) in BLOCKS.items():
            name = f"{space}_{method}"
            if name == "rings_sgmp" and not words:
                continue  # normalised, sections beside the outer wall are off by C/R^2 (doc/theory.md, 7)
            text = rod_text.replace("dimension 1", f"dimension {dimension}").replace("x=-0.25:1.75",
                                                                                extent).replace("lower=0 upper=1.125",
                                                                                                f"lower={lower} "
                                                                                                f"upper={upper}")
            text = text.replace('"x<0.125" x=', f'"{axis}<0.125" {axis}=').replace("\ntime", f"\nwall {walls}\ntime")
            result = run(name, text, method=method, cells=32)
            if not report.finished(result, name):
                continue
            ledger(report, name, result)
            worst = max(abs(row[f"stress_{axis}{axis}"] - stress) for row in result.table("particles_end.csv")
                        for place, stress in [min(line, key=lambda pair, row=row: abs(pair[0] - row[f"{axis}0"]))])
            report.check(worst < 1e-9*PEAK, f"{name}: {worst/PEAK} off the rod")
            area = {"plane": 4/32, "space": (2/32)**2, "rings": math.pi*(4/32)**2}[space]
            own, others = result.table("motion.csv")[-1], rod.table("motion.csv")[-1]
            report.check(abs(own["work"]/others["work"]/area - 1) < 1e-9, f"{name}: work {own['work']}")


def period_of(result):
    """Twice the mean time between changes of sign of the velocity of the free end."""
    rows = [(row["time"], row["velocity_x"]) for row in result.table("gauges.csv")]
    zeros = [t + (u - t)*v/(v - w) for (t, v), (u, w) in zip(rows, rows[1:]) if v*w < 0]
    return 2*(zeros[-1] - zeros[0])/(len(zeros) - 1)


def print_clamps():
    """Errors of the period where the part ends at a node and some quarters of a cell behind it."""
    for method in ("mpm", "gimp", "sgmp", "bspline"):
        periods = [period_of(run(f"clamp_{method}_{quarter}", SWING, method=method, shift=0.25*quarter))
                   for quarter in range(4)]
        wall = SWING.replace("lower=-0.25+shift/cells",
                             "lower=0").replace("x=-0.5:1.75",
                                                "x=0:1.75\nwall x-=fixed").replace('motion rod where="x<shift/cells" '
                                                                                   'x=0', "")
        print(method, *(f"{100*(period/4 - 1):+.2f} %" for period in periods),
              f"wall {100*(period_of(run(f'wall_{method}', wall, method=method))/4 - 1):+.2f} %")


def print_carried():
    """The force of a bar at rest, and its mean and scatter while grips carry it through four cells."""
    for method in ("mpm", "gimp", "sgmp", "bspline"):
        rows = [row for row in run(f"carried_{method}", CARRIED, method=method).table("motion.csv")
                if row["motion"] == 2]
        rest = statistics.mean(row["force_x"] for row in rows if 90 < row["time"] < 99)
        moved = [row["force_x"] for row in rows if row["time"] > 310]
        print(method, f"at rest {rest:.5f}, carried {statistics.mean(moved):.5f} +- "
                      f"{statistics.pstdev(moved)/rest:.1%}")


def swing(report):
    """The period of a rod that is held at one end; its force is that on a wall."""
    for method, most in (("sgmp", 0.012), ("mpm", 0.001), ("gimp", 0.001), ("bspline", 0.01)):
        name = f"swing_{method}"
        result = run(name, SWING, method=method)
        if not report.finished(result, name):
            continue
        ledger(report, name, result)
        period = period_of(result)
        report.check(abs(period/4 - 1) < most, f"{name}: period {period}, not 4")
        report.check(abs(result["energy.external_work"]) < 1e-20,
                     f"{name}: a clamp works: {result['energy.external_work']}")


def pull(report):
    """The force on the grips."""
    for method, most in (("mpm", 1e-6), ("gimp", 1e-3), ("sgmp", 0.05)):
        name = f"pull_{method}"
        result = run(name, PULLED, method=method)
        if not report.finished(result, name):
            continue
        ledger(report, name, result)
        first, second = result.table("motion.csv")[-2:]
        report.check(abs(second["force_x"]/0.02 - 1) < most, f"{name}: force {second['force_x']}, not 0.02")
        report.check(abs(first["force_x"] + second["force_x"]) < 1e-6*0.02,
                     f"{name}: grips pull with {first['force_x']} and {second['force_x']}")
        report.check(first["work"] == 0 and second["work"] > 0, f"{name}: work {first['work']}, {second['work']}")


def turn(report):
    """A body that is turned as a whole."""
    angle = sum(0.02*math.cos(0.02*(k + 0.5)) for k in range(200))
    for method, update in (("sgmp", "musl"), ("sgmp", "usl"), ("mpm", "musl"), ("gimp", "usl"), ("cpgimp", "musl"),
                           ("bspline", "usl"), ("mpm", "usf"), ("sgmp", "usavg")):
        name = f"turn_{method}_{update}"
        result = run(name, TURNED, method=method, update=update)
        if not report.finished(result, name):
            continue
        ledger(report, name, result)
        rows = result.table("particles_end.csv")
        off = max(math.hypot(row["x"] - 1.2 - math.cos(angle)*row["x0"] + math.sin(angle)*row["y0"],
                             row["y"] - math.sin(angle)*row["x0"] - math.cos(angle)*row["y0"])
                  for row in rows)
        report.check(off < 1e-13, f"{name}: particles are off by {off}")
        if update == "usavg":
            continue
        stress = max(abs(row[key]) for row in rows for key in ("stress_xx", "stress_yy", "stress_xy"))
        report.check(stress < 1e-12, f"{name}: stress {stress}")
        report.check(abs(result["energy.drift"]) < 1e-12, f"{name}: energy drifts by {result['energy.drift']}")
        # Moments of points about (0,0), of which the centre of mass is 1 away; between steps 100 and 101 at t = 2.
        particles = [(-0.875 + 0.25*i, -0.875 + 0.25*j) for i in range(16) for j in range(8)]
        inertia = sum(1.5*0.25**2*(x*x + y*y) for x, y in particles)
        expected = inertia*(math.cos(2.01) - math.cos(1.99))/0.02
        torque = result.table("motion.csv")[101]["torque_z"]
        report.check(abs(torque/expected - 1) < 2e-3, f"{name}: torque {torque}, not {expected}")


def free(report):
    """Components that are not named are free, and so is a part that is let go."""
    for method, update in (("sgmp", "musl"), ("mpm", "musl"), ("gimp", "usl"), ("bspline", "usavg"), ("sgmp", "usf")):
        name = f"free_{method}_{update}"
        text = TURNED.replace('omega_z="cos(t)" x=0.3 about=(0,0)',
                              'x="0.3+t" until=2.01').replace("\ntime", "\ngravity (0,-1)\ntime")
        result = run(name, text, method=method, update=update)
        if not report.finished(result, name):
            continue
        ledger(report, name, result)
        history, drives = result.table("history.csv"), result.table("motion.csv")
        mass = 1.5*8
        # Steps whose middle is before t = 2.01 are driven; the last of them ends at 2.02.
        speed_x = 0.3 + 1.99
        last = history[-1]
        report.check(abs(last["momentum_x"]/(mass*speed_x) - 1) < 1e-12,
                     f"{name}: momentum {last['momentum_x']}, not {mass*speed_x}")
        report.check(abs(last["momentum_y"]/(-mass*(4 - 0.01)) - 1) < 1e-12,
                     f"{name}: momentum {last['momentum_y']}, not {-mass*3.99}")
        report.check(all(row["force_x"] == 0 for row in drives[102:]) and abs(drives[60]["force_x"]/mass - 1) < 1e-9,
                     f"{name}: forces {drives[60]['force_x']}, {drives[110]['force_x']}")
        report.check(all(row["force_y"] == 0 for row in drives), f"{name}: a force along y")
        report.check(abs(drives[-1]["work"]/(0.5*mass*(speed_x**2 - 0.3**2)) - 1) < 1e-9,
                     f"{name}: work {drives[-1]['work']}")


def damped(report):
    """With flip below 1 the momentum is what whoever moves the part has given, touched by another body or not."""
    text = """
dimension 2
grid cell=0.25 x=open y=open
method {method} flip={flip}
time end=0.3 dt=5e-3
material steel elastic density=4 young=200 poisson=0.3
material soft elastic density=1 young=20 poisson=0.3
body plate block material=steel lower=(0.03,0.02) upper=(2.03,0.52) ppc=2
body ball block material=soft lower=(0.52,0.56) upper=(1.3,1.3) ppc=2
velocity ball x=0.5 y=-1
{contact}
motion plate where="x<{to}" x="0.3*sin(5*t)" y=0
history steps=1
"""
    for number, method in enumerate(("mpm update=musl", "gimp update=usf", "bspline update=usl", "sgmp update=usavg "
                                     "rotation=plain surfaces=plain stress=plain")):
        for flip in (0.9, 0):
            name = f"damped_{number}_{flip}"
            result = run(name, text.format(method=method, flip=flip, to=0.6 if flip else 0.9,
                                           contact="contact plate ball friction=0.3" if number % 2 else ""))
            if not report.finished(result, name):
                continue
            rows, moved = result.table("history.csv"), result.table("motion.csv")
            for axis in "xy":
                given = 5e-3*sum(row[f"force_{axis}"] for row in moved[1:])
                change = rows[-1][f"momentum_{axis}"] - rows[0][f"momentum_{axis}"]
                report.check(abs(given - change) < 1e-13, f"{name}: momentum along {axis} {change}, given {given}")


def faces(report):
    """At closed faces what is free is turned back, with its momentum on the grid; what is moved goes on, is removed and
    counted."""
    for space, extent, walls, corners in (("plane", "x=-2:4.5 y=-2:2", "", "lower=(-1,-1) upper=(3,1)"),
                                          ("rings", "r=0:3 z=-2:4.5", "", "lower=(0,-1) upper=(1,3)")):
        along = "x" if space == "plane" else "z"
        for method in ("sgmp", "mpm"):
            name = f"faces_{space}_{method}"
            text = TURNED.replace("grid cell=0.5", f"grid cell=0.5 {extent}\nlost "
                                                   f"reflect").replace("lower=(-1,-1) upper=(3,1)", corners)
            text = text.replace("dimension 2", "dimension 2" if space == "plane"
                                else "dimension axisymmetric").replace("output csv", f"velocity bar {along}=2\noutput "
                                                                                     f"csv")
            moved = 'motion bar omega_z="cos(t)" x=0.3 about=(0,0)'
            for part, until, lost in (("<0", " until=0.3", False), (">2", "", True)):
                result = run(f"{name}_{lost}", text.replace(moved, f'motion bar where="{along}{part}" '
                                                                   f'{along}=2{until}'), method=method, update="musl")
                if report.finished(result, name):
                    ledger(report, f"{name}_{lost}", result)
                    many = {"plane": 4*8, "rings": 4*4}[space]
                    report.check(result["particles_lost"] == (many if lost else 0),
                                 f"{name}: {result['particles_lost']} particles lost")


def turned(report):
    """A block that is turned as a whole is not strained with exact rotation, and whoever turns it does the work that
    its energy says."""
    text = """
parameter update = musl
dimension 2
grid cell=1
method sgmp update=$update rotation=exact surfaces=corrected stress=normalised
time cfl=0.3 steps=200
material soft elastic density=1 young=100 poisson=0.3
body block block material=soft lower=(-3,-2) upper=(4,3)
motion block omega_z=0.05 about=(0.5,0.5)
history steps=1
"""
    for update in ("musl", "usf", "usl", "usavg"):
        name = f"turned_{update}"
        result = run(name, text, update=update)
        if not report.finished(result, name):
            continue
        energy, row = result["energy"], result.table("history.csv")[-1]
        # m (a^2 + b^2)/12 omega^2/2 of a block of 7 by 5; particles stand for points, not for squares.
        report.check(abs(row["kinetic_energy"]/(35*(49 + 25)/24*0.05**2) - 1) < 0.02,
                     f"{name}: kinetic energy {row['kinetic_energy']}")
        # A step stretches what turns by (omega dt)^2/2.
        report.check(row["internal_energy"] < 1e-3*row["kinetic_energy"],
                     f"{name}: {row['internal_energy']} of {row['kinetic_energy']} is internal")
        report.check(abs(energy["remainder"]) < 1e-11*energy["supplied"],
                     f"{name}: the ledger misses {energy['remainder']/energy['supplied']:.1e}")


def mistakes(report):
    """What a deck must not say, and what it is told."""
    cases = (("nothing prescribed", 'x=-1', '', "the motion prescribes nothing"),
             ("no particle", '"y>1"', '"y>100"', "the motion moves no particle"),
             ("time chooses", '"y>1"', '"y>t"', "'where' cannot depend on t"),
             ("no number", '"y>1"', '"sqrt(y)"', "where=… is not a number at some places of body 'ball'"),
             ("all bodies", "motion ball", "motion all", "a motion belongs to a part of one body"),
             ("a rigid body", "history", "rigid ball x=1\nhistory", "is rigid: it moves as a whole"),
             ("place in a velocity", 'x=-1', 'x="y"', "cannot depend on position"),
             ("no such axis to turn about", 'x=-1', 'omega_x=1', "nothing turns about x"),
             ("about without rotation", 'x=-1', 'x=-1 about=(0,0)', "'about' of a part that does not turn"),
             ("the same particles twice", "load ball", 'motion ball where="y>2" x=1\nload ball',
              "two cards move the same particles of body 'ball'"),
             ("no such time", "until=5", "until=0", "'until' = 0 is out of range"),
             ("friction at the surface", "load ball", "contact all friction=0.1\nmethod sgmp rotation=exact\nload ball",
              "is rubbed by others"),
             ("too many", "load ball", "".join(f'motion ball where="y>-3+0.5*{k} && y<-3+0.5*{k + 1}" x={k}\n'
                                               for k in range(8)) + "load ball", "more than 8 cards motion"))
    for title, before, after, message in cases:
        text = MOVING.replace("grid cell=1\n", "grid cell=1 y=-20:30\n")
        result = run(title.replace(" ", "_"), text.replace(before, after))
        report.check(result.code == 3, f"{title}: exit code {result.code}")
        report.check(message in result.text, f"{title}: says {result.text}")


def bits(report):
    """The same for threads, ranks and restarts."""
    for scene, text, method, update in (("plane", MOVING, "sgmp", "musl"), ("plane", MOVING, "gimp", "usl"),
                                        ("plane", MOVING, "mpm", "usf"), ("plane", MOVING, "bspline", "usavg"),
                                        ("space", SPACE, "sgmp", "usf"), ("space", SPACE, "mpm", "musl")):
        name, deck = f"{scene}_{method}_{update}", text + "checkpoint every=15 keep=9\n"
        reference = straight(report, name, deck, method=method, update=update)
        ledger(report, name, reference)
        for title, threads, launcher in ((f"{name}_threads", 3, ()), (f"{name}_ranks", 1, mpirun(2))):
            other = straight(report, title, deck, threads=threads, launcher=launcher, method=method, update=update)
            for key in ("checksum", "energy.external_work", "energy.total"):
                report.check(other[key] == reference[key], f"{title}: {key} {other[key]}, not {reference[key]}")
            report.check(other.table("motion.csv") == reference.table("motion.csv"), f"{title}: motion.csv differs")
        goes_on(report, reference, f"{name}_again", deck, checkpoints(os.path.join(SCRATCH, name))[0], method=method,
                update=update)
    deck = MOVING.replace('x="0.6+0.1*sin(t)"', 'x="0.6+0.1*sin(t)" until=1') + "checkpoint every=15 keep=9\n"
    goes_on(report, straight(report, "let_go", deck), "let_go_again", deck, 15)


if __name__ == "__main__":
    if sys.argv[4:]:
        {"clamps": print_clamps, "carried": print_carried}[sys.argv[4]]()
        sys.exit()
    REPORT = Report()
    pulse(REPORT)
    spaces(REPORT)
    swing(REPORT)
    pull(REPORT)
    turn(REPORT)
    free(REPORT)
    damped(REPORT)
    faces(REPORT)
    turned(REPORT)
    mistakes(REPORT)
    bits(REPORT)
    REPORT.end()
