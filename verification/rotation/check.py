#!/usr/bin/env python3
"""Exact rotation (doc/rotation.md): a free disk and a ring of five cells keep their angular momentum; bar, vortex and
rings are as good as without it."""
import importlib.util
import math
import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent.parent / "bar")]
import numpy as np  # noqa: E402
from common import ROOT, Case, main, slopes, solve  # noqa: E402
from contact import deck  # noqa: E402
from exact import error_along  # noqa: E402
from sgmp_view import read_vtu  # noqa: E402

RADIUS, SPIN = 1.6, 3.0
TURNS = "2*pi*10/3"  # end time of ten turns


def angular_momentum(run):
    """Of the particles of the disk over what it had at the start."""
    particles = run.particles()
    velocity, start = particles.fields["velocity"], particles.fields["initial_position"]
    now = (particles.points[:, 0]*velocity[:, 1] - particles.points[:, 1]*velocity[:, 0]).sum()
    return now/(SPIN*(start[:, 0]**2 + start[:, 1]**2).sum())


def disk(book, full):
    """Three radians on three grids, all updates, and ten turns."""
    cases = [{"h": h} for h in (0.4, 0.2, 0.1)] + [{"h": 0.2, "update": update} for update in ("usf", "usl", "usavg")]
    cases += [{"h": 0.2, "t_end": TURNS}, {"h": 0.2, "t_end": TURNS, "update": "usavg"}]
    runs = solve([deck("contact_rolling/spin", rotation="exact", **case) for case in cases])
    rows = []
    for case, run in zip(cases, runs):
        turns = "ten turns" if "t_end" in case else "three radians"
        name = f"free disk, R/h = {RADIUS/case['h']:g}, {case.get('update', 'musl').upper()}, {turns}"
        history, change = run.history(), 100*(angular_momentum(run) - 1)
        remainder = np.abs(history["energy_remainder"]).max()/history["total_energy"][0]
        rows.append(
            [
                name, float(change), float(100 * (history["total_energy"][-1] / history["total_energy"][0] - 1)),
                float(remainder),
            ]
        )
        book.near(name, "change of angular momentum (%)", change, 0.0, 1.0 if turns == "ten turns" else 0.1)
        book.at_most(name, "remainder of the ledger over the energy", remainder, 1e-12)
    book.table(
        "rotation_disk", ["case", "angular momentum (%)", "energy (%)", "remainder"], rows,
        "Free disk with rotation=exact: changes.",
    )
    book.command(runs[0].case)


def ring(book, full):
    """Three turns of a ring five cells thick, where plain SGMP loses all."""
    for update in ("musl", "usavg"):
        run = solve([deck("rotation/ring", rotation="exact", update=update)])[0]
        name = f"free ring, five cells thick, {update.upper()}, three turns"
        book.near(name, "change of angular momentum (%)", 100*(angular_momentum(run) - 1), 0.0, 0.1)
        book.command(run.case)


def held_together(run, radius, speed=0.1, poisson=0.3, rim=1.5):
    """Of a disk that spins under stress: mean radial stress and that around over those of the closed form (plane
    strain), inside a rim, in the last turn; angular momentum and radius over the first."""
    spin = speed/radius
    particles = run.particles()
    velocity, start = particles.fields["velocity"], particles.fields["initial_position"]
    last, first = (points[:, :2] - points[:, :2].mean(axis=0) for points in (particles.points, start))
    radius = math.sqrt(2*(first**2).sum(axis=1).mean())  # of the disk of squares
    a, b = spin**2*(3 - 2*poisson)/(8*(1 - poisson)), spin**2*(1 + 2*poisson)/(8*(1 - poisson))
    found, exact = np.zeros(2), np.zeros(2)
    for name in sorted(run.folder.glob("*.vtu"))[-9:-1]:
        cloud = read_vtu(name)
        place = cloud.points[:, :2] - cloud.points[:, :2].mean(axis=0)
        stress = cloud.fields["stress"]
        r = np.hypot(place[:, 0], place[:, 1]) + 1e-12
        c, s = place[:, 0]/r, place[:, 1]/r
        inside = r < radius - rim
        xx, yy, xy = stress[inside, 0], stress[inside, 1], stress[inside, 3]
        c, s, r = c[inside], s[inside], r[inside]
        found += (xx*c*c + yy*s*s + 2*xy*c*s).sum(), (xx*s*s + yy*c*c - 2*xy*c*s).sum()
        exact += (a*(radius**2 - r**2)).sum(), (a*radius**2 - b*r**2).sum()
    momentum = (last[:, 0]*velocity[:, 1] - last[:, 1]*velocity[:, 0]).sum()/(spin*(first**2).sum())
    return (*(found/exact - 1), momentum - 1, math.sqrt((last**2).sum()/(first**2).sum()) - 1)


