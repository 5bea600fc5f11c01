#!/usr/bin/env python3
"""Writes the tables of laws and equations of state in doc/materials.md.

python3 scripts/dev/material_models.py SGMP              writes them python3 scripts/dev/material_models.py SGMP --check
exit code 1 if they are not what it would write python3 scripts/dev/material_models.py SGMP --measure    measures the
price of all of them first: on a machine that does nothing else python3 scripts/dev/material_models.py SGMP --measure
concrete …   of these alone, over that of `elastic` beside them

Which laws there are says the program (`sgmp help`), what they store `sgmp DECK --check`; equations, sources and what
they were compared with stand here, and a law that is missing here is an error. Prices, once measured, are in
doc/material-prices.json; without them the tables have no column of them, and a dash for one that is missing.
"""
import json
import os
import re
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGE = os.path.join(ROOT, "doc", "materials.md")
PRICES = os.path.join(ROOT, "doc", "material-prices.json")
SOLID = "young=100 poisson=0.3"
# name: cards, equation and source, compared with
LAWS = {
    "elastic": ([f"elastic density=1 {SOLID}"], "Hooke, Jaumann rate; or the linear theory",
                "bars and beam of the paper (verification/bar, beam)"),
    "neo_hookean": ([f"neo_hookean density=1 {SOLID}"], "σ = (μ (F Fᵀ − 1) + λ ln J)/J",
                    "manufactured solution, bar in large deformation (bar, vortex)"),
    "j2": ([f"j2 density=1 {SOLID} yield=0.1 hardening=linear hardening_modulus=1"], "von Mises, radial return (R1)",
           "uniaxial strain in closed form (test_stress_update)"),
    "johnson_cook": ([f"johnson_cook density=1 {SOLID} yield=0.1 hardening_modulus=1 hardening_exponent=0.3 "
                      f"rate_coefficient=0.02 reference_rate=1e-3 "
                      "thermal=yes melt_temperature=1000 specific_heat=10 failure=yes d1=9"],
                     "(J1)–(J3), Johnson and Cook 1983, 1985",
                     "Taylor bars (taylor_bar; three metals beside finite elements, taylor_metals), a plate that is "
                     "pierced (perforation), closed forms (test_material_jc), paths of the library's metals "
                     "(tests/regression/library.py)"),
    "explosive": (["explosive density=1 detonation_speed=7",
                   "eos m jwl a=371 b=3.2 r1=4.15 r2=0.95 omega=0.3 energy0=7", "detonation time=-100 normal=(1,0,0)"],
                  "(W1), programmed burn", "Chapman-Jouguet state and Taylor wave (tnt_slab)"),
    "fluid": (["fluid density=1 viscosity=1e-3", "eos m tait c0=10 pressure0=1"], "2η dev D − p",
              "shock tube, shocks, hydrostatics, vortex (fluids), below"),
    "drucker_prager": ([f"drucker_prager density=1 {SOLID} friction=30 cohesion=0.1"],
                       "(D1), (D2), Drucker and Prager 1952",
                       "Mohr and Coulomb's strength in triaxial compression, oedometer and pure shear in closed form "
                       "(test_material_drucker_prager)"),
    "mohr_coulomb": ([f"mohr_coulomb density=1 {SOLID} friction=30 cohesion=0.1"],
                     "(M1), Coulomb 1776, Mohr 1900; cut-off of Rankine",
                     "triaxial, plane strain and simple shear in closed form (test_material_mohr_coulomb); a second "
                     "implementation, all regions (tests/regression/laws.py)"),
    "mooney_rivlin": (["mooney_rivlin density=1 c1=15 c2=4 poisson=0.4"], "(R2), Mooney 1940, Rivlin 1948",
                      "Rivlin's uniaxial, equibiaxial, pure and simple shear; stress and work from the energy "
                      "(test_material_mooney_rivlin, tests/regression/laws.py)"),
    "steinberg_guinan": ([f"steinberg_guinan density=1 {SOLID} yield=0.1 yield_limit=1 hardening_factor=40 "
                          f"hardening_exponent=0.3 pressure_stiffening=0.02 "
                          "thermal_softening=4e-4 specific_heat=10 melt_temperature=1000"],
                         "(SG1)–(SG3), Steinberg, Cochran and Guinan 1980",
                         "closed forms (test_material_steinberg_guinan); paths of a second implementation, with "
                         "temperature, Ymax and melting (tests/regression/laws.py, 0.1 %)"),
    "zerilli_armstrong": ([f"zerilli_armstrong density=1 {SOLID} yield=0.1 thermal_stress=1 thermal_softening=7e-3 "
                           f"thermal_rate=4e-4 hardening_modulus=1 "
                           "hardening_exponent=0.3 specific_heat=10"],
                          "(ZA1), Zerilli and Armstrong 1987",
                          "closed forms, both lattices (test_material_zerilli_armstrong); paths of a second "
                          "implementation (tests/regression/laws.py, 0.1 %); paths of the library's metals "
                          "(tests/regression/library.py), Taylor bars (taylor_metals)"),
    "johnson_holmquist": (["johnson_holmquist density=1 shear_modulus=90 k1=130 k2=10 k3=10 hugoniot_limit=2.8 "
                           "hugoniot_pressure=1.4 intact_strength=0.9 intact_exponent=0.6 fractured_strength=0.3 "
                           "fractured_exponent=0.6 rate_coefficient=0.01 tension_limit=0.2 damage_strain=0.005"],
                          "(JH1)–(JH6), JH-2 of Johnson and Holmquist 1994",
                          "states by hand (test_material_johnson_holmquist); one element squeezed, let go and drawn by "
                          "a second implementation (tests/regression/laws.py, 0.1 to 0.5 %); a tungsten rod, which "
                          "misses (long_rod)"),
    "cam_clay": (["cam_clay density=1 poisson=0.3 critical_ratio=1 compression_slope=0.1 swelling_slope=0.02 "
                  "void_ratio=1 pressure0=1"],
                 "(CC1)–(CC4), modified Cam-clay of Roscoe and Burland 1968",
                 "lines of compression and swelling, undrained path, drained triaxial compression, critical state "
                 "in closed form (test_material_cam_clay); one element squeezed, let go and drawn by a second "
                 "implementation (tests/regression/laws.py, 0.1 %)"),
    "crushable_foam": ([f"crushable_foam density=1 {SOLID} plateau=1 linear_hardening=1 densification=1 "
                        f"densification_strain=1.5"],
                       "(CF1)–(CF3), Deshpande and Fleck 2000; curve of Hanssen et al. 2002",
                       "uniaxial crush, pressure and shear in closed form (test_material_crushable_foam); "
                       "one element squeezed, let go and drawn by a second implementation (tests/regression/laws.py, "
                       "0.1 %)"),
    "concrete": (["concrete density=1 shear_modulus=40 compressive_strength=0.2 cohesive_strength=0.8 "
                  "pressure_hardening=1.6 pressure_exponent=0.6 strength_limit=7 rate_coefficient=0.007 "
                  "reference_rate=1e-3 tension_limit=0.02 damage_strain=0.04 least_damage_strain=0.01 "
                  "crush_pressure=0.05 crush_compression=0.001 lock_pressure=2 lock_compression=0.1 k1=250 k2=-500 "
                  "k3=600"],
                 "(HJC1)–(HJC7), Holmquist, Johnson and Cook 1993",
                 "the three regions of the pressure, let go in each, strength, damage, tension and the work of "
                 "squeezing in closed form (test_material_concrete); one element squeezed to 10 GPa, let go and drawn "
                 "by a second implementation (tests/regression/laws.py, 0.3 %); slabs that are pierced (concrete)"),
}
SOLIDS = "metals, fluid"
# name: constants, goes with, equation and source, compared with
EQUATIONS = {
    "jwl": ("", "explosive", "(W1), Jones-Wilkins-Lee", "Chapman-Jouguet state and Taylor wave (tnt_slab); detonation "
                                                        "speeds and pressures of the library's explosives"),
    "gruneisen": ("c0=10 s=1.5 gamma0=2", SOLIDS + "; porous with `distention`",
                  "(G1), (G2): Us = c0 + s up, the series of (H1) to the third order in the compression (too soft in "
                  "copper at given compression: 0.2 % at up = 0.5 km/s, 1.0 % at 1, 2.6 % at 1.5)",
                  "Hugoniot to third order (test_eos_gruneisen); shock in water at 200 m/s"),
    "ideal_gas": ("gamma=1.4 pressure0=1", SOLIDS, "(S1), p∞ = 0",
                  "isentrope 1:2 (test_eos_fluids, test_stress_update), shock tube, planar Noh"),
    "stiffened_gas": ("gamma=4.4 p_inf=20 pressure0=1", SOLIDS, "(S1), Harlow and Amsden 1971",
                      "isentrope, shock in water at 500 m/s"),
    "polynomial": ("a1=100 a2=100 a3=50 b0=0.3 b1=0.3", SOLIDS, "(P1), LS-DYNA's C0…C6",
                   "coefficients one by one (test_eos_fluids)"),
    "tait": ("c0=10 pressure0=1", SOLIDS, "(T1), Cole 1948",
             "bulk modulus and its slope, hydrostatic column, shock in water"),
    "shock": ("c0=10 s=1.5 gamma0=2", SOLIDS + "; porous with `distention`",
              "(H1), (H2): the Hugoniot itself, Us = c0 + s up + s2 (up/Us) up + s3 (up/Us)² up, Steinberg 1996",
              "Hugoniots of six metals and of water (hugoniot); paths of the library's metals "
              "(tests/regression/library.py)"),
    "tillotson": ("a_thermal=0.5 b_thermal=1.5 bulk=100 bulk2=100 e0=10 e_incipient=3 e_complete=10", SOLIDS,
                  "(TI1)–(TI3), Tillotson 1962 as in Melosh 1989: melts and evaporates; not linear in E",
                  "limits in closed form, measured Hugoniots of aluminium and iron within 2 % (test_eos_tillotson)"),
    "table": ('file="gas.txt" energy0=2.5', SOLIDS,
              "(TB1), (TB2): a file of densities, energies and pressures, bicubic with limited slopes (Steffen 1990); "
              "not linear in E", "an ideal gas to round-off, Tillotson's aluminium, isentrope, monotone points "
              "(test_eos_table); a shock tube beside `ideal_gas` (tests/regression/tables.py)"),
}
# The table of `table`, and cards failure of `j2`, by none of which it fails.
GAS = "".join(f"{0.25*1.2**i} {0.5*1.2**j} {0.4*0.25*1.2**i*0.5*1.2**j}\n" for i in range(20) for j in range(20))
FAILURES = {"plastic_strain": "plastic_strain=9", "pmin": "pmin=-1e9", "plastic_work": "plastic_work=9e9",
            "hosford_strain": "hosford_strain=9e9 hosford_exponent=1.5 hosford_friction=0.1",
            "flaws": "flaws=1e-30 flaw_exponent=8", "length": "plastic_strain=9 length=2"}
