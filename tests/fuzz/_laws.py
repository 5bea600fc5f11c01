"""What random scenes of the last seeds have beyond those of _further.py: tables as equations of state, afterburn of
products, damage that knows the stress, flaws, and a length over which plastic strain is averaged. Each is drawn from a
stream that its caller gives."""


def table_fluid(luck, numbers, file):
    """Cards of a gas or a liquid whose pressure a table has, and the table."""
    young, density = numbers["young"], numbers["density"]
    gas, warm = luck.random() < 0.5, luck.random() < 0.5
    unit = young/density
    if gas:
        densities, energies = [density*0.005*1.6**i for i in range(20)], [unit*0.003*2**j for j in range(12)]
        pressure, temperature = (lambda rho, e: 0.4*rho*e), (lambda rho, e: 300*e/unit)
        start = f"energy0={0.1*young:g}"
    else:
        densities, energies = [density*(0.7 + 0.05*i) for i in range(20)], [unit*(-0.05 + 0.05*j) for j in range(12)]
        # Cold pressure K (rho/rho0 - 1) and 0.5 rho e; T = T0 (rho/rho0)^(1/2) + (e - e_cold)/c is left out.
        pressure, warm = (lambda rho, e: 0.5*young*(rho/density - 1) + 0.5*rho*e), False
        start = luck.choice(("", f"pressure0={0.02*young:g}"))
    pairs = [(rho, e) for rho in densities for e in energies]
    if luck.random() < 0.5:
        pairs = [(rho, e) for e in energies for rho in densities]
    values = [(rho, e, pressure(rho, e), *([temperature(rho, e)] if warm else [])) for rho, e in pairs]
    rows = "".join(" ".join(f"{x:.12g}" for x in row) + "\n" for row in values)
    lines = [f"material {numbers['name']} fluid density={density}" + luck.choice(("", f" viscosity={young*0.01:g}")),
             f'eos {numbers["name"]} table file="{file}" {start}']
    if luck.random() < 0.7:
        lines.append(f"viscosity {numbers['name']} quadratic=1.5 linear=0.3")
    return lines, "# density energy pressure" + " temperature"*warm + "\n" + rows


def afterburn(luck):
    """Words of a JWL equation: a window of time, or Miller's rate."""
    energy = f" afterburn={luck.choice((1, 10))}"
    if luck.random() < 0.5:
        start = luck.choice((0, 0.5))
        return energy + f" afterburn_start={start} afterburn_end={start + luck.choice((0.01, 2))}"
    energy += f" afterburn_rate={luck.choice((0.1, 10))} afterburn_pressure={luck.choice((0.1, 1))}"
    return energy + luck.choice(("", " afterburn_order=1 afterburn_exponent=1",
                                 " afterburn_order=2 afterburn_exponent=0"))


def ductile(luck, numbers):
    """The card failure with damage by the work of the largest stress, or by mean stress and Lode angle."""
    work = f"plastic_work={numbers['weak']*luck.choice((0.003, 0.03)):g}"
    hosford = f"hosford_strain={luck.choice((0.003, 0.03))} hosford_exponent={luck.choice((1, 1.4, 2, 6))}"
    hosford += f" hosford_friction={luck.choice((0, 0.1, 0.5))}" + luck.choice(("", " hosford_power=0.5"))
    words = luck.choice((work, hosford))
    words += luck.choice(("", "", f" pmin=-{numbers['young']*0.01:g}", f" weibull={luck.choice((2, 8))}"))
    return f"failure {numbers['name']} {words} carries={luck.choice(('nothing', 'pressure', 'everything'))}"


def flawed(luck, numbers):
    """The card failure with flaws, in a cell one of them below a strain of a hundredth, or of a thousandth."""
    return (f"failure {numbers['name']} flaws={luck.choice((1e12, 1e18))} flaw_exponent=6 seed={luck.randint(0, 3)} "
            f"carries={luck.choice(('nothing', 'pressure'))}"
            + luck.choice(("", " flaw_count=8", f" crack_speed={luck.choice((0.1, 10))}")))


def averaged(card, length):
    """The card failure with a length, where something of it is driven by plastic strain."""
    driven = any(f" {key}=" in card for key in ("plastic_strain", "plastic_work", "hosford_strain"))
    return card + f" length={length}"*driven
