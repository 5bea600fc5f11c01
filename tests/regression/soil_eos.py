#!/usr/bin/env python3
"""Soil with an equation of state (drucker_prager; doc/materials.md, Soils): shocks in clay and in porous sand against
the jump conditions with friction, what is pulled apart, a buried charge.

usage: soil_eos.py SGMP SOURCE_DIR SCRATCH_DIR

Behind a plane front in soil that slides, stress along the way is p + 2/3 q with q = k + M p; momentum, mass and energy
give p, density and speed. Solved here from the equations alone.
"""
import math

from _runs import Report, run

PLATES = """
units mm g ms
parameter u = 300
dimension 1
grid cell=0.05 x=open
method sgmp
time end=10/u*{way} cfl=0.2
material soil drucker_prager density={density} young={young} poisson=0.3 friction={angle} cohesion={cohesion}
eos soil shock c0=3000 s=1.5 gamma0=1 {pores}
body left block material=soil lower=-10 upper=0 ppc=2
body right block material=soil lower=0 upper=10 ppc=2
velocity left x=u
velocity right x=-u
output csv at=end fields=pressure,density,von_mises
"""
PULLED = """
dimension {space}
grid cell=1
method sgmp
time end=20 cfl=0.4
material soil drucker_prager density=1 young=1 poisson=0.3 friction=30 cohesion={cohesion}
eos soil shock c0=1 s=1.5 gamma0=1
body soil block material=soil lower=({zero}) upper=({upper}) ppc=2
velocity soil x="0.02*(x0-4)"
output csv at=end fields=pressure,von_mises
"""
MINE = """
units mm g ms
dimension axisymmetric
grid cell=20 r=0:600 z=-300:500
wall z-=fixed r+=slip
lost remove
method sgmp
time end=0.5
material sand drucker_prager density=1.7e-3 young=50 poisson=0.3 friction=33 cohesion=0.001
{eos}
material tnt explosive density=1.63e-3 detonation_speed=6930
eos tnt jwl a=371.2e3 b=3.231e3 r1=4.15 r2=0.95 omega=0.3 energy0=7000
body ground block material=sand lower=(0,-300) upper=(600,0)
subtract ground cylinder centre=(0,-100) axis=(0,1) radius=60 length=40
body mine cylinder material=tnt centre=(0,-100) axis=(0,1) radius=60 length=40
detonation point=(0,-80)
"""
report = Report()


def behind(density, u, m, k, distention):
    """Pressure and volume over the first one behind a front."""
    solid = density*distention

    def pressure(v):
        full, energy = v*distention, 0.5*density*u**2*distention
        eta = 1 - full
        hugoniot = solid*3000**2*eta/(1 - 1.5*eta)**2 if eta > 0 else solid*3000**2*eta
        return hugoniot*(1 - 0.5*eta) + energy

    def lacks(v):
        p = pressure(v)
        return p + 2/3*(k + m*p) - density*u**2/(1 - v)

    low, high = 0.5, 0.9999
    for _ in range(200):
        v = 0.5*(low + high)
        low, high = (v, high) if lacks(v) > 0 else (low, v)
    return pressure(v), v


def fronts():
    """Shocks in clay without pores and in sand that is crushed."""
    for name, density, angle, cohesion, distention, u in (
        ("clay", 2.0e-3, 5, 0, 1.0, 100), ("clay", 2.0e-3, 5, 0, 1.0, 400), ("sand", 1.7e-3, 33, 0, 1.5, 300),
        ("sand", 1.7e-3, 33, 0, 1.5, 600),
    ):
        sines = math.sin(math.radians(angle))
        m, k = 6*sines/(3 - sines), 6*cohesion*math.cos(math.radians(angle))/(3 - sines)
        pores = "distention=1.5 crush_start=1 crush_end=100" if distention > 1 else ""
        exact, volume = behind(density, u, m, k, distention)
        way = 0.5*u*(1 - volume)/u if distention > 1 else 0.5*u/3500
        deck = PLATES.format(young=2e5 if distention > 1 else 2e4, density=density, angle=angle, cohesion=cohesion,
                             pores=pores, way=way)
        result = run(f"{name}_{u}", deck, u=u)
        if not report.finished(result, f"{name} {u}"):
            continue
        rows = [row for row in result.table("particles_end.csv") if 0.5 < abs(row["x"]) < 1.5]
        p, rho, q = (sum(row[key] for row in rows)/len(rows) for key in ("pressure", "density", "von_mises"))
        print(f"{name} {u}: p {p:.2f} of {exact:.2f}, density {rho/density*volume:.4f}, q {q:.2f} of {k + m*exact:.2f}")
        report.check(abs(p/exact - 1) < 0.02, f"{name} {u}: pressure {p}, not {exact}")
        report.check(abs(rho/density*volume - 1) < 0.01, f"{name} {u}: density {rho}, not {density/volume}")
        report.check(abs(q/(k + m*exact) - 1) < 0.06, f"{name} {u}: von Mises {q}, not {k + m*exact}")


def pulled():
    """Soil bears no more tension than at its apex, and without cohesion nothing."""
    for space, zero, upper in ((1, "0", "8"), (2, "0,0", "8,4"), (3, "0,0,0", "8,3,3")):
        for cohesion in (0.0, 1e-3):
            result = run(f"pulled_{space}_{cohesion}", PULLED.format(space=space, zero=zero, upper=upper,
                                                                     cohesion=cohesion))
            if not report.finished(result, f"pulled {space}D"):
                continue
            rows = result.table("particles_end.csv")
            apex = cohesion/math.tan(math.radians(30))
            report.check(all(row["pressure"] > -apex - 1e-12 for row in rows), f"pulled {space}D: tension")
            report.check(min(row["pressure"] for row in rows) < -0.99*apex + 1e-12, f"pulled {space}D: not to the apex")
            if cohesion == 0:
                report.check(max(row["von_mises"] for row in rows) < 1e-9, f"pulled {space}D: shear")


def mine():
    """A buried charge: without an equation of state the soil collapses, with one it does not."""
    for name, eos, most in (
        ("mine", "eos sand shock c0=3000 s=1.5 gamma0=1 distention=1.56 crush_start=0.2 crush_end=200 pore_speed=600",
         2.2), ("saturated", "eos sand shock c0=1700 s=1.8 gamma0=1", 2.2),
    ):
        result = run(name, MINE.format(eos=eos))
        if report.finished(result, name):
            report.check("constant moduli" not in result.text, f"{name}: {result.text}")
            report.check(result["verdict"] != "doubtful", f"{name}: {result['verdict_reasons']}")
            dense = result["end_state.largest_compression"]
            report.check(dense < most, f"{name}: {dense} times as dense")
            report.check(abs(result["energy.drift"]) < 0.02, f"{name}: drift {result['energy.drift']}")
    collapsed = run("bare", MINE.format(eos=""))
    report.check("soil 'ground' has constant moduli" in collapsed.text, f"a mine without eos: {collapsed.text}")
    report.check(collapsed.code != 0 or collapsed["verdict"] == "doubtful", "a mine in soil without eos is not doubted")


fronts()
pulled()
mine()
report.end()