NOTES = {"j2": "; energy with an equation of state, damage with `failure`",
         "johnson_cook": " (temperature and damage where asked for); energy with an equation of state",
         "steinberg_guinan": " (temperature with `specific_heat`); energy with an equation of state",
         "zerilli_armstrong": " (temperature with `specific_heat`); energy with an equation of state",
         "fluid": " (without a viscosity one stress component)"}
DECK = """
dimension 3
grid cell=1 x=0:{n} y=0:{n} z=0:{n}
wall x-=slip x+=slip y-=slip y+=slip z-=slip z+=slip
method sgmp
time cfl=0.3 steps={steps}
{cards}
body b block material=m lower=(0,0,0) upper=({n},{n},{n}) ppc=2
velocity b x="0.2*sin(pi*x/{n})*cos(pi*y/{n})" y="-0.2*cos(pi*x/{n})*sin(pi*y/{n})"
"""


def cards_of(kind, name):
    if kind == "failure":
        return cards_of("law", "j2") + f"\nfailure m {FAILURES[name]}"
    if kind == "law":
        law, *others = LAWS[name][0]
    elif name == "jwl":
        return cards_of("law", "explosive")
    else:
        law, others = "fluid density=1", [f"eos m {name} {EQUATIONS[name][0]}"]
    return "\n".join([f"material m {law}", *others])


