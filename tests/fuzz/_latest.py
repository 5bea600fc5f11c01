"""What random scenes of later seeds have: later materials and porous matter, tables, loads, walls that move, particle
files. As in _features.py each is drawn from a stream that its caller gives; what is known of a load from outside is
said beside its card."""
import math

# Strength in the scene's Young's modulus and yield stress; heat such that plastic work warms by some tens of degrees.
METALS = {
    "steinberg_guinan": "material {name} steinberg_guinan density={density} young={young} poisson={poisson} "
    "yield={weak} hardening_factor={factor} "
    "hardening_exponent=0.3 yield_limit={weak}*3 pressure_stiffening=0.3/{young} initial_strain={strain}",
    "zerilli_armstrong": "material {name} zerilli_armstrong density={density} young={young} poisson={poisson} "
    "yield={weak}/2 hardening_modulus={young}/20 hardening_exponent=0.4 thermal_stress={weak} thermal_softening=0.005 "
    "thermal_rate=3e-4 "
    "thermal_hardening={weak}*{strain} reference_rate={rate}",
}
HEAT = {
    "steinberg_guinan": (
        "", " specific_heat=0.01 melt_temperature=1300 thermal_softening=4e-4",
        " specific_heat=0.01 melt_temperature=1300 thermal_softening=4e-4 melt_slope=1.5 melt_gamma=2",
    ),
    "zerilli_armstrong": ("", " specific_heat=0.01", " specific_heat=0.01 melt_temperature=1000"),
}
SOLID = (
    "eos {name} gruneisen c0=sqrt({young}/{density}) s=1.5 gamma0=2",
    "eos {name} shock c0=sqrt({young}/{density}) s=1.4 gamma0=1.5",
)
# The constants of a porous material's equation are those of its solid.
POROUS = (
    "eos {name} {kind} c0=sqrt({young}/({density}*{distention})) s=1.5 gamma0=1.6 distention={distention} "
    "crush_start={start} crush_end={end}"
)
METAL_NAMES = ("j2", "johnson_cook", *METALS)


class Ramp:
    """A function of time that a deck writes as text and that is known here."""

    def __init__(self, luck, strength, table):
        self.strength = strength
        kinds = ["constant", "rise", "pulse", "wave"] + ["table"]*3*bool(table)
        self.kind, self.table = luck.choice(kinds), table

    def text(self):
        """As a deck says it, without quotes."""
        words = {"constant": "", "rise": "*min(t/2,1)", "pulse": "*sin(pi*t/3)^2*(t<3)", "wave": "*cos(2*t)"}
        return f"{self.strength:g}" + (f"*{self.table.name}(t)" if self.kind == "table" else words[self.kind])

    def __call__(self, time):
        return self.strength * {
            "constant": lambda t: 1.0,
            "rise": lambda t: min(t / 2, 1.0),
            "pulse": lambda t: math.sin(math.pi * t / 3) ** 2 * (t < 3),
            "wave": lambda t: math.cos(2 * t),
            "table": self.table,
        }[self.kind](time)


class Table:
    """A card table, its file if it has one, and its values."""

    def __init__(self, luck, name, file):
        self.name = name
        times = sorted(luck.sample((-1.0, 0.0, 0.001, 0.5, 1.0, 2.5, 6.0, 1e4), luck.choice((2, 3, 6))))
        self.rows = [(time, luck.choice((-0.5, 0.0, 0.3, 1.0, 2.0))) for time in times]
        self.file = file if luck.random() < 0.5 else ""
        self.heading = luck.choice(("", "t,value\n", "# measured\ntime value\n"))

    def card(self):
        """The card."""
        if self.file:
            return f'table {self.name} file="{self.file}"'
        return f"table {self.name} rows=" + ",".join(f"({time!r},{value!r})" for time, value in self.rows)

    def content(self):
        """The text of its file."""
        return self.heading + "".join(f"{time!r}, {value!r}\n" for time, value in self.rows)

    def __call__(self, time):
        if time <= self.rows[0][0]:
            return self.rows[0][1]
        for (before, low), (after, high) in zip(self.rows, self.rows[1:]):
            if time < after:
                return low + (time - before)/(after - before)*(high - low)
        return self.rows[-1][1]


