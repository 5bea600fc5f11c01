#!/usr/bin/env python3
"""Plastic strain averaged over a length (failure length=): the kernel in closed form, walls, gaps, free surfaces, and
failure that does not follow the cell.

usage: averaging.py SGMP SOURCE_DIR SCRATCH_DIR

Of a strain that is gathered at a point the average is exp(-|x|/l)/(2 l) along a line; about an axis it is found by
finite volumes on a fine grid. Constants and the total stay.
"""
import math

from _runs import AVERAGED, Report, changed, run

# A bar whose middle yields; its ends do not.
LINE = """
parameter h = 0.125
parameter l = 1
parameter method = sgmp
parameter update = musl
dimension 1
units mm g ms
grid cell=h x=-10:open
wall x-=slip
method $method update=$update
time end=0.05 cfl=0.5
material weak j2 density=7.85e-3 young=200e3 poisson=0.3 yield=50 hardening_modulus=2e4
material strong j2 density=7.85e-3 young=200e3 poisson=0.3 yield=5e4
failure weak plastic_strain=9 length=l
failure strong plastic_strain=9 length=l
body left block material=strong lower=-10 upper=-0.5 ppc=2
body weak block material=weak lower=-0.5 upper=0.5 ppc=2
body right block material=strong lower=0.5 upper=8 ppc=2
motion right where="x>7.4" x="(1-cos(2*pi*min(t,0.03)/0.03))"
damping rate=100
history steps=50
output csv at=end fields=plastic_strain,averaged_strain,mass
"""
# A rod whose core yields as it is stretched, between walls: a slice of it, about its axis or in the plane.
ROD = """
parameter h = 0.125
parameter l = 0.4
dimension {dimension}
units mm g ms
grid cell=h {grid}
wall {walls}
method {method}
time end=6e-3 cfl=0.4
material core j2 density=7.85e-3 young=200e3 poisson=0.3 yield=50
material coat j2 density=7.85e-3 young=200e3 poisson=0.3 yield=5e4
failure core plastic_strain=9 length=l
failure coat plastic_strain=9 length=l
{bodies}
velocity core {stretch}
velocity coat {stretch}
output csv at=end fields=plastic_strain,averaged_strain,mass
"""
DISKS = """body core cylinder material=core centre=(0,0,0) axis=(0,0,1) radius=0.75 length=1 ppc=2
body coat cylinder material=coat centre=(0,0,0) axis=(0,0,1) radius=2 length=1 ppc=2
subtract coat cylinder centre=(0,0,0) axis=(0,0,1) radius=0.75 length=1"""
RINGS = """body core block material=core lower=(0,-0.5) upper=(0.75,0.5) ppc=2
body coat block material=coat lower=(0.75,-0.5) upper=(2,0.5) ppc=2"""
AXIS = {"dimension": "axisymmetric", "grid": "r=0:open z=-0.5:0.5", "walls": "z-=slip z+=slip", "bodies": RINGS,
        "stretch": 'r="-40*r"'}
PLANE = {"dimension": 2, "grid": "", "walls": "x-=free", "bodies": DISKS, "stretch": 'x="40*x" y="-40*y"'}


def columns(result, *names):
    rows = result.table("particles_end.csv")
    return [[row[name] for row in rows] for name in names]


def along_line(x, strain, mass, length, ends):
    """The average on a line with ends, by images; each particle has its share of the length."""
    width = [(ends[1] - ends[0])*m/sum(mass) for m in mass]
    total = []
    for at in x:
        value = 0.0
        for place, e, w in zip(x, strain, width):
            if not e > 0:
                continue
            for image in (place, 2*ends[0] - place, 2*ends[1] - place):
                d = abs(at - image)
                value += e*(1 - math.exp(-w/2/length)*math.cosh(d/length) if d < w/2
                            else math.exp(-d/length)*math.sinh(w/2/length))
        total.append(value)
    return total


def off(found, wanted):
    """Difference over the reference, root of the mean square."""
    return math.sqrt(sum((a - b)**2 for a, b in zip(found, wanted))/sum(b*b for b in wanted))


def line(report):
    """The kernel of the line, with all methods and updates, from a wall to a free end."""
    scenes = [(1, "sgmp", update) for update in ("musl", "usf", "usl",
                                                 "usavg")] + [(1, method, "musl")
                                                              for method in ("gimp", "cpgimp", "mpm", "bspline")]
    for length, method, update in [*scenes, (3, "sgmp", "musl"), (6, "gimp", "musl"), (0.01, "sgmp", "musl")]:
        name = f"line_{method}_{update}_{length}"
        result = run(name, LINE, l=length, method=method, update=update)
        if not report.finished(result, name):
            continue
        x, strain, average, mass = columns(result, "x", "plastic_strain", "averaged_strain", "mass")
        wanted = along_line(x, strain, mass, length, (-10, 8.03)) if length > 0.1 else strain
        report.check(max(strain) > 1e-4 and off(average, wanted) < 0.04,
                     f"{name}: off by {off(average, wanted)} of the closed form, strain up to {max(strain)}")
        total = sum(m*a for m, a in zip(mass, average))/sum(m*e for m, e in zip(mass, strain))
        report.check(abs(total - 1) < 0.02, f"{name}: {total} of the total")


