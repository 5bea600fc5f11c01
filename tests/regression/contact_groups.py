#!/usr/bin/env python3
"""Groups of bodies in contact (doc/contact.md): two halves of a plate and of a gas behave as one body, in all methods
and spaces; names, warnings, the same bits.

usage: contact_groups.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: what is cut in two without a reason moves as the whole does.
"""
import os
import subprocess

from _restarts import mpirun, straight
from _runs import ENVIRONMENT, SCRATCH, SGMP, Report, run

# A ball of gas-like matter between a plate and a punch; {plate} and {gas} are one body each or two halves.
SCENE = """
parameter method = {method}
dimension {dimension}
grid cell=0.25 {grid}
wall {walls}
method $method update={update}
time end=1.2 cfl=0.3
material steel j2 density=4 young=200 poisson=0.3 yield=2
material air fluid density=1
eos air ideal_gas gamma=1.4 pressure0=0.5
viscosity all
{plate}
{gas}
body punch block material=steel {punch} spacing=0.125
velocity punch {axis}=-1
contact {contact} friction=0.1
history every=0.1
output csv at=end
"""
SPACES = {
    "2": ("x=0:2 y=0:open", "x-=slip x+=slip y-=slip", "lower=(0,{}) upper=(2,{})", "lower=({},{}) upper=({},{})", "y"),
    "axisymmetric": (
        "r=0:2 z=0:open", "r+=slip z-=slip", "lower=(0,{}) upper=(2,{})", "lower=({},{}) upper=({},{})", "z",
    ),
}


def deck(dimension, method, update, halves, contact):
    grid, walls, whole, part, axis = SPACES[dimension]

    def bodies(name, material, low, high):
        if not halves:
            return f"body {name} block material={material} {whole.format(low, high)} spacing=0.125"
        return "\n".join(f"body {name}{i} block material={material} {part.format(left, low, right, high)} spacing=0.125"
                         for i, (left, right) in enumerate(((0, 0.75), (0.75, 2)), 1))

    return SCENE.format(
        dimension=dimension, method=method, update=update, grid=grid, walls=walls, axis=axis, contact=contact,
        plate=bodies("plate", "steel", 0, 0.75), gas=bodies("gas", "air", 0.75, 1.5), punch=whole.format(1.5, 2.25),
    )


def same_as_whole(report):
    for dimension, method, update in (
        ("2", "sgmp", "musl"), ("2", "mpm", "usavg"), ("2", "gimp", "musl"), ("axisymmetric", "sgmp", "usf"),
        ("2", "bspline", "usl"),
    ):
        name = f"{dimension}_{method}_{update}"
        whole = straight(report, f"whole_{name}", deck(dimension, method, update, False, "all"))
        # Between the halves of the plate there is no card, nor between those of the gas.
        cards = " friction=0.1\ncontact ".join(["punch", "gas1 plate1", "gas1 plate2", "gas2 plate1", "gas2 plate2"])
        halves = straight(report, f"halves_{name}", deck(dimension, method, update, True, cards))
        for key in ("energy.kinetic", "energy.internal", "energy.contact_dissipation"):
            a, b = whole[key], halves[key]
            report.check(
                abs(a - b) < 1e-7 * abs(whole["energy.initial_total"]),
                f"{name}: {key} of one body {a}, of two halves {b}",
            )


