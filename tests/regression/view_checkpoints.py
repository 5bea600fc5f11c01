#!/usr/bin/env python3
"""Checkpoints as sgmp-view reads them: the last one has the particles of particles_end.csv.

usage: view_checkpoints.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import json
import os
import sys

from _runs import FLUIDS, SCRATCH, SOURCE, SPLIT, SWIRL, Report, run

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(
        f"SKIPPED: {missing}; scripts/setup/setup.sh --test installs it (pip install -r "
        f"scripts/setup/requirements-test.txt)"
    )
    sys.exit(77)

try:
    import pandas
except ImportError:
    pandas = None

sys.path.insert(0, os.path.join(SOURCE, "python"))
from sgmp_view.files import SgmpFileError, read_checkpoint, read_dump, read_particles_csv  # noqa: E402

FIELDS = "stress,pressure,density,volume,mass,plastic_strain,temperature,damage,energy"
# A metal that hits a plate, in space; the plate comes from a file with ids.
IMPACT = """
dimension 3
grid cell=1
time end=0.004 cfl=0.5
material copper johnson_cook density=8.93e-3 young=117e3 poisson=0.35 yield=90 hardening_modulus=292 &
  hardening_exponent=0.31 thermal=yes room_temperature=293 melt_temperature=1356 specific_heat=383 failure=yes d1=0.3
eos copper gruneisen c0=3940 s=1.49 gamma0=1.96
material plate elastic density=7.8e-3 young=2e5 poisson=0.3
body ball sphere material=copper centre=(0.1,0.2,2.2) radius=2 ppc=2
body plate file material=plate file="plate.csv"
velocity ball z=-400
contact all
"""
SCENES = [("impact", IMPACT), ("fluids", FLUIDS), ("split", SPLIT), ("swirl", SWIRL)]


def plate():
    """A layer of particles whose ids descend."""
    with open(os.path.join(SCRATCH, "plate.csv"), "w", encoding="utf-8") as file:
        file.write("id,x,y,z,volume\n")
        for n in range(144):
            file.write(f"{900 - 3*n},{-2.75 + 0.5*(n % 12)},{-2.75 + 0.5*(n//12)},-0.25,0.125\n")


def sums_problems(report, name, path):
    """The sums of the grid have names, and under these they are what particles give: their mass; with swirl, where m
    X^2 stands behind m v X, no more than the largest radius makes of it."""
    with h5py.File(path, "r") as file:
        fields = json.loads(file["contents"][()])["fields"]
        names = fields[0]["columns"].split()
        sums = dict(zip(names, np.asarray(file["field_1/moments"]).T))
        mass = sum(
            file[f"body_{b}/particles"][:, 2 * found_axes(file)].sum()
            for b in range(1, 1 + len(json.loads(file["contents"][()])["bodies"]))
        )
    report.check(
        len(names) == len(set(names)) == len(sums) and {"mass", "momentum", "force"} <= set(names),
        f"{name}: sums {names}",
    )
    if len(fields) == 1:
        report.check(
            abs(sums["mass"].sum() / mass - 1) < 1e-12,
            f"{name}: mass of the grid {sums['mass'].sum():.6g}, of particles {mass:.6g}",
        )
    if name == "swirl":
        radius = sums["radial"].sum()/mass
        report.check(
            radius**2 <= sums["gyration"].sum() / mass <= 12**2,
            f"{name}: mean radius {radius:.4g}, gyration {sums['gyration'].sum() / mass:.4g}",
        )


def found_axes(file):
    """Axes of a checkpoint's grid."""
    return len(json.loads(file["contents"][()])["axes"])


def cut_sums(report):
    """A checkpoint whose list of checksums has lost its second half is refused: what they were of would be believed
    unread."""
    deck = (
        "\n".join(line for line in IMPACT.splitlines() if "plate" not in line).replace(
            "time end", "checkpoint every=1000\ntime end"
        )
        + "\n"
    )
    result = run("sums", deck.replace("contact all\n", ""))
    if not report.finished(result, "sums"):
        return
    path = os.path.join(
        result.folder,
        sorted(
            entry for entry in os.listdir(result.folder) if entry.endswith(".h5") and entry.startswith("checkpoint_")
        )[-1],
    )
    whole = run("sums", deck.replace("contact all\n", ""), options=("--restart", path))
    report.finished(whole, "whole checkpoint")
    with h5py.File(path, "r+") as file:
        sums = file["checked/sums"][()]
        del file["checked/sums"]
        file["checked/sums"] = sums[:len(sums)//2]
    again = run("sums", deck.replace("contact all\n", ""), options=("--restart", path))
    report.check(
        again.code == 5 and "its checksums do not fit its contents" in again.text,
        f"half of the checksums: exit code {again.code}\n{again.text}",
    )


def main():
    report = Report()
    cut_sums(report)
    plate()
    for name, deck in SCENES:
        lines = [line for line in deck.splitlines() if not line.startswith("output csv")]
        result = run(name, "\n".join([*lines, f"output csv at=end fields={FIELDS}", "checkpoint every=1000", ""]))
        if not report.finished(result, name):
            continue
        table = read_particles_csv(result.folder)
        path = sorted(
            entry for entry in os.listdir(result.folder) if entry.startswith("checkpoint_") and entry.endswith(".h5")
        )[-1]
        found = read_dump(os.path.join(result.folder, path))
        report.check(abs(found.time - result["time"]) <= 1e-15*result["time"], f"{name}: time {found.time}")
        report.check(
            len(found.points) == len(table.points), f"{name}: {len(found.points)} particles, not {len(table.points)}"
        )
        scale = np.abs(table.points).max()
        report.check(np.allclose(found.points, table.points, rtol=0, atol=1e-15*scale), f"{name}: other places")
        for field in ("id", "body", "velocity", *FIELDS.split(",")):
            wanted = table.fields[field]
            have = found.fields.get(field, np.zeros_like(wanted))
            report.check(
                np.allclose(have, wanted, rtol=2e-15, atol=1e-15 * np.abs(wanted).max()), f"{name}: other {field}"
            )
        sums_problems(report, name, os.path.join(result.folder, path))
        for number, (body, mask) in enumerate(found.bodies.items(), 1):
            report.check(
                f"body {body} " in deck and mask.sum() == (table.fields["body"] == number).sum(),
                f"{name}: particles of {body}",
            )
        if pandas:
            frame = found.frame()
            report.check(
                np.array_equal(frame["velocity_y"], found.fields["velocity"][:, 1]) and len(frame) == len(found.points),
                f"{name}: table of pandas",
            )
    wrong = os.path.join(SCRATCH, "wrong.h5")
    with open(wrong, "wb") as file:
        file.write(b"not HDF5")
    try:
        read_checkpoint(wrong)
        report.check(False, "a file that is no checkpoint is read")
    except SgmpFileError as said:
        report.check("wrong.h5" in str(said), f"said {said}")
    report.end()


main()
