#!/usr/bin/env python3
"""Import of MPM3D decks, card by card: small decks, each with the cards, notes and particles that it must become, or
the error at its place.

usage: import_cards.py SGMP SOURCE_DIR SCRATCH_DIR

What is expected is worked out by hand, or here from the particles that the deck describes.
"""
import math
import os
import re
import shutil
import subprocess

from _runs import ENVIRONMENT, SCRATCH, SGMP, Report

DECK = """mpm3d cards
nbco 1
nbbo 1
nmat 1
nbmp 8
grid 0 4 0 4 0 4
dcell 1
endtime 1
material
1 elas 1 100 0.3
part block 1 1 1.0 1 1 1 1 2 2 2
endi
"""
PART = "part block 1 1 1.0 1 1 1 1 2 2 2\n"
MATERIAL = "material\n1 elas 1 100 0.3\n"
# Of a deck: texts and what stands there instead; what must be printed.
REFUSED = [
    ("2 2 2\nendi\n", "2 2", ":11:1: error: the deck ends where a number is expected"),
    ("nmat 1", "nmat 1.5", ":4:6: error: the number of materials must be a whole number"),
    ("nmat 1", "nmat 0", ":4:6: error: the number of materials is too small"),
    ("100", "100/2", ":10:10: error: '100/2' is not a number"),
    ("100", "2*100", ":10:10: error: '2*100' is not a number"),
    ("100", "1e2/", ":10:10: error: '1e2/' is not a number"),
    ("100", "1e00002", ":10:10: error: '1e00002' is not a number"),
    ("100", "1.2.3", ":10:10: error: '1.2.3' is not a number"),
    ("100", "1e61", ":10:10: error: '1e61' is not a number"),
    ("100", "inf", ":10:10: error: 'inf' is not a number"),
    ("100", "100." + 37 * "0", ":10:10: error: '100." + 37 * "0" + "' is not a number"),
    ("endtime", "emdtime", "did you mean 'endt'?"),
    ("material", "matrial_of_all", "did you mean 'mate'?"),
    ("dcell 1", "dcell 0", ":7:7: error: the side of a cell is not positive"),
    ("dcell 1\n", "", ":11:1: error: the deck has no cell size"),
    ("endtime 1\n", "", ":11:1: error: the deck has no end time"),
    ("grid 0 4 0 4 0 4", "spy 1 4", ":12:1: error: the deck has no box along xz\n"),
    ("nbmp 8\n", "", ":11:1: error: the deck has no nbmp"),
    ("nmat 1\n", "", ":8:1: error: there is no nmat before material"),
    (PART, "", ":11:1: error: the deck has no particles"),
    (PART, "part sphere 1 1 1.0 1 2 2 2 2001\n", ":11:29: error: the radius in spacings is too large"),
    (PART, "part block 2 1 1.0 1 1 1 1 2 2 2\n", ":11:1: error: the body is of component 2, nbco is 1"),
    (PART, "part block 1 1 1.0 1 1 1 1 2 2 3\n", ":11:1: error: there are more particles than nbmp says (8)"),
    (PART, "part blod 1 1 1.0 1 1 1 1 2 2 2 2 2 0 2\n", ":11:1: error: the body has no particles"),
    (PART, "part blod 1 1 1.0 1 1 1 1 1001 1000 100 0 0 0 1500\n", ":11:1: error: there are more particles"),
    (
        "nbmp 8\n",
        "",
        PART,
        "part point 1 2\n1 1 1 1 1 1\n2 1 1 2 1 1\n",
        ":10:14: error: the number of particles of the body is too large",
    ),
    ("nbmp 8\n", "", "endi", "load part 2 1 0 0 endl endi", ":11:11: error: the number of the particle is too large"),
    ("nbmp 8\n", "", "endi", "curv pres 2\nendi", ":11:11: error: the number of the particle is too large"),
    ("endi", "load part 0 1 0 0 endl endi", ":12:11: error: the number of the particle is too small"),
    ("endi", "cont lagr 0 3 endi", ":12:13: error: the choice of the normal is too large"),
    ("endi", "material 1 elas 1 100 0.3 endi", ":12:1: error: material is given twice"),
    ("elas 1 ", "elas 0 ", ":10:8: error: the density is not positive"),
    (MATERIAL, "seos 1 4 2\n" + MATERIAL, ":9:1: error: seos stands before material"),
    (
        "endi",
        "seos 1 1 0 0 0 0 0 0 0 0\nseos 1 4 2\nendi",
        ":13:8: error: this material has an equation of state already",
    ),
    (PART, "load endl\n" + PART, ":11:1: error: loads stand before the bodies"),
    ("endi", "load part 1 0 0 1", ":12:1: error: the deck ends within a block", "add endl"),
    ("endi", "velo body 1 0 0 1", "add endv"),
    ("endi\n", "outr", ":12:1: error: the deck ends where a variable is expected"),
    (
        "endi",
        "fixed 0 0 0 1 0 0\ngrid 0 4 0 2 0 4\nendi",
        ":11:1: error: the body has particles beyond the wall y+, which is at 2",
    ),
    (
        "nbmp 8",
        "nbmp 21",
        PART,
        "part block 1 1 1.0 1 1 1 1 21 1 1\n",
        "endi",
        "load " + " ".join(f"part {n} {n} 0 0" for n in range(1, 22)) + " endl endi",
        ":11:1: error: load puts more than 20 different forces",
    ),
    ("elas 1 100 0.3", "dpm 1 100 0.3 0 1 0 1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 0.5 -0.1 0.1 1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 0.5 1 0.1 -1", ":10:3: error: dpm: a cone that is none"),
    ("elas 1 100 0.3", "dpm 1 100 0.3 1.74 1 0.1 1", ":10:3: error: dpm: a cone that is none"),
    (
        "elas 1 100 0.3",
        "hiex 1 100",
        "endi",
        "seos 1 2 1 1 1 1\nendi",
        ":12:1: error: seos 2: this equation is not available here for hiex",
    ),
]