def under_stress(book, full):
    """A disk that spins under stress, one turn and ten: in a step a velocity moves what turns along chords."""
    cases = [{"radius": r, "turns": n} for r in (8, 16) for n in (1, 10)]
    cases += [{"radius": 8, "turns": 10, "update": update} for update in ("usf", "usl", "usavg")]
    cases += [{"radius": 8, "turns": 0.5, "cfl": 2}]
    runs = solve([Case("verification/rotation/stressed.inp", keep_dumps=True, **case) for case in cases])
    rows = []
    for case, run in zip(cases, runs):
        name = f"disk under stress, R/h = {case['radius']}, {case.get('update', 'musl').upper()}, {case['turns']} turns"
        if "cfl" in case:
            name += f", C = {case['cfl']}"
        radial, around, momentum, size = held_together(run, case["radius"])
        rows.append([name, *(float(100*value) for value in (radial, around, momentum, size)),
                     float(100*run.summary["energy"]["drift"])])
        most = 0.03 if case["radius"] == 8 else 0.01
        if case["turns"] == 10:
            most = 0.13 if case.get("update") == "usl" else 0.06
        book.near(name, "radial stress in the last turn, error", radial, 0.0, most)
        book.near(name, "stress around in the last turn, error", around, 0.0, most)
        book.near(name, "change of angular momentum (%)", 100*momentum, 0.0, 0.1 if case["radius"] == 16 else 0.6)
        book.near(name, "change of the radius (%)", 100*size, 0.0, 0.5)
    book.table(
        "rotation_stressed",
        ["case", "radial stress (%)", "around (%)", "angular momentum (%)", "radius (%)", "energy (%)"], rows,
        "Disk that spins under stress, its rim at 0.1 c, C = 0.5: errors in the last turn, changes.",
    )
    book.command(runs[0].case)


def bar(book, full):
    """The bar at 45 degrees keeps its order."""
    sizes = (16, 32, 64, 128) if full else (16, 32, 64)
    runs = solve([Case("bar_rotated", cells=n, method="sgmp", rotation="exact") for n in sizes])
    for order, n in zip(slopes([1/n for n in sizes], [error_along(run, 0.02) for run in runs]), sizes):
        book.at_least("bar at 45 degrees, rotation=exact", f"order from 1/{n} on", order, 1.9)
    book.command(runs[0].case)


def vortex(book, full):
    """The vortex in a block: the same errors."""
    module = importlib.util.spec_from_file_location("vortex", ROOT / "verification/vortex/check.py")
    shared = importlib.util.module_from_spec(module)
    module.loader.exec_module(shared)
    for n in (16, 32, 64) if full else (16, 32):
        runs = solve(
            [
                Case("vortex", keep_dumps=True, amplitude=0.25, cells=n, cfl=0.8, method="sgmp", rotation=rotation)
                for rotation in ("plain", "exact")
            ]
        )
        plain, exact = (shared.error(run, 1.0) for run in runs)
        book.within(f"vortex, h = 1/{n}, rotation=exact", "error over that of plain", exact/plain, 1.0, 0.05)
    book.command(runs[1].case)


def check(book, full):
    """Disk, ring, bar, vortex."""
    book.section("Exact rotation")
    disk(book, full)
    ring(book, full)
    under_stress(book, full)
    bar(book, full)
    vortex(book, full)


if __name__ == "__main__":
    main(check, __doc__)
