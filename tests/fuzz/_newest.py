"""What random scenes of the newest seeds have: ceramics, clay, stress at the start, shapes that are added and cut out,
and the keys of a deck that no other scene has. As in _features.py each is drawn from a stream that its caller gives."""
from _features import vector

# Strength in the scene's Young's modulus. What is broken from the start breaks by its first plastic strain.
CERAMIC = (
    "material {name} johnson_holmquist density={density} shear_modulus={shear:g} k1={bulk:g} "
    "hugoniot_limit={limit:g} hugoniot_pressure={pressure:g} "
    "intact_strength={intact} intact_exponent={exponent} fractured_strength={fractured} tension_limit={tension:g} "
    "damage_strain={strain}"
)
OPTIONS = (
    " fractured_exponent=0.5", " fractured_limit=0.2", " rate_coefficient=0.01 reference_rate=0.01",
    " damage_exponent=0.5", " damage_exponent=0", " bulking=0", " bulking=0.5", " k2={bulk:g}*2 k3={bulk:g}",
    " k2=-{bulk:g}*0.3",
)
# Keys that a card of a kind takes: its first words, a word that it must have (or ""), and what is added to it.
KEYS = (
    ("method", "", " flip=0.9"),
    ("method", "", " flip=0"),
    ("method", "", " mass_cutoff=1e-15"),
    ("method sgmp", "stress=normalised", " interior=0.5"),
    ("method", "split=", " split_most=100000"),
    ("time", "", " growth=1.01"),
    ("time", "", " growth=2 dt_min=1e-7"),
    ("material johnson_cook", "thermal=yes", " thermal_exponent=0.5 room_temperature=250 taylor_quinney=0.5"),
    ("material johnson_cook", "d1=", " d4=0.02 d5=0.5"),
    ("material explosive", "", " burn_cells=3"),
    ("eos polynomial", "", " a3=1 b2=0.2"),
    ("eos tait", "", " exponent=3"),
    ("eos shock", "", " s2=0.2 s3=-0.1"),
    ("detonation", "", " time=0.05"),
    ("detonation", "", " normal=axis"),
    ("contact", "", " lambda=0.6"),
    ("contact", "", " depth=1.5"),
    ("contact", "", " normal=average"),
    ("contact", "", " normal=stiffer"),
    ("stop", "", " energy_growth=5"),
    ("checkpoint", "", " minutes=600"),
    *(
        (f"material {kind}", "", " yield_weibull=4 yield_seed=2")
        for kind in ("j2", "johnson_cook", "steinberg_guinan", "zerilli_armstrong")
    ),
)
# may begin with a stress
HOLDS = ("elastic", "j2", "johnson_cook", "steinberg_guinan", "zerilli_armstrong", "drucker_prager", "mohr_coulomb")


def ceramic(luck, numbers):
    """Johnson and Holmquist's, that breaks at once, slowly or hardly."""
    young, poisson = numbers["young"], numbers["poisson"]
    weak = young*luck.choice((0.001, 0.01, 0.1))
    pressure = weak*luck.choice((0.3, 1, 3))
    numbers = {
        **numbers,
        "shear": young / (2 * (1 + poisson)),
        "bulk": young / (3 * (1 - 2 * poisson)),
        "pressure": pressure,
        "limit": pressure + weak * 2 / 3,
        "intact": luck.choice((0.5, 0.93)),
        "exponent": luck.choice((0, 0.6, 1)),
        "fractured": luck.choice((0, 0.3, 2)),
        "tension": pressure * luck.choice((0, 0.1, 0.1, 1)),
        "strain": luck.choice((0, 0.001, 0.02, 1)),
    }
    more = luck.sample(OPTIONS, luck.choice((0, 1, 2, 3)))
    words = (CERAMIC + "".join(more)).format(**numbers).split()
    return [
        " ".join(
            words[:3]
            + [
                word
                for n, word in enumerate(words[3:], 3)
                if word.split("=")[0] not in [w.split("=")[0] for w in words[3:n]]
            ]
        )
    ]


def keyed(luck, lines, axes, joined=False):
    """Lines of a deck with keys that are not drawn elsewhere, at most one kind to a card."""
    found = []
    for line in lines:
        words = line.split(" ", 3)
        named = words[0] in ("material", "eos")
        begins = " ".join(words[0:3:2] if named else words[:2])
        turns = "swirl=yes" in lines[0] and not joined or "rotation=" in line  # takes flip=1
        fits = [
            key
            for first, needs, key in KEYS
            if first in (begins, words[0]) and needs in line and not (turns and "flip" in key)
        ]
        key = luck.choice(fits) if fits and luck.random() < 0.4 else ""
        if key == " normal=axis":
            key = " normal=" + vector([1.0 if axis == axes[-1] else 0.0 for axis in axes])
        if words[:1] + words[2:3] == ["material", "j2"] and "hardening=linear" in line and luck.random() < 0.4:
            line = line.replace("hardening=linear", "hardening=power hardening_exponent=0.5")
        found.append(line + key)
    return found


