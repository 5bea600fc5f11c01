#!/usr/bin/env python3
"""Damage that knows the stress, along paths of one deformation that no wave reaches: drawn, sheared, drawn with sides
held back (a notch); Cockcroft and Latham, Hosford and Coulomb, beside a second integration of stress, plastic strain
and damage in ten times as many steps, which takes principal stresses by Jacobi's rotations. Pure shear in closed form.
Johnson and Cook's damage that takes strength (critical_damage). Flaws of brittle matter (Grady and Kipp) that is drawn
elastically: damage and stress of each particle by the strain of its weakest flaw, which scatters as it must.

usage: ductile.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import math

from _runs import Report, run

YOUNG, POISSON, YIELD, SLOPE, CELL, STEPS = 1000.0, 0.3, 0.5, 100.0, 1e4, 200
SHEAR, BULK = YOUNG/(2*(1 + POISSON)), YOUNG/(3*(1 - 2*POISSON))
HOSFORD = {"hosford_strain": 0.003, "hosford_exponent": 1.5, "hosford_friction": 0.15, "hosford_power": 0.4}
WORK = {"plastic_work": 0.002}
JOHNSON_COOK = {"d1": 0.0008, "d2": 0.0015, "d3": -1.5, "critical_damage": 0.6}  # on the card of the material
PATHS = {  # velocity gradient at the start; all of it with constant velocities
    "drawn": [[0.002, 0, 0], [0, -0.001, 0], [0, 0, -0.001]],
    "sheared": [[0, 0.002, 0], [0, 0, 0], [0, 0, 0]],
    "notch": [[0.002, 0, 0], [0, -0.00095, 0], [0, 0, -0.00095]],
    "squeezed": [[-0.002, 0.001, 0], [0, 0.0013, 0], [0, 0, 0.0008]]}


def product(a, b):
    return [[sum(a[i][k]*b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def inverse(a):
    def cofactor(i, j):
        k, m, u, v = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
        return a[u][k]*a[v][m] - a[u][m]*a[v][k]

    cofactors = [[cofactor(i, j) for j in range(3)] for i in range(3)]
    whole = sum(a[0][k]*cofactors[k][0] for k in range(3))
    return [[x/whole for x in row] for row in cofactors]


def principal(stress):
    """Principal stresses, the largest first, by Jacobi's rotations."""
    a = [row[:] for row in stress]
    for _ in range(12):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if abs(a[i][j]) < 1e-300:
                continue
            angle = 0.5*math.atan2(2*a[i][j], a[j][j] - a[i][i])
            turn = [[float(k == m) for m in range(3)] for k in range(3)]
            turn[i][i] = turn[j][j] = math.cos(angle)
            turn[i][j], turn[j][i] = math.sin(angle), -math.sin(angle)
            a = product(product([list(column) for column in zip(*turn)], a), turn)
    return sorted((a[k][k] for k in range(3)), reverse=True)


