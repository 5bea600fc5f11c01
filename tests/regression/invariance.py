#!/usr/bin/env python3
"""What must not matter does not: where the origin is, the units, the orientation, what is written, what was in the
memory before.

usage: invariance.py SGMP SOURCE_DIR SCRATCH_DIR
"""
from _runs import ENVIRONMENT, FAILING, FLUIDS, HOOPS, METALS, SEAT, SPLIT_SPACE, Report, run

# All in units of (m, kg, s), which are 2^n of something.
MATTER = """
parameter m = 1
parameter kg = 1
parameter s = 1
parameter jitter = 0.3
parameter kind = elastic
parameter method = sgmp
parameter update = musl
method $method update=$update
time dt=0.002*s steps=60
parameter density = 2*kg/m^3
parameter young = 50*kg/(m*s^2)
material elastic elastic density=density young=young poisson=0.3
material j2 j2 density=density young=young poisson=0.3 yield=0.7*kg/(m*s^2) hardening=linear &
  hardening_modulus=3*kg/(m*s^2)
material johnson_cook johnson_cook density=density young=young poisson=0.3 yield=0.7*kg/(m*s^2) &
  hardening_modulus=3*kg/(m*s^2) hardening_exponent=0.4 rate_coefficient=0.02 reference_rate=0.1/s &
  thermal=yes melt_temperature=1000 specific_heat=0.001*m^2/s^2
eos johnson_cook gruneisen c0=5*m/s s=1.5 gamma0=2
material steinberg_guinan steinberg_guinan density=density young=young poisson=0.3 yield=0.7*kg/(m*s^2) &
  yield_limit=1*kg/(m*s^2) &
  hardening_factor=20 hardening_exponent=0.4 pressure_stiffening=0.05*m*s^2/kg thermal_softening=1e-4 &
  melt_temperature=1000 specific_heat=0.001*m^2/s^2
eos steinberg_guinan gruneisen c0=5*m/s s=1.5 gamma0=2
material zerilli_armstrong zerilli_armstrong density=density young=young poisson=0.3 yield=0.2*kg/(m*s^2) &
  thermal_stress=4*kg/(m*s^2) &
  thermal_hardening=2*kg/(m*s^2) thermal_softening=5e-3 thermal_rate=3e-4 reference_rate=0.1/s &
  specific_heat=0.001*m^2/s^2
material foam fluid density=density
eos foam shock c0=5*m/s s=1.5 gamma0=2 distention=1.2 crush_start=0.3*kg/(m*s^2) crush_end=3*kg/(m*s^2)
failure foam pmin=0
material ceramic johnson_holmquist density=density shear_modulus=0.4*young k1=0.6*young k2=young &
  hugoniot_limit=3*kg/(m*s^2) hugoniot_pressure=1.2*kg/(m*s^2) &
  intact_strength=0.9 intact_exponent=0.6 fractured_strength=0.4 fractured_exponent=0.7 rate_coefficient=0.02 &
  reference_rate=0.1/s tension_limit=0.5*kg/(m*s^2) damage_strain=0.02
material cam_clay cam_clay density=density poisson=0.3 critical_ratio=1 compression_slope=0.2 swelling_slope=0.03 &
  void_ratio=1 pressure0=0.5*kg/(m*s^2) overconsolidation=1.5
material concrete concrete density=density shear_modulus=0.4*young compressive_strength=0.6*kg/(m*s^2) &
  cohesive_strength=0.8 pressure_hardening=1.6 pressure_exponent=0.6 &
  rate_coefficient=0.02 reference_rate=0.1/s tension_limit=0.1*kg/(m*s^2) damage_strain=0.04 &
  crush_pressure=0.2*kg/(m*s^2) crush_compression=0.005 lock_pressure=3*kg/(m*s^2) &
  lock_compression=0.2 k1=2*young k2=-young k3=3*young
material crushable_foam crushable_foam density=density young=young poisson=0.2 plateau=0.3*kg/(m*s^2) &
  plastic_poisson=0.1 densification=0.5*kg/(m*s^2) densification_strain=1
viscosity elastic quadratic=1.5 linear=0.06
"""
# A block in a box; drift makes particles change cells.
BLOCK = "dimension {dimension}\n" + MATTER + """
parameter ox = 0
parameter oy = 0
grid cell=0.25*m x=ox:ox+6*m y=oy:oy+5*m{z}
wall x-=slip y-=fixed
gravity 0,{g},0
body b block material=$kind lower=(ox,oy,0) upper=(ox+2*m,oy+1.5*m,{thick}*m) ppc=2 jitter=jitter
velocity b x="(1+2*cos(2*(x-ox)/m+(y-oy)/m))*m/s" y="sin(3*(x-ox)/m)*m/s"{vz}
output csv at=end fields=stress,density,mass
"""
PLANE = BLOCK.format(dimension=2, thick=0, z="", vz="", g="-0.5*m/s^2")
SPACE = BLOCK.format(dimension=3, thick=1, z=" z=open", vz=' z="0.5*cos(2*(y-oy)/m)*m/s"', g="-0.5*m/s^2")
# Gas under another pressure on the left, whose particles exchange volume.
EXCHANGING = (PLANE.replace("update=$update", "update=$update volumes=kept").replace("wall x-=slip y-=fixed",
                                                                                     "wall x-=slip x+=slip y-=slip "
                                                                                     "y+=slip")
              .replace("upper=(ox+2*m,oy+1.5*m,0*m)", "upper=(ox+6*m,oy+5*m,0)")
              + "material air fluid density=density\neos air ideal_gas gamma=1.4 energy0=5*kg/(m*s^2)\nviscosity air "
                "quadratic=1.5 linear=0.06\n")
