#!/usr/bin/env python3
"""Hypervelocity impact of aluminium on aluminium: Whipple shields, craters, ballistic limits.

Known from outside: energy is conserved, debris does not pass a whole wall. Printed equations (lengths in cm, densities
in g/cm^3, yield stresses in ksi, speeds in km/s, Brinell's hardness HB):

    P  = 5.24 d^(19/18) (rho_p/rho_t)^(1/2) (V/C)^(2/3)/HB^(1/4), C: speed of sound in the target
    crater in a thick target; a wall of 1.8 P is just perforated   (1)
    dc = ((t_w (sigma/40)^(1/2) + t_b)/(0.6 rho_p^(1/2) V^(2/3)))^(18/19)
    V below 2.6 to 3 km/s       (2)
    dc = 3.918 t_w^(2/3) S^(1/3) (sigma/70)^(1/3)/(rho_p^(1/3) rho_b^(1/9) V^(2/3))
    V above 7 km/s              (3)

(1) Cour-Palais, Int. J. Impact Engng 5 (1987), 221-237, and Christiansen et al., NASA/TM-2009-214785 (1.8 P: from
memory of the literature); (2), (3)
Christiansen's, as in Ryan and Christiansen, Acta Astronautica 69 (2011), 245-257 (head on; (3) for bumpers of a fourth
of the diameter at least). Shots: Piekutowski's, 2017-T4 on 1.28 mm of 6061-T6 and 3.2 mm of 2219-T87, 101.6 mm apart:
4.511 mm at 7.00 km/s is held, 4.765 mm at 6.98 km/s is not.
"""

import shutil
import subprocess
import sys
from math import pi, sqrt
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import BUILD, ROOT, SOLVER, Case, main, solve, subplots  # noqa: E402
from sgmp_view.files import dumps_of  # noqa: E402
from sgmp_view.matter import cloud_of, matter_of, start_and_dump  # noqa: E402
from sgmp_view.wall import Shot, wall_of  # noqa: E402

FOLDER = "verification/hypervelocity"
BALL = 4 / 3 * pi * 2.5**3 * 2.7e-3  # g
SHOTS = ((4.511, 7000, False), (4.765, 6980, True))
MIDDLE = 0.5 * (SHOTS[0][0] + SHOTS[1][0])
SHOT_HEADS = (
    "h (mm)", "d (mm)", "m/s", "perforated", "opening (mm)", "least thickness (mm)", "bulge (mm)", "drift", "verdict",
)
GAP, WALL, BUMPER, KSI = 10.16, 0.32, 0.128, 51.0  # cm; yield stress of 2219-T87


def crater_depth(d, v, hardness=95.0, sound=5.1, density=2.785, target=2.703):
    """(1), mm; 6061-T6."""
    return 10 * 5.24 * (d / 10) ** (19 / 18) * sqrt(density / target) * (v / sound) ** (2 / 3) / hardness**0.25


def slow_limit(v, density=2.785):
    """(2), mm."""
    return 10 * ((WALL * sqrt(KSI / 40) + BUMPER) / (0.6 * sqrt(density) * v ** (2 / 3))) ** (18 / 19)


def fast_limit(v, density=2.785, bumper=2.703):
    """(3), mm."""
    return (
        10
        * 3.918
        * WALL ** (2 / 3)
        * GAP ** (1 / 3)
        * (KSI / 70) ** (1 / 3)
        / (density ** (1 / 3) * bumper ** (1 / 9) * v ** (2 / 3))
    )


def wall_in(run, name):
    """What sgmp-view impact says of a wall in the last dump."""
    start, now = start_and_dump(run.folder)
    return wall_of(start, now, name, Shot(start))


def front(run, time):
    """Speed of the foremost 2 % of what is behind the bumper, about a time."""
    dump = min(dumps_of(run.folder), key=lambda d: abs(d.time - time))
    first = cloud_of(run.folder, dumps_of(run.folder)[0].read())
    now = matter_of(run.folder, cloud_of(run.folder, dump.read()), first)
    behind = (now.points[:, 2] < -2.5) & (now.velocity[:, 2] < -500) & ~now.of("wall")
    order = np.argsort(now.points[behind, 2])
    mass = now.mass[behind][order].cumsum()
    foremost = mass <= 0.02 * mass[-1]
    return float(
        -(now.mass[behind][order] @ (now.velocity[behind, 2][order] * foremost)) / (now.mass[behind][order] @ foremost)
    )