def metal(luck, numbers):
    """Steinberg and Guinan's or Zerilli and Armstrong's, with or without heat, an equation of state and pores."""
    kind = luck.choice(list(METALS))
    numbers = {
        **numbers,
        "factor": luck.choice((0, 10)),
        "strain": luck.choice((0, 0.02)),
        "rate": luck.choice((1, 0.01)),
    }
    pores = luck.random() < 0.25
    heat = "" if pores else luck.choice(HEAT[kind])
    lines = [(METALS[kind] + heat).format(**numbers)]
    if pores:
        lines.append(porous(luck, numbers))
    elif luck.random() < 0.5:
        lines.append(luck.choice(SOLID).format(**numbers))
    return lines


def porous(luck, numbers):
    """An equation of state with pores that close at once, or hardly."""
    young = numbers["young"]
    start = young*luck.choice((0, 0.001, 0.01))
    return POROUS.format(
        **numbers, kind=luck.choice(("gruneisen", "shock")), distention=luck.choice((1.05, 1.25, 2, 4)),
        start=f"{start:g}", end=f"{start + young * luck.choice((0.002, 0.02, 0.2)):g}",
    )


def porous_matter(luck, numbers):
    """A foam: a fluid, or a metal."""
    kinds = (
        "material {name} fluid density={density}",
        "material {name} fluid density={density} viscosity={young}*0.01",
        "material {name} j2 density={density} young={young} poisson={poisson} yield={weak}",
        "material {name} johnson_cook density={density} young={young} poisson={poisson} yield={weak} "
        "hardening_modulus={young}/20",
    )
    lines = [luck.choice(kinds).format(**numbers), porous(luck, numbers)]
    if "fluid" in lines[0] and luck.random() < 0.3:
        lines.append(f"failure {numbers['name']} pmin={luck.choice(('0', '-{young}*0.01')).format(**numbers)}")
    return lines


def rubber(luck, numbers):
    """Mooney and Rivlin's, of the scene's modulus of shear."""
    part = luck.choice((0, 0.1, 0.3)) if numbers["poisson"] > 0 else 0  # poisson/(1 - 2 poisson) must be at least that
    shear = numbers["young"]/(4*(1 + numbers["poisson"]))
    return [
        (
            "material {name} mooney_rivlin density={density} poisson={poisson}"
            + f" c1={shear * (1 - part):g} c2={shear * part:g}"
        ).format(**numbers)
    ]


def soil(luck, numbers):
    """Mohr and Coulomb's."""
    cohesion = luck.choice(
        (
            "", " cohesion={young}*0.01", " cohesion={young}*0.003 tension={young}*0.001 dilatancy=10",
            " cohesion={young}*0.01 tension=0",
        )
    )
    return [
        (
            "material {name} mohr_coulomb density={density} young={young} poisson={poisson}"
            + f" friction={luck.choice((12, 20, 35, 60))}"
            + cohesion
        ).format(**numbers)
    ]


def linear(numbers):
    """The linear theory, in which faces keep their areas."""
    return ["material {name} elastic density={density} young={young} poisson={poisson} strain=small".format(**numbers)]


def matter(luck, numbers):
    """One of all these."""
    kinds = {
        "metal": metal,
        "porous": porous_matter,
        "rubber": rubber,
        "soil": soil,
        "linear": lambda _luck, numbers: linear(numbers),
    }
    return kinds[luck.choice(("metal", "metal", "porous", "porous", "rubber", "soil", "linear"))](luck, numbers)