# The same about an axis; the place along it is free.
RINGS = "dimension axisymmetric\n" + MATTER + """
parameter oz = 0
grid cell=0.25*m r=0:5*m z=oz:oz+5*m
wall r+=slip z-=fixed
gravity 0,-0.5*m/s^2
body b cylinder material=$kind centre=(0,oz) radius=2*m length=1.5*m ppc=2 jitter=jitter
velocity b r="2*sin(r/m)*cos((z-oz)/m)*m/s" z="sin(3*r/m)*m/s"
output csv at=end fields=stress,density,mass
"""
# Flies along its lattice: particles come to lie on lines of nodes but for round-off, and nodes are as light as that.
LINES = """
parameter method = mpm
parameter update = musl
dimension 2
grid cell=0.5
method $method update=$update
time dt=0.005 steps=150
material m elastic density=1 young=10 poisson=0.3
body m block material=m lower=(0,0) upper=(3,2) ppc=2
velocity m x=-5 y=1
output csv at=end fields=displacement
"""
# powers of length, mass and time in each column
POWERS = {"x": (1, 0, 0), "velocity": (1, 0, -1), "stress": (-1, 1, -2), "density": (-3, 1, 0)}


def power_of(column, dimension):
    """Physical dimension of a column of particles_end.csv; in two dimensions masses are those of a unit thickness."""
    head = column.split("_")[0]
    if head == "mass":
        return (dimension - 3, 1, 0)
    return POWERS.get("x" if head in ("x", "y", "z") else head, (0, 0, 0))


def same_in_other_units(report, dimension, deck, kinds=("elastic", "j2", "johnson_cook", "steinberg_guinan",
                                                        "zerilli_armstrong", "foam", "ceramic", "concrete", "cam_clay",
                                                        "crushable_foam")):
    """Units that are powers of two change no bit but the exponents'."""
    units = {"m": 2.0**7, "kg": 2.0**-5, "s": 2.0**3}
    for kind in kinds:
        for method, update in (("sgmp", "musl"), ("sgmp", "usf"), ("gimp", "musl"), ("mpm", "musl")):
            if (kind != "elastic" and method != "sgmp") or (kind == "air" and update != "musl"):
                continue
            name = f"units_{dimension}_{kind}_{method}_{update}"
            settings = {"kind": kind, "method": method, "update": update}
            plain = run(name + "_1", deck, **settings)
            scaled = run(name + "_2", deck, **settings, **units)
            if not (report.finished(plain, name) and report.finished(scaled, name)):
                continue
            rows, others = plain.table("particles_end.csv"), scaled.table("particles_end.csv")
            wrong = set()
            for row, other in zip(rows, others):
                for column, value in row.items():
                    power = power_of(column, dimension)
                    factor = 128.0**power[0]*0.03125**power[1]*8.0**power[2]
                    if other[column] != value*factor:
                        wrong.add(column)
            report.check(len(rows) == len(others) and not wrong, f"{name}: other bits in {sorted(wrong)}")
            report.check(max(abs(row["velocity_x"]) for row in rows) > 0.5, f"{name}: nothing moves")