def changed(changes):
    """The deck with texts replaced, each of which it has once."""
    text = DECK
    for was, now in zip(changes[::2], changes[1::2]):
        assert text.count(was) == 1, was
        text = text.replace(was, now)
    return text


def run_import(deck, folder, *options):
    """Exit code and what is printed."""
    done = subprocess.run(
        [SGMP, "import", deck, "--output", folder, *options], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        timeout=120, check=False, env=ENVIRONMENT,
    )
    return done.returncode, done.stdout.decode("utf-8", "replace")


def imported(name, text, *options):
    """Exit code and what is printed; cards, notes and the text of files of particles by name."""
    deck, out = os.path.join(SCRATCH, name + ".mpm"), os.path.join(SCRATCH, name)
    shutil.rmtree(out, ignore_errors=True)
    with open(deck, "w", encoding="latin-1") as file:
        file.write(text)
    code, printed = run_import(deck, out, *options)
    files = {}
    for file in os.listdir(out) if os.path.isdir(out) else []:
        with open(os.path.join(out, file), encoding="utf-8") as lines:
            files[file] = lines.read()
    return code, printed, files


def refusals(report):
    """Decks with one mistake."""
    for number, (*changes, last) in enumerate(REFUSED):
        expected = [last]
        if len(changes) % 2:
            expected.insert(0, changes.pop())
        code, printed, files = imported(f"refused_{number}", changed(changes))
        report.check(
            code == 3 and not files and all(words in printed for words in expected),
            f"{changes}: {code}, not {expected} in\n{printed}",
        )
    code, printed, files = imported("nothing", "")
    report.check(
        code == 3 and "nothing.mpm:" in printed and "error: the deck ends before endi" in printed,
        f"an empty file: {code} {printed}",
    )


