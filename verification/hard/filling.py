"""Matter whose volume changes by large factors: explosive and gas in closed boxes, a bar pulled to ten times its
length, debris."""
import sys
from pathlib import Path

import numpy as np
from pictures import portraits
from table import NAMES, at_most, near, run_methods, value_of, within

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from volumes.tube import jwl  # noqa: E402

DENSITY = 1.63e-3
PLAIN = (
    "these methods have no divergence at the centres of cells that volumes could follow (volumes=kept): "
    "particles overlap or leave room"
)


def filled(deck, **parameters):
    """By all methods; with SGMP volumes follow the divergence of the auxiliary grid."""
    return run_methods(deck, ("sgmp",), volumes="kept", **parameters) | run_methods(
        deck, ("gimp", "mpm", "bspline"), **parameters
    )


def volume(run):
    """Sum of the particles'."""
    return run.particles().fields["volume"].sum()


def pressure(run):
    """Mean over the volume."""
    fields = run.particles().fields
    return (fields["pressure"]*fields["volume"]).sum()/fields["volume"].sum()


def inner_energy(run):
    """Internal energy."""
    fields = run.particles().fields
    return (fields["energy"]*fields["mass"]).sum()


def energy_ratio(run):
    """Total energy over that of the start."""
    energy = run.history()["total_energy"]
    return energy[-1]/energy[0]


def charge(table):
    """A half-filled box."""
    table.case(
        "Explosive in a box that it half fills",
        """
TNT (density 1.63 g/cm^3, detonation speed 6930 m/s; JWL: A = 371.2 GPa, B = 3.21 GPa, R1 = 4.15, R2 = 0.95, omega =
0.3, E0 = 6.993 GPa) fills the lower half of a closed box of 20 x 12 cells (h = 1 mm, plane strain) between smooth
walls; lit at a lower corner at t = 0; Courant number 0.4, to 1 ms, when the products have crossed the box some
hundred times. Then they fill it, their energy is what it was, and their mean pressure is nearly JWL at mean volume
and energy (above it by 4 % in a tube, by an independent Lagrangian code, for the gas is not of one entropy).
Particles are split in two when they are longer than a cell (`split=1`); with SGMP their volumes follow the
divergence at the centres of cells (`volumes=kept`).""",
    )
    runs = filled("volumes/box", fill=6, t_end=1, split=1.0)
    table.row(
        "sum of volumes over the box",
        {m: value_of(run, lambda run: volume(run) / 240) for m, run in runs.items()},
        1.0,
        within(1, 0.02),
        runs,
        {"all": PLAIN},
    )
    table.row(
        "mean pressure over JWL",
        {
            m: value_of(run, lambda run: pressure(run) / jwl(2.0, inner_energy(run) / DENSITY / 120))
            for m, run in runs.items()
        },
        1.0,
        within(1, 0.1),
        runs,
        {"all": PLAIN},
    )
    table.row(
        "energy over that of the start",
        {m: value_of(run, energy_ratio) for m, run in runs.items()},
        1.0,
        within(1, 0.01),
        runs,
        {"all": PLAIN},
    )
    portraits(table, "charge", runs, "pressure", "Products in the end (pressure in MPa).")


def gas(table):
    """Ten times its volume."""
    table.case(
        "Gas that expands into ten times its room",
        """
An ideal gas (gamma = 1.4, density 1, p = 1) fills 4 of 40 cells of a closed channel 4 cells high (h = 1, plane
strain, smooth walls) and is set free at t = 0; Courant number 0.4, to t = 300. At rest p V = (gamma - 1) E of the
whole channel. `split=0.75`, with SGMP `volumes=kept`.""",
    )
    runs = filled("volumes/gas", fill=4, length=40, split=0.75)
    table.row(
        "sum of volumes over the channel",
        {m: value_of(run, lambda run: volume(run) / 160) for m, run in runs.items()},
        1.0,
        within(1, 0.03),
        runs,
        {"all": PLAIN},
    )
    table.row(
        "pressure over (gamma - 1) E/V",
        {m: value_of(run, lambda run: pressure(run) / (0.4 * inner_energy(run) / 160)) for m, run in runs.items()},
        1.0,
        within(1, 0.03),
        runs,
        {"all": PLAIN},
    )
    table.row(
        "energy over that of the start",
        {m: value_of(run, energy_ratio) for m, run in runs.items()},
        1.0,
        within(1, 0.03),
        runs,
        {"all": PLAIN},
    )
    portraits(table, "gas", runs, "pressure", "The gas in the end.", layout=(4, 1), panel=(7.0, 1.1))


