#!/usr/bin/env python3
"""Kept volumes (doc/volumes.md): gas that fills a box from one side, in every space; the ledger's columns; what the
plain method says.

usage: volumes.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: gas fills its box, p V = (gamma - 1) E whatever way it came there, and energy is conserved; the
velocity of a plate before a charge, by a Lagrangian code in one dimension (tests/fuzz/_lagrange.py).
"""
import math
import sys

from _runs import BURNS, KEPT, KEPT_PLANE, KEPT_RINGS, KEPT_SPACE, SOURCE, Report, changed, run

KEPT_LINE = KEPT.format(dimension=1, grid="x=0:20", walls="x-=slip x+=fixed", upper="10,0,0")
SPACES = {
    "line": KEPT_LINE,
    "plane": KEPT_PLANE,
    "rings": KEPT_RINGS,
    "space": KEPT_SPACE,
    "plane_usavg": KEPT_PLANE.replace("update = musl", "update = usavg"),
    "plane_turned": KEPT_PLANE.replace("volumes=kept", "volumes=kept rotation=exact"),
    "rings_swirl": KEPT_RINGS.replace("dimension axisymmetric", "dimension axisymmetric swirl=yes")
    + "velocity gas spin=0.1\n",
}
# The same boxes with cells of unequal sides.
UNEQUAL = "ratio=1.2 largest=2"
SPACES |= {
    "line_unequal": KEPT_LINE.replace("x=0:20", f"x=0:20 fine_x=(6,9) {UNEQUAL}"),
    "plane_unequal": KEPT_PLANE.replace("y=0:20", f"y=0:20 fine_x=(2,4) fine_y=(4,7) {UNEQUAL}"),
    "rings_unequal": KEPT_RINGS.replace("z=0:18", f"z=0:18 fine_r=(0,2) fine_z=(8,11) {UNEQUAL}"),
    "space_unequal": KEPT_SPACE.replace("z=0:18", f"z=0:18 fine_z=(3,6) {UNEQUAL}"),
}


def settles(report):
    """The box is full, energy is kept, filtered energy is heat."""
    for name, deck in SPACES.items():
        result = run(
            name,
            deck.replace("steps=80", "end=60").replace("cfl=0.4", "cfl=0.2")
            + "output csv at=end fields=pressure,volume,energy,mass\n",
        )
        if not report.finished(result, name):
            continue
        report.check(
            abs(result["end_state.volume_over_box"] - 1) < 0.04,
            f"{name}: volumes {result['end_state.volume_over_box']}",
        )
        start = result["energy.initial_total"]
        report.check(abs(result["energy.total"]/start - 1) < 0.04, f"{name}: energy {result['energy.total']/start}")
        report.check(
            abs(result["energy.remainder"]) < 1e-13 * start,
            f"{name}: kinetic identity {result['energy.remainder'] / start}",
        )
        rows = result.table("particles_end.csv")
        work = sum(row["pressure"]*row["volume"] for row in rows)
        inner = sum(row["energy"]*row["mass"] for row in rows)
        report.check(abs(work/(0.4*inner) - 1) < 1e-9, f"{name}: p V over (gamma - 1) E is {work/(0.4*inner)}")
        report.check(
            abs(inner - result["energy.internal"]) < 1e-9 * inner,
            f"{name}: {inner} of internal energy, {result['energy.internal']}",
        )
        history = result.table("history.csv")
        report.check(
            history[-1]["filter_heat"] == result["energy.filter_heat"] > 0,
            f"{name}: heat {result['energy.filter_heat']}",
        )
        if "angular_momentum" in history[0]:
            moment = [row["angular_momentum"] for row in (history[0], history[-1])]
            report.check(abs(moment[1] - moment[0]) < 1e-12*moment[0], f"{name}: moment about the axis {moment}")
        report.check(
            history[-1]["volume_correction"] == result["energy.volume_correction"] >= 0, f"{name}: {history[-1]}"
        )


