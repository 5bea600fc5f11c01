"""What random scenes are made of beyond blocks of four solids: fluids, failure and erosion, shapes, motions. Each is
drawn from a stream of random numbers that its caller gives, and is the text of cards; nothing here knows the rest of
the scene.

Stiffnesses count in the scene's Young's modulus, so that soft and stiff matter fail and flow alike."""
import math

FLUIDS = {
    "ideal_gas": "eos {name} ideal_gas gamma={gamma} pressure0={young}*{part}",
    "tait": "eos {name} tait c0=sqrt({young}/{density}) pressure0={young}*{part}/10",
    "stiffened_gas": "eos {name} stiffened_gas gamma=4.4 p_inf={young}/4 pressure0={young}*{part}/10",
    "gruneisen": "eos {name} gruneisen c0=sqrt({young}/{density}) s=1.5 gamma0=1",
    "shock": "eos {name} shock c0=sqrt({young}/{density}) s=1.9 gamma0=0.3",
    "polynomial": "eos {name} polynomial a1={young} a2={young} b0=0.3 b1=0.3",
}


def vector(components):
    """Components as a deck writes them."""
    return "(" + ",".join(f"{component:.6g}" for component in components) + ")"


def fluid(luck, numbers):
    """A gas or a liquid, inviscid or Newtonian, with its cards."""
    numbers = {**numbers, "gamma": luck.choice((1.4, 1.667, 3)), "part": luck.choice((0.03, 0.1))}
    kind = luck.choice(list(FLUIDS))
    viscosity = luck.choice(("", "", " viscosity={young}*0.003", " viscosity={young}*0.1"))
    lines = [("material {name} fluid density={density}" + viscosity).format(**numbers), FLUIDS[kind].format(**numbers)]
    if kind != "ideal_gas" and luck.random() < 0.4:
        lines.append(f"failure {numbers['name']} pmin={luck.choice(('0', '-{young}*0.01')).format(**numbers)}")
    if luck.random() < 0.5:
        lines.append(f"viscosity {numbers['name']} quadratic=1.5 linear={luck.choice((0.06, 0.3))}")
    return lines


def soil(luck, numbers):
    """Drucker and Prager's."""
    cohesion = luck.choice(("", " cohesion={young}*0.01", " cohesion={young}*0.003 tension={young}*0.001 dilatancy=10"))
    return [
        (
            "material {name} drucker_prager density={density} young={young} poisson={poisson} friction=30" + cohesion
        ).format(**numbers)
    ]


def damage_constants(luck, line):
    """Johnson and Cook's material with their damage."""
    first = luck.choice((0.003, 0.03))
    return line.replace(" density=", f" failure=yes d1={first} d2={first} d3=-1.5 density=", 1)


def failure(luck, numbers, damages, cell_energy):
    """The card failure of a plastic material. A crack takes more energy than a cell holds: multiples of what is given
    per area."""
    words = [f"failure {numbers['name']}"]
    criteria = {"pmin": f"pmin=-{numbers['young']}*{luck.choice((0.003, 0.02))}",
                "principal_stress": f"principal_stress={numbers['young']}*{luck.choice((0.003, 0.02))}",
                "plastic_strain": f"plastic_strain={luck.choice((0.003, 0.03, 0.3))}"}
    words += [criteria[name] for name in luck.sample(list(criteria), luck.choice((1, 1, 2)))]
    carries = luck.choice(("nothing", "pressure", "everything"))
    words.append(f"carries={carries}")
    if carries != "everything" and not damages and luck.random() < 0.5:
        words.append(f"fracture_energy={cell_energy*luck.choice((1, 3)):g}")
    if luck.random() < 0.4:
        words.append(f"weibull={luck.choice((2, 8))} seed={luck.randint(0, 3)}")
    return " ".join(words)


def erosion(luck, name, plastic, fails, shortest):
    """The card erode with one or two criteria, none where the material meets none."""
    criteria = [f"time_step={shortest:g}"] if shortest else []
    if plastic:
        criteria += [f"plastic_strain={luck.choice((0.003, 0.03))}"]*2
    if fails:
        criteria += ["failed=yes"]*3
    if not criteria:
        return []
    return [" ".join([f"erode {name}"] + sorted(set(luck.sample(criteria, min(len(criteria), luck.choice((1, 2)))))))]


def shape(luck, dimension, rings, lower, size):
    """A shape in a box, and the cards that change it; lower and size of the box. {name} is the body."""
    upper = [low + side for low, side in zip(lower, size)]
    if dimension == 1:
        kinds = ["row"]
    elif rings:
        kinds = ["row", "polygon", "hole"]
    else:
        kinds = ["row", "polygon", "turned", "turned", "hole"] + ["revolved"]*(2*dimension - 4)
    return SHAPES[luck.choice(kinds)](luck, dimension, lower, upper, size)