def shield(book, full):
    """Energy, speeds and leaks of a shield, and what two cell sizes say of it."""
    sizes = (0.5, 0.25, 0.125) if full else (0.5, 0.25)
    rows, found = [], []
    for h, run in zip(sizes, solve([Case(f"{FOLDER}/whipple.inp", keep_dumps=True, h=h) for h in sizes])):
        end = run.particles()
        mass, body, places = end.column("mass"), end.column("body"), end.points
        speed = np.sqrt(sum(end.column(f"velocity_{a}") ** 2 for a in "xyz"))
        leaked = mass[(body < 3) & (places[:, 2] < -87) & (places[:, 0] < 40)].sum() / BALL
        pushed = (mass * end.column("velocity_z"))[body == 3].sum()
        found.append((abs(front(run, 0.012)), abs(pushed)))
        drift = run.summary["energy"]["drift"]
        rows.append(
            [
                h, f"{100 * drift:+.2f} %", f"{speed.max() / 1000:.1f}", f"{found[-1][0] / 1000:.2f}",
                f"{pushed:.0f}", f"{leaked:.1e}", run.summary["verdict"],
            ]
        )
        case = f"shield, h = {h} mm"
        book.at_most(case, "|drift| of the energy", abs(drift), 0.03)
        book.at_most(case, "fastest particle at the end (m/s)", speed.max(), 9000)
        book.at_most(case, "debris behind the whole wall over the ball's mass", leaked, 1e-4)
    book.within(
        "shield", f"speed of the cloud's front, h = {sizes[-2]} against {sizes[-1]} mm", found[-2][0], found[-1][0],
        0.05,
    )
    book.within(
        "shield", f"momentum of the wall, h = {sizes[-2]} against {sizes[-1]} mm", found[-2][1], found[-1][1], 0.05,
        NOTES["shield"], KNOWN.get(("shield", sizes[-2])),
    )
    book.table(
        "hypervelocity_shield",
        ["h (mm)", "drift", "fastest (km/s)", "front (km/s)", "wall (g m/s; the ball had 1070)", "leak", "verdict"],
        rows, "Whipple shield at 40 µs.",
    )
    book.command(Case(f"{FOLDER}/whipple.inp", h=0.25))


def quarter(book):
    """The shield in space: energy and speeds."""
    run = solve([Case(f"{FOLDER}/quarter.inp")])[0]
    end, drift = run.particles(), run.summary["energy"]["drift"]
    speed = np.sqrt(sum(end.column(f"velocity_{a}") ** 2 for a in "xyz"))
    book.at_most("shield, a quarter in space, h = 1 mm", "|drift| of the energy", abs(drift), 0.03)
    book.at_most("shield, a quarter in space, h = 1 mm", "fastest particle at the end (m/s)", speed.max(), 9000)
    book.command(run.case)