def about_axis(r, strain, mass, length, outer):
    """The average about an axis by finite volumes: the strain of rings is the mean of their particles."""
    n, top = 200, outer
    step = top/n
    sums, masses = [0.0]*n, [0.0]*n
    for place, e, m in zip(r, strain, mass):
        k = min(n - 1, int(place/step))
        sums[k] += m*e
        masses[k] += m
    known = [k for k in range(n) if masses[k] > 0]
    source = [sums[min(known, key=lambda q, k=k: abs(q - k))]/masses[min(known, key=lambda q, k=k: abs(q - k))]
              for k in range(n)]
    # (E_k - e_k) r_k step = l^2 of the fluxes: a system with three diagonals
    low = [-(length/step)**2*k/(k + 0.5) for k in range(n)]
    high = [-(length/step)**2*(k + 1)/(k + 0.5) for k in range(n)]
    high[-1] = 0.0
    middle = [1 - a - b for a, b in zip(low, high)]
    right = source[:]
    for k in range(1, n):
        factor = low[k]/middle[k - 1]
        middle[k] -= factor*high[k - 1]
        right[k] -= factor*right[k - 1]
    value = [0.0]*n
    value[-1] = right[-1]/middle[-1]
    for k in range(n - 2, -1, -1):
        value[k] = (right[k] - high[k]*value[k + 1])/middle[k]
    return [value[min(n - 1, int(place/step))] for place in r]


def rods(report):
    """About an axis, of rings and in the plane."""
    for name, words, methods in (("axis", AXIS, ("sgmp", "gimp")), ("plane", PLANE, ("sgmp", "bspline"))):
        for method in methods:
            title = f"rod_{name}_{method}"
            result = run(title, ROD.format(**words, method=method))
            if not report.finished(result, title):
                continue
            x, y, strain, average, mass = columns(result, "x", "y", "plastic_strain", "averaged_strain", "mass")
            r = x if name == "axis" else [math.hypot(a, b) for a, b in zip(x, y)]
            wanted = about_axis(r, strain, mass, 0.4, 2.0)
            report.check(max(strain) > 1e-3 and off(average, wanted) < 0.06,
                         f"{title}: off by {off(average, wanted)}, strain up to {max(strain)}")


def walls_and_gaps(report):
    """Half of a scene at a wall is the whole; what does not touch is not averaged with it."""
    bodies = LINE.replace("x=-10:open", "x=open:open").replace("wall x-=slip\n", "")
    pulled = 'motion left where="x<-7.9" x="-(1-cos(2*pi*min(t,0.03)/0.03))"\nmotion right'
    whole = bodies.replace("lower=-10", "lower=-8.5").replace("motion right", pulled)
    other = "body left block material=strong lower=-10 upper=-0.5 ppc=2\n"
    half = LINE.replace("x=-10:open", "x=0:open").replace(other, "")
    half = half.replace("lower=-0.5 upper=0.5", "lower=0 upper=0.5")
    whole = whole.replace("lower=-8.5", "lower=-8").replace("x<-7.9", "x<-7.4")
    first, second = run("whole", whole), run("half", half)
    if report.finished(first, "whole") and report.finished(second, "half"):
        one = {round(x, 9): a for x, a in zip(*columns(first, "x", "averaged_strain")) if x > 0}
        other = dict(zip(*columns(second, "x", "averaged_strain")))
        apart = max(abs(a - b) for a, b in zip(sorted(one.values()), sorted(other.values())))
        report.check(len(one) == len(other) and max(one.values()) > 1e-5 and apart < 1e-9,
                     f"half at a wall: {apart} apart, {len(one)} and {len(other)} particles")
    gap = LINE.replace("upper=-0.5 ppc", "upper=-1.25 ppc") + 'motion weak where="x<-0.4" x=0\n'
    result = run("gap", gap)
    if report.finished(result, "gap"):
        x, average = columns(result, "x", "averaged_strain")
        report.check(max(a for p, a in zip(x, average) if p < -1) == 0 and max(average) > 1e-5,
                     f"across a gap: {max(average)}")


def cells(report):
    """A notched bar: what it takes to tear follows the cell without a length, and not with it."""
    takes = {}
    for length in (0, 1):
        for h in (0.5, 0.25):
            deck = changed(AVERAGED, ("-8,-2", "-5,-2"), ("(8,2)", "(5,2)"), ("x>7", "x>4"), ("x<-7", "x<-4"),
                           ("length=1\n", "length=1\n" if length else "\n"))
            result = run(f"notched_{length}_{h}", deck, h=h, t_end=0.05)
            if report.finished(result, f"notched {length} {h}"):
                takes[length, h] = result["energy.supplied"]
                told = any("follows the cell" in reason for reason in result["verdict_reasons"])
                report.check(told == (length == 0), f"notched {length} {h}: {result['verdict_reasons']}")
    local, averaged = (takes[length, 0.25]/takes[length, 0.5] - 1 for length in (0, 1))
    report.check(local < -0.2 and abs(averaged) < 0.08, f"half the cells change the work of tearing by {local} and "
                                                        f"with a length by {averaged}")


def main():
    """All checks."""
    report = Report()
    line(report)
    rods(report)
    walls_and_gaps(report)
    cells(report)
    report.end()


if __name__ == "__main__":
    main()
