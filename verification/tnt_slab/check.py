#!/usr/bin/env python3
"""Detonation of a TNT slab (paper, 6.3): profiles against Chapman-Jouguet and the Taylor wave; noise, peak, front."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent / "reference")]
import numpy as np  # noqa: E402
from common import COLOURS, NAMES, VARIANTS, Case, main, point, solve, subplots, work_precision  # noqa: E402
from taylor_wave import TaylorWave  # noqa: E402

METHODS = ("mpm", "gimp", "sgmp", "normalised")
END = 14.0  # us
SCHEMES = (("usf", (0, (1, 3))), ("usl", (0, (8, 2))), ("usavg", (0, (6, 1, 1, 1, 1, 1))))


def profile(run):
    """Position (mm), pressure (GPa), density (g/cm^3), velocity (km/s), sorted along x."""
    particles = run.particles()
    order = np.argsort(particles.points[:, 0])
    fields = particles.fields
    return np.array([particles.points[order, 0], 1e-3 * fields["pressure"][order], 1e3 * fields["density"][order],
                     1e-3 * fields["velocity"][order, 0]])


def measure(run, wave, time=END):
    """What the comparison is about, at one time."""
    x, p, _, _ = profile(run)
    xi = x / (wave.speed * time)
    error = p - wave.at(x, time)[0]
    plateau, fan = (xi > 0.1) & (xi < 0.45), (xi > 0.6) & (xi < 0.95)
    last = np.flatnonzero(p > 0.5 * p.max())[-1]
    front = np.interp(-0.5 * p.max(), -p[last:last + 2], x[last:last + 2])
    return {
        "L1": np.abs(error[xi < 1]).mean(),
        "plateau": p[plateau].mean(),
        "plateau_noise": np.sqrt(np.mean((p[plateau] - wave.plateau) ** 2)),
        "fan_noise": np.std(np.diff(p[fan])) / np.sqrt(2),
        "peak": p.max(),
        "front": (front - wave.speed * time) / run.summary["h"],
    }


def run_of(**parameters):
    return Case("tnt_slab", t_end=END / 1000, **parameters)


def main_checks(book, wave):
    runs = dict(zip(METHODS, solve([run_of(**VARIANTS[m]) for m in METHODS])))
    found = {m: measure(run, wave) for m, run in runs.items()}
    book.command(*[run.case for run in runs.values()])
    for m, value in (("mpm", 1.28), ("gimp", 0.63), ("sgmp", 0.347)):
        book.regression(
            "TNT, h = 0.5 mm", f"L1 error of the pressure behind the front, {NAMES[m]} (GPa)", found[m]["L1"], value,
            0.1,
        )
    for m, value in (("gimp", 0.39), ("sgmp", 0.303)):
        book.regression(
            "TNT, h = 0.5 mm", f"noise in the plateau, {NAMES[m]} (GPa rms)", found[m]["plateau_noise"], value, 0.1
        )
    for m, value in (("gimp", 1.16), ("sgmp", 0.10)):
        book.regression("TNT, h = 0.5 mm", f"noise in the fan, {NAMES[m]} (GPa rms)", found[m]["fan_noise"], value, 0.1)
    book.regression(
        "TNT, h = 0.5 mm", "L1 error of the pressure, SGMP with normalised stress (GPa)", found["normalised"]["L1"],
        0.260, 0.1,
    )
    book.at_most(
        "TNT, h = 0.5 mm", "noise in the plateau, SGMP with normalised stress over SGMP",
        found["normalised"]["plateau_noise"] / found["sgmp"]["plateau_noise"], 0.33,
    )
    early = dict(zip(METHODS, solve([Case("tnt_slab", **VARIANTS[m], t_end=0.004) for m in METHODS])))
    loss = {m: (profile_mean(early[m], wave, 4.0) - found[m]["plateau"]) / wave.plateau for m in METHODS}
    book.at_least("TNT, h = 0.5 mm", "plateau of MPM falls between 4 and 14 µs, by", loss["mpm"], 0.05)
    book.at_most("TNT, h = 0.5 mm", "plateau of SGMP falls between 4 and 14 µs, by", loss["sgmp"], 0.01)


def profile_mean(run, wave, time):
    x, p, _, _ = profile(run)
    xi = x / (wave.speed * time)
    return p[(xi > 0.1) & (xi < 0.45)].mean()


def refinement(book, wave, full):
    sizes = (1.0, 0.5, 0.25, 0.1, 0.05) if full else (1.0, 0.5, 0.25, 0.1)
    rows, points = [], []
    for m in METHODS:
        used = sizes if full or m in ("sgmp", "normalised") else sizes[:3]
        for h, run in zip(used, solve([run_of(**VARIANTS[m], h=h) for h in used])):
            found = measure(run, wave)
            rows.append(
                [
                    NAMES[m], h, found["L1"], found["plateau"], found["plateau_noise"], found["fan_noise"],
                    found["peak"], found["front"], run.cpu_seconds,
                ]
            )
            points.append(point(f"{NAMES[m]}, CFL 0.1", m, f"h = {h} mm", run, found["L1"]))
            if m in ("sgmp", "normalised") and h <= 0.5:
                noisy = m == "sgmp" and h == 0.05
                book.within(
                    f"TNT, h = {h} mm",
                    f"pressure of the plateau, {NAMES[m]} (GPa)",
                    found["plateau"],
                    wave.plateau,
                    0.01,
                    "the noise of the stress quadrature grows with time steps, and the mean sinks with it; not so "
                    "with normalised stress"
                    if noisy
                    else "",
                    known=5.51 if noisy else None,
                )
                book.near(f"TNT, h = {h} mm", f"front of {NAMES[m]} less D t (cells)", found["front"], 0.0, 1.0)
            if m == "normalised" and h == 0.1:
                book.at_most(
                    f"TNT, h = {h} mm", "noise in the plateau, SGMP with normalised stress (GPa rms)",
                    found["plateau_noise"], 0.05,
                )
                book.at_most(
                    f"TNT, h = {h} mm", "L1 error of the pressure, SGMP with normalised stress (GPa)", found["L1"], 0.10
                )
                book.within(
                    f"TNT, h = {h} mm", "peak pressure, SGMP with normalised stress (GPa)", found["peak"], wave.peak,
                    0.03,
                )
            if m == "sgmp" and h in (0.1, 0.05):
                book.within(f"TNT, h = {h} mm", "peak pressure, SGMP (GPa)", found["peak"], wave.peak, 0.04)
                noise, error = {0.1: (0.417, 0.219), 0.05: (0.501, 0.276)}[h]
                book.regression(
                    f"TNT, h = {h} mm", "noise in the plateau, SGMP (GPa rms)", found["plateau_noise"], noise, 0.1
                )
                book.regression(f"TNT, h = {h} mm", "L1 error of the pressure, SGMP (GPa)", found["L1"], error, 0.1)
    book.table(
        "tnt",
        [
            "method", "h (mm)", "L1 (GPa)", "plateau (GPa)", "plateau noise", "fan noise", "peak (GPa)",
            "front (cells)", "CPU time (s)",
        ],
        rows,
        "Pressure at 14 µs, CFL 0.1; exact plateau 5.634, peak 20.984 GPa. Plateau noise: rms over 0.1 < x/Dt < "
        "0.45; fan noise: rms "
        "difference of neighbours over the root of 2, 0.6 < x/Dt < 0.95; front: half of the peak less D t.",
    )
    if full:
        for m in METHODS:
            for cfl, line in ((0.3, "--"), (0.5, ":")):
                cases = [run_of(**VARIANTS[m], h=h, cfl=cfl) for h in sizes[:4]]
                for h, run in zip(sizes, solve(cases, may_fail=True)):
                    if run.exit_code == 0:
                        points.append(
                            point(f"{NAMES[m]}, CFL {cfl}", m, f"h = {h} mm", run, measure(run, wave)["L1"], line)
                        )
        for update, line in SCHEMES:
            for h, run in zip(
                sizes, solve([run_of(**VARIANTS["normalised"], h=h, update=update) for h in sizes[:4]], may_fail=True)
            ):
                if run.exit_code == 0:
                    points.append(
                        point(
                            f"{NAMES['normalised']}, {update.upper()}, CFL 0.1", "normalised", f"h = {h} mm", run,
                            measure(run, wave)["L1"], line,
                        )
                    )
        work_precision(
            book, "tnt_work_precision", "TNT slab, 14 µs", points, "L1 error of the pressure (GPa)",
            (0.5, 0.3, 0.2, 0.1),
        )


def draw_times(book, wave, h):
    """Fig. 15: pressure at several times."""
    times = (2.0, 6.0, 10.0, 14.0)
    figure, axes = subplots(4, 1, figsize=(10, 11), sharex=True, sharey=True)
    for axis, m in zip(axes, METHODS):
        for time, run in zip(times, solve([Case("tnt_slab", **VARIANTS[m], h=h, t_end=time / 1000) for time in times])):
            x, p, _, _ = profile(run)
            axis.plot(x, p, ".", color=COLOURS[m], markersize=1.8)
            grid = np.append(np.linspace(0, wave.speed * time, 800), [wave.speed * time * (1 + 1e-9), 100])
            axis.plot(grid, wave.at(grid, time)[0], color="0.15", linewidth=0.9)
            axis.text(wave.speed * time - 1, wave.peak + 0.7, f"{time:g} µs", ha="right", fontsize=9)
        axis.set(ylabel="pressure (GPa)", ylim=(-1, 25), xlim=(0, 100))
        axis.set_title(f"{NAMES[m]}, h = {h} mm", loc="left", fontweight="bold")
    axes[-1].set_xlabel("x (mm)")
    book.figure(
        "tnt_pressure",
        figure,
        "Pressure at several times (Fig. 15), every particle a dot; line: exact. MPM's plateau sinks with time. The "
        "paper's \"t = 1.0 ms\" "
        "must be 10 µs: the front leaves the slab at 14.43 µs.",
    )


def draw_fields(book, wave, h):
    figure, axes = subplots(3, 4, figsize=(15, 8.5), sharex=True, sharey="row")
    labels = ("pressure (GPa)", "density (g/cm³)", "velocity (km/s)")
    grid = np.append(np.linspace(0, wave.speed * 10, 800), [wave.speed * 10 * (1 + 1e-9), 100])
    for column, (m, run) in enumerate(zip(METHODS, solve([Case("tnt_slab", **VARIANTS[m], h=h) for m in METHODS]))):
        values = profile(run)
        for row, label in enumerate(labels):
            axes[row, column].plot(values[0], values[row + 1], ".", color=COLOURS[m], markersize=1.8)
            axes[row, column].plot(grid, wave.at(grid, 10.0)[row], color="0.15", linewidth=0.9)
            axes[row, 0].set_ylabel(label)
        axes[0, column].set_title(NAMES[m], loc="left", fontweight="bold")
        axes[2, column].set(xlabel="x (mm)", xlim=(0, 100))
    book.figure("tnt_fields", figure, f"Pressure, density and velocity at 10 µs, h = {h} mm; line: exact.")


def check(book, full):
    wave = TaylorWave()
    book.section("TNT slab (6.3)")
    book.say(
        "The products of the detonation follow the JWL equation; the front is a programmed burn with D = 6930 m/s, "
        "lit at a rigid wall. Exact: the "
        f"Chapman-Jouguet state ({wave.peak:.3f} GPa, {1e3 * wave.speed:.1f} m/s) and behind it the self-similar "
        f"Taylor wave down to a plateau of "
        f"{wave.plateau:.3f} GPa, by quadrature of the isentrope. The paper states neither the burn ramp nor the "
        f"viscosity. Taken here: no ramp, "
        "quadratic 1.5, linear 0.12. <b>A calibration:</b> these settings, the windows and the measure of noise "
        "were chosen so that the errors of the independent "
        "code come out, which were given without theirs; agreement with them is no prediction. Pressure, peak, "
        "front and plateau are compared with the exact solution."
    )
    main_checks(book, wave)
    refinement(book, wave, full)
    draw_times(book, wave, 0.5)
    draw_fields(book, wave, 0.5)


if __name__ == "__main__":
    main(check, __doc__)
