"""What random scenes of the last seeds have beyond those of _newest.py: parts that are moved, walls that rub or let
waves out, crushable foam, Grady's spall, and every word of the method that corrects surfaces; of the seeds after those
concrete. As in _features.py each is drawn from a stream that its caller gives."""
from _features import vector

FOAM = ("material {name} crushable_foam density={density} young={young} poisson={poisson} plateau={plateau:g} "
        "plastic_poisson={lateral} densification_strain={closed}")
CONCRETE = ("material {name} concrete density={density} shear_modulus={shear:g} compressive_strength={strong:g} "
            "cohesive_strength={cohesion} pressure_hardening={hardening} pressure_exponent={exponent} "
            "tension_limit={tension:g} damage_strain={strain} crush_pressure={crush:g} crush_compression={start:g} "
            "lock_pressure={lock:g} lock_compression={closed} k1={dense:g}")
# Words of `method sgmp`, in the plane and in space; about an axis, on a line.
WORDS = ("", "", " surfaces=plain", " surfaces=corrected", " surfaces=corrected rotation=exact stress=normalised",
         " stress=plain rotation=plain surfaces=plain",
         " rotation=exact surfaces=plain", " stress=normalised surfaces=plain", " surfaces=corrected stress=normalised")


def foam(luck, numbers):
    """Deshpande and Fleck's foam, that begins to yield at once or late, and closes its pores or not."""
    young = numbers["young"]
    numbers = {**numbers, "plateau": young*luck.choice((0.003, 0.03)), "lateral": luck.choice((0, 0.1, 0.3)),
               "closed": luck.choice((0.1, 1))}
    more = luck.sample((f" linear_hardening={young*0.01:g}",
                        f" densification={young*0.02:g} densification_exponent={luck.choice((1, 3))}"),
                       luck.choice((0, 1, 2)))
    return [FOAM.format(**numbers) + "".join(more)]


def concrete(luck, numbers):
    """Holmquist, Johnson and Cook's, weak or strong, whose pores close soon or hardly, that breaks at once, slowly or
    hardly."""
    young, poisson = numbers["young"], numbers["poisson"]
    bulk, strong, closed = young/(3*(1 - 2*poisson)), young*luck.choice((0.001, 0.01,
                                                                         0.05)), luck.choice((0.02, 0.1, 0.3))
    crush = min(strong*luck.choice((0.1, 0.3, 1)), 0.1*bulk*closed)
    # Crushing is three times as soft as matter before it at least, and dense matter stiffer.
    lock = max(2*crush, bulk*closed*luck.choice((0.03, 0.1, 0.3)))
    numbers = {**numbers, "shear": young/(2*(1 + poisson)), "strong": strong, "cohesion": luck.choice((0, 0.3, 0.8)),
               "hardening": luck.choice((0, 0.5, 1.6)),
               "exponent": luck.choice((0, 0.6, 1)), "tension": strong*luck.choice((0, 0.1, 0.1, 1)),
               "strain": luck.choice((0, 0.001, 0.04, 1)),
               "crush": crush, "start": crush/bulk, "lock": lock, "closed": closed,
               "dense": max(3*bulk, 4*lock/closed)*(1 + closed)}
    more = luck.sample((" strength_limit=7", " rate_coefficient=0.007 reference_rate=0.01", " damage_exponent=0.5",
                        " least_damage_strain=0.01",
                        f" k2=-{bulk:g} k3={bulk:g}*2", f" k2={bulk:g}"), luck.choice((0, 1, 2, 3)))
    if sum("k2=" in word for word in more) > 1:
        more = [word for word in more if "k3=" not in word]
    return [CONCRETE.format(**numbers) + "".join(more)]


def spall(luck, numbers):
    """The card failure with Grady's ductile or brittle spall of a metal."""
    if luck.random() < 0.5:
        first = f"spall_strain={luck.choice((0.001, 0.15))}"
    else:
        least = f"-{numbers['young']}*{luck.choice((0.001, 0.01))}"
        first = f"pmin={least} toughness={numbers['young']*luck.choice((0.001, 0.03)):g}"
    return f"failure {numbers['name']} {first} carries={luck.choice(('nothing', 'pressure', 'everything'))}"


def walls(luck, card, axes, absorbs):
    """A wall card, some of whose slip walls let waves out instead, of a source, too, where they may; and cards of walls
    that rub."""
    words, more = card.split(), []
    for n, word in enumerate(words[1:], 1):
        face, kind = word.split("=")
        if kind != "slip":
            continue
        what = luck.choice(("", "absorbing", "rubs", "rubs"))
        if what == "absorbing" and absorbs:
            words[n] = f"{face}=absorbing"
        elif what == "rubs" and len(axes) > 1:
            more.append(f"wallfriction {face} friction={luck.choice((0.1, 0.5, 3))}")
    if any(word.endswith("=absorbing") for word in words) and len(axes) > 1 and luck.random() < 0.4:
        words.append("centre=" + vector([0 if axis == "r" else luck.choice((-3, 1, 4)) for axis in axes]))
    return " ".join(words), more


def moved(luck, name, axes, block, swirl=False):
    """A part of a body that is moved along some axes or turned about one, for good or for a while."""
    axis = luck.choice(axes)
    low, side = block.lower[axes.index(axis)], block.size[axes.index(axis)]
    place = luck.choice((f"{axis}<{low + 0.4*side:g}", f"{axis}>{low + 0.6*side:g}"))
    chosen = luck.sample(axes, luck.randint(1, len(axes)))
    ways = " ".join(f'{along}="{luck.choice(("0", "0.05", "0.1*sin(t)", "-0.1*min(t,1)"))}"' for along in chosen)
    if len(axes) == 3 and luck.random() < 0.3:
        ways = f"omega_z=0.05 about={vector(block.lower)}"
    if swirl:
        ways = luck.choice((ways, f"{ways} spin=0.05", 'spin="0.1*sin(t)"'))
    return f'motion {name} where="{place}" {ways}' + luck.choice(("", "", " until=1"))


def words(luck, dimension, absorbs):
    """Words of `method sgmp` that go with the rest of the scene."""
    allowed = WORDS if dimension > 1 else ("", " stress=plain", " stress=normalised")
    return luck.choice([words for words in allowed if not (absorbs and "surfaces=corrected" in words)])
