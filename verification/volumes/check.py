#!/usr/bin/env python3
"""Volumes: explosive and gas in closed boxes against closed forms, a bar pulled to ten times its length, and debris of
a hypervelocity impact: energy, time step."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402
from matplotlib.collections import PatchCollection  # noqa: E402
from matplotlib.patches import Rectangle  # noqa: E402
from sgmp_view.picture import draw_particles  # noqa: E402
from volumes.tube import jwl, tube  # noqa: E402

PLAIN, KEPT, SPLIT = {"volumes": "plain"}, {"volumes": "kept"}, {"volumes": "kept", "split": 1.0}
DENSITY = 1.63e-3


def deck(name, **parameters):
    return Case(f"verification/volumes/{name}.inp", **parameters)


def totals(run, density, size):
    """Sum of volumes, mean pressure, internal energy, initial volume, total energy over the first. Mass is all there,
    and the identity of the kinetic energy holds."""
    fields, ledger = run.particles().fields, run.summary["energy"]
    assert (
        abs(fields["mass"].sum() / (density * size) - 1) < 1e-12
        and abs(ledger["remainder"]) < 1e-11 * ledger["initial_total"]
    )
    volume = fields["volume"].sum()
    initial = fields["mass"].sum()/density
    energy = run.history()["total_energy"]
    return (
        volume, (fields["pressure"] * fields["volume"]).sum() / volume,
        (fields["energy"] * fields["mass"]).sum() / density, initial, energy[-1] / energy[0],
    )


def boxes(book, full):
    book.say(
        "TNT in a box of 20 x 12 cells between slip walls, half filled and full, lit in a corner, to 1 ms; "
        "`volumes=kept` beside plain SGMP. The products fill "
        "the box; at rest their pressure is that of JWL at the mean volume and energy where their entropy is "
        "uniform. It is not: the gas that meets the wall first is "
        "hotter, and JWL is convex in the volume, so the mean lies above (the same at half the cell and at a "
        "quarter of the step)."
    )
    rows, draw = [], []
    times = (0.2, 0.4, 0.6, 0.8, 1.0) if full else (0.2, 1.0)
    for fill, title in ((6, "half-filled box"), (12, "full box")):
        for name, variant in (("plain", PLAIN), ("kept", KEPT)) + ((("kept, split=1", SPLIT),) if fill == 6 else ()):
            used = times if name != "plain" else (0.2,)  # plain: no number of it is the same twice
            for time, run in zip(
                used, solve([deck("box", fill=fill, t_end=t, **variant) for t in used], may_fail=True)
            ):
                if run.exit_code:
                    continue
                volume, pressure, inner, initial, energy = totals(run, DENSITY, 20*fill)
                rows.append([title, name, time, volume/240, pressure/jwl(240/initial, inner/initial), energy])
                draw.append((fill, name, run))
                if name != "plain":
                    title, loses = (
                        f"{title}, split=1" if variant is SPLIT and "split" not in title else title,
                        fill == 6 and variant is KEPT,
                    )
                    book.within(title, f"sum of volumes over the box at {time} ms", volume/240, 1.0, 0.02)
                    book.within(
                        title,
                        f"energy at {time} ms over the initial one",
                        energy,
                        1.0,
                        0.02 if loses else 0.01,
                        "1 % is wanted: lost while the products rush into the vacuum, not with split=1"
                        if loses
                        else "",
                    )
                    book.within(
                        title,
                        f"mean pressure over JWL(V, E) at {time} ms",
                        rows[-1][4],
                        1.0,
                        0.10 if fill == 6 else 0.06,
                        "3 % is wanted: the exact solution in a tube lies 4 % above, as the entropy of the products "
                        "is not uniform",
                    )
                else:
                    book.add(
                        title, "plain SGMP is called doubtful where its volumes are off by 10 %",
                        run.summary["verdict"] == "doubtful", abs(volume / 240 - 1) > 0.1, "at least",
                        (run.summary["verdict"] == "doubtful") >= (abs(volume / 240 - 1) > 0.1),
                    )
    book.table(
        "volumes_box", ["box", "volumes", "t (ms)", "sum over the box", "pressure over JWL(V, E)", "energy"], rows,
        "Explosive in a closed box.",
    )
    cells = (50, 100, 200, 400) if full else (50, 100)
    ends = [(n, *tube(n, 0.2)) for n in cells]
    book.within(
        "tube",
        f"products in a half-filled tube by {cells[-1]} Lagrangian cells: mean pressure over JWL(V, E) at 0.2 ms",
        ends[-1][1], 1.04, 0.01,
    )
    book.table(
        "volumes_tube", ["cells", "pressure over JWL(V, E)", "energy", "least v", "largest v"], ends,
        "The same charge in a tube, by an independent Lagrangian code.",
    )
    figure = box_figure(
        {name: [r for f, n, r in draw if f == 6 and n == name][0].particles() for name in ("plain", "kept")}
    )
    book.figure("volumes_box", figure, "Half-filled box at 0.2 ms; the squares are as large as the particles.")


def box_figure(clouds):
    """Particles in the box as squares of their volumes, on grey: what is not covered has no particle."""
    figure, axes = subplots(1, 2, figsize=(11, 3.6))
    for axis, (name, particles) in zip(axes, clouds.items()):
        order = np.argsort(particles.fields["volume"])[::-1]
        side = np.sqrt(particles.fields["volume"][order])
        corners = particles.points[order, :2] - 0.5*side[:, None]
        shown = PatchCollection(
            [Rectangle(corner, width, width) for corner, width in zip(corners, side)], cmap="viridis",
            edgecolor="white", linewidth=0.3,
        )
        shown.set(array=particles.fields["pressure"][order], clim=(0, 3000))
        axis.add_collection(shown)
        axis.set(
            title=f"volumes {name}", xlim=(0, 20), ylim=(0, 12), aspect="equal", xlabel="x (mm)", ylabel="y (mm)",
            facecolor="0.85",
        )
        axis.grid(False)
    figure.colorbar(shown, ax=axes, label="pressure (MPa)")
    return figure


def gases(book, full):
    book.say("An ideal gas expands into an empty part of its box; at rest p V = (γ - 1) E of the whole box.")
    rows = []
    for fill, length, title in ((10, 20, "gas 1:2"), (4, 40, "gas 1:10")):
        for name, variant in (
            ("plain", PLAIN), ("kept", KEPT), ("kept, split=0.75", {"volumes": "kept", "split": 0.75}),
        ):
            run = solve([deck("gas", fill=fill, length=length, **variant)])[0]
            volume, pressure, inner, _, energy = totals(run, 1.0, 4*fill)
            rows.append([title, name, volume/(4*length), pressure/(0.4*inner/(4*length)), energy])
            if name != "plain":
                sparse = fill == 4 and name == "kept"
                note = (
                    "3 %, in the energy 1 %, are wanted: with 0.4 particles in a cell no cell is full" if sparse else ""
                )
                book.within(
                    title, f"sum of volumes over the box, {name}", volume / (4 * length), 1.0, 0.2 if sparse else 0.03,
                    note,
                )
                book.within(
                    title, f"pressure over (γ - 1) E/V of the box, {name}", rows[-1][3], 1.0, 0.25 if sparse else 0.03,
                    note,
                )
                book.within(title, f"energy over the initial one, {name}", energy, 1.0, 0.4 if sparse else 0.03, note)
    book.table(
        "volumes_gas", ["expansion", "volumes", "sum over the box", "pressure over (γ - 1) E/V", "energy"], rows,
        "Gas in a closed box at t = 300.",
    )


def stretch(book, full):
    book.say(
        "A neo-Hookean bar flies apart to ten times its length; its density is then 0.1 everywhere (inner half: the "
        "free end springs back). Without splitting it tears into particles."
    )
    rows, draw = [], []
    for method in ("sgmp", "gimp", "cpgimp", "mpm"):
        for split in ("none", 0.6, 0.75):
            run = solve([deck("stretch", method=method, split=split)])[0]
            particles, ledger = run.particles(), run.summary["energy"]
            inner = particles.fields["density"][particles.points[:, 0] < 5]
            cells = np.unique(np.floor(particles.points[:, 0]/0.25))
            gaps = int(cells.max() + 1 - len(cells))
            rows.append(
                [
                    method, split, len(particles.points), gaps, inner.min(), inner.max(),
                    ledger["total"] / ledger["initial_total"], run.summary["verdict"],
                ]
            )
            if split == "none":
                book.add(
                    "stretch", f"without splitting the verdict is doubtful, {method}",
                    run.summary["verdict"] == "doubtful", True, "equal", run.summary["verdict"] == "doubtful",
                )
                draw += [(f"{method}", particles)] if method == "sgmp" else []
                continue
            draw += [(f"{method}, split=0.6", particles)] if method == "sgmp" and split == 0.6 else []
            width = 0.25 if method == "mpm" else 0.05  # MPM: quadrature
            book.near("stretch", f"least density, {method}, split={split}", inner.min(), 0.1, 0.1*width)
            book.near("stretch", f"largest density, {method}, split={split}", inner.max(), 0.1, 0.1*width)
            book.at_most("stretch", f"gaps, {method}, split={split}", gaps, 0)
            book.near("stretch", f"mass, {method}, split={split}", particles.fields["mass"].sum(), 1.0, 1e-12)
            book.within("stretch", f"energy over the initial one, {method}, split={split}", rows[-1][6], 1.0, 0.01)
            book.near(
                "stretch", f"kinetic identity over the energy, {method}, split={split}",
                ledger["remainder"] / ledger["initial_total"], 0.0, 1e-12,
            )
    book.table(
        "stretch",
        ["method", "split", "particles", "gaps (cells)", "least density", "largest density", "energy", "verdict"], rows,
        "Bar pulled to ten times its length.",
    )
    figure, axes = subplots(2, 1, figsize=(9, 3.2), sharex=True)
    for axis, (title, particles) in zip(axes, draw):
        shown = draw_particles(axis, particles.points, particles.fields["density"], 0.125, limits=(0.05, 0.2))
        axis.set(title=title, xlim=(0, 10), ylim=(0, 1))
    figure.colorbar(shown, ax=axes, label="density")
    book.figure("stretch", figure, "The bar at ten times its length.")


def debris(book, full):
    book.say(
        "A lead ball of radius 7.5 mm hits 6.36 mm of lead at 6.58 km/s (Johnson-Cook, Mie-Grüneisen, spall at -1 "
        "GPa; cells of 4.24 mm), to 100 µs. Energy is conserved, and "
        "what flies freely needs no shorter steps."
    )
    rows, shown = [], None
    for method, cfl, update in (
        ("sgmp", 0.5, "musl"), ("sgmp", 0.25, "musl"), ("gimp", 0.25, "musl"), ("mpm", 0.2, "musl"),
    ):
        run = solve([deck("debris", method=method, cfl=cfl)])[0]
        state, drift, history = run.summary["end_state"], run.summary["energy"]["drift"], run.history()
        given = history["momentum_z"][0]
        book.near(
            "debris", f"momentum over that of the ball, {method}, CFL {cfl}", history["momentum_z"][-1] / given, 1.0,
            1e-9,
        )
        rows.append([method, cfl, drift, state["shortest_step"]/state["longest_step"], run.summary["verdict"]])
        known = {("sgmp", 0.5): 0.0536, ("mpm", 0.2): 0.0365}.get((method, cfl))
        book.near(
            "debris", f"drift of the energy, {method}, CFL {cfl}", drift, 0.0, 0.03,
            "coarse cells at the first contact; falls with the step", known=known,
        )
        book.at_least("debris", f"shortest over longest step, {method}, CFL {cfl}", rows[-1][3], 0.2)
        shown = run if (method, cfl) == ("sgmp", 0.25) else shown
    book.table(
        "debris", ["method", "CFL", "drift of the energy", "shortest over longest step", "verdict"], rows,
        "Debris at 100 µs.",
    )
    particles = shown.particles()
    figure, axis = subplots(figsize=(6.5, 6.5))
    balls = draw_particles(axis, particles.points, particles.fields["damage"], shown.summary["spacing"])
    axis.set(xlabel="x (mm)", ylabel="z (mm)")
    figure.colorbar(balls, ax=axis, label="damage (1: failed)")
    book.figure("debris", figure, "All particles at 100 µs seen from the side, SGMP, CFL 0.25.")


def check(book, full):
    book.section("Volumes and debris")
    boxes(book, full)
    gases(book, full)
    stretch(book, full)
    debris(book, full)
    book.command(deck("box", **KEPT), deck("gas", **KEPT), deck("stretch", split=0.75), deck("debris"))


if __name__ == "__main__":
    main(check, __doc__)