# What decks become: changes of DECK; lines of the native deck, after ! such as it must not have; what notes say; rows
# of particle files.
LATTICE = "".join(
    f"{1 + i + 4 * (j + 3 * k)} 1 0.25 {1.25 + 0.5 * i} {1.25 + 0.5 * j} {1.25 + 0.5 * k}\n"
    for k in range(2)
    for j in range(3)
    for i in range(4)
)
BECOMES = {
    "numbers": (
        ["elas 1 100 0.3", "elas 1e60 100." + 36 * "0" + " 3e-0001", "endi", "dtscale 2.5 endi"],
        [
            "material material_1 elastic density=1e60 young=100 poisson=0.3",
            "parameter cfl      = 2.5        ! Courant number",
        ],
        [],
    ),
    "title_92": (["mpm3d cards", "mpm3d **~" + 91 * "t"], ['title "~' + 91 * "t" + '"'], []),
    "title_93": (["mpm3d cards", "mpm3d " + "t t" + 90 * "t"], ["title &", '  "t t' + 90 * "t" + '"'], []),
    # Three corners of a square; particles of two masses; two at one place; one off the lattice along one axis: no
    # blocks.
    "points": (
        [
            "nbbo 1",
            "nbbo 4",
            "nbmp 8",
            "nbmp 18",
            "elas 1 ",
            "elas 1e-6 ",
            PART,
            "part point 1 3\n1 1 1e-6 1 1 1\n2 1 1e-6 2 1 1\n3 1 1e-6 1 2 1\npart point 1 8\n"
            + "".join(
                f"{n + 1} 1 {(1, 0.9, 1.1, 1)[n % 4]}e-6 {1 + n % 2} {1 + n // 2 % 2} {1 + n // 4}\n" for n in range(8)
            )
            + "part point 1 4\n1 1 1e-6 2 1 1\n2 1 1e-6 2 1 1\n3 1 1e-6 1 2 1\n4 1 1e-6 2 2 1\n"
            + "part point 1 3\n1 1 1e-6 1 1 1\n2 1 1e-6 2.3 1 1\n3 1 1e-6 3 1 1\n",
        ],
        [f'body body_{n} file file="points_body_{n}.txt" material=material_1 overlap=allow' for n in range(1, 5)],
        [],
    ),
    "lattice": (
        ["elas 1 ", "elas 2 ", "nbmp 8", "nbmp 24", PART, "part point 1 24\n" + LATTICE],
        [
            "body body_1 block lower=(1,1,1) upper=(3,2.5,2) material=material_1 spacing=spacing",
            "parameter spacing  = 0.5        ! distance of particles",
        ],
        ["body 1 (poin, 24 particles): a block, for its particles are"],
    ),
    # Particles 5 and 8 of the first body, 9 and 16 of the second; 18 is of none.
    "gauges": (
        [
            "nbbo 1",
            "nbbo 2",
            "nbmp 8",
            "nbmp 20",
            PART,
            PART + "part block 1 1 1.0 0.5 3 3 3 2 2 2\n",
            "endi",
            "curv pres 5\ncurv stsx 8\ncurv epef 5\ncurv pres 16\ncurv pres 9\ncurv pres 18\ncurv mat\ncurx pres 1 "
            "2 3\ncurx seqv 3 2 1\nendi",
        ],
        [
            "gauge particle_5 point=(1.5,1.5,2.5)", "gauge particle_8 point=(2.5,2.5,2.5)",
            "gauge particle_9 point=(3.25,3.25,3.25)", "gauge particle_16 point=(3.75,3.75,3.75)",
            "gauge particle_1 point=(1.5,1.5,1.5)", "gauge point_1 point=(1,2,3)", "gauge point_2 point=(3,2,1)",
            "!gauge particle_18",
            "body body_1 block lower=(1,1,1) upper=(3,3,3) material=material_1 spacing=1 overlap=allow",
            "body body_2 block lower=(3,3,3) upper=(4,4,4) material=material_1 spacing=0.5 overlap=allow",
            "!parameter spacing", "output csv at=end fields=pressure,stress,plastic_strain,von_mises",
        ],
        [
            ":13:6: honoured: pres: field pressure; a gauge: gauges.csv",
            ":14:6: approximated: stsx: field stress of the files of particles; gauges.csv has it not",
            ":19:6: approximated: mat: files have the number of the body instead of that of the material\n",
            ":5:1: approximated: nbmp: the bodies have 16 particles, not 20",
        ],
    ),
    # Beyond x+ and z-, which are free, beside walls at y- and z+.
    "beyond": (
        [
            "nbbo 1", "nbbo 2", "nbmp 8", "nbmp 16", "endi", "fixed 0 0 2 0 0 1\nendi", PART,
            "part block 1 1 1.0 1 3 1 1 2 2 2\npart block 1 1 1.0 1 1 1 -1 2 2 2\n",
        ],
        ["grid cell=h x=0:open y=0:4 z=open:4", "wall y-=slip z+=fixed shift=none", "lost remove  ! through x- y+"],
        [
            ":11:1: approximated: particle: there are particles beyond the free face x+",
            ":12:1: approximated: particle: there are particles beyond the free face z-",
        ],
    ),
    "metal": (
        [
            "nmat 1", "nmat 2", "nbbo 1", "nbbo 2", "nbmp 8", "nbmp 16", "elas 1 100 0.3",
            "sjc 2 100 0.3 10 0 0.5 0.02 3\n2 sjc 2 100 0.3 10 0.5 0.6 0 1", PART,
            PART + "part block 1 2 1.0 1 1 1 1 2 2 2\n", "endi", "seos 1 4 3 endi",
        ],
        [
            "material material_1 johnson_cook density=2 young=100 poisson=0.3 yield=10 rate_coefficient=0.02 &",
            "  reference_rate=3", "eos material_1 polynomial a1=18",
            "material material_2 johnson_cook density=2 young=100 poisson=0.3 yield=10 hardening_modulus=0.5 &",
            "  hardening_exponent=0.6",
        ],
        [],
    ),
    "elastic": (
        ["endi", "seos 1 1 0 1 0 0 0 0 0 0 endi"],
        ["!eos"],
        [":12:1: approximated: seos: left out: elas has its pressure from its moduli"],
    ),
    "water": (
        ["elas 1 100 0.3", "null 1 100 0", "endi", "seos 1 4 2 bulk 0 0.3 endi"],
        ["eos material_1 polynomial a1=100", "viscosity material_1 quadratic=0 linear=0.3"], [],
    ),
    "contact": (
        [
            "nbco 1", "nbco 2", "nbbo 1", "nbbo 3", "nbmp 8", "nbmp 24", PART,
            PART.replace("block 1", "block 2") + PART + PART, "endi", "cont lagr 0.3 2 endi",
        ],
        [
            "group component_1 body_2,body_3", "contact component_1 body_1 friction=0.3 normal=second",
            "!contact body_2 body_3", "!contact body_3 body_2",
        ],
        [],
    ),
    "loads": (
        ["endi", "load grav 1 0.5 0.5 -0.5 body 1 0.25 -0.25 0 endl endi"],
        ['bodyforce body_1 x="0.5+0.25" y="0.5-0.25" z="-0.5"'], [],
    ),
    # Particles 2 and 4 of five.
    "groups": (
        [
            "nbmp 8", "nbmp 5", PART, "part block 1 1 1.0 0.5 1 1 1 5 1 1\n", "endi",
            "load part 2 1e-9 0 0 part 4 1e-9 0 0 endl endi",
        ],
        ['bodyforce body_1_load_2 x="8e-9"'],
        [],
        {
            "body_1_load_1": [(1.25, 1.25, 1.25, 0.125), (2.25, 1.25, 1.25, 0.125), (3.25, 1.25, 1.25, 0.125)],
            "body_1_load_2": [(1.75, 1.25, 1.25, 0.125), (2.75, 1.25, 1.25, 0.125)],
        },
    ),
    # 0.3/0.1 is 3 but for round-off.
    "groups_round": (
        [
            "nbmp 8", "nbmp 3", PART, "part point 1 3\n1 1 0.1 1 1 1\n2 1 1 2 1 1\n3 1 1 3 1 1\n", "endi",
            "load part 1 0.3 0 0 part 2 3 0 0 endl endi",
        ],
        ['bodyforce body_1_load_1 x="3"'],
        [],
        {"body_1_load_1": [(1, 1, 1, 0.1), (2, 1, 1, 1)], "body_1_load_2": [(3, 1, 1, 1)]},
    ),
    "groups_20": (
        [
            "nbmp 8", "nbmp 20", PART, "part block 1 1 1.0 1 1 1 1 20 1 1\n", "endi",
            "load " + " ".join(f"part {n} {n}e-7 0 0" for n in range(1, 21)) + " endl endi",
        ],
        [
            f'bodyforce body_1_load_{n} x="{n / 1e7:.12g}"'.replace("e-07", "e-7").replace("e-06", "e-6")
            for n in range(1, 21)
        ],
        [],
    ),
    # The built-in wave is of body 1 alone.
    "wave_2": (
        ["nbbo 1", "nbbo 2", "nbmp 8", "nbmp 16", PART, PART + PART, "endi", "velo ksin 0.5 2 endv endi"],
        [
            f"body body_{n} block lower=(1,1,1) upper=(3,3,3) material=material_1 spacing=spacing overlap=allow"
            for n in (1, 2)
        ]
        + ["!velocity"],
        [],
    ),
    "corners": (
        ["nbmp 8", "nbmp 4", PART, "part blod 1 1 1.0 0.5 1 1 1 6 6 1 2.5 2.5 0 3\n"],
        [
            "body body_1 block lower=(1,1,1) upper=(4,4,1.5) material=material_1 spacing=spacing fit=cubes",
            "subtract body_1 cylinder centre=(2.5,2.5,1) radius=1.5 axis=(0,0,1) length=0.5",
        ],
        [":5:1: honoured: nbmp: 4 particles", "body 1 (blod, 4 particles): a block with a hole"],
    ),
    # Eight by eight particles but the four about (0.002, 0.004), in layers from 0.001 on.
    "hole": (
        [
            "grid 0 4 0 4 0 4", "grid 0 0.01 0 0.01 0 0.01", "dcell 1", "dcell 0.002", "nbmp 8", "nbmp 120", PART,
            "part blod 1 1 1.0 0.001 0 0 0.001 8 8 2 0.002 0.004 7 1\n",
        ],
        [
            "body body_1 block lower=(0,0,0.001) upper=(0.008,0.008,0.003) material=material_1 spacing=spacing &",
            "  fit=cubes",
            "subtract body_1 cylinder centre=(0.002,0.004,0.001) radius=0.001 axis=(0,0,1) length=0.002",
        ],
        [":5:1: honoured: nbmp: 120 particles"],
    ),
    # The first of two particles is on the edge of a hole of radius 1.
    "edge": (
        ["nbmp 8", "nbmp 2", PART, "part blod 1 1 1.0 1 2 3 1 2 1 1 1.5 3.5 1 1\n"],
        ['body body_1 file file="edge_body_1.txt" material=material_1', "!subtract"],
        ["or particles lie on the edge of the hole"],
        {"body_1": [(2.5, 3.5, 1.5, 1), (3.5, 3.5, 1.5, 1)]},
    ),
    "ball": (
        ["nbmp 8", "nbmp 8", PART, "part sphere 1 1 1.0 1 2 1 2 1\n"],
        ["body body_1 sphere centre=(2,1,2) radius=1 material=material_1 spacing=spacing fit=cubes"],
        [":5:1: honoured: nbmp: 8 particles"],
    ),
    "one": (
        ["nbmp 8", "nbmp 1", PART, "part block 1 1 1.0 1 1 1 1 1 1 1\n"],
        ["body body_1 block lower=(1,1,1) upper=(2,2,2) material=material_1 spacing=spacing"],
        [":5:1: honoured: nbmp: 1 particles"],
    ),
    # One disc on the other: each differs from the one below it in one thing - place, radius, spacing, velocity, force,
    # gravity -, the last in nothing.
    "discs": (
        [
            "grid 0 4 0 4 0 4",
            "grid -4 4 -4 4 0 4",
            "nbbo 1",
            "nbbo 8",
            "nbmp 8",
            "nbmp 1000",
            PART,
            "part cicl 1 1 1.0 0.5 0 1 0 4\npart cicl 1 1 1.0 0.5 0.5 1 0.5 4\npart cicl 1 1 1.0 0.5 0.5 1 1 "
            "3\npart cicl 1 1 1.0 0.25 0.5 1 1.5 6\n"
            + "".join(f"part cicl 1 1 1.0 0.25 0.5 1 {1.75 + 0.25 * n} 6\n" for n in range(4)),
            "endi",
            "velo "
            + " ".join(f"body {n} 0 0 0.5" for n in range(5, 9))
            + " endv\nload "
            + " ".join(f"body {n} 0.0078125 0 0" for n in (6, 7, 8))
            + " grav 7 0 0 -0.5 grav 8 0 0 -0.5 endl endi",
        ],
        [
            "body body_1 cylinder centre=(0,1,0) radius=2 axis=(0,0,1) length=0.5 material=material_1 &",
            "body body_2 cylinder centre=(0.5,1,0.5) radius=2 axis=(0,0,1) length=0.5 material=material_1 &",
            "body body_3 cylinder centre=(0.5,1,1) radius=1.5 axis=(0,0,1) length=0.5 material=material_1 &",
            "body body_4 cylinder centre=(0.5,1,1.5) radius=1.5 axis=(0,0,1) length=0.25 material=material_1 &",
            "body body_5 cylinder centre=(0.5,1,1.75) radius=1.5 axis=(0,0,1) length=0.25 material=material_1 &",
            "body body_6 cylinder centre=(0.5,1,2) radius=1.5 axis=(0,0,1) length=0.25 material=material_1 &",
            "body bodies_7_to_8 cylinder centre=(0.5,1,2.25) radius=1.5 axis=(0,0,1) length=0.5 &",
            "velocity body_5 z=0.5", 'bodyforce body_6 x="0.5"', 'bodyforce bodies_7_to_8 x="0.5" z="-0.5"',
            "!velocity body_4",
        ],
        [f":5:1: approximated: nbmp: the bodies have {2 * 52 + 32 + 5 * 112} particles"],
    ),
    # One cell in every direction; and what keeps a direction though it is one cell thick, or does not.
    "cell": (
        [
            "grid 0 4 0 4 0 4", "grid 0 1 2 3 4 5", PART, "part block 1 1 1.0 0.5 0 2 4 2 2 2\n", "endi",
            "fixed 2 2 2 2 2 2\nendi",
        ],
        [
            "dimension 1", "grid cell=h x=0:1", "wall x-=slip x+=slip shift=none",
            "body body_1 block lower=0 upper=1 material=material_1 spacing=spacing",
        ],
        [
            "one cell thick between planes of symmetry along y z: solved in fewer dimensions (uniaxial strain); "
            "masses and energies here are those there over 1"
        ],
    ),
    "thin_ball": (
        [
            "grid 0 4 0 4 0 4", "grid 0 4 0 4 0 1", "nbmp 8", "nbmp 32", PART, "part sphere 1 1 1.0 0.25 2 2 0.5 2\n",
            "endi", "fixed 0 0 0 0 2 2\nendi",
        ],
        ["dimension 3"],
        [
            "the direction z, one cell thick between planes of symmetry, is kept: rows differ along it",
            ":5:1: honoured: nbmp: 32 particles",
        ],
    ),
    "thin_hole": (
        [
            "grid 0 4 0 4 0 4", "grid 0 4 0 1 0 4", "nbmp 8", "nbmp 16", PART,
            "part blod 1 1 1.0 0.5 1 0 1 4 2 2 -9 -9 0 1\n", "endi", "fixed 0 0 2 2 0 0\nendi",
        ],
        ["dimension 3"],
        ["the direction y, one cell thick between planes of symmetry, is kept: rows differ along it"],
    ),
    "thin_points": (
        [
            "grid 0 4 0 4 0 4",
            "grid 0 4 0 4 0 1",
            PART,
            "part point 1 8\n"
            + "".join(
                f"{n + 1} 1 0.125 {1.25 + n % 2 / 2} {1.25 + n // 2 % 2 / 2} {0.25 + n // 4 / 2}\n" for n in range(8)
            ),
            "endi",
            "fixed 0 0 0 0 2 2\nload part 5 0.05 0 0 endl endi",
        ],
        ["dimension 3"],
        ["the direction z, one cell thick between planes of symmetry, is kept: rows differ along it"],
    ),
    # The first particle of the second layer is pushed.
    "thin_block": (
        [
            "grid 0 4 0 4 0 4", "grid 0 4 0 4 0 1", "nbmp 8", "nbmp 16", PART, "part block 1 1 1.0 0.5 1 1 0 4 2 2\n",
            "endi", "fixed 0 0 0 0 2 2\nload part 9 0.05 0 0 endl endi",
        ],
        ["dimension 3"],
        ["the direction z, one cell thick between planes of symmetry, is kept: rows differ along it"],
    ),
    # The first particles of both layers are: a file has one of the two, with the volume of both over the thickness of
    # 1.
    "thin_file": (
        [
            "grid 0 4 0 4 0 4", "grid 0 4 0 4 0 1", "nbmp 8", "nbmp 16", PART, "part block 1 1 1.0 0.5 1 1 0 4 2 2\n",
            "endi", "fixed 0 0 0 0 2 2\nload part 1 0.0625 0 0 part 9 0.0625 0 0 endl endi",
        ],
        ["dimension 2", 'bodyforce body_1_load_1 x="0.5"'],
        [],
        {
            "body_1_load_2": [(1.25 + 0.5 * i, 1.25 + 0.5 * j, 0, 0.25) for j in range(2) for i in range(4) if i + j],
            "body_1_load_1": [(1.25, 1.25, 0, 0.25)],
        },
    ),
    # A volume of 0.5 whose nearest neighbour is 0.5 away: 2 thick.
    "thin_three": (
        [
            "grid 0 4 0 4 0 4", "grid 0 4 0 4 0 1", "nbmp 8", "nbmp 3", PART,
            "part point 1 3\n1 1 0.5 1 1 0.5\n2 1 0.5 1.5 1 0.5\n3 1 0.5 1 2 0.5\n", "endi", "fixed 0 0 0 0 2 2\nendi",
        ],
        ["dimension 2"],
        ["masses and energies here are those there over 2"],
        {"body_1": [(1, 1, 0, 0.25), (1.5, 1, 0, 0.25), (1, 2, 0, 0.25)]},
    ),
    "sines": (
        ["nbmp 8", "nbmp 2", PART, "part point 1 2\n1 1 1 1 1 1\n2 1 2 2 2 2\n", "endi", "velo vsin 0.5 endv endi"],
        [],
        [],
        {"body_1": [(1, 1, 1, 1, 0.5 * math.sin(math.pi / 6), 0, 0), (2, 2, 2, 2, 0.5 * math.sin(math.pi / 3), 0, 0)]},
    ),
    # The wave is counted along rows of 320: the second row of four goes on where the first one ends.
    "wave": (
        [
            "nbmp 8", "nbmp 8", PART, "part block 1 1 1.0 0.003125 0 0 0 4 2 1\n", "dcell 1", "dcell 0.5", "endi",
            "velo ksin 1e-5 1 endv endi",
        ],
        [],
        [],
        {
            "body_1": [
                (
                    0.003125 * (i + 0.5), 0.003125 * (j + 0.5), 0.0015625, 0.003125**3,
                    1e-5 * math.sin(math.pi * 0.003125 * (i + 4 * j + 0.5)), 0, 0,
                )
                for j in range(2)
                for i in range(4)
            ]
        },
    ),
}