def plain(report):
    """Without it the same gas is called doubtful for its volumes, and the option is named; nothing is stored or
    written."""
    deck = KEPT_PLANE.replace(" volumes=kept", " volumes=plain").replace("steps=80", "end=200")
    result = run("plain", deck)
    if report.finished(result, "plain"):
        report.check(any("volumes" in reason and "volumes=kept" in reason for reason in result["verdict_reasons"]),
                     f"plain: {result['verdict']} {result['verdict_reasons']} {result['end_state']}")
        report.check(
            "filter_heat" not in result.table("history.csv")[0] and "filter_heat" not in result["energy"],
            "plain: columns of kept volumes",
        )


def by_itself(report):
    """A deck without the word gets it where nothing but gas moves in a box of walls, and where it goes with the rest of
    the deck; particles are split then, but on a line. Gas that expands 1:4 fills its box with the pressure that its
    energy has, which it has kept."""
    alone = KEPT_PLANE.replace(" volumes=kept", "")
    expands = run("expands", alone.replace("steps=80", "end=300").replace("y=0:20", "y=0:40")
                  + "output csv at=end fields=pressure,volume\n")
    if report.finished(expands, "expands"):
        rows = expands.table("particles_end.csv")
        volume = sum(row["volume"] for row in rows)
        pressure = sum(row["pressure"]*row["volume"] for row in rows)/volume
        room = volume/expands["end_state.volume_over_box"]
        report.check(abs(volume/room - 1) < 0.02, f"expands: volumes {volume/room}")
        exact = 0.4*expands["energy.internal"]/room
        report.check(abs(pressure/exact - 1) < 0.02, f"expands: pressure {pressure/exact}")
        report.check(abs(expands["energy.drift"]) < 0.03, f"expands: drift {expands['energy.drift']}")
        report.check(expands["verdict"] == "sound", f"expands: {expands['verdict_reasons']}")
        report.check(len(rows) > 1.5*expands.table("bodies.csv")[0]["particles"], "expands: nothing was split")
    words = run("by_word", alone.replace("update=$update", "update=$update volumes=kept split=1"))
    solid = "material s elastic density=1 young=10 poisson=0\nbody s block material=s lower=(0,15) upper=(6,20) ppc=2\n"
    for name, deck, kept, same in (
        ("alone", alone, "kept", True),
        ("usl", alone.replace("update = musl", "update = usl"), "plain", False),
        ("usavg", alone.replace("update = musl", "update = usavg"), "plain", False),
        ("stress_plain", alone.replace("update=$update", "update=$update stress=plain"), "plain", False),
        ("auto_step", alone.replace("cfl=0.4", "cfl=auto"), "plain", False),
        ("open", alone.replace("y+=slip", "y+=free").replace("y=0:20", "y=0:open"), "plain", False),
        ("solid", alone + solid, "plain", False),
        ("line", KEPT_LINE.replace(" volumes=kept", ""), "kept", False),
    ):
        result = run(f"itself_{name}", deck)
        if report.finished(result, f"itself_{name}"):
            report.check(result["volumes"] == kept, f"itself_{name}: volumes are {result['volumes']}")
            report.check((result["checksum"] == words["checksum"]) == same, f"itself_{name}: bits")


# Gas that flows along a solid in its field.
SLIDES = """
dimension 2
grid cell=1 x=0:40 y=0:8
wall x-=slip x+=slip y-=slip y+=slip
method sgmp volumes=kept
time end=10 cfl=0.4
material s elastic density=10 young=1000 poisson=0.3
material g fluid density=1
eos g ideal_gas gamma=1.4 pressure0=1
body s block material=s lower=(0,0) upper=(40,4) ppc=2
body g block material=g lower=(0,4) upper=(40,8) ppc=2
velocity g x="0.3*sin(pi*x/40)"
history steps=20
"""
# A charge, dense air and a plate in a strip: what the other code of tests/fuzz has as Stack, too.
PLATE = """
units mm g ms
dimension 2
grid cell=0.25 x=0:open y=0:1
wall x-=slip y-=slip y+=slip
method sgmp
time end=0.0026 cfl=0.4
""" + BURNS + """body tnt block material=tnt lower=(0,0) upper=(2,1) ppc=2
body air block material=air lower=(2,0) upper=(6,1) ppc=2
body plate block material=steel lower=(6,0) upper=(7,1) ppc=2
detonation point=(0,0) normal=(1,0)
history steps=50
output csv at=end fields=path
"""


