#!/usr/bin/env python3
"""A rigid plate pressed on an elastic sphere: force and contact radius against Hertz and against the elastic sphere of
finite size."""
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parent.parent), str(Path(__file__).resolve().parent)]
from common import main, solve, subplots  # noqa: E402
from contact import contact, deck  # noqa: E402
from elastic_sphere import curve, hertz  # noqa: E402

DEPTH = 0.02
# Cells per radius and band: force and radius. Half a cell of contact circle at the start is too stiff (doc/contact.md).
KNOWN = {(24, 0): (1.09, None)}
BANDS = ((0.004, 0.006), (0.008, 0.012), (0.013, 0.017), (0.017, 0.02))


def measured(run):
    """Approach at the middle of each row, force on the whole sphere, contact radius; all in units of radius and Young's
    modulus. The radius comes from the torque of the reaction: Hertz's pressure on a quarter of a circle has its centre
    at 3/8 a in x and y."""
    rows = contact(run)
    depth = DEPTH*0.5*(rows["time"][1:] + rows["time"][:-1])/rows["time"][-1]
    force = rows["force_z"][1:]
    lever = 0.5*(rows["torque_x"][1:] - rows["torque_y"][1:])
    return depth, 4*force, lever


def check(book, full):
    """Quick: 16 and 24 cells per radius; full: 8 to 48."""
    book.section("Contact: Hertz")
    exact = curve()
    book.say(
        "Hertz takes the sphere for a half-space. The model is a sphere between two plates, measured from its "
        "centre: linear elasticity "
        "(Legendre series, elastic_sphere.py) gives 5.3 % more force at d = 1 % of the radius and 7.7 % at 2 %. "
        "Means over bands of d, for the elastic "
        "plate of finite size the force rings with it."
    )
    sizes = (8, 16, 24, 32, 48) if full else (16, 24)
    runs = solve([deck("contact_hertz/hertz", cells=cells) for cells in sizes])
    figure, axis = subplots(figsize=(7.2, 4.6))
    rows = []
    for cells, run in zip(sizes, runs):
        depth, force, lever = measured(run)
        reference = np.interp(depth, np.append(0, exact[:, 1]), np.append(0, exact[:, 2]**(2/3)))**1.5
        for number, (low, high) in enumerate(BANDS):
            band = (depth >= low) & (depth < high)
            middle = depth[band].mean()
            ratio, to_hertz = force[band].mean()/reference[band].mean(), force[band].mean()/hertz(depth[band]).mean()
            radius = np.interp(middle, exact[:, 1], exact[:, 0])
            found = 8/3*lever[band].mean()/(force[band].mean()/4)
            rows.append([cells, float(middle), float(ratio), float(to_hertz), float(found/radius), float(radius*cells)])
            if cells != sizes[-1]:
                continue
            name = f"Hertz, {cells} cells per radius, d = {100*middle:.1f} % of R"
            note = f"the contact radius is {radius*cells:.1f} cells"
            known = KNOWN.get((cells, number), (None, None))
            book.within(name, "force over that of the elastic sphere", ratio, 1.0, 0.05, note, known=known[0])
            book.within(
                name, "contact radius over that of the elastic sphere", found / radius, 1.0, 0.1, note, known=known[1]
            )
        smooth = np.convolve(force, np.ones(9)/9, mode="same")[4:-4]
        axis.plot(100*depth[4:-4], smooth, label=f"{cells} cells per radius", linewidth=1)
    axis.plot(100*exact[:, 1], exact[:, 2], "k-", linewidth=2, label="elastic sphere")
    d = np.linspace(0, DEPTH, 100)
    axis.plot(100*d, hertz(d), "k--", label="Hertz")
    axis.set(xlabel="approach of plate and centre (% of R)", ylabel="force / $E R^2$", xlim=(0, 2), ylim=(0, None))
    axis.set_title("Force of a plate on a sphere", loc="left", fontweight="bold")
    axis.legend()
    book.figure("contact_hertz", figure, "Force against approach, running means over nine rows.")
    book.table(
        "contact_hertz",
        ["cells per R", "d/R", "F over elastic sphere", "F over Hertz", "a over elastic sphere", "a/h"], rows,
        "Force and contact radius.",
    )
    book.command(*[run.case for run in runs])


if __name__ == "__main__":
    main(check, __doc__)
