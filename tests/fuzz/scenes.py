#!/usr/bin/env python3
"""Random scenes by seed: all dimensions, axisymmetric ones with and without swirl, methods, updates, materials,
contact, walls, rigid bodies. Three of five scenes have features beyond these: fluids, soils, failure, softening,
scatter, erosion, turned shapes, rows and polygons, rigid bodies that turn or are free, initial rotation, damping, loads
that rise, ends at rest. Four of five scenes of the seeds from 40000000 on draw what came last, too: the materials and
loads of _latest.py, tables, walls that move, particle files; of those from 80000000 on four of five what is in
_newest.py: ceramics, more shapes, gauges, and keys that no other scene has; of those from 120000000 on what is in
_further.py: parts that are moved, walls that rub or let waves out, foam, spall, all words of `method sgmp`; of those
from 160000000 on concrete; of those from 200000000 on what is in _laws.py: tables as equations of state, afterburn,
damage that knows the stress, flaws, averaged strain; of those from 240000000 on bodies that may touch themselves, all
of which are too small to do so, and nine of ten scenes that may have grids with unequal cells; of those from 280000000
on what turns about the axis and is rubbed, driven or read from the grid, walls that move beside damping, Gauss points
of unequal cells, erosion by the step with any update; of those from 299000000 on the mass of the nodes. Each is run
with one and two threads, on two ranks and from a checkpoint; then

* the same exit code, bits, histories and verdict in all of them;
* exit code 0, or 4 with a failure in words; never a crash or a hang;
* the identity of kinetic energy (energy.remainder) to round-off, no mass lost but what is booked, momentum as forces,
  damping and erosion have it;
* a run that is called sound has not made energy.

usage: scenes.py SGMP SOURCE_DIR SCRATCH_DIR [--inputs N] [--seed S]     N scenes of the seeds S, S+1, …
       scenes.py SGMP SOURCE_DIR SCRATCH_DIR --show S                    the deck of one, its files as comments
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

import _features as features
import _further as further
import _latest as latest
import _laws as laws
import _newest as newest
from _driver import CRASH, Findings, arguments
from _features import vector

FINISHED, WRONG_DECK, NUMERICAL = 0, 3, 4
CELLS = {1: 8, 2: 4, 3: 3}            # of a body along an axis, at most
STEPS = {1: 120, 2: 60, 3: 24}
LATEST = 40000000                     # seeds below draw nothing of _latest.py
NEWEST = 80000000                     # and below these nothing of _newest.py
FURTHER = 120000000                   # and below these nothing of _further.py
CONCRETE = 160000000                  # and below these no concrete
LAWS = 200000000                      # and below these nothing of _laws.py
GRADED = 240000000                    # and below these cells are equal, and no body touches itself
MASSES = 299000000                    # and below these nothing about the mass of the nodes
JOINED = 280000000                    # and below these some features that go together are not drawn together
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1",
               "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_WAIT_POLICY": "passive", "SGMP_THREADS": "exact"}

MATERIALS = {
    "elastic": "material {name} elastic density={density} young={young} poisson={poisson}",
    "neo_hookean": "material {name} neo_hookean density={density} young={young} poisson={poisson}",
    "j2": "material {name} j2 density={density} young={young} poisson={poisson} yield={weak} hardening=linear "
          "hardening_modulus={young}/20",
    "johnson_cook": "material {name} johnson_cook density={density} young={young} poisson={poisson} yield={weak} "
                    "hardening_modulus={young}/20 hardening_exponent=0.5 rate_coefficient=0.02 reference_rate=0.01 "
                    "thermal=yes melt_temperature=1000 specific_heat=0.01\neos {name} gruneisen "
                    "c0=sqrt({young}/{density}) s=1.5 gamma0=2",
    "explosive": "material {name} explosive density={density} detonation_speed=3\n"
                 "eos {name} jwl a=371.2 b=3.2 r1=4.15 r2=0.95 omega=0.3 energy0=7\ndetonation point=(0,0,0)",
}


class Scene:
    """A deck made of random choices, and what is known of it."""

    def __init__(self, seed):
        self.seed = seed
        self.luck = random.Random(seed)
        self.dimension = self.luck.choice((1, 2, 2, 2, 3))
        self.steps = STEPS[self.dimension]
        self.method = self.luck.choice(("sgmp", "sgmp", "sgmp", "gimp", "mpm", "cpgimp", "bspline"))
        self.update = self.luck.choice(("musl", "musl", "usf", "usl", "usavg"))
        self.walls = self.rigid = self.floats = self.removes = False
        # What follows has streams of its own, so that the choices of old seeds stay what they were.
        self.split = self.stream("split").random() < 0.3
        self.rich = self.stream("rich").random() < 0.6
        self.axisymmetric = self.dimension == 2 and self.has("axisymmetric", 0.3)
        self.swirl = self.axisymmetric and self.method == "sgmp" and self.has("swirl", 0.8)
        self.flows, self.fails, self.erodes = self.has("flows", 0.4), self.has("fails", 0.4), self.has("erodes", 0.3)
        self.axes = "rz" if self.axisymmetric else "xyz"[:self.dimension]
        self.gravity, self.ramp, self.bodyforce = 0.0, 0.0, False
        self.damping, self.damped_until = 0.0, math.inf
        self.late = seed >= LATEST and self.stream("latest").random() < 0.8
        self.newer = seed >= NEWEST and self.stream("newest").random() < 0.8
        self.last = seed >= FURTHER and self.stream("further").random() < 0.8
        self.alone = self.draws("alone", 0.3)  # nothing acts from outside but forces that are known
        self.erodes = self.erodes and not self.alone
        self.table, self.files, self.fixed, self.moving = None, {}, [], False
        self.deforming, self.pushes, self.loaded = {}, [], False
        self.absorbs = self.rubs = False
        self.pair = []                    # bodies of one group
        self.joined = seed >= JOINED
        self.lines = ["dimension axisymmetric" + " swirl=yes"*self.swirl if self.axisymmetric
                      else f"dimension {self.dimension}"]
        self.tables()
        self.space()
        self.discretisation()
        self.bodies()
        self.loads()
        self.ends()
        pores = ",distention"*any(" distention=" in line for line in self.lines)
        broken = ",damage"*any(" johnson_holmquist " in line or " concrete " in line for line in self.lines)
        broken += ",averaged_strain"*any(" length=" in line and line.startswith("failure") for line in self.lines)
        broken += ",afterburnt"*any(" afterburn=" in line for line in self.lines)
        broken += ",compaction"*any(" concrete " in line for line in self.lines)
        self.lines += ["output csv at=end fields=mass,stress,density" + pores + broken, "history steps=1",
                       f"checkpoint every={self.steps//3} keep=9"]
        if self.newer:
            for name in self.deforming:
                if self.has_newest(f"stress of {name}", 0.3):
                    self.lines += newest.initial_stress(self.stream(f"stress at the start of {name}"), self.lines, name,
                                                        self.axes, self.gravity)
            self.lines = newest.keyed(self.stream("keys"), self.lines, self.axes, self.joined)
            self.lines += newest.further_cards(self.stream("cards"), self.lines, self.axes,
                                               [block.lower for block in self.deforming.values()])
        if seed >= GRADED and not (seed >= MASSES and self.stream("equal cells").random() < 0.7):
            self.grade()
        if seed >= MASSES:
            self.weigh()

    def weigh(self):
        """A consistent mass, where nothing of the scene forbids it (doc/mass.md)."""
        text = "\n".join(self.lines)
        if self.method != "sgmp" or self.axisymmetric or re.search(
                r"^wallfriction |^wallmotion |^motion | reactions=yes| flip=| volumes=kept|=absorbing| fine_[xyz]=|"
                r" self=yes",
                text, re.MULTILINE):
            return
        mass = self.stream("mass").choice((" mass=consistent", " mass=consistent", " mass=lumped", ""))
        self.lines = [line + mass if line.startswith("method ") else line for line in self.lines]

    def grade(self):
        """Unequal cells, where nothing of the scene forbids them (doc/grids.md, 6). Bodies have particles of half a
        cell, as they must."""
        text = "\n".join(self.lines)
        if self.method != "sgmp" or re.search(
                r"^detonation |^failure .* length=| file file=| explosive ", text, re.MULTILINE):
            return
        luck = self.stream("unequal cells")
        if luck.random() < 0.1:
            return
        words = []
        for axis in luck.sample(self.axes, luck.randint(1, len(self.axes))):
            low = luck.choice((0, 2, 3))
            words.append(f"fine_{axis}=({low},{low + luck.choice((2, 3))})"
                         + f",({low + 8},{low + 11})"*(luck.random() < 0.3))
        words.append(f"ratio={luck.choice((1.05, 1.1, 1.3, 1.5))} largest={luck.choice((1.5, 3))}")
        self.lines = [line + " " + " ".join(words) if line.startswith("grid ") else
                      re.sub(r"(?<= )ppc=1\b" + "|layout=gauss "*(not self.joined),
                             lambda found: "ppc=2" if "ppc" in found[0] else "", line)
                      if line.startswith("body ") else line for line in self.lines]

    def stream(self, what):
        """Random numbers for one choice alone."""
        return random.Random(f"{what} {self.seed}")

    def has(self, feature, share):
        """Whether a scene with new features has this one."""
        return self.rich and self.stream(feature).random() < share

    def draws(self, feature, share):
        """Whether a scene of a late seed has this feature of the latest ones."""
        return self.late and self.stream(feature).random() < share

    def has_newest(self, feature, share):
        """Whether a scene of one of the newest seeds has this feature."""
        return self.newer and self.stream(feature).random() < share

    def has_further(self, feature, share):
        """Whether a scene of one of the last seeds has this feature."""
        return self.last and self.stream(feature).random() < share

    def has_law(self, feature, share):
        """Whether a scene of one of the last seeds of all has this feature."""
        return self.seed >= LAWS and self.has_further(feature, share)

    def text(self):
        """The deck."""
        return "\n".join(self.lines) + "\n"

    def write(self, folder, name):
        """The deck and the files that it names."""
        os.makedirs(folder, exist_ok=True)
        for file, content in [(name, self.text()), *self.files.items()]:
            with open(os.path.join(folder, file), "w", encoding="ascii") as opened:
                opened.write(content)

    def tables(self):
        """A table that loads, walls and rigid bodies may use."""
        if self.draws("table", 0.5):
            self.table = latest.Table(self.stream("rows"), "course", f"course_{self.seed}.csv")
            self.lines.append(self.table.card())
            if self.table.file:
                self.files[self.table.file] = self.table.content()

    def space(self):
        """A box, closed or open, and its walls."""
        words, walls = ["grid cell=1"], []
        for axis in self.axes:
            closed = self.luck.random() < 0.5 and not self.alone
            size = 3*CELLS[self.dimension] + 6
            words.append(f"{axis}=0:{size}" if closed else f"{axis}=open")
            for side in "-+" if closed else "":
                kind = self.luck.choice(("slip", "fixed", "free"))
                if axis + side == "r-":  # the axis
                    continue
                walls.append(f"{axis}{side}={kind}")
                self.fixed += [(axis, side)]*(kind == "fixed")
                self.walls = self.walls or kind != "free"
        self.lines.append(" ".join(words))
        if walls:
            policy = self.luck.choice(("remove", "reflect"))
            self.removes = policy == "remove"
            self.walls = self.walls or policy == "reflect"
            card, more = "wall " + " ".join(walls), []
            if self.has_further("edges", 0.6) and (self.joined or not self.swirl):
                card, more = further.walls(self.stream("kinds of edges"), card, self.axes, not self.swirl)
            self.absorbs, self.rubs = "absorbing" in card, bool(more)
            self.lines += [card, f"lost {policy}", *more]
        self.moving_walls()

    def moving_walls(self):
        """Motions of fixed walls along themselves; with an axis of symmetry of the outer one alone."""
        for axis, side in self.fixed:
            along = [other for other in self.axes if other not in (axis, "r")]
            if not along or not self.draws(f"wall {axis}{side}", 0.5):
                continue
            luck = self.stream(f"motion of {axis}{side}")
            chosen = luck.sample(along, luck.randint(1, len(along)))
            self.lines.append(f"wallmotion {axis}{side} " + " ".join(
                f'{other}="{latest.Ramp(luck, luck.choice((0.05, 0.3, -0.3)), self.table).text()}"'
                for other in chosen))
            self.moving = True

    def discretisation(self):
        """Method, update and step."""
        words = [f"method {self.method} update={self.update}"]
        if self.method == "sgmp":
            extra = self.luck.choice(("", "", " rotation=exact", " stress=normalised"))
            if self.update in ("musl", "usavg") and extra in ("", " stress=normalised",
                                                              " rotation=exact") and self.has("kept", 0.2):
                extra += " volumes=kept"
            if self.has_further("words", 0.7):
                kept = " volumes=kept"*(" volumes=kept" in extra)
                extra = further.words(self.stream("words of the method"), self.dimension, self.absorbs) + kept
                if kept:
                    extra = extra.replace(" stress=plain", "")
            words.append(extra)
        if self.update in ("musl", "usavg") and self.has_further("drift", 0.3):
            words.append(self.stream("which drift").choice((" drift=plain", " drift=remapped")))
        if self.split:
            words.append(" split=1")
        self.lines.append("".join(words))
        self.cfl = self.luck.choice(("0.2", "0.3", "0.4", "auto"))
        self.lines.append(f"time cfl={self.cfl} steps={self.steps}")

    def material(self, name):
        """One of the kinds, with soft and stiff, light and heavy constants."""
        kind = self.luck.choice(list(MATERIALS) if self.luck.random() < 0.3 else list(MATERIALS)[:4])
        young = self.luck.choice((1, 10, 100))
        numbers = {"name": name, "density": self.luck.choice((0.5, 1, 4)), "young": young,
                   "poisson": self.luck.choice((0, 0.25, 0.3, 0.45)),
                   "weak": young*self.luck.choice((0.003, 0.03))}
        text = MATERIALS[kind].format(**numbers)
        if kind == "explosive" and self.has_law("afterburn", 0.7):
            text = text.replace(" energy0=7", " energy0=7" + laws.afterburn(self.stream(f"afterburn of {name}")))
        if "detonation" in text and any("detonation point" in line for line in self.lines):
            text = text[:text.rindex("\n")]
        viscous = self.luck.random() < 0.2
        lines = self.other_matter(kind, numbers) or text.split("\n")
        self.lines += self.failing(lines, numbers)
        if viscous and not any(line.startswith("viscosity") for line in lines):
            self.lines.append(f"viscosity {name}")

    def other_matter(self, kind, numbers):
        """A fluid, a soil, or what can fail, in the place of what was drawn; nothing where that stays."""
        luck = self.stream(f"matter {numbers['name']}")
        if kind == "explosive":
            return []
        if self.alone and self.stream(f"linear {numbers['name']}").random() < 0.5:
            return latest.linear(numbers)
        if self.has_law(f"table {numbers['name']}", 0.2):
            file = f"table_{self.seed}_{numbers['name']}.txt"
            lines, self.files[file] = laws.table_fluid(self.stream(f"table of {numbers['name']}"), numbers, file)
            return lines
        if self.seed >= CONCRETE and self.has_further(f"concrete {numbers['name']}", 0.25):
            return further.concrete(self.stream(f"concrete of {numbers['name']}"), numbers)
        if self.has_newest(f"ceramic {numbers['name']}", 0.4):
            return newest.ceramic(self.stream(f"ceramic matter {numbers['name']}"), numbers)
        if self.has_further(f"foam {numbers['name']}", 0.25):
            return further.foam(self.stream(f"foam of {numbers['name']}"), numbers)
        if self.has_newest(f"clay {numbers['name']}", 0.15):
            return newest.cam_clay(self.stream(f"clay of {numbers['name']}"), numbers)
        if self.draws(f"latest {numbers['name']}", 0.6):
            return latest.matter(self.stream(f"latest matter {numbers['name']}"), numbers)
        if self.flows and luck.random() < 0.7:
            return features.fluid(luck, numbers) if luck.random() < 0.8 else features.soil(luck, numbers)
        if (self.fails or self.erodes) and kind in ("elastic", "neo_hookean") and luck.random() < 0.6:
            return [MATERIALS["j2"].format(**numbers)]
        return []

    def failing(self, lines, numbers):
        """The cards of a material, with its failure and its erosion."""
        luck = self.stream(f"failure {numbers['name']}")
        kind = lines[0].split()[2]
        fails = kind in ("johnson_holmquist", "concrete")
        plastic = fails or kind in (*latest.METAL_NAMES, "drucker_prager", "mohr_coulomb", "cam_clay")
        wears = self.has_law(f"ductile {numbers['name']}", 0.6)
        if (self.fails or wears) and kind in latest.METAL_NAMES:
            damages = kind == "johnson_cook" and luck.random() < 0.4
            if damages:
                lines = [features.damage_constants(luck, lines[0]), *lines[1:]]
                if self.has_law(f"critical damage {numbers['name']}", 0.5):
                    lines[0] += " critical_damage=" + self.stream("critical damage").choice(("0.3", "0.9"))
            fails = damages or luck.random() < 0.8
            if not damages and fails or luck.random() < 0.3 or wears:
                grady = self.has_further(f"spall {numbers['name']}", 0.5)
                card = (further.spall(luck, numbers) if grady
                        else features.failure(luck, numbers, damages, 0.01*numbers["young"]))
                if wears and not damages:
                    card = laws.ductile(self.stream(f"ductile {numbers['name']}"), numbers)
                if self.has_law(f"flaws {numbers['name']}", 0.3) and not damages:
                    card = laws.flawed(self.stream(f"flaws of {numbers['name']}"), numbers)
                heated = "specific_heat" in lines[0] and kind != "johnson_cook"
                if self.has_law("length", 0.5) and not heated:
                    card = laws.averaged(card, self.stream("length of all").choice((0.7, 2, 3)))
                lines = [*lines, card]
                fails = True
        if self.erodes and luck.random() < 0.8:
            fastest = 2.5*math.sqrt(numbers["young"]/numbers["density"])  # c + |v|; faster than waves at the start
            shortest = 0.0
            if self.joined or self.cfl != "auto" and self.update != "usf":
                shortest = (1.5 if self.cfl == "auto" else float(self.cfl))/fastest
            lines = lines + features.erosion(luck, numbers["name"], plastic, fails, shortest)
        return lines

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
            layout = self.luck.choice(("ppc=2", "ppc=2", "ppc=1", "ppc=3", "spacing=0.45", "ppc=2 jitter=0.3",
                                       "layout=gauss ppc=2"))
            if self.dimension == 3:
                layout = self.luck.choice(("ppc=2", "ppc=1", "ppc=2 jitter=0.3"))
            names.append(f"b{b}")
            cards = []
            if self.dimension > 1 and self.luck.random() < 0.25:
                radius = size[-1]/2
                centre = [low + radius for low in lower]
                shape = (f"sphere centre={vector(centre)} radius={radius}" if self.luck.random() < 0.5
                         or self.dimension == 3 or self.axisymmetric else
                         f"ring centre={vector(centre)} axis=(0,0,1) radius={radius} inner={radius}/2")
            else:
                shape = f"block lower={vector(lower)} upper={vector([low + s for low, s in zip(lower, size)])}"
            if self.has(f"shape {b}", 0.4):
                shape, cards = features.shape(self.stream(f"shape of {b}"), self.dimension, self.axisymmetric, lower,
                                              size)
            if self.has_newest(f"changed {b}", 0.3):
                cards = [*cards, newest.changed(self.stream(f"change of {b}"), self.dimension, self.axisymmetric, lower,
                                                size)]
            if self.draws(f"file {b}", 0.2):
                self.body_of_file(b, lower, size)
            else:
                self.lines.append(f"body b{b} {shape} material=m{b} {layout}")
                self.lines += [card.format(name=f"b{b}") for card in cards]
                upper = vector([low + s for low, s in zip(lower, size)])
                whole = shape == f"block lower={vector(lower)} upper={upper}" and not cards
                self.deforming[f"b{b}"] = latest.Block(lower, size, whole, layout)
            height += size[-1] + self.luck.choice((0, 0, 0.1, 1.5))
        if number > 1 and self.luck.random() < 0.7:
            friction = self.luck.choice((0, 0.3, 10))
            friction = 0 if self.swirl and not self.joined else friction
            self.lines.append(f"contact all{self.self_contact()} friction={friction}")
            self.grouped(names)
            if self.luck.random() < 0.3 and not self.alone:
                self.rigid = True
                speed = self.luck.choice(('0', '0.1', '"0.2*sin(t)"'))
                chosen = self.luck.choice(names)
                if chosen in self.pair:
                    chosen = next(name for name in names if name not in self.pair)
                turns = (features.turning(self.stream("turning"), self.dimension, True)
                         if self.dimension > 1 and not self.axisymmetric and self.has("turns", 0.5) else "")
                if self.table and self.draws("rigid by table", 0.5):
                    speed = '"0.1*course(t)"'
                self.lines.append(f"rigid {chosen} {self.axes[-1]}={speed}{turns}")
                names.remove(chosen)
                self.deforming.pop(chosen, None)
        if self.has("free", 0.4):
            luck = self.stream("free body")
            mass = luck.choice(("", "", f" mass={luck.choice((0.1, 3, 20))}"))
            chosen = luck.choice(names)
            if chosen in self.pair:
                chosen = next((name for name in names if name not in self.pair), None)
            if chosen is None:
                return
            self.lines.append(f"rigid {chosen} free=yes{mass}")
            self.deforming.pop(chosen, None)
            self.floats = True

    def self_contact(self):
        """Bodies that touch themselves, where the method allows it."""
        method = next(line for line in self.lines if line.startswith("method"))
        if self.seed < GRADED or self.dimension == 1 or self.swirl or not self.stream("self").random() < 0.5:
            return ""
        refused = ("rotation=exact", "surfaces=corrected", "volumes=kept")
        return "" if any(word in method for word in refused) else " self=yes"

    def grouped(self, names):
        """Two of three bodies in a group of one velocity field, or a card for that group alone; the rigid and the free
        ones are among the others."""
        if len(names) < 3 or not self.has_further("group", 0.7):
            return
        luck = self.stream("group of bodies")
        chosen = luck.sample(names, 2)
        self.lines.append(f"group pair {','.join(chosen)}")
        self.pair = chosen
        if luck.random() < 0.5:
            smooth = self.swirl and not self.joined
            self.lines.append(f"contact pair friction={0 if smooth else luck.choice((0, 0.2))}")

    def body_of_file(self, number, lower, size):
        """A body of a particle file, or two bodies of different matter that share one."""
        luck, materials = self.stream(f"file of {number}"), [f"m{number}"]
        if luck.random() < 0.4:
            numbers = {"name": f"n{number}", "density": 1, "young": luck.choice((1, 10, 100)), "poisson": 0.3,
                       "weak": 0.1}
            self.lines += latest.matter(luck, numbers)
            materials.append(numbers["name"])
        file = f"particles_{self.seed}_{number}.csv"
        self.files[file] = latest.particle_file(luck, self.axes, lower, size, materials)
        for material in materials:
            name = material.replace("m", "b")
            self.lines.append(f'body {name} file file="{file}" material={material} overlap=allow')  # jitter
            self.deforming[name] = latest.Block(lower, size, False, "file")

    def loads(self):
        """Velocities, gravity, forces, damping."""
        speed = self.luck.choice((0.01, 0.1, 0.5))
        place = self.axes[0]
        words = [f'{axis}="{speed}*{self.luck.choice(("1", "-1", f"sin({place})", f"cos({place}+1)", "0"))}"'
                 for axis in self.axes]
        if self.swirl:
            words.append(f"spin={self.stream('spin').choice(('0.1', '0.3*sin(z)'))}")
        elif self.dimension > 1 and not self.axisymmetric and self.has("omega", 0.3):
            words.append(features.turning(self.stream("omega of all"), self.dimension, False).strip())
        self.lines.append("velocity all " + " ".join(words))
        if self.luck.random() < 0.3:
            self.gravity = -0.02
            self.lines.append("gravity " + vector([0.0]*(self.dimension - 1) + [self.gravity]))
        if self.luck.random() < 0.15 and not self.alone:
            self.bodyforce = True
            self.lines.append(f'bodyforce all {self.axes[-1]}="0.01*sin({place}0)*cos(t)"')
        if self.has("ramp", 0.15):
            self.ramp = self.stream("ramp of").choice((-0.05, 0.02))
            self.lines.append(f'bodyforce all {self.axes[-1]}="{self.ramp}*min(t/2,1)"')
        self.forces()
        self.motions()
        if (self.joined or not self.moving) and self.has("damping", 0.2):
            luck = self.stream("damping by")
            self.damping = luck.choice((0.1, 1.0, math.inf))  # infinite: kinetic
            words = ["damping kinetic=yes" if math.isinf(self.damping) else f"damping rate={self.damping}"]
            self.damped_until = luck.choice((math.inf, 0.5))
            self.lines.append(" ".join(words + ["until=0.5"]*(self.damped_until < 1)))

    def forces(self):
        """Loads, pressures and tractions on bodies that deform."""
        for name, block in self.deforming.items():
            luck = self.stream(f"forces on {name}")
            for _ in range(luck.choice((1, 2)) if self.draws(f"forces {name}", 0.5) else 0):
                faces = block.lattice
                small = any(f" {name.replace('b', 'm', 1)} elastic" in f" {line[8:]}" and "strain=small" in line
                            for line in self.lines)
                card, pushes = latest.force(luck, name, self.axes, block, faces, self.dimension == 1 or small,
                                            self.alone, self.table)
                self.lines.append(card)
                self.loaded = self.loaded or pushes is None or self.erodes
                self.pushes += pushes or []

    def motions(self):
        """Parts of bodies that are moved, where the method allows it."""
        smooth = self.swirl and not self.joined
        if smooth or self.moving or self.rubs or any("self=yes" in line for line in self.lines):
            return
        rough = any(line.startswith("contact") and not line.endswith("friction=0") for line in self.lines)
        if rough and any("rotation=exact" in line for line in self.lines):
            return
        for name, block in self.deforming.items():
            if self.has_further(f"motion {name}", 0.25):
                self.lines.append(further.moved(self.stream(f"motion of {name}"), name, self.axes, block,
                                                self.swirl))
                self.loaded = True

    def ends(self):
        """An end before the last step."""
        if self.has("ends", 0.2):
            self.lines.append("stop " + self.stream("end").choice(("kinetic_below=0.3", "at_rest=0.01",
                                                                   "at_rest=0.1 hold=0.2",
                                                                   "at_rest=0.3 after=1 hold=0.1")))

    def pull(self, time):
        """Acceleration of everything along the last axis."""
        return self.gravity + self.ramp*min(time/2, 1)

    def push(self, axis, time):
        """Force from outside along an axis, as far as it is known."""
        return sum(part*ramp(time) for along, part, ramp in self.pushes if along == axis)

    def free(self):
        """Whether nothing from outside acts but gravity, loads that everything feels alike or whose force is known, and
        damping."""
        return not (self.walls or self.rigid or self.bodyforce or self.loaded)


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
        return [{key: real(value) for key, value in row.items() if key != "name"} for row in rows]

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
        done = subprocess.run([*launcher, chosen.sgmp, deck, "--quiet", "--threads", str(threads), "--output", folder,
                               *options],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment, timeout=600,
                              check=False)
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
    for name in ("history.csv", "contact.csv", "rigid.csv", "bodies.csv", "gauges.csv", "particles_end.csv"):
        if first.content(name) != other.content(name):
            yield f"{title}: {name} differs"
            return


def physics_problems(scene, result):
    """What holds whatever the scene is."""
    rows, energy = result.table("history.csv"), result.summary["energy"]
    if energy["remainder"] is None or any(not math.isfinite(value) for row in rows for value in row.values()):
        yield "a history that is not of numbers"
        return
    supplied = max(max(abs(row[key]) for row in rows) for key in ("kinetic_energy", "internal_energy", "external_work"))
    # A free body that has left the grid in part moves as the whole.
    if not (scene.floats and result.summary["particles_lost"]) and abs(energy["remainder"]) > 1e-10*max(supplied,
                                                                                                        1e-300):
        yield f"the ledger misses {energy['remainder']/supplied:.1e} of the energy"
    particles = result.table("particles_end.csv")
    if any(not math.isfinite(value) for row in particles for value in row.values()):
        yield "a number that is none"
    if len(particles) != result.summary["particles"]:
        yield f"{len(particles)} particles in the file, {result.summary['particles']} in the summary"
    # no face holds what is rigid
    if not (scene.removes or scene.rigid or scene.floats) and result.summary["particles_lost"]:
        yield "particles lost where none may"
    masses = {}
    for row in result.table("bodies.csv"):
        masses[row["step"]] = masses.get(row["step"], 0.0) + row["mass"]
    yield from mass_problems(scene, result, rows, particles, masses)
    yield from momentum_problems(scene, rows, masses, result.summary["end_state"]["lost_impulse"])
    if result.summary["verdict"] == "sound" and result.code == FINISHED:
        made = explained(rows[-1]) - explained(rows[0])
        # Matter under pressure that counts no energy at the start gives some away.
        given = max(rows[0]["total_energy"] + max(row["external_work"], -row["internal_energy"]) for row in rows)
        if made > 0.06*max(given, 1e-300):
            yield f"called sound with an energy of {made:.3g} from nowhere"


def explained(row):
    """The energy of a row and what has been taken from it, less what was given."""
    taken = ("contact_dissipation", "damping_dissipation", "eroded_kinetic_energy", "eroded_internal_energy",
             "lost_kinetic_energy", "lost_internal_energy")
    return row["total_energy"] + sum(row.get(key, 0.0) for key in taken) - row["external_work"]


def mass_problems(scene, result, rows, particles, masses):
    """What is left and what is booked as eroded or lost is what there was, in each row; bodies weigh what their
    particles do."""
    steps = [row["step"] for row in rows]
    worst = max(abs(masses[row["step"]] + row.get("eroded_mass", 0.0) + row.get("lost_mass", 0.0) - masses[steps[0]])
                for row in rows)
    if worst > 1e-12*masses[steps[0]]:
        yield f"mass wrong by {worst/masses[steps[0]]:.1e}"
    # may have a mass by their card, and keep it as their particles leave the grid
    free = {body["body"] for body in (result.table("rigid.csv") if result.content("rigid.csv") else [])}
    names = re.findall(r"^body (\w+)", scene.text(), re.MULTILINE)
    free |= {names.index(name) + 1 for name in re.findall(r"^rigid (\w+)", scene.text(), re.MULTILINE)}
    for body in result.table("bodies.csv"):
        own = sum(row["mass"] for row in particles if row["body"] == body["body"])
        if body["step"] != steps[-1] or body["body"] in free:
            continue
        if abs(own - body["mass"]) > 1e-12*masses[steps[0]]:
            yield f"particles of body {body['body']:.0f} weigh {own:.6g}, the body {body['mass']:.6g}"


def momentum_problems(scene, rows, masses, lost):
    """Nothing from outside: momentum stays; gravity and forces that are known change it by their sum over steps, of
    which the first counts half, for velocities are half a step behind. With damping and free bodies that is so but for
    half a step. `lost`: impulses that moved nothing, by the summary."""
    if not scene.free() or scene.rigid:
        return
    if math.isinf(scene.damping):  # kinetic damping stops everything whenever it likes
        return
    scale = max(max(math.sqrt(2*masses[row["step"]]*row["kinetic_energy"]) for row in rows), 1e-30)
    # Along r hoop stress pulls and pushes: what is kept there is the momentum about the axis, where there is one.
    kept = [(f"momentum_{axis}", scale, scene.pull if axis == scene.axes[-1] else lambda time: 0.0, axis)
            for axis in scene.axes if axis != "r"]
    if scene.swirl and not scene.floats:  # a rigid body does not turn, and may be rubbed
        kept.append(("angular_momentum", scale*3*CELLS[2], lambda time: 0.0, ""))
    longest = max(row["dt"] for row in rows)
    for key, size, pull, axis in kept:
        expected, wrong, strongest, span = rows[0][key], 0.0, 0.0, 0.0
        for before, row in zip(rows, rows[1:]):
            last, span = span, row["time"] - before["time"]
            weight = masses[before["step"]]*pull(before["time"]) + scene.push(axis, before["time"])
            gone = sum(row.get(cause + key, 0.0) - before.get(cause + key, 0.0) for cause in ("eroded_", "lost_"))
            rate = scene.damping if before["time"] < scene.damped_until else 0.0
            expected = (expected + weight*(last + span)/2 - gone)*math.exp(-rate*span)
            wrong = max(wrong, abs(row[key] - expected))
            strongest = max(strongest, abs(weight) + scene.damping*abs(before[key]))
        # A particle of mpm that lies on a cell's face pushes nodes to which it gives no mass: that force is lost, and
        # the run says so.
        reach = 3*CELLS[2] if key == "angular_momentum" else 1
        loose = 1.01*strongest*longest if scene.damping or scene.floats else 0.0
        if wrong > 1e-10*size + reach*lost + loose:
            yield f"{key} wrong by {wrong/size:.1e}"


def problems(chosen, scene, deck):
    """Everything wrong with a scene, and how it ended."""
    first = run(chosen, deck, "first")
    # Small round bodies may have no particle, or none that a load finds, a rigid one alone may be at rest; all else
    # that is drawn must be legal.
    if first.code == WRONG_DECK:
        return first, [] if re.search("has no particles|nothing limits the time step|acts on no particle|there are no "
                                      "such faces|show opposite faces|no particle is within the radius of gauge|have "
                                      "no known faces at an absorbing edge|nothing ends at the absorbing edge|the "
                                      "motion moves no particle",
                                      first.printed) else ["a deck refused"]
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
        again = run(chosen, deck, "restarted", threads=2,
                    options=["--restart", os.path.join(copy, os.path.basename(middle))])
        found += layout_problems(first, again, "restart")
    return first, found


def never_drawn():
    """What the last seeds must draw, and do not in 400 scenes."""
    texts = "".join(Scene(seed).text() for seed in range(JOINED, JOINED + 400))
    return [word for word in ("motion ", "wallfriction ", "=absorbing", " crushable_foam ", " concrete ", " toughness=",
                              " spall_strain=", " surfaces=corrected", " table file=", " afterburn=", " plastic_work=",
                              " hosford_strain=", " flaws=", ",averaged_strain", " fine_x=", " fine_r=", " self=yes",
                              " spin=0.05")
            if word not in texts]


def main():
    """So many scenes from a seed on."""
    if "--show" in sys.argv:
        scene = Scene(int(sys.argv[sys.argv.index("--show") + 1]))
        sys.exit(print(scene.text() + "".join(f"# {name}:\n# " + "\n# ".join(text.splitlines()) + "\n"
                                              for name, text in scene.files.items())))
    chosen = arguments(__doc__, 12, JOINED)
    findings, codes = Findings(chosen.scratch), {}
    deck = os.path.join(chosen.scratch, "scene.inp")
    for word in never_drawn():
        findings.add(f"no scene draws '{word}'", "nothing.inp", b"", "")
    for seed in range(chosen.seed, chosen.seed + chosen.inputs):
        scene = Scene(seed)
        scene.write(chosen.scratch, "scene.inp")
        result, found = problems(chosen, scene, deck)
        word = f"{result.code} {result.summary.get('verdict', 'refused')}"
        codes[word] = codes.get(word, 0) + 1
        for problem in found:
            findings.add(problem, f"scene_{seed}.inp", scene.text().encode(), result.printed)
            scene.write(findings.folder, f"scene_{seed}.inp")
        for name in scene.files:
            os.remove(os.path.join(chosen.scratch, name))
    findings.end(chosen.inputs, "scenes", chosen.seed, codes)


main()
