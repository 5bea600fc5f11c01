#!/usr/bin/env python3
"""Writes doc/material-library.md from the files of input/materials.

    python3 scripts/dev/material_library.py             writes the page
    python3 scripts/dev/material_library.py --check     exit code 1 if the page is not what it would write

tests/regression/library.py reads the files by this module, too.
"""
import glob
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGE = os.path.join(ROOT, "doc", "material-library.md")
UNCHECKED = "not checked"

HEAD = """# Material library

<!-- written by scripts/dev/material_library.py; do not edit -->

Materials of `input/materials`, one to a file, in SI units; a deck includes them and states its own units:

    units mm g ms
    include "materials/copper.inp"
    body bar block material=copper lower=(0,0,0) upper=(1,1,9)

The numbers are converted to the units of the deck, because the file says that its units are its own
(`units m kg s scope=file`). A file of your own may do the same, in the units of the paper that the constants come from
(`units cm g us scope=file` has stresses in Mbar); it holds cards `material`, `eos`, `failure`, `viscosity` and
parameters. `sgmp DECK --verbose` prints the cards as they are after conversion. To change a constant, copy the file.
Bulk viscosity is not in the files: shocks need a card `viscosity`. Stresses of the table are in Pa, temperatures in K,
angles in degrees: `pmin=-100` of water is a tension of 100 Pa, next to none.

Each line of a file says where its constants come from, or that it is not known: the strength of `steel_304` is in
general use, but its primary source was not found; what is called representative (density and moduli of `sand`, density
and Poisson's ratio of `weald_clay`) was chosen, not measured. Those with a source were compared with other prints of
them (libraries of other codes, reports that quote them), not with the originals; those marked * were found in no other
print. What is called handbook are elastic moduli and densities as they stand in any. Explosives are checked by
themselves: their constants give the published speed and pressure of detonation to 0.2 %. Every material is strained
along a path in two systems of units and compared with its equations, worked out independently
(tests/regression/library.py).

`alumina_jh2`: its constants were found in one other print, rounded to two or three digits. `silicon_carbide_jh2`: in
one print that quotes them, but for the density; its limit of 14.457 GPa is 14.567 GPa elsewhere (from memory of the
literature), which makes the strength 1.3 % higher.

`aluminium_2024_t351`: its strain at failure is Hosford and Coulomb's law, fitted here to eleven tests of Bai and
Wierzbicki (2010, Int. J. Fract. 161, 1), whose strains are from memory of the literature: see
[materials, Failure](materials.md#failure).

`concrete_48mpa`: its constants were found in one other print (a test of another code, with 14.8 GPa for the shear
modulus), not in the original. What tests it is a row of shots: [materials, Concrete](materials.md#concrete).

`copper_zerilli` and `iron_zerilli`: no other print of Zerilli and Armstrong's constants could be seen. What speaks for
their digits is Johnson and Cook's law, which was fitted to the same metals: see the table of flow stresses in
[materials, Metals](materials.md#metals).

`copper`, `copper_zerilli` and `copper_steinberg` are the same metal: the first two are for rates and temperatures of
impact, the third for pressures of 10 GPa and more.

`weald_clay`: M, λ and the void ratio were found in one other print, which takes κ = 0.025 for the same clay.

Johnson and Cook's damage is off in `copper`, `iron`, `steel_4340`, `steel_mild`, `weldox_460e`, `aluminium_2024_t3` and
`aluminium_6061_t6`; `--set copper_failure=yes`, and so on with the name of each, switches that of the metal on.

At second hand: `steel_mild`, `steel_ap_core`, `glass_soda_lime`, `pmma`, `polyethylene` and the damage of the aluminium
alloys are as papers that use these materials quote their sources. Neither the originals nor, but for what follows,
other prints could be seen. Found in one other print: d1, d2 and d4 of `aluminium_2024_t3`, d1 to d3 of
`aluminium_6061_t6`, d1 to d4 of `weldox_460e` (its other constants in none; its critical_damage, off unless asked
for, is from memory of the literature). Signs: d3 is negative here where some
codes print it positive.

**d3 of `aluminium_2024_t3` is doubtful**: that other print has -0.5 in the place of -1.5. With -0.5 the failure strain
is 0.22 and not 0.19 in uniaxial tension (mean stress a third of the flow stress), 0.17 and not 0.13 where the mean
stress is 1.5 of it, 0.26 and not 0.31 in uniaxial compression. Where a result hangs on it, run both.

What is missing, and why: no damage constants of `tungsten_alloy` (two sets are quoted in the literature, neither with a
source that could be seen); of concrete one strength, of glass soda-lime glass alone; of polyethylene no measured
strength (its moduli and yield stress are representative); of the steel of bullets the hardened core alone
(`steel_ap_core`; lead and brass are `lead` and `brass`).

"""

