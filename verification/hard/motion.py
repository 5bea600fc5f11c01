"""Motion that must leave a body as it is, and bodies of few particles."""
import re
import sys
from pathlib import Path

import numpy as np
from pictures import curves, method_styles, portraits
from table import METHODS, NAMES, at_most, near, run_methods, value_of, within

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from contact import body  # noqa: E402

SPEED_OF_WAVES = np.sqrt(0.7/(1.3*0.4))  # E = density = 1, nu = 0.3


def alone(table):
    """Alone."""
    table.case(
        "One particle alone",
        """
A single particle of volume (h/2)^3 in an unbounded grid, velocity (5, 3, 4) h per unit of time, gravity 0.5 along
-z, E = 1, density 2; to t = 20, about 140 cells. It must fly a parabola x0 + v t + g t^2/2 and feel no stress; any
step is stable, and `cfl=auto` must find one nevertheless.""",
    )
    for cfl, words in ((0.5, "Courant number 0.5"), ("auto", "cfl=auto")):
        runs = run_methods("alone", cfl=cfl)
        expected = np.array([0.35, 0.45, 0.55]) + np.array([5.0, 3.0, 4.0])*20 + np.array([0.0, 0.0, -0.25])*400
        values = {
            m: value_of(run, lambda run: np.abs(run.particles().points[0] - expected).max()) for m, run in runs.items()
        }
        table.row(f"distance from the parabola over h, {words}", values, 0.0, at_most(1e-9), runs)
        stress = {
            m: value_of(run, lambda run: np.abs(run.particles().fields["stress"]).max()) for m, run in runs.items()
        }
        table.row(f"largest stress over E, {words}", stress, 0.0, at_most(1e-9), runs)
    time = np.linspace(0, 20, 81)
    lines = [(0.35 + 5*time, 0.55 + 4*time - 0.25*time**2, {"color": "0.3", "label": "parabola"})]
    for number, (method, run) in enumerate(runs.items()):
        way = body(run, 1)
        lines.append((way["x"][number::4], way["z"][number::4], method_styles(method, linestyle="")))
    curves(
        table, "alone", lines, "Way of the particle (cfl=auto), markers of the methods in turn.", xlabel="x/h",
        ylabel="z/h",
    )


def flight(table):
    """Flight in ten directions."""
    table.case(
        "Free flight through 100 cells",
        """
A disk of radius 5 h, centre at (0.13, 0.29) h, E = density = 1, nu = 0.3, breathes: radial velocity 0.002 c r/R at
the start. It flies at 0.5 c in the directions 0, 9, 18, … 81 degrees for a time of 200 h/c with the step 0.2 h/c,
that is through 100 cells. In its own frame nothing may differ from the same disk at rest.""",
    )
    energy, shape, rest = {}, {}, {}
    angles = range(0, 90, 9)
    for method in METHODS:
        still = run_methods("flight", (method,), speed=0)[method]
        flying = [run_methods("flight", (method,), angle=angle)[method] for angle in angles]
        start = own_energy(still, 0.0)
        rest[method] = start[-1]/start[0] - 1
        energy[method] = max(abs((own_energy(run, 0.5)[-1] - start[-1])/start[0]) for run in flying)
        shape[method] = max(
            np.sqrt(np.mean(np.sum((own_shape(run, 0.5, angle) - own_shape(still, 0.0, 0)) ** 2, axis=1))) / 0.01
            for run, angle in zip(flying, angles)
        )
    crossing = {
        "mpm": "the gradient jumps at cell faces: each crossing of a particle changes its force by a finite amount",
        "all": "mass and stiffness of the rim, as the grid sees them, depend on where its particles lie in their "
        "cells, which changes all the way",
    }
    runs = run_methods("flight")
    table.row("energy of the disk at rest, change", rest, 0.0, near(0, 0.05), runs)
    table.row(
        "energy in its own frame, largest deviation from the disk at rest over the initial", energy, 0.0, at_most(0.05),
        runs, crossing,
    )
    table.row(
        "place of particles in its own frame, largest rms deviation over 0.002 R", shape, 0.0, at_most(0.1), runs,
        crossing,
    )
    lines = []
    for method in METHODS:
        for angle, speed, style in ((45, 0.5, "-"), (0, 0.0, ":")):
            run = run_methods("flight", (method,), **({"angle": angle} if speed else {"speed": 0}))[method]
            energy_now = own_energy(run, speed)
            lines.append(
                (
                    run.history()["time"] * SPEED_OF_WAVES, energy_now / energy_now[0],
                    method_styles(method, linestyle=style, marker="", **({} if speed else {"label": None})),
                )
            )
    curves(
        table, "flight", lines,
        "Energy in its own frame of the disk that flies at 45 degrees (lines) and of the disk at rest (dots).",
        xlabel="t c/h", ylabel="energy over the first",
    )