def looked_at(text):
    """What --check says of a deck, warnings of its cards among it."""
    path = os.path.join(SCRATCH, "looked_at.inp")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return subprocess.run(
        [SGMP, path, "--check"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, text=True,
        env=ENVIRONMENT,
    ).stdout


def card_group(report):
    """With cards `group` the halves move as the whole does, whatever contact card is for them; the group's name stands
    for both."""
    groups = "\ngroup plate plate1,plate2\ngroup gas bodies=(gas1,gas2)\n"
    for dimension, method, update in (("2", "sgmp", "musl"), ("2", "mpm", "usl"), ("axisymmetric", "gimp", "usavg")):
        name = f"{dimension}_{method}_{update}"
        whole = straight(report, f"one_{name}", deck(dimension, method, update, False, "all"))
        for title, cards in (("all", "all"), ("pairs", "gas plate friction=0.1\ncontact punch")):
            halves = straight(report, f"group_{title}_{name}", deck(dimension, method, update, True, cards) + groups)
            for key in ("energy.kinetic", "energy.internal", "energy.contact_dissipation"):
                a, b = whole[key], halves[key]
                report.check(
                    abs(a - b) < 1e-7 * abs(whole["energy.initial_total"]),
                    f"{name}, {title}: {key} of one body {a}, of a group of halves {b}",
                )


def checked(report):
    """--check says what is a field, what touches and what passes through."""
    groups = "\ngroup plate plate1,plate2\n"
    text = looked_at(deck("2", "sgmp", "musl", True, "plate punch") + groups)
    for wanted in (
        "plate1+plate2, stick together (group plate)", "gas1+gas2, mix", "contact     plate1+plate2 and punch",
        "contact     plate1+plate2 and gas1+gas2", "default   contact all",
    ):
        report.check(wanted in text, f"--check does not say '{wanted}':\n{text}")
    bare = deck("2", "sgmp", "musl", True, "all").replace("contact all friction=0.1", "")
    text = looked_at(bare.replace("velocity punch y=-1", "") + "\nrigid punch y=-1\n")
    for wanted in ("'gas1' flows and sticks to 'plate1'", "plate1+plate2+gas1+gas2, stick together (default:"):
        report.check(wanted in text, f"--check does not say '{wanted}':\n{text}")
    bare = bare.replace("velocity punch y=-1", "velocity punch y=-0.5")
    text = looked_at(bare + groups)
    for wanted in ("default   contact all", "plate1+plate2 and punch, friction 0"):
        report.check(wanted in text, f"--check does not say '{wanted}':\n{text}")
    text = looked_at(bare + "\ngroup all_solids plate1,plate2,punch\ngroup gas gas1,gas2\n")
    for wanted in ("contact     none: all bodies share one velocity field", "group 'gas' does nothing"):
        report.check(wanted in text, f"--check does not say '{wanted}':\n{text}")
    report.check("group 'all_solids' does nothing" not in text, f"a group of solids does nothing:\n{text}")


def errors(report):
    """What a group cannot be."""
    for cards, message in (
        ("group a plate1,plate3", "there is no body 'plate3'"),
        ("group a plate1,plate2\ngroup b plate2,gas1", "is in two groups: 'a' and 'b'"),
        ("group a plate1", "a group of one body"), ("group gas1 plate1,plate2", "'gas1' is the name of a body"),
        ("group a plate1,plate2\ngroup a gas1,gas2", "there are two groups 'a'"),
        ("group a plate1,plate1", "is named twice"),
        ("group a plate1,plate2\ncontact plate1 gas1", "name the group: a"),
        ("group a plate1,plate2\ncontact a a", "contact of a group with itself"),
        ("group a plate1,punch\nrigid punch", "body 'punch' is rigid"),
        ("group a plate1,gas1", "of gases or fluids and of solids: they stick together"),
        ("group a plate1,plate2,gas1,gas2,punch", "all bodies are in one group"),
    ):
        text = looked_at(deck("2", "sgmp", "musl", True, "all") + "\n" + cards + "\n")
        report.check(message in text, f"{cards!r}: no '{message}' in\n{text}")


def names(report):
    result = straight(report, "names", deck("2", "sgmp", "musl", True, "all"))
    with open(result.folder + "/contact.csv", encoding="utf-8") as file:
        text = file.read()
    report.check("gas1+gas2" in text, "contact.csv names the bodies of a group")
    report.check("plate1 plate2" in text, "halves of a plate touch where `contact all` says so")


def warnings(report):
    text = deck("2", "sgmp", "musl", True, "gas1 punch")
    result = run("strangers", text, options=("--check",))
    report.check(
        "pass through each other" in result.text, f"bodies in other fields without a card are named\n{result.text}"
    )


def bits(report):
    for groups in ("", "group plate plate1,plate2"):
        text = deck("2", "sgmp", "musl", True, "all") + "\n" + groups + "\n"
        reference = straight(report, f"bits{len(groups)}", text)
        for title, threads, launcher in (("threads", 3, ()), ("ranks", 1, mpirun(3))):
            other = straight(report, f"bits_{title}{len(groups)}", text, threads=threads, launcher=launcher)
            report.check(
                other["checksum"] == reference["checksum"],
                f"{title} {groups}: checksum {other['checksum']}, not {reference['checksum']}",
            )


if __name__ == "__main__":
    REPORT = Report()
    same_as_whole(REPORT)
    card_group(REPORT)
    checked(REPORT)
    errors(REPORT)
    names(REPORT)
    warnings(REPORT)
    bits(REPORT)
    REPORT.end()
