#!/usr/bin/env python3
"""Two bars that collide in one dimension: stress, duration and momentum against the exact solution."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import main, solve  # noqa: E402
from contact import METHODS, NAMES, contact, deck  # noqa: E402

SPEED = 1e-3


def check(book, full):
    """Impedances 1 : 1 and 1 : 4; equal wave speeds, so the bars part after 2 L/c in both."""
    book.section("Contact: two bars")
    cases = [(method, ratio) for method in METHODS for ratio in (1, 4)]
    runs = solve(
        [deck("contact_bars/bars", method=method, cells=200 if full else 100, ratio=ratio) for method, ratio in cases]
    )
    for (method, ratio), run in zip(cases, runs):
        force = SPEED*ratio/(1 + ratio)
        rows, momentum = contact(run), run.history()["momentum_x"]
        name = f"bars, impedance 1:{ratio}, {NAMES[method]}"
        inside = (rows["time"] > 0.5) & (rows["time"] < 1.5)
        book.within(name, "stress while in contact", -rows["force_x"][inside].mean(), force, 0.02)
        book.within(name, "time at which they part", rows["time"][-rows["force_x"] > 0.5*force][-1], 2.0, 0.02)
        book.at_most(name, "change of momentum, relative", max(abs(momentum/momentum[0] - 1)), 1e-12)
    book.command(runs[0].case)


if __name__ == "__main__":
    main(check, __doc__)