def same_elsewhere(report, dimension, deck):
    """A box moved by whole cells, or by anything exact, has the same bits; the same body elsewhere in it nearly."""
    for method, update in (("sgmp", "musl"), ("gimp", "usf"), ("mpm", "musl")):
        name = f"exact_{dimension}_{method}"
        settings = {"method": method, "update": update, "jitter": 0}
        plain = run(name + "_1", deck, **settings)
        moved = run(name + "_2", deck, ox=64, oy=-32, **settings)
        if report.finished(plain, name) and report.finished(moved, name):
            report.check(plain["checksum"] == moved["checksum"], f"{name}: a box elsewhere has other bits")
        name = f"shift_{dimension}_{method}"
        settings = {"method": method, "update": update}
        plain = run(name + "_1", deck, **settings)
        moved = run(name + "_2", deck, ox=64, oy=-32, **settings)
        if report.finished(plain, name) and report.finished(moved, name):
            # The lattice and its jitter are made in physical coordinates, in which the origin costs digits.
            compare(report, name, plain, moved, lambda row: {**row, "x": row["x"] - 64, "y": row["y"] + 32}, 1e-10)


FREE = """
parameter at = 0
parameter method = sgmp
dimension {dimension}
grid cell=0.25
method $method
time dt=0.002 steps=60
material m elastic density=2 young=50 poisson=0.25
body b block material=m lower=({lower}) upper=({upper}) spacing=0.125
velocity b {velocity}
output csv at=end fields=stress,density
"""


def same_along_the_axis(report):
    """A scene about an axis moved along it by anything exact has the same bits."""
    for method in ("sgmp", "gimp", "mpm"):
        plain, moved = (run(f"axis_{method}_{place}", RINGS, method=method, oz=place, jitter=0) for place in (0, 4))
        if not (report.finished(plain, f"axis {method}") and report.finished(moved, f"axis {method} moved")):
            continue
        rows, others = plain.table("particles_end.csv"), moved.table("particles_end.csv")
        wrong = {column for row, other in zip(rows, others) for column, value in row.items()
                 if column != "z" and other[column] != value}
        report.check(len(rows) == len(others) and not wrong, f"axis {method}: other bits in {sorted(wrong)}")


def same_by_whole_cells(report):
    """Without boundaries: moved by whole cells; bins, rows and planes have other numbers, positions other digits."""
    for method in ("sgmp", "gimp", "mpm"):
        results = []
        for at in (0, -3, 5):
            deck = FREE.format(dimension=3, lower="at,-at,2*at", upper="at+1,-at+0.75,2*at+0.5",
                               velocity='x="3+cos(2*(x-at)+y+at)" y="1+sin(3*(y+at))" z="2+sin(z-2*at+x-at)"')
            result = run(f"cells_{method}_{at}", deck, method=method, at=at)
            report.finished(result, f"cells {method} {at}")
            results.append(result)
        report.check(len({(r["steps"], r["grid_points"]) for r in results}) == 1, f"{method}: steps or points differ")
        first = results[0].table("particles_end.csv")
        for at, result in zip((-3, 5), results[1:]):
            def back(row, at=at):
                return {**row, "x": row["x"] - at, "y": row["y"] + at, "z": row["z"] - 2*at}
            compare(report, f"cells {method} {at}", results[0], result, back, 1e-11)
        report.check(len(first) == 8*6*4, "particles")


def same_when_turned(report):
    """A quarter turn: x to y and y to -x."""
    for method in ("sgmp", "gimp", "mpm"):
        plain = run(f"turn_{method}_1", FREE.format(dimension=2, lower="0,0", upper="1.5,1",
                                                    velocity='x="2*cos(x+2*y)" y="3*sin(2*x-y)"'), method=method)
        turned = run(f"turn_{method}_2", FREE.format(dimension=2, lower="-1,0", upper="0,1.5",
                                                     velocity='x="-3*sin(2*y+x)" y="2*cos(y-2*x)"'), method=method)

        def back(row):
            return {**row, "x": row["y"], "y": -row["x"], "velocity_x": row["velocity_y"],
                    "velocity_y": -row["velocity_x"],
                    "stress_xx": row["stress_yy"], "stress_yy": row["stress_xx"], "stress_xy": -row["stress_xy"]}
        if report.finished(plain, "turn") and report.finished(turned, "turned"):
            compare(report, f"quarter turn {method}", plain, turned, back, 1e-11, by_place=True)