SOURCES = """
## Sources

* Borvik and others 2001: Borvik, Hopperstad, Berstad and Langseth, A computational model of viscoplasticity and ductile
  damage for impact and penetration, Eur. J. Mech. A/Solids 20, 685-712.
* Borvik, Dey and Clausen 2009: Perforation resistance of five different high-strength steel plates subjected to
  small-arms projectiles, Int. J. Impact Engng 36, 948-964.
* Cole 1948: Underwater Explosions, Princeton University Press.
* Corbett 2006: Numerical simulations of target hole diameters for hypervelocity impacts into elevated and room
  temperature bumpers, Int. J. Impact Engng 33, 431-440.
* Cronin and others 2003: Cronin, Bui, Kaufmann, McIntosh and Berstad, Implementation and validation of the
  Johnson-Holmquist ceramic material model in LS-DYNA, 4th European LS-DYNA Users Conference, Ulm.
* Dobratz and Crawford 1985: LLNL Explosives Handbook, UCRL-52997 Change 2.
* Holmquist and others 1993: Holmquist, Johnson and Cook, A computational constitutive model for concrete subjected to
  large strains, high strain rates and high pressures, 14th International Symposium on Ballistics, Quebec, 591-600.
* Holmquist and others 1995: Holmquist, Johnson, Grady, Lopatin and Hertel, High strain rate properties and constitutive
  modeling of glass, 15th International Symposium on Ballistics, Jerusalem, 237-244.
* Iqbal and others 2015: Iqbal, Senthil, Bhargava and Gupta, The characterization and ballistic evaluation of mild
  steel, Int. J. Impact Engng 78, 98-113.
* Johnson and Cook 1983: A constitutive model and data for metals, 7th International Symposium on Ballistics, The Hague,
  541-547.
* Johnson and Cook 1985: Fracture characteristics of three metals, Engineering Fracture Mechanics 21, 31-48.
* Johnson and Holmquist 1994: An improved computational constitutive model for brittle materials, AIP Conf. Proc. 309,
  981-984.
* Kay 2003: Failure modeling of titanium 6Al-4V and aluminum 2024-T3 with the Johnson-Cook material model,
  DOT/FAA/AR-03/57.
* Lange and Ahrens 1983: The dynamic tensile strength of ice and ice-silicate mixtures, J. Geophys. Res. 88, 1197-1208.
* Lesuer 2000: Experimental investigations of material models for Ti-6Al-4V titanium and 2024-T3 aluminum,
  DOT/FAA/AR-00/25.
* Lesuer, Kay and LeBlanc 2001: Modeling large-strain, high-rate deformation in metals, UCRL-JC-134118.
* LS-DYNA Aerospace Working Group: Modeling Guidelines Document.
* Lube, Huppert, Sparks and Freundt 2005: Collapses of two-dimensional granular columns, Phys. Rev. E 72, 041301.
* Marsh 1980: LASL Shock Hugoniot Data, University of California Press.
* Petrovic 2003: Mechanical properties of ice and snow, J. Mater. Sci. 38, 1-6.
* Schofield and Wroth 1968: Critical State Soil Mechanics, McGraw-Hill.
* Steinberg 1996: Equation of state and strength properties of selected materials, UCRL-MA-106439 Change 1.
* Stewart and Ahrens 2005: Shock properties of H2O ice, J. Geophys. Res. 110, E03005.
* Treloar 1944: Stress-strain data for vulcanised rubber under various types of deformation, Trans. Faraday Soc. 40,
  59-70.
* US Standard Atmosphere 1976, NOAA-S/T 76-1562.
* Wood and Martin 1964: Compressibility of natural rubber at pressures below 500 kg/cm2, J. Res. NBS 68A, 259-268.
* Zerilli and Armstrong 1987: Dislocation-mechanics-based constitutive relations for material dynamics calculations, J.
  Appl. Phys. 61, 1816-1825.
"""


def library(root=ROOT):
    """Paths of the files."""
    return sorted(glob.glob(os.path.join(root, "input", "materials", "*.inp")))


def constants(path):
    """The cards of a file: {card: {"words": [...], key: number or word}}, parameters replaced."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r" *&\s*\n", " ", re.sub(r" *[!#].*", "", file.read()))
    cards, words = {}, {}
    for line in text.splitlines():
        tokens = line.split()
        if not tokens:
            continue
        if tokens[0] == "parameter":
            words["$" + tokens[1]] = tokens[3]
            continue
        card = cards.setdefault(tokens[0], {"words": [token for token in tokens[1:] if "=" not in token]})
        for token in tokens[1:]:
            key, equals, value = token.partition("=")
            value = words.get(value, value)
            if equals:
                card[key] = float(value) if re.match(r"[-+.\d]", value) else value
    return cards


def sourced(path):
    """What a file says: title, and (constants, source) of each line."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    title, rows = lines[0][2:], []
    for line in lines[2:]:
        text, mark, source = line.partition("!")
        if text.startswith("parameter") or not mark:
            continue
        words = text.split()
        first = 0 if "=" in words[0] else 2 if words[0] == "failure" else 3
        rows.append((" ".join(word for word in words[first:] if word != "&" and not word.startswith("failure=$")),
                     source.strip()))
    return title, rows


def page():
    """The whole page."""
    text = HEAD + "| material | what it is | law, equation of state | constants (SI) and sources |\n|---|---|---|---|\n"
    for path in library():
        name = os.path.basename(path)[:-4]
        cards = constants(path)
        title, rows = sourced(path)
        laws = cards["material"]["words"][1] + (", " + cards["eos"]["words"][1] if "eos" in cards else "")
        said = []
        for numbers, source in rows:
            star = "*" if source.endswith(UNCHECKED) else ""
            source = re.sub(", " + UNCHECKED + "$", "", source)
            if said and said[-1][1] == (source, star):
                said[-1][0] += " " + numbers
            else:
                said.append([numbers, (source, star)])
        sources = "<br>".join(f"{numbers} ({source}{star})" for numbers, (source, star) in said)
        text += f"| [{name}](../input/materials/{name}.inp) | {title} | {laws} | {sources} |\n"
    return text + SOURCES


def main():
    if sys.argv[1:] == ["--check"]:
        with open(PAGE, encoding="utf-8") as file:
            sys.exit(0 if file.read() == page() else 1)
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(page())


if __name__ == "__main__":
    main()
