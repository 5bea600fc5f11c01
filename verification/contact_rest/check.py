#!/usr/bin/env python3
"""Bodies at rest on each other: contact makes no energy; an arch of seven wedges stands by friction alone."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import NAMES, main, solve  # noqa: E402
from contact import METHODS, body, deck, excess  # noqa: E402

BOUND = 2e-3  # two blocks swing by 1.5e-3, three by 0.5e-3: of second order in the step
UPDATES = ("musl", "usf", "usavg", "usl")


def stacks(book, full):
    """Energy of stacks to t = 40."""
    cases = [(3, method, update, {}) for method in METHODS for update in (UPDATES if full else ("musl", "usavg"))]
    cases += [(2, "sgmp", "usavg", {}), (3, "sgmp", "usavg", {"friction": 0}), (3, "sgmp", "usavg", {"depth": 0.6}),
              (3, "sgmp", "usavg", {"normal": "average"})]
    if full:
        cases += [(10, method, update, {}) for method in METHODS for update in ("musl", "usavg")] + [
            (3, "cpgimp", "usavg", {})
        ]
    runs = solve(
        [
            deck(f"contact_rest/stack_{blocks}", method=method, update=update, **more)
            for blocks, method, update, more in cases
        ]
    )
    rows = []
    for (blocks, method, update, more), run in zip(cases, runs):
        what = ", ".join(f"{key} {value}" for key, value in more.items())
        name = f"{blocks} blocks, {NAMES.get(method, method)} {update.upper()}" + (f", {what}" if what else "")
        mean, most, falls, taken = excess(run.history(), update)
        rows.append([name, float(mean), float(most), float(taken), float(falls)])
        book.at_most(name, "largest energy of unknown origin over the work", most, BOUND)
        if update == "usavg":  # the others take energy from what vibrates, without contact, too
            book.at_most(name, "its mean over the last fifth", abs(mean), 1e-3)
    book.table(
        "contact_rest", ["case", "energy of unknown origin, late mean", "largest", "taken by contact", "falls of that"],
        rows, "Over the largest external work, t = 40.",
    )
    book.command(runs[0].case)


def arch(book, full):
    """The arch with friction, and without."""
    updates = UPDATES[:3] if full else ("musl",)
    cases = [(update, friction) for update in updates for friction in (0.6, 0)]
    runs = solve([deck("contact_rest/arch", update=update, friction=friction) for update, friction in cases])
    for (update, friction), run in zip(cases, runs):
        name = f"arch, SGMP {update.upper()}, friction {friction}"
        crown = body(run, 5)
        sunk, fall = crown["y"][0] - crown["y"][-1], 0.5*0.1*crown["time"][-1]**2
        if friction:
            book.at_most(name, "the crown has sunk (over the height of the arch)", sunk/9, 0.01)
        else:
            book.at_least(name, "the crown has sunk (over free fall)", sunk/fall, 0.5)
    book.command(runs[0].case)


def check(book, full):
    """Stacks and the arch."""
    book.section("Contact: bodies at rest")
    stacks(book, full)
    arch(book, full)


if __name__ == "__main__":
    main(check, __doc__)
