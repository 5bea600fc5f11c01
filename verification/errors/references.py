#!/usr/bin/env python3
"""Makes references.json: what the numbers of check.py are beside, by other means than this program where there are any.

    build/venv/bin/python verification/errors/references.py [beam blast rings ball]        minutes each

beam: finite elements (verification/surfaces/elements.py) of two meshes, taken to their limit with the second order of
the elements blast: spherical shells (verification/blast/shells.py), two numbers of shells rings: finite elements,
verification/surfaces/bounce.json and bounce_rings.csv taylor: an independent code, verification/bar_surface.py ball:
nothing but this program: gimp and bspline with cells of 0.4 of the deck's
"""

import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "surfaces"), str(HERE.parent / "blast"), str(ROOT / "python")]
import numpy as np  # noqa: E402

OMEGA, PERIODS = 0.100247, 1.125  # of the beam
BALL = ("bodies.ball.velocity_z", "impact.plate.opening.diameter", "impact.plate.cloud.momentum")


def beam_run(through):
    """The beam of beam.inp along x: velocity and way of its middle, kinetic energy at the end."""
    from elements import Mesh, block_nodes
    bl = 4.7300407448627
    b, c1, c2 = bl / 8, np.cosh(bl) - np.cos(bl), np.sin(bl) - np.sinh(bl)
    x, y = np.meshgrid(np.linspace(0, 8, 8 * through + 1), np.linspace(0, 1, through + 1), indexing="ij")
    nodes, quads = block_nodes(x, y)
    mesh = Mesh(nodes, quads, 1.0, 1.0, 0.3)
    s = b * nodes[:, 0]
    place, speed = nodes.copy(), np.zeros_like(nodes)
    speed[:, 1] = 1e-3 * OMEGA / (2 * c2) * (c1 * (np.sin(s) + np.sinh(s)) + c2 * (np.cos(s) + np.cosh(s)))
    end = 2 * np.pi * PERIODS / OMEGA
    steps = int(np.ceil(end / mesh.dt))
    dt, middle = end / steps, np.flatnonzero((np.abs(nodes[:, 0] - 4) < 1e-9) & (np.abs(nodes[:, 1] - 0.5) < 1e-9))[0]
    for step in range(steps):
        force, _ = mesh.force(place)
        speed += (dt if step else 0.5 * dt) * force / mesh.m[:, None]
        place += dt * speed
    speed += 0.5 * dt * mesh.force(place)[0] / mesh.m[:, None]
    return np.array([speed[middle, 1], place[middle, 1] - nodes[middle, 1], 0.5 * (mesh.m[:, None] * speed**2).sum()])


def beam():
    """Two meshes, and their limit; along y of the deck, where the beam lies at 15 degrees."""
    coarse, fine = beam_run(8), beam_run(16)
    turn = np.cos(np.radians(15))
    limit, spread = fine + (fine - coarse) / 3, np.abs(fine - coarse) / 3
    scale = np.array([turn, turn, 1])
    names = ("gauges.middle.velocity_y", "gauges.middle.y:change", "history.kinetic_energy")
    return dict(zip(names, np.column_stack([limit * scale, spread * scale]).tolist()))


def blast():
    """Shells of the charge of blast.inp: overpressure is the deck's pressure, with the ambient one."""
    from shells import blast as shells
    found = []
    for cells in (40, 80):
        times, rows, _, _ = shells(cells, 24.47, 700.0, 0.14, np.array([250.0]))
        pressure = rows[:, 1, 0]
        found.append([pressure.max(), np.trapezoid(pressure, times), times[pressure.argmax()]])
    coarse, fine = np.array(found)
    names = ("gauges.above.pressure:max", "gauges.above.pressure:integral", "gauges.above.pressure:time_of_max")
    return dict(zip(names, np.column_stack([fine, np.abs(fine - coarse)]).tolist()))


def rings():
    """Rebound and energies of rings.inp (h apart, both the same as a body before a wall)."""
    known = json.loads((HERE.parent / "surfaces/bounce.json").read_text())["rings"]
    rows = np.loadtxt(HERE.parent / "surfaces/bounce_rings.csv", delimiter=",", skiprows=1)
    first = 2 * 0.5 * 1.01e-3 * np.pi * (40**2 - 30**2) * 30**2
    apart = abs(known["meshes"][0]["kinetic_end"] - known["meshes"][1]["kinetic_end"])
    return {"bodies.left.velocity_x": [-30 * known["rebound"], 30 * known["rebound_uncertainty"]],
            "history.kinetic_energy": [first * known["kinetic_end"], first * apart],
            "history.kinetic_energy:min": [first * float(rows[:, 1].min()), first * apart]}


def taylor():
    """Converged shape: length, and radius of the foot."""
    from bar_surface import REFERENCE
    (length, band), (foot, foot_band) = REFERENCE["L"], REFERENCE["D"]
    return {"extent.bar.z_max": [length, band], "extent.bar.r_max": [foot / 2, foot_band / 2]}


def ball():
    """Two other methods with cells of 0.4 of the deck's: their mean, and half of what is between them."""
    import common
    from sgmp_view.quantities import quantity_of
    found = []
    for method in ("gimp", "bspline"):
        text = (
            (ROOT / "input/gallery/ball_plate.inp")
            .read_text()
            .replace("method sgmp", f"method {method}")
            .replace("h = 0.25", "h = 0.1")
        )
        folder = common.BUILD / "errors" / f"ball_{method}"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "ball.inp").write_text(text)
        common.subprocess.run(
            [
                str(common.SOLVER), str(folder / "ball.inp"), "--quiet", "--threads", "1", "--output",
                str(folder / "out"),
            ],
            check=True,
        )
        found.append([quantity_of(folder / "out", name) for name in BALL])
    first, second = np.array(found)
    return dict(zip(BALL, np.column_stack([0.5 * (first + second), 0.5 * np.abs(first - second)]).tolist()))


if __name__ == "__main__":
    parts = {"beam": beam, "blast": blast, "rings": rings, "taylor": taylor, "ball": ball}
    path = HERE / "references.json"
    for name in sys.argv[1:] or parts:
        result = parts[name]()
        known = json.loads(path.read_text()) if path.exists() else {}
        path.write_text(json.dumps({**known, name: result}, indent=1, sort_keys=True) + "\n")
        print(name, result, flush=True)
