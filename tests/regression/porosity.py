#!/usr/bin/env python3
"""Porous matter: a block that is compressed and let expand, against Herrmann's P-alpha solved by bisection in finer
steps, and plates that meet, against the jump conditions of the precursor and the compacting shock, worked out from the
equations alone. Both with pores that stay and with pores that are compressed elastically; there a block is squeezed,
let go and squeezed again, against Herrmann's differential equation step by step, and weak waves run with the speed that
was asked for.

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
    for _ in range(60):
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


def bound(pressure, first=ALPHA):
    return 1 + (first - 1)*min(1.0, max(0.0, (P1 - pressure)/(P1 - P0)))**2


def stiffness(alpha, ce):
    """-dp/dalpha of Herrmann's elastic pores: K0 h^2/(alpha^2 (1 - h^2)), beyond the first distention as there."""
    alpha = min(alpha, ALPHA)
    h = 1 - (alpha - 1)*(1 - ce/C0)/(ALPHA - 1)
    return SOLID*C0**2*h**2/(alpha**2*max(1e-15, 1 - h**2))


def elastic_change(before, after, ce):
    """Change of the pressure on an elastic curve from one distention to another, by Simpson's rule on either side of
    the first one."""
    ends = [before, after]
    if (before - ALPHA)*(after - ALPHA) < 0:
        ends.insert(1, ALPHA)
    change = 0.0
    for a, b in zip(ends, ends[1:]):
        n = 8
        change -= (
            (b - a)
            / (3 * n)
            * sum(
                (1, 4, 2)[0 if k in (0, n) else 1 if k % 2 else 2] * stiffness(a + (b - a) * k / n, ce)
                for k in range(n + 1)
            )
        )
    return change


def first_distention(ce):
    """Where crushing begins: Herrmann's equation from the first distention at no pressure to P0, in small steps."""
    alpha = ALPHA
    for _ in range(4000):
        half = alpha - P0/8000/stiffness(alpha, ce)
        alpha -= P0/4000/stiffness(half, ce)
    return alpha


def elastic_path(volumes, ce):
    """Pressures and distentions at volumes, with as many steps between; what is known of the past is the last pressure
    and distention."""
    energy, pressure, alpha, first, found = 0.0, 0.0, ALPHA, first_distention(ce), []
    for old, new in zip(volumes, volumes[1:]):
        for i in range(10):
            a, b = old + (new - old)*i/10, old + (new - old)*(i + 1)/10

            def state(alpha):
                cold = porous(b, 0.0, alpha, False)
                slope = porous(b, 1.0, alpha, False) - cold
                return (cold + slope*(energy - pressure*(b - a)/2))/(1 + slope*(b - a)/2)

            def above(x):
                """By how much the pressure is above that of the elastic curve or of crushing."""
                crush = P1 - (P1 - P0)*math.sqrt((x - 1)/(first - 1)) if x < first else P0
                return state(x) - min(pressure + elastic_change(alpha, x, ce), crush)
            if alpha > 1:
                low, high = 1.0, max(alpha, b*ALPHA)*1.05
                for _ in range(60):
                    middle = (low + high)/2
                    low, high = (middle, high) if above(middle) < 0 else (low, middle)
                now = high if high > 1 + 1e-9 else 1.0
            else:
                now = 1.0
            last, pressure, alpha = pressure, state(now), now
            energy -= (pressure + last)/2*(b - a)
        found.append((pressure, alpha))
    return found


