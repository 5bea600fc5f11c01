#!/usr/bin/env python3
"""Porous matter: a block that is compressed and let expand, against Herrmann's P-alpha solved by bisection in finer steps, and
plates that meet, against the jump conditions of the precursor and the compacting shock, worked out from the equations alone.

usage: porosity.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math

from _runs import Report, run

# Solid copper (Steinberg 1996); distention and crush curve are chosen. m kg s.
SOLID, C0, S, GAMMA = 8930.0, 3940.0, 1.489, 2.02
ALPHA, P0, P1 = 1.25, 0.2e9, 1.5e9
DENSITY = SOLID/ALPHA
EOS = f"c0={C0} s={S} gamma0={GAMMA} distention={ALPHA} crush_start={P0} crush_end={P1}"


def bisected(function, low, high):
    """Where an increasing function is nothing."""
    for _ in range(200):
        middle = (low + high)/2
        low, high = (middle, high) if function(middle) < 0 else (low, middle)
    return (low + high)/2


def solid(v, energy, series):
    """Pressure of the solid at V/V0 and energy per its initial volume."""
    bulk, eta, mu = SOLID*C0**2, 1 - v, 1/v - 1
    if eta < 0:
        return bulk*mu + GAMMA*energy
    cold = bulk*(mu + (2*S - 1)*mu**2 + (S - 1)*(3*S - 1)*mu**3) if series else bulk*eta/(1 - S*eta)**2
    return cold*(1 - GAMMA*eta/2) + GAMMA*energy


def porous(v, energy, alpha, series):
    """Pressure at the volume over the initial one of the porous matter, energy per that."""
    return solid(v*ALPHA/alpha, energy*ALPHA, series)/alpha


def bound(pressure):
    return 1 + (ALPHA - 1)*min(1.0, max(0.0, (P1 - pressure)/(P1 - P0)))**2


def path(volumes, series):
    """Pressures and distentions at volumes, with as many steps between."""
    energy, pressure, alpha, found = 0.0, 0.0, ALPHA, []
    for old, new in zip(volumes, volumes[1:]):
        for i in range(40):
            a, b = old + (new - old)*i/40, old + (new - old)*(i + 1)/40

            def state(alpha):
                """p of E = E_old - (p + p_old)/2 dv, linear in p."""
                cold = porous(b, 0.0, alpha, series)
                slope = porous(b, 1.0, alpha, series) - cold
                return (cold + slope*(energy - pressure*(b - a)/2))/(1 + slope*(b - a)/2)
            if alpha > bound(state(alpha)):
                alpha = bisected(lambda x: x - bound(state(x)), 1.0, alpha)
            last, pressure = pressure, state(alpha)
            energy -= (pressure + last)/2*(b - a)
        found.append((pressure, alpha))
    return found


def strained(report, name, law, series, compressed):
    """A block closes, and then, turned round by a body force that is linear, too, opens."""
    rate, cell, steps = 1e4, 0.03, 800
    turn = f' \nbodyforce b x="{rate**2/(2*compressed)!r}*x0"' if compressed else ""
    deck = f"""dimension 1
