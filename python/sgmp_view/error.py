"""How wrong a number of a deck is: the deck is run with other cells, another step, place of the grid, method and number
of particles.

    sgmp-view error impact.inp --quantity bodies.core.velocity_z --tolerance 5% --budget 10m
    sgmp-view error impact.inp --list                        # the quantities, with units and their values after one
    step

Prints the number with its error and the parts of it, and which cell reaches the tolerance for the least CPU time; draws
error.png. Costs are told before, and the budget of wall time is kept: coarse cells come first, finer ones last; a part
whose run does not fit is looked at with coarser cells, where its change is larger, if anything. The same call with a
larger budget goes on. Results: DECK.error/error.json, `error_estimate` in summary.json of the deck's own run
(DECK.error/deck), and of DECK.out if that is the same run; `sgmp-view report` shows it. Any deck runs: no parameter is
needed.

Cells: grid convergence index (Roache 1994), 1.25 |f - f0| where three sizes and more show an order, else 3 times the
spread over the ratio of the sizes less 1. Step: 3 times the change with half of it. Others: the largest change. The
parts are added as squares.
"""

import difflib
import json
import math
import re
from copy import deepcopy
from pathlib import Path

from . import deck_variations as variations
from .deck_text import Deck
from .error_estimate import errors_of_runs, half_widths, line_of, needed_cell, total_of, verdict_of
from .error_figure import draw
from .files import SgmpFileError, read_summary_if_any, read_table, read_units
from .quantities import KEYS, OF_ROWS, listed, quantity_of, short_name, unit_of
from .runs import program_of
from .turning import hindrance, with_turn
from .study_runs import Member, Runner, clock

CELLS = (2.0, 1.4)                                      # sides of cells over the deck's
# as far as the budget allows, the last two until the tolerance is reached
FINER = (1 / 1.4, 0.5, 1 / 2.8, 0.25)
# by which bodies of a copy may miss their mass more than the deck's
MASS_FAULT = 0.002
AWAY = 0.05                                             # fault of a cell that is e times the one that was wanted
# a cell that lies differently in the bodies, where walls hold the grid
NEARBY = 1.03
SECONDS = {"s": 1, "m": 60, "min": 60, "h": 3600}


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("deck", type=Path)
    parser.add_argument(
        "--quantity", action="append", default=[], metavar="NAME",
        help="what is asked for, as --list names it; may be repeated",
    )
    parser.add_argument(
        "--tolerance", default="5%",
        help="error that can be borne: of the value (5%%, the default), or in its unit (0.2)",
    )
    parser.add_argument("--budget", default="10m", help="wall time for all runs: 90s, 10m (default), 2h")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="a parameter of the deck")
    parser.add_argument("--threads", type=int, metavar="N", help="threads of each run (default: all)")
    parser.add_argument("--sgmp", help="the program (default: $SGMP, the path, build/release/sgmp)")
    parser.add_argument(
        "--against", type=Path, metavar="OUT_DIR",
        help="the run that shapes are compared with (default: the deck's own)",
    )
    parser.add_argument("--list", action="store_true", help="list the quantities, run one step only")
    parser.add_argument("--check", action="store_true", help="tell what it will cost, run one step only")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="folder of the study (default: the deck's name and .error)"
    )


def seconds_of(text):
    """Seconds of a time like 10m."""
    found = re.fullmatch(r"([\d.]+) *([a-z]*)", text)
    if not found or (found[2] or "s") not in SECONDS:
        raise ValueError(f"--budget {text}: expected a time as 90s, 10m or 2h")
    return float(found[1]) * SECONDS[found[2] or "s"]


def tolerance_of(text, value):
    """The error that can be borne, in the unit of the quantity."""
    found = re.fullmatch(r"([\d.eE+-]+) *(%?)", text)
    if not found:
        raise ValueError(f"--tolerance {text}: expected a share as 5% or a number in the unit of the quantity")
    return float(found[1]) * (abs(value) / 100 if found[2] else 1)


def spoken(tolerance, unit):
    """The tolerance in words."""
    return f"{tolerance.rstrip('%').strip()} %" if tolerance.endswith("%") else f"{tolerance} {unit}".strip()


# ---------------------------------------------------------------- the runs