def row(luck, dimension, lower, upper, size):
    """Copies of a block along the first axis, touching each other or not."""
    copies = luck.choice((2, 3))
    offset = size[0]/copies
    first = [lower[0] + offset*luck.choice((1, 1, 0.6)), *upper[1:]]
    return (
        f"block lower={vector(lower)} upper={vector(first)} copies={copies} "
        f"offset={vector([offset] + [0] * (dimension - 1))}",
        [],
    )


def polygon(luck, dimension, lower, upper, size):
    """A triangle, an angle or an arrow; in space with a length."""
    corners = luck.choice(
        (
            ((0, 0), (1, 0), (0.3, 1)), ((0, 0), (1, 0), (1, 0.4), (0.4, 0.4), (0.4, 1), (0, 1)),
            ((0, 0), (0.5, 0.3), (1, 0), (0.5, 1)),
        )
    )
    length = f" centre={vector([0, 0, lower[2]])} length={upper[2] - lower[2]:g}" if dimension == 3 else ""
    return "polygon corners=" + ",".join(
        vector([low + part * side for low, part, side in zip(lower, corner, size)]) for corner in corners
    ) + length, []


def revolved(luck, _dimension, lower, _upper, size):
    """A cone, or a bottle that is hollow, about one of the axes."""
    along = luck.randint(0, 2)
    radius = min(side for axis, side in enumerate(size) if axis != along)/2
    corners = luck.choice(
        (((0, 0), (1, 0), (0, 1)), ((0, 0), (1, 0), (1, 0.7), (0.4, 1), (0, 1)), ((0.4, 0), (1, 0), (1, 1), (0.6, 1)))
    )
    centre = [low if axis == along else low + side/2 for axis, (low, side) in enumerate(zip(lower, size))]
    axis = vector([1.0 if axis == along else 0.0 for axis in range(3)])
    return (f"revolved centre={vector(centre)} axis={axis} corners=" +
            ",".join(vector([distance*radius, height*size[along]]) for distance, height in corners)), []


def turned(luck, dimension, lower, upper, size):
    """A block that is turned about its middle, and smaller, so that it stays in the box."""
    angle = luck.choice((30, 45, 90, -10))
    axis = luck.choice(((0, 0, 1), (1, 0, 0), (0, 1, 1), (1, 2, 3))) if dimension == 3 else (0, 0, 1)
    matrix = rotation(math.radians(angle), axis)
    part = min(side/sum(abs(matrix[a][b])*other for b, other in enumerate(size)) for a, side in enumerate(size))
    middle = [(low + high)/2 for low, high in zip(lower, upper)]
    text = (
        f"block lower={vector([at - part * side / 2 for at, side in zip(middle, size)])} "
        f"upper={vector([at + part * side / 2 for at, side in zip(middle, size)])} "
        f"rotation={angle} pivot={vector(middle)}"
    )
    return text + (f" rotation_axis={vector(axis)}" if dimension == 3 else ""), []


def hole(luck, dimension, lower, upper, size):
    """A block with a part cut away, a second one added or only what both have kept."""
    middle = [(low + high)/2 for low, high in zip(lower, upper)]
    radius = 0.45*min(size)
    third = [low + side/3 for low, side in zip(lower, size)]
    cards = [
        f"subtract {{name}} sphere centre={vector(middle)} radius={radius:g}",
        f"intersect {{name}} sphere centre={vector(middle)} radius={1.1 * radius:g}",
        f"subtract {{name}} block lower={vector(lower)} upper={vector(third)} copies=2 "
        f"offset={vector([size[0] / 2] + [0] * (dimension - 1))}",
    ]
    return f"block lower={vector(lower)} upper={vector(upper)}", [luck.choice(cards if min(size) > 1 else cards[1:2])]


SHAPES = {"row": row, "polygon": polygon, "revolved": revolved, "turned": turned, "hole": hole}


def rotation(angle, axis):
    """Rodrigues' matrix."""
    length = math.sqrt(sum(component**2 for component in axis))
    x, y, z = (component/length for component in axis)
    c, s = math.cos(angle), math.sin(angle)
    return [
        [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
        [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
        [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
    ]


def turning(luck, dimension, formula):
    """Words of an angular velocity, a number or a function of time, about the centre of mass or a point."""
    axes = luck.sample("xyz", luck.choice((1, 3))) if dimension == 3 else "z"
    speeds = ("0.05", "0.3", '"0.4*cos(3*t)"', '"0.2*min(t,1)"') if formula else ("0.02", "0.1", "-0.5")
    words = [f"omega_{axis}={luck.choice(speeds)}" for axis in axes]
    if luck.random() < 0.4:
        words.append(f"about={vector([luck.choice((0, 3, 5)) for _ in range(dimension)])}")
    return " " + " ".join(words)