# A soft bar that is pulled to three times its length, and a gas elsewhere.
PULLED = """
dimension 2
grid cell=0.25 x=0:open y=0:4
wall x-=slip y-=slip y+=slip
method sgmp
time end=2 cfl=0.4
material rubber neo_hookean density=1 young=1e-3 poisson=0
material g fluid density=1e-3
eos g ideal_gas gamma=1.4 pressure0=1e-6
body bar block material=rubber lower=(0,0) upper=(1,1) ppc=2
body g block material=g lower=(0,3) upper=(1,4) ppc=2
velocity bar x=x
history steps=50
"""


def solids_stay_whole(report):
    """Beside gas solids are not split unless the deck says so."""
    for name, words, grows in (("whole", "", False), ("by_word", " split=0.75", True)):
        result = run(f"pulled_{name}", PULLED.replace("method sgmp", "method sgmp" + words))
        if report.finished(result, f"pulled_{name}"):
            rows = [part["particles"] for part in result.table("bodies.csv") if part["name"] == "bar"]
            report.check((rows[-1] > rows[0]) == grows, f"pulled_{name}: {rows[0]}, {rows[-1]} particles")
            if not grows:
                report.check("split=0.75" in str(result["verdict_reasons"]), f"pulled: {result['verdict_reasons']}")


def truth(report):
    """The other code against closed forms: a piston before a simple wave of gas, plates on their Hugoniot curve."""
    sys.path.insert(0, f"{SOURCE}/tests/fuzz")
    from _lagrange import Gas, Layer, Metal, Row
    heavy, sound, time = 2.0, 1.4**0.5, 0.8
    exact = 5*sound*(1 - (1 + 1.2*time/(heavy*sound))**(-1/6))
    row = Row([Layer(Gas(1, 1.4, 1.0), 0, 1, 100), Layer(Metal(10, 10, 1.5, 2, 100, 1e9), 1, 1.2, 20)], left=0.0)
    before = sum(row.energies())
    row.run(time)
    report.check(abs(row.velocity(1)/exact - 1) < 1e-3, f"truth: piston {row.velocity(1)}, {exact}")
    report.check(abs(sum(row.energies())/before - 1) < 1e-3, "truth: energy of the piston")
    copper, speed = Metal(8.93e-3, 3940, 1.49, 2, 44776, 1), 1000.0
    row = Row([Layer(copper, -1, 0, 100, speed), Layer(copper, 0, 1, 100)]).run(0.5/(3940 + 1.49*0.5*speed))
    middle = row.p[80:120].mean()
    exact = 8.93e-3*(3940 + 1.49*0.5*speed)*0.5*speed
    report.check(abs(middle/exact - 1) < 5e-3, f"truth: plates {middle}, {exact}")


def slides(report):
    """The difference of their velocities is not taken for noise."""
    result = run("slides", SLIDES)
    if report.finished(result, "slides"):
        first = result.table("history.csv")[0]["kinetic_energy"]
        report.check(result["energy.filter_heat"] < 0.3*first, f"slides: {result['energy.filter_heat']} of {first}")