def cycled(report, ce, size, drift):
    """A block whose elastic pores are squeezed, let go into tension and squeezed further, three times."""
    turns, total = 3, 3e-5
    w = 2*math.pi*turns/total
    rate, drift = size*w, drift/total
    cell, steps = 0.03, 3000
    result = run(f"cycled_{ce:.0f}", f"""dimension 1
grid cell={cell}
time dt={total/steps!r} steps={steps}
material m fluid density={DENSITY!r}
eos m shock {EOS} pore_speed={ce}
viscosity m quadratic=0 linear=0
body b block material=m lower={-15*cell} upper={15*cell} ppc=2
velocity b x="-{rate + drift!r}*x"
bodyforce b x="{rate*w!r}*sin({w!r}*t)*x0"
gauge middle point={cell/4} fields=energy,distention
history steps=20
""")
    if not report.finished(result, f"cycled, {ce}"):
        return
    rows = result.table("gauges.csv")
    volumes = [DENSITY/row["density"] for row in rows]
    wanted = elastic_path(volumes, ce)
    largest = max(abs(pressure) for pressure, _ in wanted)
    worst = [max(abs(row["pressure"] - p) for row, (p, _) in zip(rows[1:], wanted))/largest,
             max(abs(row["distention"] - a) for row, (_, a) in zip(rows[1:], wanted))/(ALPHA - 1)]
    print(
        f"pore_speed {ce:.0f}: pressures up to {max(p for p, _ in wanted) / 1e9:.3f} and down to "
        f"{min(p for p, _ in wanted) / 1e9:.3f} GPa off by {worst[0]:.1e} of the largest, "
        f"distentions down to {min(a for _, a in wanted):.4f}, at most {max(a for _, a in wanted):.4f}, off by "
        f"{worst[1]:.1e}"
    )
    report.check(max(worst) < 3e-3, f"pore_speed {ce}: pressure and distention off by {worst}")
    report.check(
        min(p for p, _ in wanted) < -0.05 * largest and max(p for p, _ in wanted) > 2 * P0,
        f"pore_speed {ce}: pressures from {min(p for p, _ in wanted)} to {largest}",
    )


def weak_wave(report, ce):
    """Plates that meet with 1 m/s: pressure rho c v behind a front that runs with the speed of sound of the porous
    matter."""
    length, cells = 0.5, 400
    t_end = 0.7*length/ce
    result = run(f"weak_{ce:.0f}", f"""dimension 1
grid cell={length/cells!r} x=open
time end={t_end!r} cfl=0.3
material m fluid density={DENSITY!r}
eos m shock {EOS}{f' pore_speed={ce}' if ce < C0 else ''}
viscosity m quadratic=1.5 linear=0.3
body left block material=m lower={-length} upper=0 ppc=2
body right block material=m lower=0 upper={length} ppc=2
velocity left x=1
velocity right x=-1
history steps=50
output csv at=end fields=pressure
""")
    if not report.finished(result, f"weak wave, {ce}"):
        return
    rows = sorted(result.table("particles_end.csv"), key=lambda row: row["x"])
    half = DENSITY*ce/2
    front = next(a["x"] + (b["x"] - a["x"])*(a["pressure"] - half)/(a["pressure"] - b["pressure"])
                 for a, b in zip(rows, rows[1:]) if a["x"] > 0.01*length and a["pressure"] >= half > b["pressure"])
    inside = [row["pressure"] for row in rows if abs(row["x"]) < 0.5*front]
    mean = sum(inside)/len(inside)
    print(f"weak wave, pore_speed {ce:.0f}: {front/t_end:.1f} m/s, pressure {mean/(DENSITY*ce):.4f} of rho c v")
    report.check(abs(front/t_end/ce - 1) < 0.01, f"weak wave with {front/t_end} m/s, expected {ce}")
    report.check(abs(mean/(DENSITY*ce) - 1) < 0.01, f"weak wave of {mean} Pa, expected {DENSITY*ce}")


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
viscosity m quadratic=0 linear=0
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
    report.check(
        least < 0.9 and (volumes[-1] > least + 0.004) == bool(compressed),
        f"{name}: volume down to {least}, {volumes[-1]} in the end",
    )
    largest = max(pressure for pressure, _ in wanted)
    for row, (pressure, alpha) in zip(rows[1:], wanted):
        report.check(
            abs(row["pressure"] - pressure) < 2e-3 * largest, f"{name}: pressure {row['pressure']}, expected {pressure}"
        )
        report.check(
            abs(row["distention"] - alpha) < 2e-3 * (ALPHA - 1),
            f"{name}: distention {row['distention']}, expected {alpha}",
        )
    closed = wanted[-1][1]
    report.check(closed < 1.15 and (closed > 1.02) == bool(compressed), f"{name}: distention {closed}")