def crater(book, full):
    """Depth of craters against (1)."""
    rows, speeds = [], (3000, 6000, 7000)
    figure, axis = subplots(figsize=(5, 3.4))
    curve = np.linspace(2.5, 7.5, 60)
    axis.plot(curve, crater_depth(5, curve), color="black", label="equation (1)")
    for h in (1.0, 0.5, 0.25) if full else (1.0, 0.5):
        runs = solve([Case(f"{FOLDER}/crater.inp", keep_dumps=True, h=h, speed=speed) for speed in speeds])
        walls = [wall_in(run, "target")["crater"] for run in runs]
        for speed, run, wall in zip(speeds, runs, walls):
            rows.append(
                [
                    h, speed, f"{wall['depth']:.2f}", f"{crater_depth(5, speed / 1000):.2f}", f"{wall['radius']:.2f}",
                    f"{wall['volume']:.0f}", f"{100 * run.summary['energy']['drift']:+.2f} %",
                ]
            )
        axis.plot(
            [v / 1000 for v in speeds], [wall["depth"] for wall in walls], "os^"[len(rows) // 3 - 1],
            label=f"h = {h} mm",
        )
    for speed, wall in zip(speeds, walls):
        book.within(
            "crater", f"depth at {speed} m/s, h = {h} mm (mm), against (1)", wall["depth"],
            crater_depth(5, speed / 1000), 0.1, NOTES["crater"], KNOWN.get(("crater", speed, h)),
        )
    axis.set(xlabel="speed (km/s)", ylabel="depth (mm)")
    axis.legend(fontsize=7)
    book.figure("hypervelocity_crater", figure, "Depth of the crater of a ball of 5 mm of 2024-T3 in 6061-T6.")
    book.table(
        "hypervelocity_crater", ["h (mm)", "m/s", "depth (mm)", "(1)", "radius (mm)", "volume (mm³)", "drift"], rows,
        "Craters.",
    )
    book.command(Case(f"{FOLDER}/crater.inp", h=0.5, speed=6000))
    ductile_crater(book)


def ductile_crater(book):
    """The same in metal that bears any tension: depth against (1), volume against energy."""
    rows, speeds = [], (3000, 6000, 7000)
    for h in (1.0, 0.5):
        runs = solve([Case(f"{FOLDER}/crater.inp", keep_dumps=True, h=h, speed=v, target_pmin=-1e5) for v in speeds])
        walls = [wall_in(run, "target")["crater"] for run in runs]
        for speed, wall in zip(speeds, walls):
            depth = crater_depth(5, speed / 1000)
            rows.append(
                [
                    h, speed, f"{wall['depth']:.2f}", f"{depth:.2f}", f"{wall['volume']:.0f}",
                    f"{2 / 3 * pi * depth**3:.0f}",
                ]
            )
    for speed, wall in zip(speeds, walls):
        book.within(
            "crater without spall", f"depth at {speed} m/s, h = {h} mm (mm), against (1)", wall["depth"],
            crater_depth(5, speed / 1000), 0.1, NOTES["ductile"], KNOWN.get(("ductile", speed, h)),
        )
    for speed, wall in zip(speeds[1:], walls[1:]):
        book.within(
            "crater without spall", f"volume at {speed} over that at 3000 m/s, h = {h} mm, against energy",
            wall["volume"] / walls[0]["volume"], (speed / 3000) ** 2, 0.05,
        )
    book.table(
        "hypervelocity_ductile",
        ["h (mm)", "m/s", "depth (mm)", "(1)", "volume (mm³)", "half a ball of radius (1) (mm³)"],
        rows, "Craters in metal that bears any tension.",
    )


def limits(book, full):
    """Piekutowski's two shots, and limits against (2) and (3)."""
    rows = []
    for h in (0.64, 0.32) if full else (0.64,):
        runs = solve([Case(f"{FOLDER}/shield.inp", keep_dumps=True, h=h, d=d, speed=v) for d, v, _ in SHOTS])
        for (d, v, through), run in zip(SHOTS, runs):
            wall = wall_in(run, "wall")
            rows.append(shot_row(h, d, v, run, wall))
            book.add(
                "Piekutowski's shots",
                f"perforated: {d} mm at {v} m/s, h = {h} mm (measured: {'yes' if through else 'no'})",
                float(wall["perforated"]),
                float(through),
                "equal to",
                wall["perforated"] == through,
                NOTES["limit"] if wall["perforated"] != through else "",
                KNOWN.get(("shot", d, h)),
            )
    figure, axis = subplots(figsize=(5, 3.6))
    for curve, law, colour in (
        (np.linspace(1.5, 3, 30), slow_limit, "0.3"),
        (np.linspace(7, 10, 30), fast_limit, "0.6"),
    ):
        axis.plot(curve, law(curve), color=colour, label="equation (2)" if law is slow_limit else "equation (3)")
    # (2) is for balls that are not broken by the bumper; six cells through the wall do for them, not for a cloud.
    points = [
        (speed, part, law, h, tension)
        for law, of, h, tension in (
            (slow_limit, (2000, 2500, 3000), 0.64, -1e5),
            (fast_limit, (7000, 8500, 10000) if full else (8500,), 0.32, -1500),
        )
        for speed in of
        for part in (0.8, 1.2)
    ]
    runs = solve(
        [
            Case(
                f"{FOLDER}/shield.inp", keep_dumps=True, h=h, d=round(part * law(speed / 1000), 3), speed=speed,
                t_end=0.06 * 7000 / speed, ball_pmin=tension,
            )
            for speed, part, law, h, tension in points
        ]
    )
    for (speed, part, law, h, _), run in zip(points, runs):
        wall, d = wall_in(run, "wall"), run.case.parameters["d"]
        rows.append(shot_row(h, d, speed, run, wall))
        axis.plot(speed / 1000, d, "ko" if wall["perforated"] else "kx", fillstyle="none")
        through = part > 1
        book.add(
            "limits",
            f"perforated: {part} of the limit {law(speed / 1000):.2f} mm at {speed} m/s, h = {h} mm",
            float(wall["perforated"]),
            float(through),
            "equal to",
            wall["perforated"] == through,
            NOTES["slow"] if wall["perforated"] != through else "",
            KNOWN.get(("limit", speed, part)),
        )
    for d, v, through in SHOTS:
        axis.plot(
            v / 1000, d, "r^" if through else "rv", label=f"{d} mm: {'perforated' if through else 'held'} (measured)"
        )
    axis.set(xlabel="speed (km/s)", ylabel="diameter (mm)")
    axis.legend(fontsize=7)
    book.figure(
        "hypervelocity_limits",
        figure,
        "Rings: the wall is perforated in the computation, crosses: it is not (below 3 km/s h = 0.64 mm, a ball that "
        "bears any tension; above 7 km/s h = 0.32 mm); triangles: Piekutowski's shots.",
    )
    book.table(
        "hypervelocity_limits",
        SHOT_HEADS,
        rows,
        "Shots at the shield.",
    )
    book.command(Case(f"{FOLDER}/shield.inp", h=0.32, d=4.765, speed=6980))
    limit_by_cells(book, full)
    fragments(book, full)


def limit_by_cells(book, full):
    """The largest ball that is held, for a wall that spalls at the tension which print has, and what cells do to it."""
    rows, found = [], []
    for h in (0.64, 0.32) if full else (0.64,):
        ladder = (3.5, 4.0, 4.5, 5.0, 5.5, 6.0) if h < 0.5 else (3.5, 4.0, 4.5, 5.0)
        runs = solve(
            [Case(f"{FOLDER}/shield.inp", keep_dumps=True, h=h, d=d, speed=6980, wall_pmin=-1100) for d in ladder]
        )
        walls = [wall_in(run, "wall") for run in runs]
        rows += [shot_row(h, d, 6980, run, wall) for d, run, wall in zip(ladder, runs, walls)]
        first = next((k for k, wall in enumerate(walls) if wall["perforated"]), len(ladder) - 1)
        found.append(0.5 * (ladder[max(first - 1, 0)] + ladder[first]))
        book.within(
            "ballistic limit", f"diameter at 6.98 km/s, h = {h} mm (mm), ± 0.25, against the middle of the two shots",
            found[-1], MIDDLE, 0.1, NOTES["cells"], KNOWN.get(("diameter", h)),
        )
    if full:
        book.within(
            "ballistic limit", "diameter, h = 0.64 against 0.32 mm", found[0], found[1], 0.1, NOTES["cells"],
            KNOWN["diameters"],
        )
    book.table(
        "hypervelocity_limit_by_cells",
        SHOT_HEADS,
        rows,
        "Shots at the shield whose wall spalls at 1.1 GPa.",
    )


def fragments(book, full):
    """The smallest fragment at 6 km/s that goes through the wall of the shield by itself: 1.8 P is the thickness."""
    rows, ladder = [], (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2)
    limit = (10 * WALL / 1.8 / crater_depth(1, 6)) ** (18 / 19)
    for h in (0.16, 0.08) if full else (0.16,):
        for d in ladder:
            run = solve([Case(f"{FOLDER}/fragment.inp", keep_dumps=True, h=h, d=d)])[0]
            wall = wall_in(run, "wall")
            rows.append(shot_row(h, d, 6000, run, wall))
            if wall["perforated"]:
                break
        book.within(
            "fragments", f"smallest one that goes through the wall at 6 km/s, h = {h} mm (mm), ± 0.05", d - 0.05,
            limit, 0.1, NOTES["crater"], KNOWN.get(("fragment", h)),
        )
    book.table("hypervelocity_fragments", SHOT_HEADS, rows, "Fragments that hit the wall of the shield.")


def lead(book):
    """A lead ball through a lead plate, from a deck of MPM3D that has no failure: to its end, and the hole."""
    shutil.rmtree(BUILD / "lead", ignore_errors=True)
    subprocess.run(
        [SOLVER, "import", ROOT / FOLDER / "lead.mpm", "--output", BUILD / "lead"], check=True,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )
    text = (BUILD / "lead" / "lead.inp").read_text() + "output vtu every=0.05 fields=density,mass\n"
    rows = []
    for method in ("sgmp", "gimp", "mpm"):
        (BUILD / f"lead_{method}.inp").write_text(text.replace("method sgmp", f"method {method}"))
        run = solve([Case(f"build/verification/lead_{method}.inp", keep_dumps=True)])[0]
        hole, drift = 0.5 * wall_in(run, "body_2")["opening"]["diameter"], run.summary["energy"]["drift"]
        rows.append([method, f"{100 * drift:+.2f} %", f"{hole:.1f}", run.summary["verdict"], f"{run.cpu_seconds:.0f}"])
        book.at_most(
            f"lead, {method}", "|drift| of the energy at 100 µs", abs(drift), 0.03, NOTES["torn"],
            KNOWN.get(("lead", method)),
        )
        book.near(
            f"lead, {method}", "radius of the hole (mm)", hole, 25.0, 2.0, NOTES["hole"], KNOWN.get(("hole", method))
        )
    book.table(
        "hypervelocity_lead", ["method", "drift", "radius of the hole (mm)", "verdict", "CPU s"], rows,
        "Lead ball of 7.42 mm radius through 6.36 mm of lead at 6.58 km/s, 3D, h = 2.12 mm, C = 0.5.",
    )
    book.command(f"build/release/sgmp import {FOLDER}/lead.mpm")


def shot_row(h, d, v, run, wall):
    return [
        h, d, v, "yes" if wall["perforated"] else "no",
        f"{wall['opening']['diameter']:.2f}" if wall["perforated"] and not wall.get("broken_up") else "",
        "" if wall.get("broken_up") else f"{wall['thickness']['least']:.2f}",
        "" if wall.get("broken_up") else f"{wall['bulge']['height']:.2f}",
        f"{100 * run.summary['energy']['drift']:+.2f} %", run.summary["verdict"],
    ]


NOTES = {
    "crater": "deeper than the equation at all speeds and both sizes; what has failed in tension counts as gone "
    "(doc/results.md)",
    "ductile": "finer cells make it deeper; the strength of another law changes little (doc/results.md)",
    "torn": "the deck's Courant number 0.5: of first order in the step, 1.1 % (gimp) and 2.4 % (mpm) with 0.25",
    "hole": "28.4 (gimp) and 28.8 mm (sgmp) with half the cells: the answer of the deck's constants (doc/results.md)",
    "cells": "cells decide it: five and ten through the wall differ by a third",
    "shield": "four cells through the bumper at the coarser size",
    "limit": "a cloud of rings without fragments: one of 0.8 mm goes through this wall by itself (doc/results.md)",
    "slow": "at 3 km/s the ball comes apart even so: the end of the equation's range",
}
KNOWN = {
    ("fragment", 0.16): 0.65,
    ("shield", 0.5): 1215.4,
    ("crater", 3000, 0.5): 7.199,
    ("crater", 6000, 0.5): 11.40,
    ("crater", 7000, 0.5): 13.17,
    ("shot", 4.765, 0.64): 0.0,
    ("shot", 4.765, 0.32): 0.0,  # 1: perforated
    ("ductile", 6000, 0.5): 10.60,
    ("ductile", 7000, 0.5): 11.78,
    ("diameter", 0.32): 5.75,
    "diameters": 4.25,
    ("hole", "gimp"): 28.67,
    ("hole", "mpm"): 27.56,
}


def check(book, full):
    book.section("Hypervelocity impact")
    book.say(
        "No part of the paper. Aluminium on aluminium at 2 to 10 km/s, axisymmetric, with constants of the library."
    )
    shield(book, full)
    if full:
        quarter(book)
    crater(book, full)
    limits(book, full)
    lead(book)


if __name__ == "__main__":
    main(check, __doc__)