def run(sgmp, cards, *options, steps=1, n=4):
    with tempfile.TemporaryDirectory() as folder:
        deck = os.path.join(folder, "deck.inp")
        with open(deck, "w", encoding="utf-8") as file:
            file.write(DECK.format(cards=cards, steps=steps, n=n))
        with open(os.path.join(folder, "gas.txt"), "w", encoding="ascii") as file:
            file.write(GAS)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run([sgmp, deck, "--threads", "1", "--output", os.path.join(folder, "out"), *options],
                              capture_output=True, text=True, check=False,
                              env={**os.environ, "OMP_WAIT_POLICY": "passive"})
        if done.returncode:
            sys.exit(f"{cards}\n{done.stdout}{done.stderr}")
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, done.stdout


def stored(sgmp, cards):
    """What `--check` says is stored of each particle besides what always is."""
    lines = run(sgmp, cards, "--check")[1].splitlines()
    first = next(i for i, line in enumerate(lines) if line.strip().startswith("stored"))
    kept = []
    for line in lines[first + 1:]:
        if not line.startswith(" "*12):
            break
        kept.append(re.sub(r" \(.*", "", line.strip()))
    return ", ".join(kept)


def names(sgmp, card):
    """The words of the card's key `kind`."""
    text = subprocess.run([sgmp, "help", card], capture_output=True, text=True, check=True).stdout
    return re.search(r"(?s)\n  kind .*?\n +one of ([a-z0-9_\s]+);", text).group(1).split()