def free_beam(x):
    """Velocity of the first mode of a free beam, 0.06 m long and 0.01 m high, of beryllium, of unit deflection, with
    the numbers of MPM3D."""
    k, length = 78.83, 0.06
    omega = k**2*math.sqrt(318e9*0.01**2/(12*1845*(1 - 0.054**2)))
    ratio = (math.cosh(k*length) - math.cos(k*length))/(math.sinh(k*length) - math.sin(k*length))
    return omega/2*(ratio*(math.sinh(k*x) + math.sin(k*x)) - math.cosh(k*x) - math.cos(k*x))


def near(text, expected):
    """Whether numbers of a line are those expected, of which 0 is none."""
    values = [float(word) for word in text.split()]
    size = max(abs(value) for value in expected[4:]) if expected[4:] else 0
    return len(values) == len(expected) and all(
        abs(a - b) <= 1e-9 * (abs(b) if place < 4 else size) + 1e-300
        for place, (a, b) in enumerate(zip(values, expected))
    )


def table_is(text, expected):
    """Whether a particle file has these rows."""
    rows = [line for line in text.splitlines() if not line.startswith("!")]
    return len(rows) == len(expected) and all(map(near, rows, expected))


def acceptances(report):
    """Decks without a mistake: cards that the native deck has or has not, notes, rows of particles."""
    for name, (changes, cards, notes, *tables) in BECOMES.items():
        code, printed, files = imported(name, changed(changes))
        if not report.check(code == 0, f"{name}: {code} {printed}"):
            continue
        deck, note = files[name + ".inp"], files[name + ".import.txt"]
        lines = deck.splitlines()
        for card in cards:
            if card.startswith("!"):
                report.check(not any(line.startswith(card[1:]) for line in lines), f"{name}: '{card[1:]}' in\n{deck}")
            else:
                report.check(lines.count(card) == 1, f"{name}: not once '{card}' in\n{deck}")
        for words in notes:
            report.check(words in note, f"{name}: no '{words}' in\n{note}")
        for body, rows in (tables[0] if tables else {}).items():
            report.check(table_is(files.get(f"{name}_{body}.txt", ""), rows), f"{name}: {files}, not {rows}")


