#!/usr/bin/env python3
"""Random scenes by seed: all dimensions, methods, updates, materials, contact, walls, rigid bodies. Each is run with one and two threads, on two
ranks and from a checkpoint; then

* the same exit code, bits, histories and verdict in all of them;
* exit code 0, or 4 with a failure in words; never a crash or a hang;
* the identity of kinetic energy (energy.remainder) to round-off, no mass lost, momentum as the forces have it;
* a run that is called sound has not made energy.

usage: scenes.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S]     N scenes of the seeds S, S+1, …
       scenes.py SGMP SOURCE_DIR SCRATCH_DIR --show S                    the deck of one
"""
import csv
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys

from _driver import CRASH, Findings, arguments

FINISHED, WRONG_DECK, NUMERICAL = 0, 3, 4
CELLS = {1: 8, 2: 4, 3: 3}            # of a body along an axis, at most
STEPS = {1: 120, 2: 60, 3: 24}
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
               "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_WAIT_POLICY": "passive", "SGMP_THREADS": "exact"}

MATERIALS = {
    "elastic": "material {name} elastic density={density} young={young} poisson={poisson}",
    "neo_hookean": "material {name} neo_hookean density={density} young={young} poisson={poisson}",
    "j2": "material {name} j2 density={density} young={young} poisson={poisson} yield={weak} hardening=linear hardening_modulus={young}/20",
    "johnson_cook": "material {name} johnson_cook density={density} young={young} poisson={poisson} yield={weak} hardening_modulus={young}/20 "
                    "hardening_exponent=0.5 rate_coefficient=0.02 reference_rate=0.01 thermal=yes melt_temperature=1000 specific_heat=0.01\n"
                    "eos {name} gruneisen c0=sqrt({young}/{density}) s=1.5 gamma0=2",
    "explosive": "material {name} explosive density={density} detonation_speed=3\n"
                 "eos {name} jwl a=371.2 b=3.2 r1=4.15 r2=0.95 omega=0.3 energy0=7\ndetonation point=(0,0,0)",
}