def stretch(table):
    """Ten times its length."""
    table.case(
        "Bar pulled to ten times its length",
        """
A neo-Hookean bar (E = 0.001, nu = 0, density 1, length 1, height 1 between smooth walls, h = 0.25) flies apart with
the velocity x, nearly without force, to t = 9: it is then ten times as long and its density 0.1 everywhere
(measured over its inner half, x < 5, for its free end springs back). Particles of `split=0.6` are cut in two when
they are longer than 0.6 cells; without it they part, and the bar is a row of grains.""",
    )
    bars = {}
    for split in ("none", 0.6):
        runs = run_methods("volumes/stretch", split=split)
        bars |= {f"{m} {split}": run for m, run in runs.items() if m in ("sgmp", "mpm")}

        def gaps(run):
            cells = np.unique(np.floor(run.particles().points[:, 0]/0.25))
            return cells.max() + 1 - len(cells)

        def inner(run):
            particles = run.particles()
            return particles.fields["density"][particles.points[:, 0] < 5]

        torn = (
            {"all": "particles further apart than a cell do not feel each other"}
            if split == "none"
            else {"mpm": "the gradient jumps at cell faces, and so does the strain of particles that cross them"}
        )
        words = f"split={split}"
        table.row(
            f"cells without a particle, {words}",
            {m: value_of(run, gaps) for m, run in runs.items()},
            0.0,
            at_most(0),
            runs,
            torn,
        )
        table.row(
            f"least density, {words}",
            {m: value_of(run, lambda run: inner(run).min()) for m, run in runs.items()},
            0.1,
            within(0.1, 0.05),
            runs,
            torn,
        )
        table.row(
            f"largest density, {words}",
            {m: value_of(run, lambda run: inner(run).max()) for m, run in runs.items()},
            0.1,
            within(0.1, 0.05),
            runs,
            torn,
        )
    portraits(
        table,
        "stretch",
        bars,
        "density",
        "The bar in the end, without and with splitting.",
        layout=(4, 1),
        panel=(7.0, 1.0),
        names={name: f"{NAMES[name.split()[0]]}, split={name.split()[1]}" for name in bars},
    )


def debris(table):
    """A lead ball through lead."""
    table.case(
        "Debris of a hypervelocity impact",
        """
Three dimensions: a lead ball of radius 7.5 mm hits the middle of a free plate 127.2 x 127.2 x 6.36 mm of lead at
6.58 km/s along +z; density 11.35 g/cm^3, E = 17 GPa, nu = 0.42, yield stress 12 MPa, hardening 125 MPa,
Mie-Grueneisen (c0 = 2092 m/s, s = 1.45, gamma = 2); what has seen a pressure of -1 GPa or a plastic strain of 3
carries nothing; h = 4.24 mm, Courant number 0.25, to 100 us. Energy is conserved, and what flies freely needs no
shorter steps.""",
    )
    runs = run_methods("volumes/debris", cfl=0.25)
    coarse = {"all": "the error falls with the time step"}
    table.row(
        "change of the energy over the first",
        {m: value_of(run, lambda run: run.summary["energy"]["drift"]) for m, run in runs.items()},
        0.0,
        near(0, 0.03),
        runs,
        coarse,
    )
    table.row(
        "momentum over that of the ball, less 1",
        {
            m: value_of(run, lambda run: run.history()["momentum_z"][-1] / run.history()["momentum_z"][0] - 1)
            for m, run in runs.items()
        },
        0.0,
        near(0, 1e-9),
        runs,
    )
    table.row(
        "1 less the shortest over the longest step",
        {
            m: value_of(
                run,
                lambda run: 1 - run.summary["end_state"]["shortest_step"] / run.summary["end_state"]["longest_step"],
            )
            for m, run in runs.items()
        },
        0.0,
        at_most(0.8),
        runs,
    )
    portraits(
        table, "debris", runs, "body",
        "Plate (green) and ball (blue) in the end, seen from the side (mm); the ball came from the left.",
        axes=(2, 0, 1), layout=(2, 2), panel=(4.6, 3.4),
    )