def jump(before, up, first=ALPHA, stays=ALPHA):
    """Shock into matter of pressure, volume, energy and velocity `before` that brings it to the velocity up: pressure,
    volume, energy and speed. Volumes over the initial one, energies per initial volume."""
    p, v, e, u = before

    def behind(volume):
        def pressure(alpha):
            # E = e + (p + P)/2 (v - V), linear in P
            cold = porous(volume, 0.0, alpha, False)
            slope = porous(volume, 1.0, alpha, False) - cold
            return (cold + slope*(e + p*(v - volume)/2))/(1 - slope*(v - volume)/2)

        alpha = (
            stays
            if stays <= bound(pressure(stays), first)
            else bisected(lambda x: x - bound(pressure(x), first), 1.0, stays)
        )
        return pressure(alpha)
    volume = bisected(lambda x: (up - u)**2*DENSITY - (behind(x) - p)*(v - x), 0.35, v*(1 - 1e-9))
    pressure = behind(volume)
    return pressure, volume, u + (pressure - p)/(DENSITY*(up - u))


def impact(report, up, ce=C0):
    """Two plates meet; behind the precursor of p0 the pores close in a shock. Pressure and density behind it."""
    # the precursor: pores stay, or are compressed elastically, to the pressure p0
    begins = first_distention(ce) if ce < C0 else ALPHA
    elastic = bisected(lambda x: P0 - porous(x, P0*(1 - x)/2, begins, False), 0.97, 1.0)
    slow = math.sqrt(P0*(1 - elastic)/DENSITY)
    first = (P0, elastic, P0*(1 - elastic)/2, slow)
    pressure, volume, speed = jump(first, up, begins, begins)
    alone = jump((0.0, 1.0, 0.0, 0.0), up, begins, begins)
    if alone[2] > slow/(1 - elastic):  # it overtakes the precursor
        pressure, volume, speed = alone
    length, cells = 0.01, 400 if up < 200 else 200 if up < 1000 else 100
    t_end = 0.8*length/max(speed, C0)
    result = run(f"impact_{up:.0f}_{ce:.0f}", f"""dimension 1
grid cell={length/cells!r} x=open
time end={t_end!r} cfl=0.1
material m fluid density={DENSITY!r}
eos m shock {EOS}{f' pore_speed={ce}' if ce < C0 else ''}
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
    found = {
        key: sum(row[key] / row["density"] for row in inside) / sum(1 / row["density"] for row in inside)
        for key in ("pressure", "distention")
    }
    density = len(inside)/sum(1/row["density"] for row in inside)
    print(
        f"{up:6.0f} m/s, pore_speed {ce:.0f}: shock {speed:6.0f} m/s, p {pressure / 1e9:.4f} GPa, found "
        f"{found['pressure'] / 1e9:.4f}; density {DENSITY / volume:.1f}, found {density:.1f}; "
        f"distention {found['distention']:.4f}, {len(inside)} particles"
    )
    report.check(len(inside) > 20, f"{up} m/s: {len(inside)} particles behind the shock")
    report.check(
        abs(found["pressure"] / pressure - 1) < 0.02, f"{up} m/s: pressure {found['pressure']}, expected {pressure}"
    )
    report.check(abs(density*volume/DENSITY - 1) < 0.002, f"{up} m/s: density {density}, expected {DENSITY/volume}")
    report.check(
        abs(found["distention"] - bound(pressure, begins)) < 0.01,
        f"{up} m/s: distention {found['distention']}, expected {bound(pressure, begins)}",
    )


def main():
    report = Report()
    strained(report, "closes", "fluid density=" + repr(DENSITY), False, 0)
    strained(report, "closes_series", "j2 density=" + repr(DENSITY) + " young=1e3 poisson=0.3 yield=1e3", True, 0)
    strained(report, "opens", "fluid density=" + repr(DENSITY), False, 0.12)
    for up in (150.0, 400.0, 1000.0):
        impact(report, up)
        impact(report, up, 2500.0)
    for ce, size, drift in ((2000.0, 0.025, 0.16), (3200.0, 0.016, 0.1)):
        cycled(report, ce, size, drift)
    for ce in (1500.0, 3000.0, C0):
        weak_wave(report, ce)
    report.end()


main()
