#!/usr/bin/env python3
"""Energy error (paper, section 3): what the identities predict from accelerations and strains, and what the run
does."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import COLOURS, NAMES, Case, main, solve, subplots  # noqa: E402
from sgmp_view.files import read_pvd, read_vtu  # noqa: E402

SCHEMES = ("usf", "musl", "usl")
METHODS = ("mpm", "sgmp")
YOUNG, DENSITY, LENGTH = 50.0, 25.0, 1.0


def states(run):
    """Positions, velocities and stresses of every step, shape (steps + 1, particles)."""
    clouds = [read_vtu(path) for _, path in read_pvd(run.folder / "particles.pvd")]
    orders = [np.argsort(cloud.fields["id"]) for cloud in clouds]
    return [
        np.array([values(cloud)[order] for cloud, order in zip(clouds, orders)])
        for values in (
            lambda c: c.points[:, 0], lambda c: c.fields["velocity"][:, 0], lambda c: c.fields["stress"][:, 0],
        )
    ]


def predicted(run):
    """Energy change of each step by the identities for linear elasticity, from the dumps of every step. Per step, with
    p the particles, dv and ds the changes of velocity and stress, and D the interpolation error of Eq. 43 (from
    history.csv):
      USF   +1/2 sum m dv^2 - 1/2 sum V ds^2/E                                               (Eq. 60)
      USL   -(2 D + sum m dv^2) + 1/2 sum m dv^2 + 1/2 sum V ds^2/E                          (Eq. 62)
      MUSL  -1/2 sum m dv^2 + 1/2 sum V ds^2/E                                               (exact; Eq. 64 is
      approximate)
    and with normalised stress the work that `normalisation_work` finds."""
    position, velocity, stress = states(run)
    volume = LENGTH / position.shape[1]
    kinetic = 0.5 * DENSITY * volume * np.sum(np.diff(velocity, axis=0)**2, axis=1)
    elastic = 0.5 * volume / YOUNG * np.sum(np.diff(stress, axis=0)**2, axis=1)
    interpolation = np.diff(run.history()["interpolation_error"])
    update = run.case.parameters["update"]
    change = {"usf": kinetic - elastic, "usl": elastic - kinetic - 2 * interpolation, "musl": elastic - kinetic}[update]
    if run.case.parameters.get("stress") == "normalised":
        change = change + normalisation_work(run, position, velocity, stress, volume, update)
    return change


def normalisation_work(run, position, velocity, stress, volume, update):
    """What normalised stress adds to the energy in each step: dt sum_c (1 - kappa_c) (sigma V)_c L_c, where L_c is the
    velocity gradient that strains the particles. The nodes feel kappa_c (sigma V)_c, the particles book (sigma V)_c. A
    small SGMP of its own."""
    h, cells = run.summary["h"], round(LENGTH / run.summary["h"])
    dt = run.history()["dt"][1:]
    work = []
    for step in range(len(position) - 1):
        place = position[step] / h + 0.5                     # centre c = 0 is the ghost behind the left wall
        left = np.floor(place).astype(int)
        right = place - left

        def centres(values, parity):
            """Values at the centres, walls folded."""
            sums = np.bincount(left, values * (1 - right), cells + 2) + np.bincount(left + 1, values * right, cells + 2)
            sums[1] += parity * sums[0]
            sums[-2] += parity * sums[-1]
            return sums[1:-1]

        # USF takes the stress of this step, the others that of the last one
        used = step + 1 if update == "usf" else step
        moment = centres(volume * stress[used], 1)
        kappa = h / centres(np.full(len(left), volume), 1)
        mass = centres(np.full(len(left), DENSITY * volume), 1)
        momentum = centres(DENSITY * volume * velocity[step + 1 if update == "musl" else step], -1)
        node_mass = 0.5 * (mass[1:] + mass[:-1])             # inner nodes; those on the walls rest
        node_velocity = 0.5 * (momentum[1:] + momentum[:-1]) / node_mass
        if update == "usl":
            node_velocity += dt[step] * np.diff(kappa * moment) / h / node_mass
        gradient = np.diff(np.concatenate([[0.0], node_velocity, [0.0]])) / h
        work.append(dt[step] * np.sum((1 - kappa) * moment * gradient))
    return np.array(work)


def normalised(book):
    """Normalised stress where the volumes at the centres are uneven."""
    cases = [
        Case(
            "verification/energy/bar_every_step.inp", keep_dumps=True, method="sgmp", update=u, stress=s, jitter=0.4,
            v0=1e-10,
        )
        for s in ("plain", "normalised")
        for u in SCHEMES
    ]
    runs = solve(cases)
    book.command(*cases)
    rows = []
    for run in runs:
        start = run.history()["total_energy"][0]
        actual, told = np.diff(run.history()["total_energy"]), predicted(run)
        stress, update = run.case.parameters["stress"], run.case.parameters["update"]
        book.at_most(
            "energy",
            f"{update.upper()}, {stress} stress, uneven particles: actual less predicted change, largest, relative "
            f"to E0",
            np.abs(np.cumsum(actual - told)).max() / start,
            1e-10,
        )
        book.at_most(
            "energy",
            f"{update.upper()}, {stress} stress, uneven particles: kinetic energy the ledger leaves unexplained, "
            f"relative to E0",
            np.abs(run.history()["energy_remainder"]).max() / start,
            1e-12,
        )
        work = (
            np.cumsum(normalisation_work(run, *states(run), LENGTH / run.summary["particles"], update)) / start
            if stress == "normalised"
            else np.zeros(1)
        )
        rows.append(
            [update.upper(), stress, actual.sum() / start, np.abs(np.cumsum(actual)).max() / start, np.abs(work).max()]
        )
    book.table(
        "energy_normalised",
        [
            "scheme", "stress", "change after 400 steps / E0", "largest change / E0",
            "largest work of the normalisation / E0",
        ],
        rows,
        "Normalised stress, particles displaced at random by up to 0.4 of their spacing, so that the volume at the "
        "centres is uneven. The nodes feel κ(σV) and the particles book σV; the difference, "
        "dt Σ (1-κ) (σV)_c L_c, is the whole of what normalisation does to the energy.",
    )


def check(book, full):
    book.section("Energy error (section 3)")
    book.say(
        "A bar with two of its modes in motion so small that neither volume nor weights change, CFL 0.4. From the "
        "dumps of every step comes the energy "
        "change that the identities predict; the history has the actual one. Eq. 60 (USF) and Eq. 62 (USL) hold as "
        "printed; for MUSL the "
        "exact statement uses the strain of the re-mapped velocity, e = -½ Σ m|Δv|² + ½ Σ V Δε:D:Δε, which Eq. 64 "
        "only approximates. Eq. 46 counts its "
        "first term too often; Σ m<sub>I</sub>|a<sub>I</sub>|² - Σ m<sub>p</sub>|a<sub>p</sub>|² needs no mass matrix."
    )
    keys = [(m, u) for m in METHODS for u in SCHEMES]
    runs = dict(
        zip(
            keys,
            solve(
                [Case("verification/energy/bar_every_step.inp", keep_dumps=True, method=m, update=u) for m, u in keys]
            ),
        )
    )
    book.command(*[run.case for run in runs.values()])
    figure, axes = subplots(1, 4, figsize=(15, 4.2))
    rows = []
    for (method, update), run in runs.items():
        history = run.history()
        start = history["total_energy"][0]
        actual, told = np.diff(history["total_energy"]), predicted(run)
        miss = np.abs(np.cumsum(actual - told)).max() / start
        book.at_most(
            "energy", f"{NAMES[method]} {update.upper()}: actual less predicted change, largest, relative to E0", miss,
            1e-12,
        )
        book.at_most(
            "energy", f"{NAMES[method]} {update.upper()}: kinetic energy the ledger leaves unexplained, relative to E0",
            np.abs(history["energy_remainder"]).max() / start, 1e-12,
        )
        least = np.diff(history["interpolation_error"]).min() / start
        book.at_least(
            "energy",
            f"{NAMES[method]} {update.upper()}: least interpolation error of a step, relative to E0 (Eq. 43: never "
            f"negative)",
            least,
            -1e-15,
        )
        periods = history["time"] * np.sqrt(YOUNG / DENSITY) / 2
        axis = axes[SCHEMES.index(update)]
        axis.plot(
            periods, history["total_energy"] / start - 1, color=COLOURS[method], linewidth=1.3,
            label=f"{NAMES[method]}, actual",
        )
        axis.plot(
            periods[1::8], np.cumsum(told)[::8] / start, "o", color=COLOURS[method], markersize=3,
            markerfacecolor="white", markeredgewidth=0.8, label=f"{NAMES[method]}, predicted",
        )
        if update == "musl":
            axes[3].plot(
                periods, history["interpolation_error"] / start, color=COLOURS[method], linewidth=1.3,
                label=NAMES[method],
            )
        rows.append(
            [
                NAMES[method], update.upper(), actual.sum() / start, told.sum() / start,
                history["interpolation_error"][-1] / start,
            ]
        )
    for axis, update in zip(axes, SCHEMES):
        axis.set_title(update.upper(), loc="left", fontweight="bold")
    axes[3].set_title("Interpolation error, MUSL", loc="left", fontweight="bold")
    axes[0].set_ylabel("energy change / initial energy")
    axes[3].set_ylabel("sum / initial energy")
    for axis in axes:
        axis.set_xlabel("time (periods)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncol=4)
    book.figure(
        "energy_error",
        figure,
        "Change of the total energy, actual (line) and predicted by the identities (circles), for the three "
        "schemes; right: the sum of the "
        "interpolation error (Eq. 43), which the algorithmic error of MUSL very nearly makes up for.",
    )
    book.table(
        "energy_error", ["method", "scheme", "actual change / E0", "predicted change / E0", "interpolation error / E0"],
        rows, "After 400 steps.",
    )
    normalised(book)


if __name__ == "__main__":
    main(check, __doc__)
