#!/usr/bin/env python3
"""Free vibration of a beam (paper, 6.1): six combinations of method and scheme; energies, bending stress, period."""

import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import (  # noqa: E402
    COLOURS, NAMES, VARIANTS, Case, draw_plane, main, point, slopes, solve, subplots, work_precision,
)

SCHEMES = ("usf", "musl", "usl")
LINES = {"usf": "--", "musl": "-", "usl": ":"}


def reference():
    with open(Path(__file__).with_name("reference") / "mode.csv") as stream:
        return {row["quantity"]: float(row["value"]) for row in csv.DictReader(stream)}


def period(run):
    """Period of the motion: the kinetic energy, fitted with a constant and the first mode's cos(2 w t), has half of
    it."""
    history = run.history()
    time, kinetic = 1e3 * history["time"], history["kinetic_energy"]

    def misfit(trial):
        phase = 4 * np.pi * time / trial
        base = np.column_stack([np.ones_like(time), np.cos(phase), np.sin(phase)])
        return np.sum((base @ np.linalg.lstsq(base, kinetic, rcond=None)[0] - kinetic)**2)

    trials = np.linspace(24, 34, 1001)
    best = trials[np.argmin([misfit(t) for t in trials])]
    fine = np.linspace(best - 0.02, best + 0.02, 81)
    return float(fine[np.argmin([misfit(t) for t in fine])])


def section_stress(run, half_width):
    """Height above the middle and sigma_xx of the particles near mid-span."""
    particles = run.particles()
    start = particles.fields["initial_position"]
    near = np.abs(start[:, 0] - 30.0) < half_width
    return start[near, 1] - 5.0, particles.column("stress_xx")[near]


def linearity(y, stress):
    """R^2 of a straight line, and its value at the upper surface."""
    line = np.polyfit(y, stress, 1)
    rest = stress - np.polyval(line, y)
    return 1 - np.sum(rest**2) / np.sum((stress - stress.mean())**2), 5.0 * line[0]


def deflection_error(run):
    """Root mean square (mm) of the middle line's deflection at 50 us less that of finite elements
    (reference/deflection.csv)."""
    with open(Path(__file__).with_name("reference") / "deflection.csv") as stream:
        rows = list(csv.DictReader(stream))
    particles = run.particles()
    start = particles.fields["initial_position"]
    # one row on either side, or the row on the line
    near = np.flatnonzero(np.abs(start[:, 1] - 5.0) < 0.75 * run.summary["spacing"])
    columns, which = np.unique(start[near, 0].round(6), return_inverse=True)
    moved = particles.points[near, 1] - start[near, 1]
    middle = np.bincount(which, moved) / np.bincount(which)
    exact = np.interp(columns, [float(row["x_mm"]) for row in rows], [float(row["u_y_mm"]) for row in rows])
    return float(np.sqrt(np.mean((middle - exact)**2)))


def accuracy(book, runs, coarse, full):
    """Error over the cell size, and its price."""
    sizes = (1.0, 0.5, 0.3125)
    errors = [deflection_error(run) for run in (coarse["musl", 1.0], coarse["musl", 0.5], runs["sgmp", "musl"])]
    book.at_least(
        "beam", "order of SGMP MUSL in the deflection, 1 to 0.3125 mm",
        slopes([sizes[0], sizes[-1]], [errors[0], errors[-1]])[0], 1.8, "finite elements, reference/finite_elements.py",
    )
    book.at_most(
        "beam", "deflection of SGMP MUSL at h = 0.3125 mm less that of finite elements, rms (mm; largest 0.487)",
        errors[-1], 0.003,
    )
    book.say(
        "<b>Error norm.</b> The deflection of the middle line at 50 µs against finite elements (total Lagrangian, "
        "two meshes extrapolated): "
        "verification/beam/reference/finite_elements.py, good to about 0.0001 mm."
    )
    if not full:
        return
    curves = [(NAMES[m], m, "-", VARIANTS[m]) for m in ("mpm", "gimp", "cpgimp", "sgmp", "normalised")]
    curves += [
        (f"SGMP {u.upper()}", "sgmp", LINES.get(u, "-."), {"method": "sgmp", "update": u})
        for u in ("usf", "usl", "usavg")
    ]
    curves = [(f"{name}, CFL 0.5", method, line, parameters) for name, method, line, parameters in curves]
    curves += [
        (f"{NAMES[m]}, CFL {c}", m, (0, (6, 1, 1, 1, 1, 1)), {**VARIANTS[m], "cfl": c})
        for m, c in (("gimp", 1.3), ("sgmp", 2.0), ("normalised", 2.0))
    ]
    points = []
    for curve, method, line, parameters in curves:
        for h, run in zip(sizes, solve([Case("beam", h=h, **parameters) for h in sizes], may_fail=True)):
            if run.exit_code == 0:
                points.append(point(curve, method, f"h = {h} mm", run, deflection_error(run), line))
    work_precision(
        book, "beam_work_precision", "Beam, 50 µs", points, "error of the deflection (mm)", (0.02, 0.005, 0.002, 0.001)
    )


