#!/usr/bin/env python3
"""What users read in files, against closed forms: fields of particles, columns of histories, laws of materials in one
step.

All expected values are worked out here, from the deck's numbers alone. A velocity that is linear in space strains the
particles away from a body's surface exactly as its gradient says, whatever the kernel, and so does a force that is
linear.

usage: values.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math

from _runs import Report, run

YOUNG, POISSON, DENSITY, DT = 100.0, 0.3, 3.0, 1e-4
SHEAR = YOUNG/(2*(1 + POISSON))
LAMBDA = YOUNG*POISSON/((1 + POISSON)*(1 - 2*POISSON))
METHODS = ("sgmp", "mpm", "gimp")

# grad[i][j] = d v_i/d x_j, no two the same, no sign the same along the diagonal.
GRAD = [[0.3, 0.7, -0.2], [0.1, -0.5, 0.4], [0.6, -0.3, 0.9]]
STRAINED = """
parameter method=sgmp
dimension {dimension}
grid cell=1
method $method update=musl
time dt={dt} steps=1
{before}
material m {law}
body b block material=m lower=(0,0,0) upper=({size}) ppc=2
velocity b {velocity}
{more}
output csv fields=initial_position,displacement,stress,pressure,von_mises,density,volume,mass{fields}
"""
ELASTIC = f"elastic density={DENSITY} young={YOUNG} poisson={POISSON}"


def strained(name, dimension=3, law=ELASTIC, more="", fields="", scale=1.0, method="sgmp", dt=DT, before=""):
    """A block with the velocities of GRAD after one step: the particle in its middle, and the run."""
    axes = "xyz"[:dimension]
    velocity = " ".join(f'{a}="' + "".join(f"{scale*GRAD[i][j]:+}*{b}" for j, b in enumerate(axes)) + '"'
                        for i, a in enumerate(axes))
    deck = STRAINED.format(
        dimension=dimension, law=law, velocity=velocity, more=more, fields=fields, dt=dt, before=before,
        size=",".join(["8"] * dimension),
    )
    result = run(name, deck, method=method)
    rows = result.table("particles_end.csv")
    middle = min(rows, key=lambda row: sum((row[f"{a}0"] - 4.25)**2 for a in axes))
    return middle, result


def in_the_middle(strain, dimension):
    """The strain of the places in the middle of a step: with dt^2/2 (I2 I - sym adj L); adj L = L^2 - L tr L + I2 I."""
    rate = [[DT*GRAD[i][j] if max(i, j) < dimension else 0.0 for j in range(3)] for i in range(3)]
    trace = sum(rate[i][i] for i in range(3))
    square = [[sum(rate[i][k]*rate[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    return [[strain[i][j] - (square[i][j] + square[j][i] - trace*(rate[i][j] + rate[j][i]))/4 for j in range(3)]
            for i in range(3)]


def close(report, found, expected, text, tolerance=1e-6, scale=None):
    """Equal within a part of the expected value, or of a scale."""
    report.check(abs(found - expected) <= tolerance*(abs(expected) if scale is None else scale),
                 f"{text}: {found}, expected {expected}")


def fields(report):
    """Stress by Hooke's law, its invariants, displacement, density, volume and mass."""
    for dimension in (1, 2, 3):
        for method in METHODS:
            name = f"strained_{dimension}_{method}"
            row, _ = strained(name, dimension, method=method)
            strain = [
                [0.5 * DT * (GRAD[i][j] + GRAD[j][i]) if max(i, j) < dimension else 0.0 for j in range(3)]
                for i in range(3)
            ]
            trace = sum(strain[i][i] for i in range(3))
            strain = in_the_middle(strain, dimension)
            stress = {a: LAMBDA*trace*(a[0] == a[1]) + 2*SHEAR*strain["xyz".index(a[0])]["xyz".index(a[1])]
                      for a in ("xx", "yy", "zz", "xy", "yz", "xz")}
            for a in ["xx", "yy", "zz", "xy", "yz", "xz"][:2 + dimension if dimension == 2 else 3*(dimension - 1) or 3]:
                # The stress that a later part of the step turns with the spin is of second order.
                close(report, row[f"stress_{a}"], stress[a], f"{name}: stress_{a}", 1e-3)
            mean = (stress["xx"] + stress["yy"] + stress["zz"])/3
            close(report, row["pressure"], -mean, f"{name}: pressure", 1e-3)
            double = sum((stress[a] - mean) ** 2 for a in ("xx", "yy", "zz")) + 2 * sum(
                stress[a] ** 2 for a in ("xy", "yz", "xz")
            )
            close(report, row["von_mises"], math.sqrt(1.5*double), f"{name}: von_mises", 1e-3)
            for i, a in enumerate("xyz"[:dimension]):
                speed = sum(GRAD[i][j]*row[f"{b}0"] for j, b in enumerate("xyz"[:dimension]))
                close(report, row[f"displacement_{a}"], speed*DT, f"{name}: displacement_{a}", 1e-6, DT)
                close(report, row[f"velocity_{a}"], speed, f"{name}: velocity_{a}", 1e-6, 1.0)
            volume = 0.5**dimension
            close(report, row["mass"], DENSITY*volume, f"{name}: mass", 1e-12)
            close(report, row["volume"]/volume - 1, trace, f"{name}: volume", 1e-3)
            close(report, row["density"]/DENSITY - 1, -trace, f"{name}: density", 1e-3)