def own_energy(run, speed):
    """Energy less that of the flight."""
    mass = 0.25*len(run.particles().points)
    return run.history()["total_energy"] - 0.5*mass*(speed*SPEED_OF_WAVES)**2


def own_shape(run, speed, angle):
    """Displacement less that of the flight."""
    particles = run.particles()
    way = speed*200*np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    return (particles.points - particles.fields["initial_position"])[:, :2] - way


def single(table):
    """Few particles per cell."""
    table.case(
        "One particle per cell",
        """
A bar of length 1 and 32 cells between fixed ends, E = density = 1, nu = 0, velocity 1e-4 sin(pi x), step 0.1 h/c,
one period (t = 2). Particles in the middle of equal parts of the cells. Then every particle is back where it
was.""",
    )
    for ppc in (1, 2, 3):
        runs = run_methods("single", ppc=ppc)
        values = {
            m: value_of(
                run,
                lambda run: (
                    np.sqrt(
                        np.mean((run.particles().points[:, 0] - run.particles().fields["initial_position"][:, 0]) ** 2)
                    )
                    / (1e-4 / np.pi)
                ),
            )
            for m, run in runs.items()
        }
        table.row(
            f"rms displacement after a period over the amplitude, {ppc} per cell", values, 0.0, at_most(0.02), runs
        )
        if ppc == 2:
            lines = [(*displaced(run), method_styles(method, linestyle="")) for method, run in runs.items()]
            curves(
                table, "single", lines, "Displacement after a period, two particles per cell: 0 is exact.", xlabel="x",
                ylabel="displacement over the amplitude",
            )


def displaced(run):
    """Places and displacements over the amplitude."""
    particles = run.particles()
    start = particles.fields["initial_position"][:, 0]
    return start, (particles.points[:, 0] - start)/(1e-4/np.pi)


def thin(table):
    """A plate one particle thick."""
    exact = 2*40*np.sqrt(0.91)
    table.case(
        "Plate one particle thick",
        """
A plate of length 40 h and a thickness of one, two or four particles of side h/2, free on all sides, its lower face
at 0.25 h over a line of nodes, E = density = 1, nu = 0.3, vibrates lengthwise: velocity -1e-4 cos(pi x/L). The
faces are free of stress, so waves run at sqrt(E/(density (1 - nu^2))); with thickness strain suppressed they would
run at c, in 0.90 of the time.""",
    )
    lines = []
    for layers in (1, 2, 4):
        runs = run_methods("thin", layers=layers)
        values = {m: value_of(run, lambda run: period(run, exact)/exact) for m, run in runs.items()}
        table.row(
            f"period over 2 L sqrt(density (1 - nu^2)/E), {layers} layer{'s' if layers > 1 else ''}",
            values,
            1.0,
            within(1, 0.02),
            runs,
            {
                "all": "one layer reads next to no strain across its thickness and cannot relax its stress there: "
                "waves run at c"
            },
        )
        for method, run in runs.items():
            if method in ("sgmp", "mpm") and layers != 2:
                history = run.history()
                lines.append(
                    (
                        history["time"] / exact,
                        history["kinetic_energy"] / history["kinetic_energy"][0],
                        method_styles(
                            method, linestyle="-" if layers == 1 else "--", marker="",
                            label=f"{NAMES[method]}, {layers} layer{'s' if layers > 1 else ''}",
                        ),
                    )
                )
    time = np.linspace(0, lines[0][0][-1], 400)
    lines.append(
        (time, np.cos(2 * np.pi * time) ** 2, {"color": "0.3", "linestyle": ":", "label": "exact, dispersion left out"})
    )
    curves(
        table, "thin", lines, "Kinetic energy of the vibration over its exact period.",
        xlabel="t over the exact period", ylabel="kinetic energy over the first",
    )