def particle_file(luck, axes, lower, size, materials):
    """Text of a particle file for a block, whose particles are parted among materials, in any order and with any
    columns."""
    named = len(materials) > 1 or luck.random() < 0.7
    spacing, jitter = luck.choice((0.5, 0.5, 0.4)), luck.choice((0, 0, 0.1))
    counts = [int(side/spacing + 1e-9) for side in size]
    together = luck.random() < 0.3
    rings, moves = axes == "rz", luck.random() < 0.4
    rows = []
    for number in range(math.prod(counts)):
        place, rest = [], number
        for count, low in zip(counts, lower):
            place.append(low + spacing*(rest % count + 0.5 + jitter*(luck.random() - 0.5)))
            rest //= count
        volume = spacing**len(axes)*(2*math.pi*place[0] if rings else 1)
        part = luck.randrange(len(materials)) if together else len(materials)*number//math.prod(counts)
        rows.append({**dict(zip(axes, place)), "volume": volume, "material": materials[part], "id": 7*number % 4093,
                     **{f"velocity_{axis}": luck.choice((0, 0.1)) for axis in axes if moves}})
    luck.shuffle(rows)
    if not named:
        return "".join(
            " ".join(repr(number) for number in ([row[axis] for axis in axes] + [0.0, 0.0])[:3] + [row["volume"]])
            + "\n"
            for row in rows
        )
    columns = list(axes) + ["volume"] + [f"velocity_{axis}" for axis in axes if moves]
    columns += ["id"]*(luck.random() < 0.6) + ["material"]*(len(materials) > 1 or luck.random() < 0.5)
    luck.shuffle(columns)
    return ",".join(columns) + "\n" + "".join(",".join(str(row[name]) for name in columns) + "\n" for row in rows)


class Block:
    """What is known of a body: its box, whether it is all of it, how particles lie in it."""

    def __init__(self, lower, size, whole, layout):
        self.lower, self.size = lower, size
        self.lattice = "jitter" not in layout and "gauss" not in layout and layout != "file"
        self.filled = whole and layout.startswith("ppc=")  # by cubes, to its faces

    def area(self, axes, axis):
        """Of the face across an axis; about an axis of symmetry that of a ring, across z."""
        if axes == "rz":
            return math.pi*((self.lower[0] + self.size[0])**2 - self.lower[0]**2) if axis == "z" else math.nan
        return math.prod(side for other, side in zip(axes, self.size) if other != axis)


def force(luck, name, axes, block, faces, areas_stay, alone, table):
    """A card load, pressure or traction; and along which axes, by what factor of which function it pushes the scene,
    None where that is not known, which it always is in scenes that are `alone`."""
    ramp, place = Ramp(luck, luck.choice((0.003, 0.03, -0.03, 0.3)), table), luck.choice(("", "", "", "0", " "))
    varies = "" if alone else {"": "", "0": f"*(1+0.1*{axes[0]}0)", " ": f"*cos({axes[-1]})"}[place]
    where = luck.choice(("", "", f' where="{axes[-1]}>{block.lower[-1] + block.size[-1]/2:g}"'))
    axis, side = luck.choice(axes), luck.choice("-+")
    known = areas_stay and block.filled and not math.isnan(block.area(axes, axis)) and not varies
    kind = luck.choice(("load", "pressure", "traction") if faces and (known or not alone) else ("load",))
    if kind == "load":
        chosen = luck.sample(axes, luck.randint(1, len(axes)))
        words = [f'{axis}="{ramp.text()}{varies}"' for axis in chosen]
        return f"load {name} " + " ".join(words) + where, None if varies else [(axis, 1.0, ramp) for axis in chosen]
    face = "" if luck.random() < 0.3 and not alone else f" face={axis}{side}"
    where = "" if alone else where
    if kind == "pressure":
        card, area = f'pressure {name} p="{ramp.text()}{varies}"', {"-": 1.0, "+": -1.0}[side]
        pushed = [axis]
    else:
        pushed, area = luck.sample(axes, luck.randint(1, len(axes))), 1.0
        card = f"traction {name} " + " ".join(f'{along}="{ramp.text()}{varies}"' for along in pushed)
    known = known and face and not where
    return card + face + where, [(along, area*block.area(axes, axis), ramp) for along in pushed] if known else None
