#!/usr/bin/env python3
"""Particles that carry their spin: a free body keeps turning, about any axis; momentum and mirror symmetry are kept.

usage: spin.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import Report, run

# A body in free flight that turns by about half a radian; it is stiff, so that a grid that strains it slows it down.
BODY = """
parameter carry = carried
dimension {dimension}
grid cell=0.25
method sgmp update=musl spin=$carry stress=plain rotation=plain surfaces=plain
time end=0.5 cfl=1
material stuff elastic density=1 young=1e4 poisson=0.3
body b {shape} material=stuff radius=1 spacing=0.125
velocity b {velocity}
history every=0.1
output csv at=end fields=initial_position
"""
# About each axis in turn: (shape, velocity) with the same centre on the diagonal.
SPHERE = "sphere centre=(0.05,0.05,0.05)"
AXES = {"x": 'x=0.1 y="-(z-0.05)" z="y-0.05"', "y": 'y=0.1 z="-(x-0.05)" x="z-0.05"', "z": 'z=0.1 x="-(y-0.05)" y="x-0.05"'}
DISK = ("cylinder axis=(0,0,1) centre=(0.05,0.02,0)", 'x="-(y-0.02)" y="x-0.05"')


def angular(result, axis):
    """Angular momentum about an axis through the centroid, over the mass."""
    rows = result.table("particles_end.csv")
    p, q = {"x": "yz", "y": "zx", "z": "xy"}[axis]
    mean = {name: sum(row[name] for row in rows)/len(rows) for name in (p, q, f"velocity_{p}", f"velocity_{q}")}
    total = 0.0
    for row in rows:
        total += (row[p] - mean[p])*(row[f"velocity_{q}"] - mean[f"velocity_{q}"]) \
            - (row[q] - mean[q])*(row[f"velocity_{p}"] - mean[f"velocity_{p}"])
    return total/len(rows)


def inertia(result, axis, centre):
    """Moment of inertia at the start, over the mass: the angular momentum of unit spin."""
    rows = result.table("particles_end.csv")
    p, q = {"x": "yz", "y": "zx", "z": "xy"}[axis]
    place = dict(zip("xyz", centre))
    return sum((row[f"{p}0"] - place[p])**2 + (row[f"{q}0"] - place[q])**2 for row in rows)/len(rows)


def free_bodies(report):
    """A free body keeps its angular momentum; without the option it loses per cent. All axes are alike."""
    result = run("disk", BODY.format(dimension=2, shape=DISK[0], velocity=DISK[1]))
    plain = run("disk_plain", BODY.format(dimension=2, shape=DISK[0], velocity=DISK[1]), carry="none")
    if report.finished(result, "disk") and report.finished(plain, "disk, plain"):
        change = angular(result, "z")/inertia(result, "z", (0.05, 0.02, 0)) - 1
        report.check(abs(change) < 1e-3, f"disk: angular momentum changes by {change}")
        change = angular(plain, "z")/inertia(plain, "z", (0.05, 0.02, 0)) - 1
        report.check(change < -1e-2, f"disk without spin: angular momentum changes by {change} only: the scene does not test anything")
    found = {}
    for axis, velocity in AXES.items():
        result = run(f"sphere_{axis}", BODY.format(dimension=3, shape=SPHERE, velocity=velocity))
        if not report.finished(result, f"sphere about {axis}"):
            return
        found[axis] = angular(result, axis)/inertia(result, axis, (0.05, 0.05, 0.05)) - 1
        report.check(abs(found[axis]) < 2e-3, f"sphere about {axis}: angular momentum changes by {found[axis]}")
        momentum = [row[f"momentum_{axis}"] for row in result.table("history.csv")]
        report.check(max(abs(m/momentum[0] - 1) for m in momentum) < 1e-12, f"sphere about {axis}: momentum changes")
    report.check(max(found.values()) - min(found.values()) < 1e-7, f"axes are not alike: {found}")


# Half of it behind a slip wall, or all of it.
BLOCK = """
dimension {dimension}
grid cell=0.5{box}
{wall}
method sgmp update=musl spin=carried stress=plain surfaces=plain
time dt=0.01 steps=150
material gel elastic density=1 young=20 poisson=0.3
body b block material=gel lower=({low},0.2,0) upper=(2,1.7,{thick}) ppc=2
velocity b x="0.3*x*(y-1)" y="-0.2*x*x"{z}
output csv at=end
"""


def mirror(report):
    """What a slip wall cuts off moves as its mirror image."""
    for dimension in (2, 3):
        z = ' z="0.1*x*x*y"' if dimension == 3 else ""
        half = run(f"half_{dimension}", BLOCK.format(dimension=dimension, thick=dimension - 2, box=" x=0:open", wall="wall x-=slip", low="0", z=z))
        whole = run(f"whole_{dimension}", BLOCK.format(dimension=dimension, thick=dimension - 2, box="", wall="", low="-2", z=z))
        if not (report.finished(half, "half") and report.finished(whole, "whole")):
            return
        state = [sorted((tuple(round(row[k], 7) + 0.0 for k in ("x", "y")), row["velocity_x"], row["velocity_y"])
                        for row in result.table("particles_end.csv") if row["x"] > 0) for result in (half, whole)]
        report.check(len(state[0]) == len(state[1]), f"{dimension} dimensions: {len(state[0])} and {len(state[1])} particles")
        miss = max(max(abs(a[0][0] - b[0][0]), abs(a[0][1] - b[0][1]), abs(a[1] - b[1]), abs(a[2] - b[2])) for a, b in zip(*state))
        report.check(miss < 1e-6, f"{dimension} dimensions: half and whole differ by {miss}")


def main():
    report = Report()
    free_bodies(report)
    mirror(report)
    report.end()


if __name__ == "__main__":
    main()