def second(gradient, law, time):
    """Plastic strain, damage and von Mises stress at each twentieth of the time."""
    stress, plastic, damage, hardened, found = [[0.0]*3 for _ in range(3)], 0.0, 0.0, 0.0, []
    taken = law.get("critical_damage", 0.0)
    steps = 10*STEPS
    dt = time/steps
    for n in range(steps):
        place = [[float(i == j) + gradient[i][j]*(n + 0.5)*dt for j in range(3)] for i in range(3)]
        rate = product(gradient, inverse(place))
        strain = [[0.5*dt*(rate[i][j] + rate[j][i]) for j in range(3)] for i in range(3)]
        spin = [[0.5*dt*(rate[i][j] - rate[j][i]) for j in range(3)] for i in range(3)]
        turned = [list(x) for x in stress]
        for sign, (a, b) in ((1, (spin, stress)), (-1, (stress, spin))):
            turned = [[turned[i][j] + sign*product(a, b)[i][j] for j in range(3)] for i in range(3)]
        trace = sum(strain[k][k] for k in range(3))
        mean = sum(turned[k][k] for k in range(3))/3
        dev = [[turned[i][j] - (i == j)*mean + 2*SHEAR*(strain[i][j] - (i == j)*trace/3) for j in range(3)]
               for i in range(3)]
        mean += BULK*trace
        mises = math.sqrt(1.5*sum(x*x for row in dev for x in row))
        left = 1 - taken*min(damage, 1.0)
        more = max(0.0, (mises - left*(YIELD + SLOPE*hardened))/(3*SHEAR + left**2*SLOPE))
        dev = [[x*(1 - 3*SHEAR*more/mises) for x in row] for row in dev]
        stress = [[dev[i][j] + (i == j)*mean for j in range(3)] for i in range(3)]
        plastic += more
        hardened += left*more
        if more > 0:
            s = principal(stress)
            if "plastic_work" in law:
                damage += max(s[0], 0.0)*more/law["plastic_work"]
            elif "d1" in law:
                triaxial = mean/(mises - 3*SHEAR*more)
                damage += more/(law["d1"] + law["d2"]*math.exp(law["d3"]*triaxial))
            else:
                a, c, norm = law["hosford_exponent"], law["hosford_friction"], mises - 3*SHEAR*more
                g = (((s[0] - s[1])**a + (s[1] - s[2])**a + (s[0] - s[2])**a)/2)**(1/a)/norm + c*(s[0] + s[2])/norm
                if g > 0:
                    damage += more/(law["hosford_strain"]*((1 + c)/g)**(1/law["hosford_power"]))
        if (n + 1) % (steps//20) == 0:
            norm = math.sqrt(1.5*sum(x*x for row in dev for x in row))
            found.append((plastic, min(damage, 1.0), norm))
    return found


def deck(gradient, law, time):
    steps = 4*STEPS if "critical_damage" in law else STEPS  # strength knows the damage of the step before
    formulas = ["+".join(f"({x!r})*{axis}" for x, axis in zip(row, "xyz")) for row in gradient]
    speeds = " ".join(f'{axis}="{formula}"' for axis, formula in zip("xyz", formulas))
    words = " ".join(f"{key}={value}" for key, value in law.items())
    matter = (f"m johnson_cook yield={YIELD} hardening_modulus={SLOPE} hardening_exponent=1 failure=yes {words}\n"
              "failure m carries=everything" if "d1" in law else
              f"m j2 yield={YIELD} hardening=linear hardening_modulus={SLOPE}\nfailure m carries=everything {words}")
    matter = matter.replace(" yield", f" density=1 young={YOUNG} poisson={POISSON} yield", 1)
    return (f"dimension 3\ngrid cell={CELL}\nmethod mpm\ntime dt={time/steps!r} steps={steps}\n"
            f"material {matter}\nbody b block material=m lower=({-2*CELL},{-2*CELL},{-2*CELL}) "
            f"upper=({2*CELL},{2*CELL},{2*CELL}) ppc=2\n"
            f"velocity b {speeds}\ngauge middle point=({CELL/4},{CELL/4},{CELL/4}) fields=plastic_strain,damage\n"
            f"history steps={steps//20}\n")


def flawed(report):
    """Matter that is drawn along one axis and breaks by flaws: (e/2.4e-3)^6 of them grow below e in a particle."""
    power, speed, count, rate = 6.0, 40.0, 4.0, 0.002
    number = (1/2.4e-3)**power/(CELL/2)**3
    cards = (f"dimension 3\ngrid cell={CELL}\nmethod mpm\ntime dt={1/STEPS!r} steps={STEPS}\n"
             f"material m j2 density=1 young={YOUNG} poisson={POISSON} yield=1e6\n"
             f"failure m flaws={number!r} flaw_exponent={power} crack_speed={speed*CELL/100!r} "
             f"flaw_count={count} seed=5\n"
             f"body b block material=m lower=({','.join([str(-3*CELL)]*3)}) upper=({','.join([str(3*CELL)]*3)}) ppc=2\n"
             f'velocity b x="{rate!r}*x"\noutput csv at=end fields=stress,damage,flaw_strain\n')
    result = run("flawed", cards)
    if not report.finished(result, "flawed"):
        return
    volume = (CELL/2)**3
    radius, lame, broken = (0.75*volume/math.pi)**(1/3), BULK - 2*SHEAR/3, 0
    rows = [row for row in result.table("particles_end.csv") if max(abs(row[axis]) for axis in "xyz") < CELL]
    every = [row["flaw_strain"] for row in result.table("particles_end.csv")]
    mean = math.gamma(1 + 1/power)*(1/(number*volume))**(1/power)
    found = sum(every)/len(every)
    report.check(abs(found/mean - 1) < 0.03, f"weakest flaws grow at {found:.4g} in the mean, not {mean:.4g}")
    for row in rows:
        damage, first, steps = 0.0, row["flaw_strain"], 10*STEPS
        for n in range(steps):
            strain = math.log(1 + rate*(n + 0.5)/steps)
            pull = (lame + 2*SHEAR)*strain/YOUNG
            growing = 0.0 if pull <= first else 1 + number*volume*(pull**power - first**power)
            if growing:
                damage = max(damage, min((damage**(1/3) + growing*speed*CELL/100/steps/radius)**3, growing/count, 1.0))
        strain = math.log(1 + rate)
        stress = (1 - damage)*(lame + 2*SHEAR)*strain
        broken += damage > 0.05
        report.check(abs(row["damage"] - damage) < 0.03, f"damage of a particle: {row['damage']:.4g}, not {damage:.4g}")
        report.check(abs(row["stress_xx"] - stress) < 0.04*(lame + 2*SHEAR)*strain,
                     f"a particle bears {row['stress_xx']:.4g}, not {stress:.4g}")
    report.check(len(rows) == 64 and 10 < broken < 64, f"{broken} of {len(rows)} particles are damaged")


def main():
    report = Report()
    flawed(report)
    for name, gradient in PATHS.items():
        for kind, law in (("work", WORK), ("hosford", HOSFORD), ("johnson_cook", JOHNSON_COOK)):
            result = run(f"{name}_{kind}", deck(gradient, law, 1.0))
            if not report.finished(result, f"{name} {kind}"):
                continue
            rows, wanted = result.table("gauges.csv")[1:], second(gradient, law, 1.0)
            report.check(len(rows) == 20, f"{name} {kind}: {len(rows)} rows")
            for i, column in enumerate(("plastic_strain", "damage", "von_mises")):
                largest = max(values[i] for values in wanted)
                off = max(abs(row[column] - values[i]) for row, values in zip(rows, wanted))
                report.check(off <= 0.005*largest,
                             f"{name} {kind}: {column} is off by {off:.3g}, where the largest is {largest:.3g}")
            if name == "sheared" and kind != "johnson_cook":
                strain = wanted[-1][0]
                exact = (YIELD*strain + SLOPE*strain**2/2)/math.sqrt(3)/WORK["plastic_work"]
                if kind == "hosford":
                    a, c = HOSFORD["hosford_exponent"], HOSFORD["hosford_friction"]
                    shape = (1 + 2**(a - 1))**(1/a)/math.sqrt(3)/(1 + c)
                    exact = strain/HOSFORD["hosford_strain"]*shape**(1/HOSFORD["hosford_power"])
                report.check(abs(wanted[-1][1] - exact) < 0.005*exact,
                             f"{name} {kind}: damage {wanted[-1][1]:.4g}, in closed form {exact:.4g}")
    report.end()


main()
