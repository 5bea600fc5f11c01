#!/usr/bin/env python3
"""Makes bounce.json and the histories bounce_<case>.csv: bodies on a rigid frictionless wall, by finite elements on two
meshes.

    python3 verification/surfaces/references.py [CASE ...]

One body on a rigid frictionless wall is half of two equal bodies that meet head on. Restitution and the rest are those
of the finer mesh; their uncertainty is the difference between the meshes. Minutes per case.
"""

import json
import sys
from pathlib import Path

import numpy as np
from elements import bounce, disk, ring

HERE = Path(__file__).resolve().parent
RUBBER = 1.01e-3  # g/mm^3, lengths in mm, times in ms, stresses in MPa
# shape, outer and inner radius, Young's modulus, Poisson's ratio, speed, end, elements through the thickness (disks:
# half the radius)
CASES = {
    "rings": ("ring", 40.0, 30.0, 73.0, 0.4, 30.0, 5.0, (8, 16)),
    "rings_thin": ("ring", 40.0, 34.0, 73.0, 0.3, 15.0, 7.0, (4, 6)),
    "rings_thick": ("ring", 40.0, 24.0, 73.0, 0.2, 40.0, 4.0, (8, 12)),
    "disks": ("disk", 40.0, 0.0, 73.0, 0.3, 30.0, 3.0, (8, 12)),
}


def mesh(shape, outer, inner, through):
    """Mesh with a gap of 1 mm to the wall."""
    if shape == "disk":
        return disk(-outer - 1.0, outer, through)
    around = round(np.pi * 0.5 * (outer + inner) / ((outer - inner) / through))
    return ring(-outer - 1.0, outer, inner, through, around)


def run(case):
    shape, outer, inner, young, poisson, speed, end, sizes = CASES[case]
    found = []
    for through in sizes:
        rows = bounce(*mesh(shape, outer, inner, through), RUBBER, young, poisson, speed, end)
        # free of the wall the mean velocity stays; the last value is the rebound
        found.append({"through": through, "rebound": -rows[-1, 2], "kinetic_end": rows[-1, 1],
                      "energy_drift": float(np.ptp(rows[:, 3]))})
        print(case, found[-1], flush=True)
    np.savetxt(HERE / f"bounce_{case}.csv", rows[:, :3], fmt="%.5f", delimiter=",", comments="",
               header="time_ms,kinetic_over_first,mean_velocity_over_first")
    coarse, fine = found
    return {
        "shape": shape,
        "outer": outer,
        "inner": inner,
        "young": young,
        "poisson": poisson,
        "speed": speed,
        "end": end,
        "rebound": round(fine["rebound"], 4),
        "rebound_uncertainty": round(abs(fine["rebound"] - coarse["rebound"]), 4),
        "kinetic_end": round(fine["kinetic_end"], 4),
        "meshes": found,
    }


if __name__ == "__main__":
    for case in sys.argv[1:] or CASES:
        result = run(case)
        path = HERE / "bounce.json"
        known = json.loads(path.read_text()) if path.exists() else {}
        known[case] = result
        path.write_text(json.dumps(known, indent=1, sort_keys=True) + "\n")