def further_cards(luck, lines, axes, places):
    """Cards that no other scene has: gauges, kinds of output, how ranks share the work. `places`: corners of the
    bodies."""
    found = []
    for number, place in enumerate(places):
        if luck.random() < 0.5:
            more = luck.choice(("", " radius=1.5", " radius=1.5 frame=fixed", " radius=1 fields=stress,bulking,damage"))
            fields = "stress,damage,plastic_strain,bulking"
            keep = any(" johnson_holmquist " in line for line in lines)
            more = more.replace("stress,bulking,damage", fields if keep and len(places) == 1 else "stress")
            found.append(f"gauge g{number} point={vector(place)}{more}")
    if luck.random() < 0.4:
        found.append(f"balance every={luck.choice((0, 1, 7))} gain={luck.choice((0, 0.05))}")
    if luck.random() < 0.3:
        found.append(
            f"output {luck.choice(('vtu', 'tecplot', 'vtkhdf'))} every={luck.choice((0.05, 0.3))} "
            f"fields=displacement,von_mises,path,strength"
        )
    return found


def solid(luck, dimension, lower, size):
    """A shape within a box, of the kinds that other scenes do not have."""
    middle = [low + side/2 for low, side in zip(lower, size)]
    radius, length = 0.4*min(size), 0.8*size[-1]
    base = vector([*middle[:-1], lower[-1]] if dimension == 3 else middle)
    kinds = [f"cylinder centre={base} radius={radius:g} length={length:g}"]
    if dimension == 3:
        kinds += [f"cone centre={base} radius={radius:g} top={luck.choice((0, 0.3))*radius:g} length={length:g}",
                  f"ogive centre={base} radius={radius:g} length={max(length, 1.2*radius):g}"]
    return luck.choice(kinds)


def changed(luck, dimension, rings, lower, size):
    """A card that adds a shape to a body, within its box, or cuts one out; {name} is the body."""
    if dimension == 1 or rings:
        return (
            f"add {{name}} block lower={vector(lower)} "
            f"upper={vector([low + side / 2 for low, side in zip(lower, size)])}"
        )
    if luck.random() < 0.5 or min(size) < 2:
        return f"add {{name}} {solid(luck, dimension, lower, size)}"
    middle = vector([low + side/2 for low, side in zip(lower, size)])
    tip = vector([low + 0.8*side for low, side in zip(lower, size)])
    return luck.choice(
        (
            f"subtract {{name}} {solid(luck, dimension, lower, size)}",
            f"subtract {{name}} halfspace centre={tip} axis={vector([1.0] * dimension + [0.0] * (3 - dimension))}",
            f"intersect {{name}} block lower={vector(lower)} upper={tip} rotation=20 pivot={middle}",
        )
    )


def cam_clay(luck, numbers):
    """Roscoe and Burland's clay, under a pressure that nothing holds."""
    young, slope = numbers["young"], luck.choice((0.03, 0.1, 0.25))
    ratio = luck.choice(("", " overconsolidation=1.5", " overconsolidation=8", f" preconsolidation={young*0.05:g}"))
    return [
        f"material {numbers['name']} cam_clay density={numbers['density']} poisson={numbers['poisson']} "
        f"critical_ratio={luck.choice((0.8, 1.2))} compression_slope={slope} "
        f"swelling_slope={slope / luck.choice((1.2, 5))} void_ratio={luck.choice((0.4, 1, 2))} "
        f"pressure0={young * luck.choice((0.001, 0.02)):g}" + ratio
    ]


def initial_stress(luck, lines, name, axes, gravity):
    """The stress of a body at the start, if its matter may have one: of ground, or any that is smooth."""
    matter = next(line.split("material=")[1].split()[0] for line in lines if line.startswith(f"body {name} "))
    card = next(line for line in lines if line.startswith(f"material {matter} "))
    others = [line.split()[0] for line in lines if line.split()[1:2] == [matter]]
    if (
        card.split()[2] not in HOLDS
        or "eos" in others
        or any(line.startswith(f"failure {matter} ") and ("fracture_energy" in line or "flaws" in line)
               for line in lines)
    ):
        return []
    young = float(card.split("young=")[1].split()[0])
    if gravity and luck.random() < 0.5:
        return [
            f"initial_stress {name} surface=50 k0={luck.choice((0.3, 1))} pressure={young * luck.choice((0, 0.01)):g}"
        ]
    parts = ["xx", "yy", "zz"] + ["xy"]*(axes[:2] == "xy") + ["xz"]*(axes == "rz") + ["yz", "xz"]*(axes == "xyz")
    chosen = luck.sample(parts, luck.choice((1, 2, len(parts))))
    return [
        f"initial_stress {name} "
        + " ".join(
            f'{part}="{young * luck.choice((0.01, -0.01, -0.1)):g}*{luck.choice(("1", f"cos({axes[0]})"))}"'
            for part in chosen
        )
    ]