def burns(report):
    """A deck without a word on volumes keeps them where something burns beside other matter, and splits particles of
    gas a few times: the velocity of the plate is that of a code in one dimension. By word nothing of it is done."""
    sys.path.insert(0, f"{SOURCE}/tests/fuzz")
    from _lagrange import Gas, Jwl, Layer, Metal, Row
    row = Row([
        Layer(Jwl(1.63e-3, 6930, 371200, 3210, 4.15, 0.95, 0.30, 6993), 0, 2, 40, lit=0.0),
        Layer(Gas(5e-5, 1.4, 0.1), 2, 6, 64), Layer(Metal(7.83e-3, 4569, 1.49, 1.93, 207000/2.58, 500), 6, 7, 40),
    ], left=0.0)
    exact = row.run(0.0026).velocity(2)
    result = run("burns", PLATE)
    if not report.finished(result, "burns"):
        return
    ends = {part["name"]: part for part in result.table("bodies.csv")[-3:]}
    starts = {part["name"]: part for part in result.table("bodies.csv")[:3]}
    report.check(result["volumes"] == "kept" and result["verdict"] == "sound", f"burns: {result['verdict_reasons']}")
    report.check(abs(ends["plate"]["velocity_x"]/exact - 1) < 0.05, f"burns: {ends['plate']['velocity_x']}, {exact}")
    report.check(ends["plate"]["particles"] == starts["plate"]["particles"], "burns: a solid was split")
    report.check(ends["tnt"]["particles"] > starts["tnt"]["particles"], "burns: nothing was split")
    flies = run("flies", PLATE.replace("x=0:open", "x=open").replace("wall x-=slip", "wall").replace("0.0026", "0.01"))
    if report.finished(flies, "flies"):
        longest = max(particle["path"] for particle in flies.table("particles_end.csv"))
        report.check(16 <= longest < 32, f"flies: path {longest}, not halved four times")
    whole = run("burns_plain", PLATE.replace("method sgmp", "method sgmp volumes=plain"))
    if report.finished(whole, "burns_plain"):
        report.check(
            whole["volumes"] == "plain" and whole["verdict"] != "sound"
            and whole.table("bodies.csv")[-3]["particles"] == starts["tnt"]["particles"],
            f"burns_plain: {whole['verdict']}",
        )
    bare = run("bare", "".join(line for line in PLATE.splitlines(True) if " air" not in line and "plate" not in line))
    if report.finished(bare, "bare"):
        report.check(bare["volumes"] == "plain", "bare: volumes are kept where nothing but a charge is")


BURST = """
dimension 2
grid cell=1/4 x=0:open y=0:open
wall x-=slip y-=slip
method sgmp
time end=2.3 cfl=0.2
material hot fluid density=4
eos hot ideal_gas gamma=1.4 pressure0=3
material cold fluid density=1
eos cold ideal_gas gamma=1.4 pressure0=1
viscosity all
body hot sphere material=hot radius=2 ppc=2
intersect hot block lower=(0,0) upper=(9,9)
body cold sphere material=cold radius=8 ppc=2
subtract cold sphere radius=2
intersect cold block lower=(0,0) upper=(9,9)
contact all
history steps=50
output csv at=end fields=velocity,mass,body
"""


def bursts(report):
    """A cylinder of gas that bursts in another keeps volumes without a word: radial velocity of the outer one by a code
    in one dimension; with plain volumes the run is coarse, by less than it tells."""
    from _lagrange import Gas, Layer, Row
    exact = Row([Layer(Gas(4, 1.4, 3), 0, 2, 100), Layer(Gas(1, 1.4, 1), 2, 8, 300)], order=1).run(2.3).velocity(1)

    def off(result):
        rows = [row for row in result.table("particles_end.csv") if row["body"] == 2]
        push = sum(row["mass"]*(row["x"]*row["velocity_x"] + row["y"]*row["velocity_y"])/math.hypot(row["x"], row["y"])
                   for row in rows)/sum(row["mass"] for row in rows)
        return abs(push/exact - 1)

    result = run("bursts", BURST)
    if report.finished(result, "bursts"):
        report.check(result["volumes"] == "kept" and result["verdict"] != "doubtful", f"bursts: {result.text}")
        report.check(off(result) < 0.03, f"bursts: {off(result)}")
    plain_one = run("bursts_plain", BURST.replace("sgmp", "sgmp volumes=plain split=none"))
    if report.finished(plain_one, "bursts_plain"):
        report.check(
            plain_one["verdict"] == "coarse" and off(plain_one) < plain_one["verdict_error"],
            f"bursts_plain: {plain_one['verdict']}, {off(plain_one)}",
        )