def draw_energies(book, runs):
    figure, axes = subplots(1, 3, figsize=(13, 4.2))
    for axis, column, title in zip(
        axes, ("kinetic_energy", "internal_energy", "total_energy"), ("Kinetic", "Internal", "Total")
    ):
        for (method, update), run in runs.items():
            history = run.history()
            axis.plot(
                1e3 * history["time"], history[column] / history["total_energy"][0], LINES[update],
                color=COLOURS[method], linewidth=1.2, label=f"{NAMES[method]} {update.upper()}",
            )
        axis.set(xlabel="time (µs)", xlim=(0, 50), ylim=(0, 1.6) if title == "Total" else (-0.02, 1.6))
        axis.set_title(f"{title} energy", loc="left", fontweight="bold")
    axes[0].set_ylabel("energy / initial energy")
    axes[2].legend(ncol=2, loc="lower right")
    book.figure(
        "beam_energies",
        figure,
        "Energies of the six combinations, h = 0.3125 mm (Fig. 7). MPM USL leaves at once; MPM USF gains energy "
        "without end.",
    )


def draw_stress(book, runs):
    figure, axes = subplots(3, 2, figsize=(12.5, 5.4), sharex=True, sharey=True)
    for (method, update), run in runs.items():
        axis = axes[SCHEMES.index(update), ("mpm", "sgmp").index(method)]
        axis.set_title(f"{NAMES[method]}, {update.upper()}", loc="left", fontweight="bold")
        if run.exit_code:
            axis.set(aspect="equal", xlim=(-2, 62), ylim=(-2.5, 12.5))
            axis.text(
                30, 5, f"blown up: ended at t = {1e3 * run.history()['time'][-1]:.1f} µs", ha="center", va="center"
            )
            continue
        particles = run.particles()
        dots = draw_plane(axis, particles.points, 1e-3 * particles.column("stress_xx"), run.summary["spacing"], (-4, 4))
        axis.set(xlim=(-2, 62), ylim=(-2.5, 12.5))
    for axis in axes[-1]:
        axis.set_xlabel("x (mm)")
    for axis in axes[:, 0]:
        axis.set_ylabel("y (mm)")
    figure.colorbar(dots, ax=axes, shrink=0.7, label="$\\sigma_{xx}$ (GPa)")
    book.figure("beam_stress", figure, "Bending stress at 50 µs (Fig. 6).")


def draw_section(book, runs, theory):
    figure, axes = subplots(1, 3, figsize=(12, 4.4), sharey=True, sharex=True)
    y = np.array([-5.0, 5.0])
    for axis, update in zip(axes, SCHEMES):
        for method, marker in (("mpm", "x"), ("sgmp", ".")):
            run = runs[method, update]
            if run.exit_code:
                continue
            height, stress = section_stress(run, 0.3)
            axis.plot(1e-3 * stress, height, marker, color=COLOURS[method], markersize=4, label=NAMES[method])
        axis.plot(1e-3 * theory * y / 5, y, "-", color="0.2", linewidth=1, label="bending theory")
        axis.set(xlabel="$\\sigma_{xx}$ (GPa)", xlim=(-6, 6))
        axis.set_title(update.upper(), loc="left", fontweight="bold")
        axis.legend(loc="lower right")
    axes[0].set_ylabel("height above the middle (mm)")
    book.figure(
        "beam_section", figure,
        "Stress across the height at mid-span and 50 µs, with the stress of Timoshenko's first mode.",
    )