def period(run, exact):
    """Of the vibration, whose kinetic energy has half of it: best fit of a + b cos + c sin."""
    history = run.history()
    time, kinetic = history["time"], history["kinetic_energy"]
    best = (np.inf, 0.0)
    for guess in exact*np.linspace(0.7, 1.3, 1201):
        phase = 4*np.pi*time/guess
        columns = np.column_stack([np.ones_like(time), np.cos(phase), np.sin(phase)])
        residual = kinetic - columns @ np.linalg.lstsq(columns, kinetic, rcond=None)[0]
        best = min(best, (float(residual @ residual), float(guess)))
    return best[1]


def drift(table):
    """A million steps."""
    table.case(
        "A million steps",
        """
A bar of length 1 and 8 cells with two Gauss points each between fixed ends, E = density = 1, nu = 0, small strains,
velocity 1e-6 sin(pi x), step 0.02 (Courant number 0.16), a million steps: 10^4 periods. USAVG. Nothing damps; what
energy is lost or found is round-off and the scheme. Compared are the means over the first and the last
hundredth.""",
    )
    runs = run_methods("drift")

    def change(run):
        total = run.history()["total_energy"]
        n = len(total)//100
        return total[-n:].mean()/total[:n].mean() - 1

    table.row(
        "energy, relative change", {m: value_of(run, change) for m, run in runs.items()}, 0.0, near(0, 1e-3), runs
    )
    remainder = {
        m: value_of(run, lambda run: abs(run.summary["energy"]["remainder"]) / run.history()["total_energy"][0])
        for m, run in runs.items()
    }
    table.row("remainder of the kinetic identity over the energy", remainder, 0.0, at_most(1e-9), runs)
    lines = []
    for method, run in runs.items():
        history = run.history()
        parts = len(history["time"])//100
        means = [history[name][:100*parts].reshape(100, parts).mean(axis=1) for name in ("time", "total_energy")]
        lines.append((means[0]/2, means[1]/means[1][0] - 1, method_styles(method, marker="")))
    curves(
        table, "drift", lines, "Energy, means over a hundredth of the run each.", xlabel="periods",
        ylabel="energy over the first, less 1",
    )


def units(table):
    """Units by powers of two."""
    table.case(
        "Units by powers of two",
        """
An elastoplastic block (2 x 1.5, h = 0.25, J2, particles displaced at random by 0.3 spacings) slides and falls
between walls for 200 steps; once in m, kg, s, once with all inputs in units 2^7, 2^-5 and 2^3 times smaller. All
results must have the same mantissas.""",
    )
    differing = {}
    scaled = run_methods("units", m=2.0**7, kg=2.0**-5, s=2.0**3)
    plain = run_methods("units")
    for method in METHODS:
        one, other = (read_raw(run) for run in (plain[method], scaled[method]))
        factor = np.array([scale_of(name) for name in one["names"]])
        differing[method] = float(np.sum(one["values"]*factor != other["values"]))
    table.row("numbers of particles_end.csv that differ", differing, 0.0, at_most(0), plain)
    portraits(table, "units", plain, "speed", "The block after 200 steps.")


def scale_of(name):
    """What a column has to be multiplied with."""
    length, mass, time = {"x": (1, 0, 0), "y": (1, 0, 0), "z": (1, 0, 0), "velocity": (1, 0, -1), "stress": (-1, 1, -2),
                          "density": (-3, 1, 0)}.get(name.split("_")[0], (0, 0, 0))
    return 2.0**(7*length - 5*mass + 3*time)


def read_raw(run):
    """Names and numbers of particles_end.csv."""
    lines = (run.folder / "particles_end.csv").read_text().splitlines()
    rows = [
        [float(re.sub(r"(\d)([+-]\d{3})$", r"\1E\2", word)) for word in line.split(",")]
        for line in lines[1:]
        if not line.startswith("#")
    ]
    return {"names": lines[0].split(","), "values": np.array(rows)}

