#!/usr/bin/env python3
"""Two elastic rings collide and part: momentum, energy, rebound."""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import NAMES, Case, main, solve  # noqa: E402
from contact import METHODS, body, contact  # noqa: E402

SPEED = 30.0


def check(book, full):
    """MUSL at h = 2 mm; full: h = 1 mm, and all schemes."""
    book.section("Contact: two rings")
    cases = [(method, "musl") for method in METHODS]
    if full:
        cases += [(method, update) for method in METHODS for update in ("usf", "usl", "usavg")]
    runs = solve(
        [
            Case("rings", h=1 if full else 2, method=method, update=update, cfl=0.5 if method == "sgmp" else 0.3)
            for method, update in cases
        ],
        may_fail=True,
    )
    rows = []
    for (method, update), run in zip(cases, runs):
        name = f"rings, {NAMES[method]} {update.upper()}"
        history, left, right, pair = run.history(), body(run, 1), body(run, 2), contact(run)
        if run.exit_code:
            rows.append([name, float("nan"), float("nan"), float("nan"), f"stopped at {history['time'][-1]:.3g} ms"])
            continue
        total, scale = history["momentum_x"], left["mass"][0]*SPEED
        drift = max(abs(total - total[0]))/scale
        loss = 1 - history["total_energy"][-1]/history["total_energy"][0]
        touched = pair["time"][np.abs(pair["force_x"]) > 0]
        rebound = 0.5*(right["velocity_x"][-1] - left["velocity_x"][-1])
        rows.append(
            [name, float(drift), float(100 * loss), float(rebound / SPEED), f"{touched[0]:.3g} to {touched[-1]:.3g} ms"]
        )
        book.at_most(name, "change of momentum over that of one ring", drift, 1e-12)
        if update == "musl":
            book.at_most(name, "energy lost over the whole collision (%)", 100*loss, 2.0,
                         "" if full else "the ring is five cells thick, and each closing of a contact takes energy",
                         known=None if full else {"sgmp": 2.856}.get(method))
            book.at_most(name, "last contact (ms)", touched[-1], 4.0)
    book.table(
        "contact_rings", ["case", "momentum", "energy lost (%)", "rebound over speed", "contact"], rows,
        "Momentum relative to that of one ring. The rest of the rings' energy after the rebound is in their vibration.",
    )
    book.command(*[run.case for run in runs])


if __name__ == "__main__":
    main(check, __doc__)