class Scene:
    """A deck made of random choices, and what is known of it."""

    def __init__(self, seed):
        self.luck = random.Random(seed)
        self.dimension = self.luck.choice((1, 2, 2, 2, 3))
        self.steps = STEPS[self.dimension]
        self.method = self.luck.choice(("sgmp", "sgmp", "sgmp", "gimp", "mpm", "cpgimp", "bspline"))
        self.update = self.luck.choice(("musl", "musl", "usf", "usl", "usavg"))
        self.walls = self.rigid = self.carried = self.removes = False
        self.split = random.Random(f"split {seed}").random() < 0.3  # of its own, so that scenes of old seeds stay what they were
        self.gravity, self.bodyforce = 0.0, False
        self.kinds = []
        self.lines = [f"dimension {self.dimension}"]
        self.space()
        self.discretisation()
        self.bodies()
        self.loads()
        self.lines += ["output csv at=end fields=mass,stress,density", "history steps=1", f"checkpoint every={self.steps//3} keep=9"]

    def text(self):
        """The deck."""
        return "\n".join(self.lines) + "\n"

    def space(self):
        """A box, closed or open, and its walls."""
        words, walls = ["grid cell=1"], []
        for axis in "xyz"[:self.dimension]:
            closed = self.luck.random() < 0.5
            size = 3*CELLS[self.dimension] + 6
            words.append(f"{axis}=0:{size}" if closed else f"{axis}=open")
            for side in "-+" if closed else "":
                kind = self.luck.choice(("slip", "fixed", "free"))
                walls.append(f"{axis}{side}={kind}")
                self.walls = self.walls or kind != "free"
        self.lines.append(" ".join(words))
        if walls:
            policy = self.luck.choice(("remove", "reflect"))
            self.removes = policy == "remove"
            self.walls = self.walls or policy == "reflect"
            self.lines += ["wall " + " ".join(walls), f"lost {policy}"]

    def discretisation(self):
        """Method, update and step."""
        words = [f"method {self.method} update={self.update}"]
        if self.method == "sgmp":
            extra = self.luck.choice(("", "", " rotation=exact", " stress=normalised", " spin=carried"))
            if extra == " spin=carried" and (self.update != "musl" or self.dimension == 1):
                extra = ""
            self.carried = extra == " spin=carried"
            words.append(extra)
        if self.update != "usf" and self.split:
            words.append(" split=1")
        self.lines.append("".join(words))
        self.lines.append(f"time cfl={self.luck.choice(('0.2', '0.3', '0.4', 'auto'))} steps={self.steps}")

    def material(self, name):
        """One of the kinds, with soft and stiff, light and heavy constants."""
        kind = self.luck.choice(list(MATERIALS) if self.luck.random() < 0.3 else list(MATERIALS)[:4])
        young = self.luck.choice((1, 10, 100))
        numbers = {"name": name, "density": self.luck.choice((0.5, 1, 4)), "young": young, "poisson": self.luck.choice((0, 0.25, 0.3, 0.45)),
                   "weak": young*self.luck.choice((0.003, 0.03))}
        text = MATERIALS[kind].format(**numbers)
        if "detonation" in text and any("detonation point" in line for line in self.lines):
            text = text[:text.rindex("\n")]
        self.kinds.append(kind)
        self.lines += text.split("\n")
        if self.luck.random() < 0.2:
            self.lines.append(f"viscosity {name}")

    def bodies(self):
        """One to three in a row along the last axis, touching or not."""
        number = self.luck.choice((1, 2, 2, 3))
        for b in range(number):
            self.material(f"m{b}")
        height = 3.0 if self.luck.random() < 0.5 else 0.0
        names = []
        for b in range(number):
            size = [self.luck.randint(1, CELLS[self.dimension]) for _ in range(self.dimension)]
            lower = [self.luck.choice((2.0, 3.0, 2.5, 2.3)) for _ in range(self.dimension)]
            lower[-1] = height
            layout = self.luck.choice(("ppc=2", "ppc=2", "ppc=1", "ppc=3", "spacing=0.45", "ppc=2 jitter=0.3", "layout=gauss ppc=2"))
            if self.dimension == 3:
                layout = self.luck.choice(("ppc=2", "ppc=1", "ppc=2 jitter=0.3"))
            names.append(f"b{b}")
            if self.dimension > 1 and self.luck.random() < 0.25:
                radius = size[-1]/2
                centre = [low + radius for low in lower]
                shape = (f"sphere centre={vector(centre)} radius={radius}" if self.luck.random() < 0.5 or self.dimension == 3 else
                         f"ring centre={vector(centre)} axis=(0,0,1) radius={radius} inner={radius}/2")
            else:
                shape = f"block lower={vector(lower)} upper={vector([low + s for low, s in zip(lower, size)])}"
            self.lines.append(f"body b{b} {shape} material=m{b} {layout}")
            height += size[-1] + self.luck.choice((0, 0, 0.1, 1.5))
        if number > 1 and self.luck.random() < 0.7:
            self.lines.append(f"contact all friction={self.luck.choice((0, 0.3, 10))}")
            if self.luck.random() < 0.3:
                self.rigid = True
                speed = self.luck.choice(('0', '0.1', '"0.2*sin(t)"'))
                self.lines.append(f"rigid {self.luck.choice(names)} {'xyz'[self.dimension - 1]}={speed}")

    def loads(self):
        """Velocities, gravity, forces."""
        axes = "xyz"[:self.dimension]
        speed = self.luck.choice((0.01, 0.1, 0.5))
        words = [f'{axis}="{speed}*{self.luck.choice(("1", "-1", "sin(x)", "cos(x+1)", "0"))}"' for axis in axes]
        self.lines.append("velocity all " + " ".join(words))
        if self.luck.random() < 0.3:
            self.gravity = -0.02
            self.lines.append("gravity " + vector([0.0]*(self.dimension - 1) + [self.gravity]))
        if self.luck.random() < 0.15:
            self.bodyforce = True
            self.lines.append(f'bodyforce all {axes[-1]}="0.01*sin(x0)*cos(t)"')

    def free(self):
        """Whether nothing from outside acts but gravity."""
        return not (self.walls or self.rigid or self.bodyforce or self.removes)


def vector(components):
    """Components as a deck writes them."""
    return "(" + ",".join(f"{component:g}" for component in components) + ")"


