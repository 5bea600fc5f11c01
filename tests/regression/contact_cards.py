#!/usr/bin/env python3
"""The keys of the card contact: which of several cards counts, whose normal, how close bodies touch, how deep it
reaches.

Expected: free flight by hand for the distance; for the others, two ways to say the same, which must give the same bits.

usage: contact_cards.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import Report, run

SLIDE = """
dimension 2
grid cell=0.1
method sgmp
time end=0.05 cfl=0.5
gravity (6,-8)
material soft elastic density=1000 young={plate} poisson=0.3
material hard elastic density=1000 young={block} poisson=0.3
body plate block material=soft lower=(-0.5,-0.3) upper=(1,0) rotation=20
body block block material=hard lower=(0,0) upper=(0.5,0.3) rotation=20
body far block material=hard lower=(5,5) upper=(5.5,5.3)
{cards}
"""
FALL = """
parameter speed = 2
dimension {dimension}
grid cell=0.5
method {method}
time dt=1e-3 steps=900
material m elastic density=2 young=1e3 poisson=0
body table block material=m lower=(-4,-2,-{deep}) upper=(4,0,{deep}) ppc={ppc}
body block block material=m lower=(-1,1.2,-{thick}) upper=(1,2.2,{thick}) ppc={ppc}
rigid table
velocity block y=-speed
contact table block {keys}
history steps=1
"""


def slide(report, name, cards, plate=1e6, block=1e6):
    """Checksum of the sliding block under some cards."""
    result = run(f"slide_{name}", SLIDE.format(cards="\n".join(cards), plate=plate, block=block))
    return result["checksum"] if report.finished(result, name) else None


def precedence(report):
    """The card that names more counts, whatever the order of the cards."""
    rough, smooth, one = "contact plate block friction=0.6", "contact all friction=0", "contact block friction=0.2"
    wanted = {
        card: slide(report, "alone", [card, "contact far" if card != smooth else ""]) for card in (rough, smooth, one)
    }
    report.check(len(set(wanted.values())) == 3, f"friction has no effect: {wanted}")
    for cards, counts in (
        ([rough, smooth], rough), ([smooth, rough], rough), ([one, rough], rough), ([rough, one], rough),
        ([smooth, one], one), ([one, smooth], one), ([smooth, rough, one], rough),
    ):
        report.check(slide(report, "cards", cards) == wanted[counts], f"{cards}: not {counts} counts")
    turned = slide(report, "turned", ["contact block plate friction=0.6", "contact far"])
    report.check(turned is not None, "the pair the other way round")


def taken(report):
    """What friction takes from a sliding block is in the row of its pair and in the ledger."""
    deck = SLIDE.format(cards="contact plate block friction=0.3\ncontact far\nhistory steps=5", plate=1e6, block=1e6)
    result = run("taken", deck.replace("gravity (6,-8)", "gravity (6,-8)\nvelocity block x=2 y=0.7"))
    if report.finished(result, "taken"):
        ledger = result.table("history.csv")[-1]["contact_dissipation"]
        pairs = result.table("contact.csv")
        found = sum(row["dissipation"] for row in pairs if row["step"] == pairs[-1]["step"])
        report.check(
            ledger > 0 and abs(found / ledger - 1) < 1e-12, f"taken by friction: {found}, in the ledger {ledger}"
        )


def normals(report):
    """`stiffer` is the normal of the body with the larger modulus."""
    for plate, block, same in ((1e6, 3e6, "second"), (3e6, 1e6, "first")):
        found = {
            kind: slide(report, kind, [f"contact plate block friction=0.3 normal={kind}", "contact far"], plate, block)
            for kind in ("first", "second", "stiffer", "average", "separating")
        }
        report.check(found["stiffer"] == found[same], f"{plate:g}, {block:g}: stiffer is not {same}: {found}")
        report.check(len({found["first"], found["second"], found["average"]}) == 3, f"normals are alike: {found}")


def distance(report):
    """A block in free flight is touched when its particles are lambda cells from the table's, not before."""
    cell, speed, dt = 0.5, 2.0, 1e-3
    for dimension in (2, 3):
        for method in ("sgmp", "mpm") if dimension == 2 else ("sgmp",):
            for ppc, keys, wanted in ((2, "", 0.5), (3, "", 1/3), (2, "lambda=0.8", 0.8), (2, "lambda=0.35", 0.35)):
                name = f"fall_{dimension}_{method}_{ppc}_{keys.replace('=', '')}"
                deck = FALL.format(
                    dimension=dimension, deep=4 * (dimension - 2), thick=dimension - 2, method=method, ppc=ppc,
                    keys=keys,
                )
                result = run(name, deck.replace("steps=900", "steps=700"))
                if not report.finished(result, name):
                    continue
                step = next((int(row["step"]) for row in result.table("contact.csv") if row["contact_nodes"] > 0), None)
                if not report.check(step, f"{name}: never touched"):
                    continue
                # The layers of particles nearest to each other start 1.2 and a spacing apart.
                gap = 1.2 + cell/ppc - speed*dt*(step - 1)
                report.check(
                    abs(gap - wanted * cell) <= 2.5 * speed * dt,
                    f"{name}: touched at {gap / cell:.4f} cells, expected {wanted:.4f}",
                )


def depth(report):
    """The surfaces meet a fifth of a cell below a row of nodes: with half a cell of depth this one takes part and no
    other. So it does where they meet two fifths below it, for depth is measured half way between the particles, which
    are half a cell apart."""
    nodes = {}
    deck = FALL.format(dimension=2, deep=0, thick=0, method="sgmp", ppc=2, keys="depth=0.5")
    result = run("depth", deck.replace("(-4,-2,-0)", "(-4,-2.2,0)").replace("(4,0,0)", "(4,-0.2,0)"))
    if report.finished(result, "depth, two fifths"):
        most = max(row["contact_nodes"] for row in result.table("contact.csv"))
        report.check(most == 5, f"nodes in contact, two fifths of a cell below them: {most}")
    for keys in ("", "depth=0.5", "depth=3"):
        deck = FALL.format(dimension=2, deep=0, thick=0, method="sgmp", ppc=2, keys=keys)
        result = run("depth", deck.replace("(-4,-2,-0)", "(-4,-2.1,0)").replace("(4,0,0)", "(4,-0.1,0)"))
        if report.finished(result, f"depth {keys}"):
            nodes[keys] = max(row["contact_nodes"] for row in result.table("contact.csv"))
    # The block is four cells wide: five nodes of a row carry it. Particles of both bodies lie within the cell and a
    # half that
    # a node reaches of three rows: 0.8 cells below the surfaces, 0.2 and 1.2 above; a rigid block that covers the
    # other does not hold the last.
    report.check(nodes == {"": 10, "depth=0.5": 5, "depth=3": 15}, f"nodes in contact: {nodes}")


def main():
    """All of it."""
    report = Report()
    for part in (precedence, taken, normals, distance, depth):
        part(report)
    report.end()


main()