# Slope, size and dilatancy of a cone, tension cut-off; whether that lies within the cone.
SOILS = [(0.5, 0.5, 0.25, 0.5, True), (0.5, 0.5, 0.1, 2, False), (0.3, 0, 0, 1, False), (1.7, 0.25, 1.6, 0.1, True)]


def soils(report):
    """Drucker and Prager's cone, sqrt(J2) + q s <= k: by the stress states on its compressive edge, s1 = s2 > s3
    (tension is positive), on which it must be Mohr and Coulomb's, s1 - s3 + (s1 + s3) sin = 2 c cos."""
    for number, (slope, size, dilatancy, tension, cut) in enumerate(SOILS):
        code, printed, files = imported(
            f"soil_{number}", changed(["elas 1 100 0.3", f"dpm 1 100 0.3 {slope} {size} {dilatancy} {tension}"])
        )
        if not report.check(code == 0, f"{SOILS[number]}: {code} {printed}"):
            continue
        card = " ".join(files[f"soil_{number}.inp"].split())
        key = {
            name: float(value) for name, value in re.findall(r"(friction|dilatancy|cohesion|tension)=([-+.\de]+)", card)
        }
        report.check(("tension" in key) == cut and key.get("tension", tension) == tension, f"{SOILS[number]}: {card}")
        sine, cosine = math.sin(math.radians(key["friction"])), math.cos(math.radians(key["friction"]))
        for mean in (-3.0, -1.0):
            deviator = math.sqrt(3)*(size - slope*mean)  # s1 - s3
            above, below = mean + deviator/3, mean - 2*deviator/3
            report.check(
                abs(above - below + (above + below) * sine - 2 * key["cohesion"] * cosine) < 1e-9,
                f"{SOILS[number]}: not on the cone at {mean}: {card}",
            )
        sine = math.sin(math.radians(key["dilatancy"]))
        report.check(abs(6*sine/(math.sqrt(3)*(3 - sine)) - dilatancy) < 1e-9, f"{SOILS[number]}: dilatancy in {card}")