def check(book, full):
    book.section("Beam (6.1)")
    theory = reference()
    omega = 2 * np.pi / theory["period_timoshenko_us"]
    surface = theory["surface_stress_mid_span_mpa"] * np.sin(omega * 50.0)
    book.say(
        "A free-free beam, 60 x 10 mm, plane strain, starts with the velocity of the first Euler-Bernoulli mode. "
        "Its slenderness is only 6, so the "
        f"period to be expected is Timoshenko's {theory['period_timoshenko_us']:.2f} µs and not "
        f"{theory['period_euler_bernoulli_us']:.2f} µs; 50 µs are 1.7 "
        "periods. (The paper counts three: those of the energy.) Eq. 90 lacks brackets: E H²/(12 ρ (1-ν²)). The "
        "text's \"USF SGMP and USL SGMP "
        "give almost identical results\" is a slip for USF and MUSL."
    )
    keys = [(method, update) for method in ("mpm", "sgmp") for update in SCHEMES]
    runs = dict(zip(keys, solve([Case("beam", method=m, update=u) for m, u in keys], may_fail=True)))
    book.command(*[run.case for run in runs.values()])
    book.at_least("beam", "exit code of MPM USL (4: energy out of bounds)", runs["mpm", "usl"].exit_code, 4)
    usf = runs["mpm", "usf"].history()["total_energy"]
    book.at_least("beam", "energy growth of MPM USF", usf.max() / usf[0], 2.0)
    for update in SCHEMES:
        run = runs["sgmp", update]
        total = run.history()["total_energy"]
        book.at_most("beam", f"SGMP {update.upper()}: Emax/E0", total.max() / total[0], 1.01)
        book.within("beam", f"SGMP {update.upper()}: period (µs)", period(run), theory["period_timoshenko_us"], 0.01)
        remainder = np.abs(run.history()["energy_remainder"]).max() / total[0]
        book.at_most(
            "beam", f"SGMP {update.upper()}: kinetic energy that the identity leaves unexplained, relative", remainder,
            1e-10,
        )
    total = runs["sgmp", "musl"].history()["total_energy"]
    book.at_most("beam", "SGMP MUSL: energy drift at 50 µs, relative", abs(total[-1] / total[0] - 1), 0.005)
    for update in SCHEMES:
        square, value = linearity(*section_stress(runs["sgmp", update], 0.3))
        if update == "musl":
            book.at_least("beam", "SGMP MUSL: R² of the stress across the height", square, 0.99)
        book.within("beam", f"SGMP {update.upper()}: surface stress at mid-span (MPa)", value, surface, 0.1,
                    "first mode alone; higher modes are in the motion, too")
    draw_energies(book, runs)
    draw_stress(book, runs)
    draw_section(book, runs, surface)
    coarse = {(u, h): run for (u, h), run in zip([(u, h) for h in (0.5, 1.0) for u in SCHEMES],
              solve([Case("beam", method="sgmp", update=u, h=h) for h in (0.5, 1.0) for u in SCHEMES]))}
    rows = []
    for update in SCHEMES:
        for h, run in ((0.3125, runs["sgmp", update]), (0.5, coarse[update, 0.5]), (1.0, coarse[update, 1.0])):
            total = run.history()["total_energy"]
            rows.append(
                [
                    f"SGMP {update.upper()}", h, period(run), 100 * (total[-1] / total[0] - 1),
                    linearity(*section_stress(run, h))[0], run.cpu_seconds,
                ]
            )
    for h, lost in ((0.5, 4.36), (1.0, 14.5)):
        book.regression(
            "beam", f"SGMP USL: energy lost at h = {h:g} mm (%)", -next(r[3] for r in rows if r[:2] == ["SGMP USL", h]),
            lost, 0.05,
        )
    book.table("beam", ["scheme", "h (mm)", "period (µs)", "energy change (%)", "R² of stress", "CPU time (s)"], rows,
               "SGMP over the cell size; CFL 0.5.")
    accuracy(book, runs, coarse, full)
    if full:
        shifted = solve(
            [Case("beam", method=m, update="usf", shift_x=0.078125, shift_y=0.078125) for m in ("mpm", "sgmp")],
            may_fail=True,
        )
        for m, run in zip(("MPM", "SGMP"), shifted):
            total = run.history()["total_energy"]
            book.say(
                f"Shifted by a quarter of a cell along x and y, {m} USF ends with {total[-1] / total[0]:.4g} times "
                f"its energy."
            )


if __name__ == "__main__":
    main(check, __doc__)
