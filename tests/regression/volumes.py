#!/usr/bin/env python3
"""Kept volumes (doc/volumes.md): gas that fills a box from one side, in every space; the ledger's columns; what the
plain method says.

usage: volumes.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: gas fills its box, p V = (gamma - 1) E whatever way it came there, and energy is conserved.
"""
from _runs import KEPT, KEPT_PLANE, KEPT_RINGS, KEPT_SPACE, Report, run

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


def main():
    """All of them."""
    report = Report()
    settles(report)
    plain(report)
    by_itself(report)
    report.end()


main()