def built_in(report):
    """The beam's velocities in a particle file, for its particles are not where the beam is: rows of 384 are
    counted."""
    spacing = 0.00015625
    code, printed, files = imported(
        "beam",
        changed(
            [
                "elas 1 100 0.3", "elas 1845 318e9 0.054", "nbmp 8", "nbmp 400", PART,
                f"part block 1 1 1845 {spacing} 1 1 1 400 1 1\n", "endi", "velo nuli 0.0005 endv endi",
            ]
        ),
    )
    expected = [
        (
            1 + spacing * (i + 0.5), 1 + spacing / 2, 1 + spacing / 2, spacing**3, 0,
            0.0005 * free_beam(spacing * (i % 384 + 0.5)), 0,
        )
        for i in range(400)
    ]
    report.check(code == 0 and table_is(files.get("beam_body_1.txt", ""), expected), f"beam: {code} {printed}")


def names(report):
    """Names of decks that are short, long, or all suffix; files that cannot be written."""
    three = changed([PART, "part point 1 3\n1 1 1 1 1 1\n2 1 1 2 1 1\n3 1 1 1 2 1\n"])
    code, printed, files = imported(62*"s", three)
    report.check(
        code == 0
        and 'body body_1 file file="' + 62 * "s" + '_body_1.txt" &\n  material=material_1\n'
        in files[62 * "s" + ".inp"],
        f"a long name: {files}",
    )
    code, printed, files = imported("a", three)
    report.check(
        code == 0 and sorted(files) == ["a.import.txt", "a.inp", "a_body_1.txt"],
        f"a short name: {code} {printed} {files}",
    )
    hidden = os.path.join(SCRATCH, ".mpm")
    with open(hidden, "w", encoding="utf-8") as file:
        file.write(three)
    shutil.rmtree(os.path.join(SCRATCH, "hidden"), ignore_errors=True)
    code, printed = run_import(hidden, os.path.join(SCRATCH, "hidden"))
    report.check(
        code == 0 and os.path.exists(os.path.join(SCRATCH, "hidden", ".mpm.inp")), f"no name: {code} {printed}"
    )
    for name in (".mpm", "x.mp", "xmpm"):
        with open(os.path.join(SCRATCH, name), "w", encoding="utf-8") as file:
            file.write("dimension 1\n")
        done = subprocess.run(
            [SGMP, os.path.join(SCRATCH, name), "--check"], cwd=SCRATCH, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, timeout=120, check=False, env=ENVIRONMENT,
        )
        imports = b"among the keywords of MPM3D" in done.stdout
        report.check(done.returncode == 3 and imports == (name == ".mpm"), f"{name}: {done.stdout}")
    for end in ("_body_1.txt", ".import.txt", ".inp"):
        for part in (".part", ""):
            blocked = os.path.join(SCRATCH, f"out{end}{part}")
            os.makedirs(os.path.join(blocked, f"three{end}{part}", "full"), exist_ok=True)
            with open(os.path.join(SCRATCH, "three.mpm"), "w", encoding="utf-8") as file:
                file.write(three)
            code, printed = run_import(os.path.join(SCRATCH, "three.mpm"), blocked)
            report.check(
                code == 5 and f"three{end}" in printed, f"three{end}{part} cannot be written: {code} {printed}"
            )
    code, printed = run_import(os.path.join(SCRATCH, "three.mpm"), os.path.join(SCRATCH, "three.mpm"))
    report.check(code == 5 and "make directory" in printed, f"a file for a folder: {code} {printed}")


def main():
    report = Report()
    refusals(report)
    acceptances(report)
    soils(report)
    built_in(report)
    names(report)
    report.end()


main()
