"""Bodies that turn: freely, and down a slope."""
import sys
from pathlib import Path

import numpy as np
from pictures import curves, method_styles, portraits
from table import NAMES, near, run_methods, value_of, within

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from contact import body  # noqa: E402

SPIN = 3.0
EDGE = (
    "nodes beyond the edge take the velocity of what is around them, which is too slow for their place, and "
    "strain the body (SGMP's reach a cell and a half); it falls with the cell"
)
CROSSING = "crossings of cell faces make energy at this Courant number, until the run ends by itself"
GROWING = (
    "it makes energy at this Courant number, until the run ends by itself at 1.1 times the first; with 0.5 it gets "
    "through and loses 6.7 %"
)
FRICTION = (
    "friction acts at nodes up to a cell and a half from the surface, and the cylinder loses angular momentum "
    "by itself; rotation=exact cures both"
)


def angular_momentum(run):
    """Change in percent of what the body had at the start."""
    particles = run.particles()
    velocity, start = particles.fields["velocity"], particles.fields["initial_position"]
    now = (particles.points[:, 0]*velocity[:, 1] - particles.points[:, 1]*velocity[:, 0]).sum()
    return 100*(now/(SPIN*(start[:, 0]**2 + start[:, 1]**2).sum()) - 1)


def spin(table):
    """A free disk and a free ring."""
    table.case(
        "Free disk and ring that turn",
        """
Plane strain, E = 1.24e9 Pa, nu = 0.35, density 8000 kg/m^3, no load: a disk of radius 1.6 m (8 cells, centre at
(0.03, 0.04) m) turns at 3 rad/s for 1 s, a ring of radii 2 and 3 m (five cells) for three turns; h = 0.2 m, Courant
number 1. Angular momentum about the origin must stay what it is. The first row of each is the scheme of the paper
(`rotation=plain`), the last SGMP with `rotation=exact`, whose rotation strains nothing: the default for solids.""",
    )
    for deck, words in (("contact_rolling/spin", "disk, three radians"), ("rotation/ring", "ring, three turns")):
        runs = run_methods(deck)
        table.row(
            f"change of angular momentum in percent, {words}",
            {m: value_of(run, angular_momentum) for m, run in runs.items()},
            0.0,
            near(0, 1),
            runs,
            {"all": EDGE} | ({"mpm": CROSSING, "gimp": GROWING} if "ring" in words else {}),
        )
        whole = runs
        runs = run_methods(deck, ("sgmp",), rotation="exact")
        table.row(
            f"the same, rotation=exact, {words}",
            {m: value_of(run, angular_momentum) for m, run in runs.items()},
            0.0,
            near(0, 0.1),
            runs,
        )
    portraits(
        table, "spin", whole | {"exact": runs["sgmp"]}, "speed", "The ring after three turns.",
        names=NAMES | {"exact": "SGMP, rotation=exact"},
    )


def slope(table):
    """A cylinder that rolls, or rolls and slides."""
    table.case(
        "Cylinder on a slope",
        """
Plane strain: a cylinder of radius 1.6 m (E = 1.24e9 Pa, nu = 0.35, density 8000 kg/m^3) on a rigid plane that
slopes by 30, 45 and 60 degrees, gravity 10 m/s^2, friction 0.4, from rest for 1 s; h = 0.2 m, the plane on a line
of nodes, Courant number 1. It rolls as long as tan(slope) <= 3 times the friction, 50.2 degrees: g t^2 sin/3,
beyond that it slides, too: g t^2 (sin - 0.4 cos)/2. The last row of each is SGMP with `rotation=exact`.""",
    )
    lines = []
    for angle in (30, 45, 60):
        sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))

        def way(run, sine=sine, cosine=cosine):
            rows = body(run, 1)
            time = rows["time"][-1]
            rigid = 10*time**2*(sine/3 if sine <= 1.2*cosine else (sine - 0.4*cosine)/2)
            return (rows["x"][-1] - rows["x"][0])/rigid

        runs = run_methods("contact_rolling/cylinder", angle=angle)
        if angle == 30:
            for method, run in runs.items():
                rows = body(run, 1)
                lines.append((rows["time"], rows["x"] - rows["x"][0], method_styles(method, markevery=0.1)))
            lines.append(
                (
                    rows["time"],
                    10 * rows["time"] ** 2 * sine / 3,
                    {"color": "0.3", "linestyle": "--", "label": "rigid cylinder"},
                )
            )
        table.row(
            f"way over that of a rigid cylinder, {angle} degrees",
            {m: value_of(run, way) for m, run in runs.items()},
            1.0,
            within(1, 0.02),
            runs,
            {"all": FRICTION},
        )
        runs = run_methods("contact_rolling/cylinder", ("sgmp",), rotation="exact", angle=angle)
        table.row(
            f"the same, rotation=exact, {angle} degrees",
            {m: value_of(run, way) for m, run in runs.items()},
            1.0,
            within(1, 0.02),
            runs,
        )
    curves(table, "slope", lines, "Way down the slope of 30 degrees.", xlabel="t (s)", ylabel="way (m)")
