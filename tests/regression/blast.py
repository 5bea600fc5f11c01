#!/usr/bin/env python3
"""Air blast (doc/loads.md): impulses on a slab, a ball and an oblique plate in all spaces, units, what --check says,
what is refused, the same bits.

usage: blast.py SGMP SOURCE_DIR SCRATCH_DIR

Known from outside: the impulse is an integral over the surface of other printed fits to the same data, those of Swisdak
(1994).
"""
import math
import os
import re

from _restarts import checkpoints, goes_on, mpirun, straight
from _runs import SCRATCH, Report, run

STEEL = "material steel elastic density=7850 young=2.1e5 poisson=0.3"
SLAB = """
units m kg ms
dimension 1
grid cell=0.01
method {method} update={update}
time end=4 cfl=0.5
""" + STEEL + """
body plate block material=steel lower=1.5 upper=1.6 spacing=0.005
blast plate charge=8 point=(-0.5) face={face} burst=surface time=0.2
history every=0.05
"""
PLATE = """
units m kg ms
dimension 3
grid cell=0.125
method sgmp
time end=5 cfl=0.5
""" + STEEL + """
body plate block material=steel lower=(0,0,0) upper=(1,1,0.125) spacing=0.0625
blast plate charge=1 point=(0.3,0.4,1) face=z+ burst=surface
history every=0.25
checkpoint every=40
"""
DISK = """
units mm g ms
dimension axisymmetric
grid cell=50
method sgmp
time end=4 cfl=0.5
material steel elastic density=7.85e-3 young=2.1e5 poisson=0.3
body plate cylinder material=steel axis=(0,1) radius=500 length=100 spacing=25
blast plate charge=1000 point=(0,800) face=z+ burst=surface
history every=0.25
"""


def swisdak(pieces, z):
    last = next(coefficients for limit, coefficients in pieces if z <= limit)
    return math.exp(sum(c*math.log(z)**i for i, c in enumerate(last)))


ARRIVAL = [
    (1.5, (-0.7604, 1.8058, 0.1257, -0.0437, -0.0310, -0.00669)),
    (40, (-0.7137, 1.5732, 0.5561, -0.4213, 0.1054, -0.00929)),
]
REFLECTED = [(40, (6.7853, -1.3466, 0.101, -0.01123))]
PEAK = [(2.9, (7.2106, -2.1069, -0.3229, 0.1117, 0.0685))]
REFLECTED_PEAK = [(2.0, (9.006, -2.6893, -0.6295, 0.1011, 0.29255, 0.13505, 0.019736))]
DURATION = [(1.02, (0.5426, 3.2299, -1.5931, -5.9667, -4.0815, -0.9149))]
INCIDENT = [
    (0.96, (5.522, 1.117, 0.6, -0.292, -0.087)), (2.38, (5.465, -0.308, -1.464, 1.362, -0.432)),
    (33.7, (5.2749, -0.4677, -0.2499, 0.0588, -0.00554)),
]


def impulse(distance, cosine, mass=1.0):
    """kPa ms on a face (Randers-Pehrson and Bannister 1997): both parts decay within one duration, so their impulses
    add as they do."""
    root = mass**(1/3)
    z = distance/root
    incident = root*swisdak(INCIDENT, z)
    if cosine <= 0:
        return incident
    return cosine**2*root*swisdak(REFLECTED, z) + (1 + cosine**2 - 2*cosine)*incident


def on_plate(n=80):
    total = 0.0
    for i in range(n):
        for j in range(n):
            x, y = (i + 0.5)/n - 0.3, (j + 0.5)/n - 0.4
            distance = math.sqrt(x*x + y*y + 0.875**2)
            total += impulse(distance, 0.875/distance)/n**2
    return total


def on_disk(n=400):
    total = 0.0
    for i in range(n):
        r = 0.5*(i + 0.5)/n
        distance = math.hypot(r, 0.7)
        total += impulse(distance, 0.7/distance)*2*math.pi*r*0.5/n
    return total


def near(report, name, found, expected, tolerance):
    report.check(abs(found/expected - 1) < tolerance, f"{name}: {found:.6g}, not {expected:.6g}")


def momentum(result, axis):
    return result.table("history.csv")[-1][f"momentum_{axis}"]