class Study:
    """A deck, its own run and the runs that should give the same."""

    def __init__(self, options):
        self.deck = Deck(options.deck, options.set)
        self.folder = options.output or Path(options.deck.stem + ".error")
        self.runner = Runner(self.folder, program_of(options.sgmp), options.threads, seconds_of(options.budget))
        self.members, self.notes = [], []
        self.coarse = None                              # factor of the cells of the copies that are made
        asked = variations.cell_of(self.deck)
        fitted = variations.with_own_cell(self.deck)
        if fitted:
            self.note(
                f"cell {asked:.4g} does not fit between the walls; the nearest that does is taken in its place: "
                f"{fitted.split()[1]}"
            )
        own = deepcopy(self.deck)
        variations.with_final_state(own)
        self.own = Member("deck", "deck", fitted or "as it is", own.text(), 1.0)
        self.checked = self.runner.check(self.own.text)
        if not self.checked.accepted:
            raise SgmpFileError(self.checked.words)
        self.runner.base_work = self.checked.work
        self.cell, self.dimension = variations.cell_of(self.deck), len(variations.axes_of(self.deck))
        self.against = options.against

    def probe(self):
        """Folder of a run of one step, which has the names of all quantities."""
        first = deepcopy(self.deck)
        variations.with_final_state(first)
        first.one("time").set("steps", 1)
        member = Member("probe", "first_step", "one step", first.text(), 0.0)
        if not self.runner.run(member):
            raise SgmpFileError(f"the first step: {member.note}")
        return self.runner.output(member)

    def add(self, part, name, work, change, *values):
        """A copy that `change` makes of the deck, kept if the program accepts it."""
        deck = deepcopy(self.deck)
        if self.coarse:
            variations.with_cells(deck, self.coarse)
            name, work = f"{name}_coarse", work * self.coarse ** -(self.dimension + 1)
        variations.with_final_state(deck)
        variations.until(deck, self.summary["time"])
        words = change(deck, *values)
        checked = self.runner.check(deck.text()) if words else None
        if checked is None or not checked.accepted:
            return None
        return Member(part, name, words, deck.text(), work, fault=self.changed_mass(checked))

    def changed_mass(self, checked):
        """By how much a copy misses the masses of its shapes more than the deck; infinite where its shapes are
        others."""
        same = all(math.isclose(a, b, rel_tol=5e-3) for a, b in zip(checked.masses, self.checked.masses))
        return checked.fault - self.checked.fault if same else math.inf

    def cells(self, target):
        """The copy with cells near a multiple of the deck's whose particles fill the bodies best."""
        tried = {}
        for factor in variations.fitting(self.deck, target):
            member = self.add(
                "cells", f"cells_{factor:.4g}", factor ** -(self.dimension + 1), variations.with_cells, factor
            )
            if member is not None and not any(member.name == other.name for other in self.members):
                member.factor = factor
                tried[member.fault + AWAY * abs(math.log(factor / target))] = member
                if member.fault < MASS_FAULT:
                    break
        best = tried[min(tried)] if tried else None
        if best is not None and math.isinf(best.fault):
            self.note("shapes change with the cell: numbers per body differ for that reason, too")
        elif best is None:
            sides = [f"{factor * self.cell:.4g}" for factor in variations.walled(self.deck)]
            self.note(f"no cell near {target * self.cell:.3g} fits the walls; there fit {', '.join(sides)} …")
        elif best.fault > 0.01:
            self.note(f"{best.words}: bodies have up to {100 * best.fault:.1f} % another mass")
        return best

    def note(self, words):
        """Something to know, once."""
        if words not in self.notes:
            self.notes.append(words)

    def others(self):
        """Copies with another step, place of the grid, method and number of particles."""
        courant = float(self.summary["cfl"])
        yield self.add("step", "step", 2.0, variations.with_half_step, courant)
        lowest = self.lowest()
        places = [
            self.add("grid's place", f"place_{k}", 1.0, variations.with_shift, lowest, sign)
            for k, sign in enumerate((1, -1), 1)
        ]
        if not any(places):
            near = variations.fitting(self.base(), NEARBY, close=True)
            places = [self.add("grid's place", "place", 1.0, variations.with_other_lines, near[0])] if near else [None]
        yield places[0]
        slower = courant / variations.SAFE if courant > variations.SAFE else 1.0
        others = [self.method(1.5 * slower, courant)]
        yield others[0]
        yield self.add("particles", "particles", 1.5 ** self.dimension, variations.with_more_particles)
        yield self.turned()
        yield from places[1:]
        if others[0]:
            yield self.method(1.5 * slower, courant, name_of_method(others[0]))

    def method(self, work, courant, *tried):
        """The copy with another method than the deck's and those tried."""
        member = self.add(
            "method", "method", work, variations.with_other_method,
            lambda deck: self.runner.check(deck.text()).accepted, courant, tried,
        )
        if member is not None:
            member.name = name_of_method(member) + ("_coarse" if self.coarse else "")
        return member

    def turned(self):
        """The copy turned against the grid; why there is none is noted."""
        reason = hindrance(self.deck)
        member = None if reason else self.add("grid's place", "turned", 1.0, with_turn)
        if member is None:
            self.note(f"the scene is not turned against the grid: {reason or 'the program refuses the copy'}")
        else:
            member.axes = self.dimension
        return member

    def base(self):
        """The deck with the cells of the copies that are made."""
        deck = deepcopy(self.deck)
        if self.coarse:
            variations.with_cells(deck, self.coarse)
        return deck

    def coarsest(self):
        """The run with the coarsest cells that has come to its end, None where there is none."""
        return min(
            (member for member in self.members if member.part == "cells" and member.code == 0),
            key=lambda member: member.work, default=None,
        )

    def pairs(self):
        """The copies with another step, place, method and number of particles; where not all fit, with each the same
        with the coarsest cells."""
        full, beside = [member for member in self.others() if member], self.coarsest()
        if beside is None or beside.factor <= 1.0 or sum(map(self.runner.expected, full)) <= self.runner.left():
            return [(member, None) for member in full]
        self.coarse = beside.factor
        coarse = {member.name: member for member in self.others() if member}
        self.coarse = None
        for member in coarse.values():
            member.beside, member.words = beside.name, f"{member.words}, with cells of {beside.words.split()[1]}"
        return [(member, coarse.get(f"{member.name}_coarse")) for member in full]

    def take_parts(self):
        """Runs the copies of each part, with coarser cells where the budget does not bear the deck's, so that something
        is left for those to come."""
        pairs, looked = self.pairs(), set()
        for number, (full, coarse) in enumerate(pairs):
            to_come = {
                member.part: self.runner.expected(member)
                for _, member in reversed(pairs[number + 1 :])
                if member and member.part not in looked | {full.part}
            }
            room = self.runner.is_done(full) or self.runner.fits(full, sum(to_come.values()))
            if room or coarse is None or not self.runner.fits(coarse):
                self.take(full)
            elif full.part not in looked:
                self.take(coarse)
            if self.members[-1].code == 0:
                looked.add(self.members[-1].part)

    def lowest(self):
        """A corner below all bodies, as far as their centroids and size tell."""
        table = read_table(self.runner.output(self.own) / "bodies.csv")
        axes = ["x" if axis == "r" else axis for axis in variations.axes_of(self.deck)]
        return [float(table[axis].min()) for axis in axes]

    def take(self, member):
        """Runs a copy if it is there, fits in the budget and is no repetition."""
        if member is None:
            return
        self.runner.run(member)
        self.members.append(member)
        self.tell(member)

    def tell(self, member):
        """A line about a run."""
        cpu = read_summary_if_any(self.runner.output(member)).get("cpu_seconds") if member.code == 0 else None
        print(
            f"  {member.part:>12}  {member.words:<44} {f'{cpu:.3g} s CPU' if cpu is not None else '':>14}  "
            f"{member.note}",
            flush=True,
        )

    def plan(self):
        """What is to come and what it costs, by the number of particle-steps and what runs of the kind take."""
        turned = 0 if hindrance(self.deck) else 1
        more = sum(f ** -(self.dimension + 1) for f in CELLS) + 2 + 2 + turned + 1.5 + 1.5**self.dimension
        own = self.runner.seconds_per_work * self.checked.work
        print(
            f"{self.deck.path}: about {clock(own)} as it is, {clock(own * (1 + more))} with coarser cells, half the "
            f"step, another place of the grid, "
            f"method, more particles, then finer cells as far as the budget of {clock(self.runner.budget)} goes",
            flush=True,
        )

    def is_enough(self, options):
        """Whether all quantities are within the tolerance."""
        estimates = [self.estimate(quantity, options.tolerance) for quantity in options.quantity]
        return all(estimate["half_width"] <= estimate["tolerance"] for estimate in estimates)

    def run(self, options):
        """All runs, the cheapest of what says most first."""
        self.plan()
        self.runner.must_run(self.own)
        self.summary = self.runner.summary(self.own)
        self.tell(self.own)
        for target in CELLS:
            self.take(self.cells(target))
        self.take_parts()
        for number, target in enumerate(FINER):
            if number > 1 and self.is_enough(options):
                return
            if self.runner.seconds_per_work * self.checked.work * target ** -(self.dimension + 1) < self.runner.left():
                self.take(self.cells(target))

    # ------------------------------------------------------------ what they say

    def values(self, quantity):
        """By part, pairs of what was set and the value; for cells and the deck's own run what was set is the side of a
        cell. What was run with coarser cells is taken by its change from the run with these cells."""
        own = self.value(self.own, quantity)
        values = {"deck": [(self.cell, own)]}
        for member in self.members:
            if member.code == 0:
                setting = float(self.runner.summary(member)["h"]) if member.part == "cells" else member.words
                values.setdefault(member.part, []).append(
                    (setting, self.value(member, quantity) + self.coarser(member, quantity, own))
                )
        return values

    def coarser(self, member, quantity, own):
        """By how much the deck's value is above that of the run with coarser cells beside which a copy was run; 0 where
        it was run beside the deck's own."""
        if not member.beside or quantity.startswith("shape.") and self.against is None:
            return 0.0
        return own - self.value(self.named(member.beside), quantity)

    def named(self, name):
        """A run by its name."""
        return next(member for member in self.members if member.name == name)

    def coarse_parts(self):
        """Parts that were looked at with coarser cells only."""
        done = [member for member in self.members if member.code == 0]
        return {member.part: f"with cells of {self.named(member.beside).words.split()[1]}" for member in done
                if member.beside and not any(other.part == member.part and not other.beside for other in done)}

    def value(self, member, quantity):
        """What a run gives. Of a shape that is compared with the deck's own: its distance, below zero where cells are
        finer, so that it is an error of one sign."""
        folder = self.runner.output(member)
        if not quantity.startswith("shape."):
            return quantity_of(folder, quantity)
        if self.against is not None:
            return quantity_of(folder, quantity, self.against)
        if member is self.own:
            return 0.0
        if member.beside:
            return quantity_of(folder, quantity, self.runner.output(self.named(member.beside)))
        finer = member.part == "cells" and float(self.runner.summary(member)["h"]) < self.cell
        return (-1 if finer else 1) * quantity_of(folder, quantity, self.runner.output(self.own))

    def scale(self, quantity, value):
        """What a tolerance in per cent is a share of: the value, for a shape beside the deck's own the largest reach of
        its body."""
        if not quantity.startswith("shape.") or self.against is not None:
            return value
        body, folder = quantity.split(".", 1)[1].rpartition(".")[0], self.runner.output(self.own)
        return max(quantity_of(folder, f"extent.{body}.{axis}_length") for axis in variations.axes_of(self.deck))

    def ended(self):
        """The runs that have come to their end, with part and what was set, as `values` has them, and their
        summaries."""
        for member in [self.own, *self.members]:
            if member.code == 0:
                summary = self.runner.summary(member)
                yield (
                    member, (member.part, float(summary["h"]) if member.part in ("cells", "deck") else member.words),
                    summary,
                )

    def rows(self, quantity, values, widths, found):
        """What is kept of each run: its value, the error to be expected, that of the run beside it where it has coarser
        cells, its cost."""
        errors, ended = dict(errors_of_runs(values, widths, found)), list(self.ended())
        keys = {member.name: key for member, key, _ in ended}
        for member, key, summary in ended:
            yield {
                "part": key[0],
                "setting": key[1],
                "value": self.value(member, quantity),
                "cell": float(summary["h"]),
                "coarser": bool(member.beside),
                "expected_error": errors[keys[member.beside] if member.beside else key],
                "cpu_seconds": float(summary["cpu_seconds"]),
            }

    def estimate(self, quantity, tolerance):
        """The estimate of one quantity as summary.json has it."""
        values = self.values(quantity)
        widths, found = half_widths(values)
        units = read_units(self.runner.output(self.own))
        own, unit = values["deck"][0][1], unit_of(quantity, units)
        borne = tolerance_of(tolerance, self.scale(quantity, own))
        words = verdict_of(widths, borne, spoken(tolerance, unit), self.summary["verdict"] != "doubtful")
        runs, coarse = list(self.rows(quantity, values, widths, found)), self.coarse_parts()
        failed = [f"{member.words}: {member.note}" for member in self.members if member.code not in (0, -1)]
        return {
            "quantity": quantity,
            "value": own,
            "unit": unit,
            "cell_unit": units["length"],
            "half_width": total_of(widths),
            "parts": widths,
            "cells": found.words,
            "order": found.order,
            "limit": found.limit,
            "tolerance": borne,
            "verdict": words,
            "runs": runs,
            "failed": failed,
            "line": line_of(short_name(quantity), own, unit, widths, words, coarse),
            "coarse_parts": coarse,
            "advice": self.advice(runs, widths, found, borne),
        }

    def advice(self, runs, widths, found, borne):
        """Which setting reaches the tolerance for the least CPU time."""
        choices = [run for run in runs if run["part"] != "grid's place" and not run["coarser"]]  # no setting of anybody
        enough = min(
            (run for run in choices if run["expected_error"] <= borne), key=lambda run: run["cpu_seconds"], default=None
        )
        if math.isnan(widths["cells"]):
            return "no cells but the deck's were run: give a larger --budget"
        if enough:
            setting = f"cell {enough['setting']:.4g}" if enough["part"] in ("deck", "cells") else enough["setting"]
            return f"the tolerance is reached for the least by {setting}: {clock(enough['cpu_seconds'])} of CPU time"
        cell = needed_cell(self.cell, widths, found, borne)
        if cell is not None:
            cost = runs[0]["cpu_seconds"] * (self.cell / cell) ** (self.dimension + 1)
            return f"the tolerance should be reached by cell {cell:.2g}, by the order: about {clock(cost)} of CPU time"
        largest = max((width, part) for part, width in widths.items() if not math.isnan(width))[1]
        return f"none of the runs reaches the tolerance; the largest part is: {largest}" + (
            f" ({found.words})" if largest == "cells" else ""
        )


