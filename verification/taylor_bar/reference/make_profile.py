#!/usr/bin/env python3
"""Outline of the bar from a fine run by another method than the one in question: MPM, h = 0.38 mm, CFL 0.8.

experiment.csv beside this file holds the measured shape as the paper quotes it (Table 3): length, diameter of the foot,
diameter at 0.2 L0.

    python3 make_profile.py           writes profile_mpm_fine.csv beside this file (a minute)
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent.parent))
import numpy as np  # noqa: E402
from common import Case, solve  # noqa: E402

run, = solve([Case("taylor_bar", method="mpm", cfl=0.8, h=0.38)])
points, spacing = run.particles().points, run.summary["spacing"]
radius, height = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
with open(Path(__file__).with_name("profile_mpm_fine.csv"), "w") as stream:
    stream.write("height_mm,radius_mm\n")
    for z in np.arange(0.25, height.max(), 0.25):
        stream.write(f"{z:.3f},{radius[np.abs(height - z) < 0.25].max() + 0.5 * spacing:.4f}\n")
