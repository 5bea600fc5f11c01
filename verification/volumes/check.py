#!/usr/bin/env python3
"""Volumes: explosive and gas in closed boxes against closed forms, and debris of a hypervelocity impact: energy, time step."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import numpy as np  # noqa: E402
from common import Case, main, solve, subplots  # noqa: E402

PLAIN, KEPT = {"volumes": "plain"}, {"volumes": "kept"}
DENSITY = 1.63e-3


def deck(name, **parameters):
    return Case(f"verification/volumes/{name}.inp", **parameters)


def jwl(v, energy):
    """Pressure of TNT's products (MPa) at the volume v over the initial one, energy per initial volume."""
    return (371200*(1 - 0.3/(4.15*v))*np.exp(-4.15*v) + 3210*(1 - 0.3/(0.95*v))*np.exp(-0.95*v) + 0.3*energy/v)


def totals(run, density):
    """Sum of volumes, mean pressure, internal energy, initial volume, total energy over the first."""
    fields = run.particles().fields
    volume = fields["volume"].sum()
    initial = fields["mass"].sum()/density
    energy = run.history()["total_energy"]
    return (volume, (fields["pressure"]*fields["volume"]).sum()/volume, (fields["energy"]*fields["mass"]).sum()/density, initial,
            energy[-1]/energy[0])


def boxes(book, full):
    book.say("TNT in a box of 20 x 12 cells between slip walls, half filled and full, lit in a corner, to 1 ms; `volumes=kept` beside plain SGMP. The products fill "
             "the box; at rest their pressure is that of JWL at the mean volume and energy where their entropy is uniform. It is not: the gas that meets the wall first is "
             "hotter, and JWL is convex in the volume, so the mean lies above (the same at half the cell and at a quarter of the step).")
    rows, draw = [], []
    times = (0.2, 0.4, 0.6, 0.8, 1.0) if full else (0.2, 1.0)
    for fill, title in ((6, "half-filled box"), (12, "full box")):
        for name, variant in (("plain", PLAIN), ("kept", KEPT)):
            used = times if name == "kept" else (0.2,)  # plain: no number of it is the same twice
            for time, run in zip(used, solve([deck("box", fill=fill, t_end=t, **variant) for t in used], may_fail=True)):
                if run.exit_code:
                    continue
                volume, pressure, inner, initial, energy = totals(run, DENSITY)
                rows.append([title, name, time, volume/240, pressure/jwl(240/initial, inner/initial), energy])
                draw.append((fill, name, run))
                if name == "kept":
                    book.within(title, f"sum of volumes over the box at {time} ms", volume/240, 1.0, 0.02)
                    book.within(title, f"energy at {time} ms over the initial one", energy, 1.0, 0.02 if fill == 6 else 0.01,
                                "1 % is wanted: lost while the products rush into the vacuum, less at smaller steps" if fill == 6 else "")
                    book.within(title, f"mean pressure over JWL(V, E) at {time} ms", rows[-1][4], 1.0, 0.10 if fill == 6 else 0.06,
                                "3 % is wanted: not reached, as the entropy of the products is not uniform")
                else:
                    book.add(title, "plain SGMP is called doubtful where its volumes are off by 10 %", run.summary["verdict"] == "doubtful",
                             abs(volume/240 - 1) > 0.1, "at least", (run.summary["verdict"] == "doubtful") >= (abs(volume/240 - 1) > 0.1))
    book.table("volumes_box", ["box", "volumes", "t (ms)", "sum over the box", "pressure over JWL(V, E)", "energy"], rows, "Explosive in a closed box.")
    figure, axes = subplots(1, 2, figsize=(11, 3.6))
    for axis, name in zip(axes, ("plain", "kept")):
        run = [r for f, n, r in draw if f == 6 and n == name][0]
        particles = run.particles()
        order = np.argsort(particles.fields["volume"])
        shown = axis.scatter(particles.points[order, 0], particles.points[order, 1], c=particles.fields["pressure"][order], s=40*particles.fields["volume"][order],
                             vmin=0, vmax=3000, cmap="viridis", alpha=0.7, linewidth=0)
        axis.set(title=f"volumes {name}", xlim=(0, 20), ylim=(0, 12), aspect="equal")
    figure.colorbar(shown, ax=axes, label="pressure (MPa)")
    book.figure("volumes_box", figure, "Half-filled box at 0.2 ms; areas of the dots are the particles' volumes.")