GUN = """
dimension 2
grid cell=1/20 x=0:open y=0:0.2
wall x-=slip y-=slip y+=slip
method sgmp
time end=4 cfl=0.3
material g fluid density=1
eos g ideal_gas gamma=1.4 pressure0=1
viscosity g
material s elastic density=10 young=1e4 poisson=0.3
body gas block material=g lower=(0,0) upper=(1,0.2) ppc=2
body shot block material=s lower=(1,0) upper=(1.3,0.2) ppc=2
rigid shot free=yes mass=0.1
contact all
history steps=50
"""


def guns(report):
    """Gas behind a rigid shot keeps volumes without a word, and is split; behind one that deforms it does not."""
    from _lagrange import Gas, Layer, Row
    row = Row([Layer(Gas(1, 1.4, 1), 0, 1, 200)], left=0.0)
    row.node_mass[-1] += 0.5
    exact = float(row.run(4).v[-1])
    result = run("guns", GUN)
    if report.finished(result, "guns"):
        end = result.table("bodies.csv")[-1]
        report.check(result["volumes"] == "kept" and result["verdict"] == "sound", f"guns: {result.text}")
        report.check(abs(end["velocity_x"]/exact - 1) < 0.01, f"guns: {end['velocity_x']}, not {exact}")
    soft = run("guns_soft", GUN.replace("rigid shot free=yes mass=0.1\n", "").replace("end=4", "end=0.1"))
    if report.finished(soft, "guns_soft"):
        report.check(soft["volumes"] == "plain", f"guns_soft: volumes are {soft['volumes']}")


def sloshes(report):
    """Water in a box swings to and fro: the kinetic energy comes back, in the plane and in a slice of space, and the
    interior stays smooth. Without (VM1) particles gather, sink and stir: several times that energy after four
    periods."""
    with open(f"{SOURCE}/verification/flows/slosh.inp", encoding="utf-8") as file:
        deck = file.read()
    space = changed(
        deck, ("dimension 2", "dimension 3"), ("y=0:open", "y=0:open z=0:1/n"), ("y-=slip", "y-=slip z-=slip z+=slip"),
        ("lower=(0,0) upper=(long,1)", "lower=(0,0,0) upper=(long,1,1/n)"), ("gravity (0,-1)", "gravity (0,-1,0)"),
    )
    for name, text, settings, volumes, least, most in (
        ("sloshes", deck, {}, "matched", 0.6, 1.1), ("sloshes_space", space, {}, "matched", 0.6, 1.1),
        ("sloshes_usavg", deck, {"update": "usavg"}, "matched", 0.6, 1.1),
        ("sloshes_plain", deck, {"volumes": "plain"}, "plain", 1.3, 9),
        ("sloshes_usf", deck, {"update": "usf"}, "plain", 1.3, 9),
    ):
        result = run(name, text, **settings)
        if not report.finished(result, name):
            continue
        rows = result.table("history.csv")
        first, end = rows[0]["kinetic_energy"], rows[-1]["time"]
        last = max(row["kinetic_energy"] for row in rows if row["time"] > 0.75*end)/first
        report.check(least < last < most, f"{name}: {last} of the kinetic energy in the last period")
        report.check(result["volumes"] == volumes, f"{name}: volumes {result['volumes']}")


def main():
    """All of them."""
    report = Report()
    settles(report)
    plain(report)
    by_itself(report)
    truth(report)
    slides(report)
    burns(report)
    solids_stay_whole(report)
    bursts(report)
    guns(report)
    sloshes(report)
    report.end()


main()
