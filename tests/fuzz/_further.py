"""What random scenes of the last seeds have beyond those of _newest.py: parts that are moved, walls that rub or let waves out, crushable foam, Grady's spall,
and every word of the method that corrects surfaces. As in _features.py each is drawn from a stream that its caller gives."""
from _features import vector

FOAM = ("material {name} crushable_foam density={density} young={young} poisson={poisson} plateau={plateau:g} plastic_poisson={lateral} "
        "densification_strain={closed}")
# Words of `method sgmp`, in the plane and in space; about an axis, on a line.
WORDS = ("", "", " surfaces=plain", " surfaces=corrected", " surfaces=corrected rotation=exact stress=normalised", " stress=plain rotation=plain surfaces=plain",
         " rotation=exact surfaces=plain", " stress=normalised surfaces=plain", " surfaces=corrected stress=normalised")


def foam(luck, numbers):
    """Deshpande and Fleck's foam, that begins to yield at once or late, and closes its pores or not."""
    young = numbers["young"]
    numbers = {**numbers, "plateau": young*luck.choice((0.003, 0.03)), "lateral": luck.choice((0, 0.1, 0.3)), "closed": luck.choice((0.1, 1))}
    more = luck.sample((f" linear_hardening={young*0.01:g}", f" densification={young*0.02:g} densification_exponent={luck.choice((1, 3))}"), luck.choice((0, 1, 2)))
    return [FOAM.format(**numbers) + "".join(more)]


def spall(luck, numbers):
    """The card failure with Grady's ductile or brittle spall of a metal."""
    if luck.random() < 0.5:
        first = f"spall_strain={luck.choice((0.001, 0.15))}"
    else:
        first = f"pmin=-{numbers['young']}*{luck.choice((0.001, 0.01))} toughness={numbers['young']*luck.choice((0.001, 0.03)):g}"
    return f"failure {numbers['name']} {first} carries={luck.choice(('nothing', 'pressure', 'everything'))}"


def walls(luck, card, axes, rubs):
    """A wall card, some of whose slip walls let waves out instead; and cards of walls that rub, where they may."""
    words, more = card.split(), []
    for n, word in enumerate(words[1:], 1):
        face, kind = word.split("=")
        if kind != "slip":
            continue
        what = luck.choice(("", "absorbing", "rubs", "rubs"))
        if what == "absorbing":
            words[n] = f"{face}=absorbing"
        elif what and rubs and len(axes) > 1:
            more.append(f"wallfriction {face} friction={luck.choice((0.1, 0.5, 3))}")
    return " ".join(words), more


def moved(luck, name, axes, block):
    """A part of a body that is moved along some axes, for good or for a while."""
    axis = luck.choice(axes)
    low, side = block.lower[axes.index(axis)], block.size[axes.index(axis)]
    place = luck.choice((f"{axis}<{low + 0.4*side:g}", f"{axis}>{low + 0.6*side:g}"))
    chosen = luck.sample(axes, luck.randint(1, len(axes)))
    ways = " ".join(f'{along}="{luck.choice(("0", "0.05", "0.1*sin(t)", "-0.1*min(t,1)"))}"' for along in chosen)
    if len(axes) == 3 and luck.random() < 0.3:
        ways = f"omega_z=0.05 about={vector(block.lower)}"
    return f'motion {name} where="{place}" {ways}' + luck.choice(("", "", " until=1"))


def words(luck, dimension, rings, absorbs):
    """Words of `method sgmp` that go with the rest of the scene."""
    allowed = WORDS if dimension > 1 else ("", " stress=plain", " stress=normalised")
    return luck.choice([words for words in allowed if not (absorbs and "surfaces=corrected" in words or "rotation=exact" in words and rings)])