def measure(sgmp, chosen):
    """Time of a particle-step over that of the elastic law: the least of several runs of each, in turns, for others use
    the machine, too."""
    size, few, many, rounds = 24, 2, 42, 9
    all_cards = {f"law {name}": cards_of("law", name) for name in LAWS} | {f"eos {name}": cards_of("eos", name)
                                                                           for name in EQUATIONS}
    all_cards |= {f"failure {name}": cards_of("failure", name) for name in FAILURES}
    if chosen:
        all_cards = {key: cards for key, cards in all_cards.items() if key.split()[1] in ("elastic", *chosen)}
    least = {key: [float("inf")]*2 for key in all_cards}
    for _ in range(rounds):
        for key, cards in all_cards.items():
            for i, steps in enumerate((few, many)):
                least[key][i] = min(least[key][i], run(sgmp, cards, "--quiet", steps=steps, n=size)[0])
    elastic = least["law elastic"][1] - least["law elastic"][0]
    prices = {key: round((last - first)/elastic, 2) for key, (first, last) in least.items()}
    prices["elastic_ns"] = round(1e9*elastic/((many - few)*(2*size)**3))
    if chosen:
        with open(PRICES, encoding="utf-8") as file:
            before = json.load(file)
        found = {key: price for key, price in prices.items() if key.split()[-1] in chosen}
        prices = {**before, **found, "elastic_ns": before.pop("elastic_ns")}
    print(prices)
    with open(PRICES, "w", encoding="utf-8") as file:
        json.dump(prices, file, indent=1)
        file.write("\n")


def row(*cells):
    return "| " + " | ".join(cell for cell in cells if cell is not None) + " |\n"


def tables(sgmp):
    """Both tables."""
    prices = None
    if os.path.exists(PRICES):
        with open(PRICES, encoding="utf-8") as file:
            prices = json.load(file)
    for card, table in (("material", LAWS), ("eos", EQUATIONS)):
        if set(names(sgmp, card)) != set(table):
            sys.exit(f"scripts/dev/material_models.py and the card {card} differ: "
                     f"{sorted(set(names(sgmp, card)) ^ set(table))}")
    time = "time" if prices else None

    def price(kind, name):
        key = f"{kind} {name}"
        return None if not prices else f"{prices[key]:.2f}" if key in prices else "—"
    text = row("`material`", "stored per particle besides position, velocity, mass, volume", "equation and source",
               time, "compared with")
    text += row(*["---"]*4, time and "---")
    for name in names(sgmp, "material"):
        _, equation, compared = LAWS[name]
        text += row(f"`{name}`", stored(sgmp, cards_of("law", name)) + NOTES.get(name, ""), equation,
                    price("law", name), compared)
    text += "\n" + row("`eos`", "with", "equation and source", time, "compared with") + row(*["---"]*4, time and "---")
    for name in names(sgmp, "eos"):
        _, goes_with, equation, compared = EQUATIONS[name]
        text += row(f"`{name}`", goes_with, equation, price("eos", name), compared)
    if prices:
        text += (f"\nTime: of a particle-step over that of `elastic`, {prices['elastic_ns']} ns (3D, one thread). "
                 f"`johnson_cook` with rate, temperature and\ndamage, `fluid` with a viscosity; "
                 "equations of state with an inviscid `fluid`, `jwl` with `explosive`.\n")
        asked = [f"`{name}` {price('failure', name)}" for name in FAILURES if f"failure {name}" in prices]
        if asked:
            text += (f"A card `failure` of `j2`, while nothing fails: {', '.join(asked[:3])},\n"
                     f"{', '.join(asked[3:])} (`j2` alone {price('law', 'j2')}; `length` with `plastic_strain`).\n")
    return text


def main():
    sgmp = os.path.abspath(sys.argv[1])
    if "--measure" in sys.argv:
        measure(sgmp, sys.argv[sys.argv.index("--measure") + 1:])
    with open(PAGE, encoding="utf-8") as file:
        page = file.read()
    begin, end = "<!-- tables: scripts/dev/material_models.py -->\n", "<!-- end of the tables -->\n"
    head, rest = page.split(begin)
    old, tail = rest.split(end)
    new = tables(sgmp)
    if "--check" in sys.argv:
        sys.exit(0 if new == old else "the tables of doc/materials.md are not current: python3 "
                                      "scripts/dev/material_models.py SGMP")
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(head + begin + new + end + tail)


if __name__ == "__main__":
    main()