# ---------------------------------------------------------------- results

def finite(value):
    """A value for JSON, which has no nan."""
    if isinstance(value, dict):
        return {name: finite(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def keep(study, estimates):
    """Writes error.json, and `error_estimate` into the summaries of the deck's run."""
    estimates = finite(estimates)
    (study.folder / "error.json").write_text(json.dumps(estimates, indent=1) + "\n")
    for folder in (study.runner.output(study.own), Path(study.deck.path.stem + ".out")):
        summary = read_summary_if_any(folder)
        if summary and summary.get("checksum") == study.summary["checksum"]:
            kept = {**summary.get("error_estimate", {}), **{estimate["quantity"]: estimate for estimate in estimates}}
            path = folder / "summary.json"
            path.with_suffix(".part").write_text(
                json.dumps({**summary, "error_estimate": kept}, indent=2, ensure_ascii=False) + "\n"
            )
            path.with_suffix(".part").replace(path)


def name_of_method(member):
    """The method of a copy with another one."""
    return member.words.split()[1].rstrip(",")


def known(folder, quantity):
    """Sees that a run has a quantity; says which names are near."""
    names = list(listed(folder))
    bare = quantity.partition(":")[0]
    if bare in names and not (
        ":" in quantity and (quantity.partition(":")[2] not in OF_ROWS or bare.split(".")[0] not in (*KEYS, "history"))
    ):
        return
    near = difflib.get_close_matches(bare, names, 3, 0.5)
    raise SgmpFileError(
        f"--quantity {quantity}: there is none; "
        + (f"near it: {', '.join(near)}; " if near else "")
        + "all by --list, with "
        f":{', :'.join(OF_ROWS)} behind those of bodies, gauges and history"
    )


def first_value(folder, name):
    """A quantity after one step; nothing for what needs another run or more rows."""
    try:
        return "" if name.startswith("shape.") else f"{quantity_of(folder, name):.6g}"
    except SgmpFileError:
        return ""


def show_list(folder):
    """Prints the quantities."""
    units = read_units(folder)
    for name in listed(folder):
        print(f"{name:<44} {first_value(folder, name):>14} {unit_of(name, units)}".rstrip())
    print("shapes: distances of the surface to that of the run given by --against, else between the runs of the study")
    print(f"behind bodies, gauges and history: :{', :'.join(OF_ROWS)} (gauges.NAME.pressure:max)")


def run(options):
    """Runs what is missing, prints the numbers with their errors, writes and draws them."""
    study = Study(options)
    first = study.probe()
    if options.list:
        show_list(first)
        return 0
    if not options.quantity:
        raise ValueError("which number? --quantity NAME; --list shows the names")
    for quantity in options.quantity:
        known(first, quantity)
    if options.check:
        study.plan()
        return 0
    study.run(options)
    estimates = [study.estimate(quantity, options.tolerance) for quantity in options.quantity]
    keep(study, estimates)
    for note in study.notes:
        print(f"note: {note}")
    if study.summary["verdict"] != "sound":
        print(f"the deck's run is {study.summary['verdict']}: {'; '.join(study.summary['verdict_reasons'])}")
    for estimate in estimates:
        print(estimate["line"])
        print(f"  cells: {estimate['cells']}; {estimate['advice']}")
        if estimate["failed"]:
            print(f"  failed, and in no part of the error: {'; '.join(estimate['failed'])}")
    print(study.folder / "error.json")
    draw(finite(estimates), study.folder / "error.png")
    print(study.folder / "error.png")
    return 0