class Result:
    """The end of a run."""

    def __init__(self, code, printed, folder):
        self.code, self.printed, self.folder, self.summary = code, printed, folder, {}
        path = os.path.join(folder, "summary.json")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                self.summary = json.load(file)

    def table(self, name):
        """Rows of a file of columns."""
        with open(os.path.join(self.folder, name), encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        return [{key: real(value) for key, value in row.items()} for row in rows]

    def content(self, name):
        """Bytes of a file, none where it is not there."""
        path = os.path.join(self.folder, name)
        if not os.path.exists(path):
            return b""
        with open(path, "rb") as file:
            return file.read()


def real(text):
    """A number; Fortran leaves the E out of exponents of three digits."""
    return float(re.sub(r"(\d)([+-]\d{3})$", r"\1E\2", text))


def run(chosen, deck, name, launcher=(), threads=1, options=()):
    """Runs a deck in a folder of its own, which a restart keeps."""
    folder = os.path.join(chosen.scratch, name)
    if not options:
        shutil.rmtree(folder, ignore_errors=True)
    environment = dict(ENVIRONMENT)
    if not launcher:
        environment["OMPI_MCA_ess_singleton_isolated"] = "1"
    try:
        done = subprocess.run([*launcher, chosen.sgmp, deck, "--quiet", "--threads", str(threads), "--output", folder, *options],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment, timeout=600, check=False)
    except subprocess.TimeoutExpired:
        return Result(-14, "hang", folder)
    return Result(done.returncode, done.stdout.decode("utf-8", "replace"), folder)


def end_problems(result):
    """How a run may end."""
    if result.code == -14:
        yield "hang"
    elif result.code not in (FINISHED, NUMERICAL) or CRASH.search(result.printed):
        yield f"exit code {result.code}"
    elif not result.summary:
        yield "no summary.json"
    elif result.code == NUMERICAL and not result.summary.get("failure"):
        yield "a failure without words"


def layout_problems(first, other, title):
    """Two runs that must be one."""
    if first.code != other.code:
        yield f"{title}: exit code {other.code} instead of {first.code}"
        return
    for key in ("checksum", "steps", "verdict", "verdict_reasons"):
        if first.summary.get(key) != other.summary.get(key):
            yield f"{title}: {key} {other.summary.get(key)} instead of {first.summary.get(key)}"
            return
    for name in ("history.csv", "contact.csv", "bodies.csv", "particles_end.csv"):
        if first.content(name) != other.content(name):
            yield f"{title}: {name} differs"
            return


def physics_problems(scene, result):
    """What holds whatever the scene is."""
    rows, energy = result.table("history.csv"), result.summary["energy"]
    supplied = max(max(abs(row[key]) for row in rows) for key in ("kinetic_energy", "internal_energy", "external_work"))
    if not scene.carried and abs(energy["remainder"]) > 1e-10*max(supplied, 1e-300):
        yield f"the ledger misses {energy['remainder']/supplied:.1e} of the energy"
    particles = result.table("particles_end.csv")
    if any(not math.isfinite(value) for row in particles for value in row.values()):
        yield "a number that is none"
    if len(particles) != result.summary["particles"]:
        yield f"{len(particles)} particles in the file, {result.summary['particles']} in the summary"
    if not scene.removes and result.summary["particles_lost"]:
        yield "particles lost where none may"
    yield from momentum_problems(scene, rows, particles)
    if result.summary["verdict"] == "sound" and result.code == FINISHED:
        made = rows[-1]["total_energy"] + rows[-1]["contact_dissipation"] - rows[0]["total_energy"] - rows[-1]["external_work"]
        if made > 0.06*max(max(row["external_work"] + rows[0]["total_energy"] for row in rows), 1e-300):
            yield f"called sound with an energy of {made:.3g} from nowhere"


def momentum_problems(scene, rows, particles):
    """Nothing from outside: momentum stays; gravity: it grows by weight and time."""
    if not scene.free() or scene.rigid:
        return
    mass = sum(row["mass"] for row in particles)
    scale = max(max(math.sqrt(2*mass*row["kinetic_energy"]) for row in rows), 1e-30)
    axes = "xyz"[:scene.dimension]
    for axis in axes:
        key = f"momentum_{axis}"
        weight = mass*scene.gravity if axis == axes[-1] else 0.0
        wrong = max(abs(row[key] - rows[0][key] - weight*row["time"]) for row in rows)
        if wrong > 1e-10*scale + 1.01*abs(weight)*max(row["dt"] for row in rows):
            yield f"momentum along {axis} wrong by {wrong/scale:.1e}"


def problems(chosen, scene, deck):
    """Everything wrong with a scene, and how it ended."""
    first = run(chosen, deck, "first")
    if first.code == WRONG_DECK:
        return first, []
    found = list(end_problems(first))
    if found:
        return first, found
    if first.code == FINISHED:
        found += physics_problems(scene, first)
    found += layout_problems(first, run(chosen, deck, "threads", threads=2), "two threads")
    found += layout_problems(first, run(chosen, deck, "ranks", ["mpirun", "-n", "2"]), "two ranks")
    middle = os.path.join(chosen.scratch, "first", f"checkpoint_{scene.steps//3:07d}.h5")
    if os.path.exists(middle):
        copy = os.path.join(chosen.scratch, "restarted")
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(os.path.join(chosen.scratch, "first"), copy)
        again = run(chosen, deck, "restarted", threads=2, options=["--restart", os.path.join(copy, os.path.basename(middle))])
        found += layout_problems(first, again, "restart")
    return first, found


def main():
    """So many scenes from a seed on."""
    if "--show" in sys.argv:
        sys.exit(print(Scene(int(sys.argv[sys.argv.index("--show") + 1])).text()))
    chosen = arguments(__doc__, 12)
    findings, codes = Findings(chosen.scratch), {}
    deck = os.path.join(chosen.scratch, "scene.inp")
    for seed in range(chosen.seed, chosen.seed + chosen.inputs):
        scene = Scene(seed)
        with open(deck, "w", encoding="ascii") as file:
            file.write(scene.text())
        result, found = problems(chosen, scene, deck)
        word = f"{result.code} {result.summary.get('verdict', 'refused')}"
        codes[word] = codes.get(word, 0) + 1
        for problem in found:
            findings.add(problem, f"scene_{seed}.inp", scene.text().encode(), result.printed)
    findings.end(chosen.inputs, "scenes", chosen.seed, codes)


main()