def same_with_other_axes(report):
    """The axes change places and one its direction: x, y, z of the plain run are -z, x, y of the other."""
    for method in ("sgmp", "gimp", "mpm"):
        plain = run(f"axes_{method}_1", FREE.format(dimension=3, lower="0,0,0", upper="1.5,1,0.5",
                                                    velocity='x="2*cos(x+2*y-z)" y="3*sin(2*x-y+z)" z="1.5*cos(x-z)"'),
                    method=method)
        other = run(f"axes_{method}_2", FREE.format(dimension=3, lower="0,0,-1.5", upper="1,0.5,0",
                                                    velocity='x="3*sin(y-2*z-x)" y="1.5*cos(y+z)" z="-2*cos(2*x-y-z)"'),
                    method=method)

        def back(row):
            return {**row, "x": -row["z"], "y": row["x"], "z": row["y"],
                    "velocity_x": -row["velocity_z"], "velocity_y": row["velocity_x"], "velocity_z": row["velocity_y"],
                    "stress_xx": row["stress_zz"], "stress_yy": row["stress_xx"], "stress_zz": row["stress_yy"],
                    "stress_xy": -row["stress_xz"], "stress_yz": row["stress_xy"], "stress_xz": -row["stress_yz"]}
        if report.finished(plain, "axes") and report.finished(other, "other axes"):
            compare(report, f"other axes {method}", plain, other, back, 1e-11, by_place=True)


WRITING = """history steps=1
output vtu fields=stress,pressure,energy
output vtkhdf
output tecplot
gauge inside point=(ox+m,oy+m,0)
checkpoint every=7
"""


def same_whatever_is_written(report):
    """Rows, dumps, gauges and checkpoints are looks at a run, not parts of it."""
    for dimension, deck in ((2, PLANE), (3, SPACE)):
        silent, writing = run(f"silent_{dimension}", deck), run(f"writing_{dimension}", deck + WRITING)
        if report.finished(silent, "silent") and report.finished(writing, "writing"):
            report.check(silent["checksum"] == writing["checksum"], f"{dimension}D: what is written changes bits")


def same_in_used_memory(report):
    """Memory that is not empty when it is given out: nothing is read before it is written."""
    for name, deck in (("plane", PLANE), ("space", SPACE), ("fluids", FLUIDS), ("failing", FAILING), ("metals", METALS),
                       ("hoops", HOOPS), ("seat", SEAT), ("split", SPLIT_SPACE)):
        clean = run(f"clean_{name}", deck)
        # bytes of 127 where it is given out, of 128 where it is given back: numbers of 1e306
        ENVIRONMENT["MALLOC_PERTURB_"] = "128"
        used = run(f"used_{name}", deck)
        del ENVIRONMENT["MALLOC_PERTURB_"]
        if report.finished(clean, name) and report.finished(used, f"{name} in used memory"):
            report.check(clean["checksum"] == used["checksum"], f"{name}: used memory changes bits")


def compare(report, name, plain, other, back, tolerance, by_place=False):
    """Columns of two runs, the second one transformed back."""
    rows = plain.table("particles_end.csv")
    others = [back(row) for row in other.table("particles_end.csv")]
    if by_place:
        for table in (rows, others):
            table.sort(key=lambda row: [round(row[axis], 6) for axis in "xyz" if axis in row])
    report.check(len(rows) == len(others), f"{name}: {len(rows)} and {len(others)} particles")
    for column in rows[0]:
        if column in ("id", "body"):
            continue
        kind = column.split("_")[0]
        scale = max(abs(row[c]) for row in rows for c in row if c.split("_")[0] == kind)
        worst = max(abs(row[column] - o[column]) for row, o in zip(rows, others))
        report.check(worst <= tolerance*max(scale, 1e-300), f"{name}: {column} differs by {worst:.2g} of {scale:.2g}")


def lines(report):
    """Free flight strains nothing where particles meet lines of nodes."""
    for method in ("sgmp", "gimp", "mpm"):
        for update in ("musl", "usf", "usl", "usavg"):
            result = run(f"lines_{method}_{update}", LINES, method=method, update=update)
            if not report.finished(result, f"lines {method} {update}"):
                continue
            wrong = max(max(abs(row["displacement_x"] + 3.75), abs(row["displacement_y"] - 0.75))
                        for row in result.table("particles_end.csv"))
            report.check(wrong < 1e-11, f"lines {method} {update}: particles {wrong} from their places")


def main():
    """All invariances."""
    report = Report()
    for dimension, deck in ((2, PLANE), (3, SPACE)):
        same_in_other_units(report, dimension, deck)
        same_elsewhere(report, dimension, deck)
    same_in_other_units(report, 3, RINGS)        # masses are those of whole rings
    same_in_other_units(report, 2, EXCHANGING, ("air",))
    same_along_the_axis(report)
    same_by_whole_cells(report)
    same_when_turned(report)
    same_with_other_axes(report)
    same_whatever_is_written(report)
    same_in_used_memory(report)
    lines(report)
    report.end()


main()