def gases(book, full):
    book.say("An ideal gas expands into an empty part of its box; at rest p V = (γ - 1) E of the whole box.")
    rows = []
    for fill, length, title in ((10, 20, "gas 1:2"), (4, 40, "gas 1:10")):
        for name, variant in (("plain", PLAIN), ("kept", KEPT)) + ((("kept, 16 per cell", {"volumes": "kept", "ppc": 4}),) if full else ()):
            run = solve([deck("gas", fill=fill, length=length, **variant)])[0]
            volume, pressure, inner, _, energy = totals(run, 1.0)
            rows.append([title, name, volume/(4*length), pressure/(0.4*inner/(4*length)), energy])
            if name == "kept":
                sparse = fill == 4
                note = "3 %, in the energy 1 %, are wanted: with 0.4 particles in a cell no cell is full" if sparse else ""
                book.within(title, "sum of volumes over the box", volume/(4*length), 1.0, 0.2 if sparse else 0.03, note)
                book.within(title, "pressure over (γ - 1) E/V of the box", rows[-1][3], 1.0, 0.25 if sparse else 0.03, note)
                book.within(title, "energy over the initial one", energy, 1.0, 0.4 if sparse else 0.01, note)
    book.table("volumes_gas", ["expansion", "volumes", "sum over the box", "pressure over (γ - 1) E/V", "energy"], rows, "Gas in a closed box at t = 300.")


def debris(book, full):
    book.say("A lead ball of radius 7.5 mm hits 6.36 mm of lead at 6.58 km/s (Johnson-Cook, Mie-Grüneisen, spall at -1 GPa; cells of 4.24 mm), to 100 µs. Energy is conserved, and "
             "what flies freely needs no shorter steps.")
    rows, shown = [], None
    for method, cfl, update in (("sgmp", 0.5, "musl"), ("sgmp", 0.25, "musl"), ("gimp", 0.25, "musl"), ("mpm", 0.2, "musl")):
        run = solve([deck("debris", method=method, cfl=cfl)])[0]
        state, drift = run.summary["end_state"], run.summary["energy"]["drift"]
        rows.append([method, cfl, drift, state["shortest_step"]/state["longest_step"], run.summary["verdict"]])
        known = {("sgmp", 0.5): 0.059, ("mpm", 0.2): 0.040}.get((method, cfl))
        book.near("debris", f"drift of the energy, {method}, CFL {cfl}", drift, 0.0, 0.03, "coarse cells at the first contact; falls with the step", known=known)
        book.at_least("debris", f"shortest over longest step, {method}, CFL {cfl}", rows[-1][3], 0.2)
        shown = run if (method, cfl) == ("sgmp", 0.25) else shown
    book.table("debris", ["method", "CFL", "drift of the energy", "shortest over longest step", "verdict"], rows, "Debris at 100 µs.")
    particles = shown.particles()
    figure, axis = subplots(figsize=(6.5, 6.5))
    dots = axis.scatter(particles.points[:, 0], particles.points[:, 2], c=particles.fields["damage"], s=4, cmap="coolwarm")
    axis.set(xlabel="x (mm)", ylabel="z (mm)", aspect="equal")
    figure.colorbar(dots, label="damage (1: failed)")
    book.figure("debris", figure, "All particles at 100 µs seen from the side, SGMP, CFL 0.25.")


def check(book, full):
    book.section("Volumes and debris")
    boxes(book, full)
    gases(book, full)
    debris(book, full)
    book.command(deck("box", **KEPT), deck("gas", **KEPT), deck("debris"))


if __name__ == "__main__":
    main(check, __doc__)