def plasticity(report):
    """Uniform uniaxial strain beyond yield, by hand: plastic strain, heat, damage, failure."""
    yield_stress, steps, rate, dt = 0.2, 40, 1.0, 1e-3
    deck = f"""
dimension 1
grid cell=1
time dt={dt} steps={steps}
material m johnson_cook density=1e6 young={YOUNG} poisson={POISSON} yield={yield_stress} {{more}}
body b block material=m lower=0 upper=40 ppc=2
velocity b x="{-rate}*(x-20)"
output csv fields=plastic_strain,damage,temperature,von_mises,pressure,density
"""
    # ln of the stretch; the material is so heavy that nothing but the gradient moves it.
    strain = -math.log(1 - rate*dt*steps)
    plastic = 2/3*(strain - yield_stress/(2*SHEAR))
    heat = "thermal=yes melt_temperature=1e9 specific_heat=1e-8 room_temperature=300 taylor_quinney=0.7"
    cases = (("plain", "", None), ("damaged", "failure=yes d1=0.03", 0.03), ("failed", "failure=yes d1=0.01", 0.01),
             ("heated", heat, None))
    for name, more, failing in cases:
        result = run(f"plastic_{name}", deck.format(more=more))
        rows = result.table("particles_end.csv")
        row = rows[len(rows)//2]
        failed = failing is not None and plastic > failing
        if not failed:
            close(report, row["plastic_strain"], plastic, f"{name}: plastic_strain", 0.03)
            close(report, row["von_mises"], yield_stress, f"{name}: von_mises", 1e-6)
        else:
            close(report, row["damage"], 1.0, f"{name}: damage", 1e-12)
            close(report, row["von_mises"], 0.0, f"{name}: von_mises", 1e-12, 1.0)
            report.check(
                failing <= row["plastic_strain"] < failing + 3 * rate * dt,
                f"{name}: {row['plastic_strain']} when it failed",
            )
        if failing is not None and not failed:
            close(report, row["damage"], row["plastic_strain"]/failing, f"{name}: damage", 1e-6)
        if name == "heated":
            warmer = 0.7*yield_stress*row["plastic_strain"]/(1e6*1e-8)
            close(report, row["temperature"] - 300, warmer, f"{name}: temperature", 0.05)


def viscosity(report):
    """Bulk viscosity of one material only; its work heats an equation of state; an explosive that is not lit has
    none."""
    quadratic, linear, c0, tiny = 2.0, 0.5, 7.0, 1e-9
    law = f"johnson_cook density={DENSITY} young={YOUNG} poisson={POISSON} yield=1e9"
    eos = f"eos m gruneisen c0={c0} s=1.5 gamma0=0"
    trace = -sum(GRAD[i][i] for i in range(3))*4
    other, none = "material other elastic density=1 young=1 poisson=0", "viscosity m quadratic=0 linear=0"
    for name, before, card, factor in (
        ("mine", "", f"viscosity m quadratic={quadratic} linear={linear}", 1),
        ("all", "", f"viscosity quadratic={quadratic} linear={linear}", 1),
        ("later", "", f"{other}\nviscosity other\n{none}", 0), ("earlier", other, f"viscosity other\n{none}", 0),
    ):
        row, _ = strained(
            f"viscosity_{name}", law=law, before=before, more=f"{eos}\n{card}", fields=",energy", scale=-4, dt=tiny
        )
        sound = math.sqrt(c0**2 + 4/3*SHEAR/DENSITY)
        heat = (DENSITY*quadratic*trace**2 - DENSITY*linear*sound*trace)*-trace*tiny # per initial volume
        close(report, row["energy"], factor*heat, f"viscosity {name}: energy", 1e-6, heat)
    charge = """
dimension 1
grid cell=1 x=0:41
time dt=1e-3 steps=10
material tnt explosive density=2 detonation_speed=500
eos tnt jwl a=300 b=3 r1=4 r2=1 omega=0.3 energy0=7
viscosity tnt quadratic=2 linear=0.5
body b block material=tnt lower=0 upper=40 ppc=2
velocity b x="-0.1*x"
{where}
output csv fields=pressure,energy
"""
    for name, where, lit in (
        ("far", "detonation point=(1000,0,0)", 0), ("plane", "detonation point=(0,0,0) normal=(5,0,0)", 10),
        ("point", "detonation point=(0,0,0)", 10), ("late", "detonation point=(0,0,0) time=4e-3", 6),
    ):
        result = run(f"charge_{name}", charge.format(where=where))
        rows = result.table("particles_end.csv")
        # Lit where the front has been: x < D t, by particles at (i + 1/2)/2 that hardly move.
        front = sum(1 for row in rows if abs(row["pressure"]) > 1e-3)
        report.check(
            abs(front - 2 * 500 * 1e-3 * lit) <= 1,
            f"charge {name}: {front} particles lit, expected {2 * 500 * 1e-3 * lit}",
        )
        if lit == 0:
            report.check(all(abs(row["velocity_x"] + 0.1*0.5*(row["id"] - 0.5)) < 1e-9 for row in rows[1:-1]),
                         f"charge {name}: something pushes what is not lit")
            report.check(
                result["energy.viscous_dissipation"] == 0, f"charge {name}: {result['energy.viscous_dissipation']}"
            )


def step_sizes(report):
    """dt = C h/(c + |v|) with the sound speeds of the laws at rest, and the limit of growth."""
    wave = math.sqrt((LAMBDA + 2*SHEAR)/DENSITY)
    laws = {
        "elastic": (ELASTIC, "", wave),
        "neo_hookean": (ELASTIC.replace("elastic", "neo_hookean", 1), "", wave),
        "j2": (ELASTIC.replace("elastic", "j2", 1) + " yield=1", "", wave),
        "gruneisen": (
            ELASTIC.replace("elastic", "johnson_cook", 1) + " yield=1", "eos m gruneisen c0=9 s=1.5 gamma0=2",
            math.sqrt(81 + 4 / 3 * SHEAR / DENSITY),
        ),
    }
    for name, (law, more, sound) in laws.items():
        for speed in (0.0, 5.0):
            deck = (
                f"grid cell=0.5\ntime cfl=0.4 steps=1\nmaterial m {law}\n{more}\n"
                f'body b block material=m lower=(0,0,0) upper=(2,2,2) ppc=2\nvelocity b x="{speed}*0.6" '
                f'y="-{speed}*0.8"\n'
            )
            result = run(f"step_{name}", deck)
            # The speed of the first step is that of the start: velocities are uniform, nothing is strained.
            close(
                report, result.table("history.csv")[1]["dt"], 0.4 * 0.5 / (sound + speed), f"step of {name} at {speed}",
                1e-9,
            )
    deck = """
dimension 1
grid cell=0.5 x=0:30
wall x-=fixed
time cfl=0.4 growth=1.02 steps=60
material gas explosive density=2 detonation_speed=1e6
eos gas jwl a=300 b=3 r1=4 r2=1 omega=0.3 energy0=7
body b block material=gas lower=0 upper=2 ppc=2
detonation point=(0,0,0)
"""
    rows = run("growth", deck.replace("x=0:30", "x=0:open")).table("history.csv")
    ratios = [later["dt"]/row["dt"] for row, later in zip(rows[1:], rows[2:])]
    report.check(max(ratios) <= 1.02 + 1e-12 and sum(abs(ratio - 1.02) < 1e-12 for ratio in ratios) > 5,
                 f"growth of steps: at most {max(ratios)}")


def histories(report):
    """Bodies with masses that are not 1, gravity, the nearest gauge, a vibrating bar's energies at known times."""
    deck = """
grid cell=1
time dt=1e-3 steps=20
gravity (1,-2,-3)
material heavy elastic density=7 young=100 poisson=0.25
material light elastic density=0.5 young=100 poisson=0.25
body a block material=heavy lower=(0,0,0) upper=(4,4,4)
body b block material=light lower=(9,0,0) upper=(11,4,4)
velocity a x=1 y=2 z=3
velocity b x=-4 y=5 z=-6
gauge mixed point=(0.3,3.2,1.8)
gauge second point=(9.8,0.2,2.7)
"""
    result = run("bodies", deck)
    time, dt, pull = 0.02, 1e-3, (1, -2, -3)
    masses = {1: 7*64, 2: 0.5*32}
    speeds = {1: (1, 2, 3), 2: (-4, 5, -6)}
    centres = {1: (2, 2, 2), 2: (10, 2, 2)}
    kinetic = 0.0
    for row in [row for row in result.table("bodies.csv") if row["step"] == 20]:
        b = int(row["body"])
        close(report, row["mass"], masses[b], f"body {b}: mass", 1e-12)
        for i, a in enumerate("xyz"):
            # Velocities belong to the middle of the last step (leap-frog).
            speed = speeds[b][i] + pull[i]*(time - dt/2)
            close(report, row[f"velocity_{a}"], speed, f"body {b}: velocity_{a}", 1e-9)
            way = speeds[b][i]*time + sum(pull[i]*(k + 0.5)*dt*dt for k in range(20))
            close(report, row[a], centres[b][i] + way, f"body {b}: {a}", 1e-9)
            kinetic += 0.5*masses[b]*speed**2
        close(
            report, row["kinetic_energy"],
            0.5 * masses[b] * sum((speeds[b][i] + pull[i] * (time - dt / 2)) ** 2 for i in range(3)),
            f"body {b}: kinetic_energy", 1e-9,
        )
    last = result.table("history.csv")[-1]
    start = 0.5*sum(masses[b]*sum(v*v for v in speeds[b]) for b in masses)
    close(report, last["kinetic_energy"], kinetic, "kinetic_energy", 1e-9)
    close(report, last["external_work"], kinetic - start, "external_work", 1e-9)
    close(report, last["internal_energy"], 0.0, "internal_energy", 1e-9, start)
    for i, a in enumerate("xyz"):
        close(report, last[f"momentum_{a}"], sum(masses[b]*(speeds[b][i] + pull[i]*(time - dt/2)) for b in masses),
              f"momentum_{a}", 1e-9)
    gauges = [row for row in result.table("gauges.csv") if row["step"] == 0]
    for row, place in zip(gauges, ((0.25, 3.25, 1.75), (9.75, 0.25, 2.75))):
        report.check([row[a] for a in "xyz"] == list(place), f"gauge at {[row[a] for a in 'xyz']}, nearest is {place}")
    vibration(report)


def vibration(report):
    """First mode of a bar between walls: all energy is kinetic, then elastic after a quarter of the period."""
    deck = """
parameter method=sgmp
dimension 1
grid cell=0.02 x=0:1
wall x-=fixed x+=fixed
method $method update=musl
time end=0.5 cfl=0.2
material m elastic density=4 young=16 poisson=0
body b block material=m lower=0 upper=1 ppc=2
velocity b x="1e-4*sin(pi*x)"
"""
    for method in METHODS:
        rows = run(f"vibration_{method}", deck, method=method).table("history.csv")
        energy = 0.25*4*1e-8 # 1/4 rho v0^2 A L; c = 2, period 1
        close(report, rows[0]["kinetic_energy"], energy, f"{method}: kinetic energy at the start", 1e-3)
        for time, kinetic in ((0.125, 0.5), (0.25, 0.0), (0.5, 1.0)):
            row = min(rows, key=lambda row, time=time: abs(row["time"] - time))
            close(report, row["kinetic_energy"], kinetic*energy, f"{method}: kinetic energy at {time}", 0.02, energy)
            close(
                report,
                row["internal_energy"],
                (1 - kinetic) * energy,
                f"{method}: internal energy at {time}",
                0.02,
                energy,
            )
            close(
                report,
                row["total_energy"],
                row["kinetic_energy"] + row["internal_energy"],
                f"{method}: total energy",
                1e-12,
            )
        report.check(
            all(
                row["external_work"] == 0 and row["contact_dissipation"] == 0 and row["viscous_dissipation"] == 0
                for row in rows
            ),
            f"{method}: work from nowhere",
        )


def forces(report):
    """Body forces of x0, y0 and z0 while everything moves; part of the velocity from increments (flip)."""
    steps, dt = 4, 1e-2
    deck = f"""
parameter method=sgmp
grid cell=1
method $method update=musl
time dt={dt} steps={steps}
material m elastic density=2 young=1e-9 poisson=0
body b block material=m lower=(0,0,0) upper=(8,8,8) ppc=2
velocity b x=3 y=-5 z=7
bodyforce b x="2*z0" y="3*x0+1" z="-y0"
output csv fields=initial_position
"""
    for method in METHODS:
        rows = run(f"forces_{method}", deck, method=method).table("particles_end.csv")
        row = min(rows, key=lambda row: sum((row[f"{a}0"] - 4.25)**2 for a in "xyz"))
        time = (steps - 0.5)*dt # the first velocity step is a half
        for a, start, force in (("x", 3, 2*row["z0"]), ("y", -5, 3*row["x0"] + 1), ("z", 7, -row["y0"])):
            close(report, row[f"velocity_{a}"], start + force*time, f"{method}: body force {a}", 1e-6)
    # Body forces of the present place, in a grid whose corner is not the origin.
    deck = f"""
parameter method=sgmp
grid cell=1 x=-3:20 y=2:20 z=-7:20
method $method update=musl
time dt=1e-6 steps={steps}
material m elastic density=2 young=1e-9 poisson=0
body b block material=m lower=(0,3,0) upper=(8,11,8) ppc=2
bodyforce b x="2*x" y="3*y+z" z="-z"
output csv fields=initial_position
"""
    for method in METHODS:
        rows = run(f"places_{method}", deck, method=method).table("particles_end.csv")
        row = min(rows, key=lambda row: (row["x0"] - 4.25)**2 + (row["y0"] - 7.25)**2 + (row["z0"] - 4.25)**2)
        for a, force in (("x", 2*row["x0"]), ("y", 3*row["y0"] + row["z0"]), ("z", -row["z0"])):
            close(
                report,
                row[f"velocity_{a}"],
                force * (steps - 0.5) * 1e-6,
                f"{method}: body force of the present {a}",
                1e-6,
            )
    # Velocities that alternate from particle to particle give nodes none: what is left of them is flip to the number of
    # steps. All
    # of gravity arrives, whatever part of the velocity comes from increments.
    deck = """
parameter method=sgmp
dimension 1
grid cell=1
method $method update=musl flip=0.7
time dt=1e-9 steps=3
gravity (1e8,0,0)
material m elastic density=2 young=1e-9 poisson=0
body b block material=m lower=0 upper=20 ppc=2
velocity b x="5+sign(sin(2*pi*x))"
output csv
"""
    for method in METHODS:
        rows = run(f"flip_{method}", deck, method=method).table("particles_end.csv")
        for row in rows[18:22]:
            close(
                report,
                row["velocity_x"],
                5 + 1e8 * 2.5e-9 + (1 if row["id"] % 2 else -1) * 0.7**3,
                f"{method}: flip",
                1e-6,
            )


def contact(report):
    """A block on a rigid table: what the table bears, with its lever; work of a rigid tool, first or second of the
    pair."""
    deck = """
grid cell=1
method sgmp
time end=0.3 cfl=0.4
gravity (0,0,-2)
material m elastic density=3 young=5e3 poisson=0
body table block material=m lower=(0,0,-2) upper=(10,8,0) ppc=2
body block block material=m lower=(4,2,0) upper=(6,6,2) ppc=2
rigid table {motion}
contact {pair}
"""
    weight, centre = 3*16*2.0, (5, 4)
    for pair, sign in (("table block", 1), ("block table", -1)):
        name = pair.replace(" ", "_")
        result = run(f"table_{name}", deck.format(pair=pair, motion=""))
        rows = result.table("contact.csv")
        impulse = {a: sum(later[a]*(later["time"] - row["time"]) for row, later in zip(rows, rows[1:]))
                   for a in ("force_z", "torque_x", "torque_y")}
        bodies = [row for row in result.table("bodies.csv") if row["body"] == 2]
        gained = 3*16*bodies[-1]["velocity_z"]
        # What gravity gave up to the middle of the last step and the block has not.
        time = rows[-1]["time"] - 0.5*(rows[-1]["time"] - rows[-2]["time"])
        push = -sign*(gained + weight*time)
        close(report, abs(impulse["force_z"]), abs(push), f"{pair}: impulse of the table", 1e-6)
        report.check((impulse["force_z"] < 0) == (sign > 0), f"{pair}: force on the first body {impulse['force_z']}")
        close(report, impulse["torque_x"], centre[1]*impulse["force_z"], f"{pair}: torque_x", 1e-6)
        close(report, impulse["torque_y"], -centre[0]*impulse["force_z"], f"{pair}: torque_y", 1e-6)
        moving = run(f"tool_{name}", deck.format(pair=pair, motion="z=0.25").replace("gravity (0,0,-2)", ""))
        block = [row for row in moving.table("bodies.csv") if row["body"] == 2][-1]
        last = moving.table("history.csv")[-1]
        report.check(block["velocity_z"] > 0.1, f"{pair}: the tool does not push")
        close(report, last["external_work"], 0.25*block["mass"]*block["velocity_z"], f"{pair}: work of the tool", 1e-9)


def main():
    """All of it."""
    report = Report()
    for part in (fields, plasticity, viscosity, step_sizes, histories, forces, contact):
        before = report.failures
        part(report)
        print(f"{part.__name__}: {'ok' if report.failures == before else 'FAILED'}")
    report.end()


main()