def slabs(report):
    expected = impulse(2.0, 1.0, 8.0)*1e-3
    for method, update in (("sgmp", "musl"), ("mpm", "musl"), ("gimp", "usf"), ("bspline", "usavg")):
        front = run(f"front_{method}", SLAB.format(method=method, update=update, face="x-"))
        if report.finished(front, method):
            near(report, f"{method} {update}: impulse on the face in front", momentum(front, "x"), expected, 0.01)
            first = next(row["time"] for row in front.table("history.csv") if row["momentum_x"] > 0)
            near(report, f"{method} {update}: arrival", first - 0.2, 2*swisdak(ARRIVAL, 1.0), 0.06)
    back = run("back", SLAB.format(method="sgmp", update="musl", face="x+"))
    near(report, "impulse on the face behind", momentum(back, "x"), -impulse(2.1, -1.0, 8.0)*1e-3, 0.02)


def spaces(report):
    plate = straight(report, "plate", PLATE)
    near(report, "oblique plate in 3D", momentum(plate, "z"), -on_plate()*1e-3, 0.02)
    disk = run("disk", DISK)
    if report.finished(disk, "disk"):  # 1 kPa ms m2 is 1 N s, or 1e3 g m/s
        near(report, "disk in an axisymmetric scene", momentum(disk, "z"), -on_disk()*1e3, 0.02)
    for name, threads, launcher in (("plate_threads", 2, ()), ("plate_ranks", 1, mpirun(2))):
        other = straight(report, name, PLATE, threads=threads, launcher=launcher)
        for key in ("checksum", "energy.external_work"):
            report.check(other[key] == plate[key], f"{name}: {key} {other[key]}, not {plate[key]}")
    goes_on(report, plate, "plate_again", PLATE, checkpoints(os.path.join(SCRATCH, "plate"))[0])


def refused(report, name, text, said):
    failed = run(name, text)
    report.check(failed.code == 3 and said in failed.text, f"{name}: exit code {failed.code}\n{failed.text}")


def checked(report):
    """What --check says of the face nearest to the charge; another explosive is as much TNT as its equivalent says."""
    text = run("checked", PLATE.replace("charge=1 ", "charge=0.5 tnt=2 "), options=["--check"]).text
    numbers = [
        float(x)
        for x in re.findall(r"[-+]?\d+\.\d+(?:E[-+]?\d+)?", text[text.index("nearest face") : text.index("memory")])
    ]
    least = math.hypot(0.875, 0.3 - 0.28125, 0.4 - 0.40625)
    expected = [
        least,
        least,
        swisdak(ARRIVAL, least),
        swisdak(DURATION, least),
        swisdak(PEAK, least) * 1e-3,
        swisdak(INCIDENT, least) * 1e-3,
        # kPa and kPa ms; kg/(m ms2) are 1e6 Pa, ms are ms
        swisdak(REFLECTED_PEAK, least) * 1e-3,
        swisdak(REFLECTED, least) * 1e-3,
    ]
    for name, found, value in zip(
        (
            "distance", "scaled distance", "arrival", "duration", "incident peak", "incident impulse", "reflected peak",
            "reflected impulse",
        ),
        numbers,
        expected,
        strict=True,
    ):
        near(report, "--check: " + name, found, value, 0.02)


def refusals(report):
    refused(report, "no_units", PLATE.replace("units m kg ms", ""), "what the numbers of the deck mean")
    refused(
        report, "near", PLATE.replace("point=(0.3,0.4,1)", "point=(0.3,0.4,0.2)"),
        "the fits of its blast begin at 0.178",
    )
    refused(report, "far", PLATE.replace("charge=1 ", "charge=1e-5 "), "the fits of its blast end at 40")
    refused(report, "burst", PLATE.replace("burst=surface", "burst=ground"), "free_air")
    refused(report, "beside", DISK.replace("point=(0,800)", "point=(10,800)"), "not on the axis")
    refused(
        report,
        "flat",
        DISK.replace("axisymmetric", "2")
        .replace("face=z+", "face=y+")
        .replace(
            "cylinder material=steel axis=(0,1) radius=500 length=100",
            "block material=steel lower=(0,0) upper=(500,100)",
        ),
        "is a sphere, not a cylinder",
    )


if __name__ == "__main__":
    REPORT = Report()
    slabs(REPORT)
    spaces(REPORT)
    checked(REPORT)
    refusals(REPORT)
    REPORT.end()