grid cell={cell}
time dt={0.3/rate/steps!r} steps={steps}
material m {law}
eos m {'gruneisen' if series else 'shock'} {EOS}
body b block material=m lower={-15*cell} upper={15*cell} ppc=2
velocity b x="-{rate!r}*x"{turn}
gauge middle point={cell/4} fields=energy,distention
history steps=10
"""
    result = run(name, deck)
    if not report.finished(result, name):
        return
    rows = result.table("gauges.csv")
    volumes = [DENSITY/row["density"] for row in rows]
    wanted = path(volumes, series)
    least = min(volumes)
    report.check(least < 0.9 and (volumes[-1] > least + 0.004) == bool(compressed), f"{name}: volume down to {least}, {volumes[-1]} in the end")
    largest = max(pressure for pressure, _ in wanted)
    for row, (pressure, alpha) in zip(rows[1:], wanted):
        report.check(abs(row["pressure"] - pressure) < 2e-3*largest, f"{name}: pressure {row['pressure']}, expected {pressure}")
        report.check(abs(row["distention"] - alpha) < 2e-3*(ALPHA - 1), f"{name}: distention {row['distention']}, expected {alpha}")
    closed = wanted[-1][1]
    report.check(closed < 1.15 and (closed > 1.02) == bool(compressed), f"{name}: distention {closed}")


def jump(before, up):
    """Shock into matter of pressure, volume, energy and velocity `before` that brings it to the velocity up: pressure, volume, energy
    and speed. Volumes over the initial one, energies per initial volume."""
    p, v, e, u = before

    def behind(volume):
        def pressure(alpha):
            # E = e + (p + P)/2 (v - V), linear in P
            cold = porous(volume, 0.0, alpha, False)
            slope = porous(volume, 1.0, alpha, False) - cold
            return (cold + slope*(e + p*(v - volume)/2))/(1 - slope*(v - volume)/2)
        alpha = ALPHA if ALPHA <= bound(pressure(ALPHA)) else bisected(lambda x: x - bound(pressure(x)), 1.0, ALPHA)
        return pressure(alpha)
    volume = bisected(lambda x: (up - u)**2*DENSITY - (behind(x) - p)*(v - x), 0.35, v*(1 - 1e-9))
    pressure = behind(volume)
    return pressure, volume, u + (pressure - p)/(DENSITY*(up - u))


def impact(report, up):
    """Two plates meet; behind the precursor of p0 the pores close in a shock. Pressure and density behind it."""
    # the precursor: pores stay, pressure p0
    elastic = bisected(lambda x: P0 - porous(x, P0*(1 - x)/2, ALPHA, False), 0.99, 1.0)
    slow = math.sqrt(P0*(1 - elastic)/DENSITY)
    first = (P0, elastic, P0*(1 - elastic)/2, slow)
    pressure, volume, speed = jump(first, up)
    alone = jump((0.0, 1.0, 0.0, 0.0), up)
    if alone[2] > slow/(1 - elastic):  # it overtakes the precursor
        pressure, volume, speed = alone
    length, cells = 0.01, 400 if up < 1000 else 200
    t_end = 0.8*length/max(speed, C0)
    result = run(f"impact_{up:.0f}", f"""dimension 1
grid cell={length/cells!r} x=open
time end={t_end!r} cfl=0.1
material m fluid density={DENSITY!r}
eos m shock {EOS}
viscosity m quadratic=1.5 linear=0.3
body left block material=m lower={-length} upper=0 ppc=2
body right block material=m lower=0 upper={length} ppc=2
velocity left x={up}
velocity right x={-up}
history steps=50
output csv at=end fields=pressure,density,energy,distention
""")
    if not report.finished(result, f"impact {up}"):
        return
    front = (speed - up)*t_end
    inside = [row for row in result.table("particles_end.csv") if 0.25*front < abs(row["x"]) < 0.75*front]
    found = {key: sum(row[key]/row["density"] for row in inside)/sum(1/row["density"] for row in inside) for key in ("pressure", "distention")}
    density = len(inside)/sum(1/row["density"] for row in inside)
    print(f"{up:6.0f} m/s: shock {speed:6.0f} m/s, p {pressure/1e9:.4f} GPa, found {found['pressure']/1e9:.4f}; density {DENSITY/volume:.1f}, found {density:.1f}; "
          f"distention {found['distention']:.4f}, {len(inside)} particles")
    report.check(len(inside) > 20, f"{up} m/s: {len(inside)} particles behind the shock")
    report.check(abs(found["pressure"]/pressure - 1) < 0.02, f"{up} m/s: pressure {found['pressure']}, expected {pressure}")
    report.check(abs(density*volume/DENSITY - 1) < 0.002, f"{up} m/s: density {density}, expected {DENSITY/volume}")
    report.check(abs(found["distention"] - bound(pressure)) < 0.01, f"{up} m/s: distention {found['distention']}, expected {bound(pressure)}")


def main():
    report = Report()
    strained(report, "closes", "fluid density=" + repr(DENSITY), False, 0)
    strained(report, "closes_series", "j2 density=" + repr(DENSITY) + " young=1e3 poisson=0.3 yield=1e3", True, 0)
    strained(report, "opens", "fluid density=" + repr(DENSITY), False, 0.12)
    for up in (150.0, 400.0, 1000.0):
        impact(report, up)
    report.end()


main()
