"""Begin a run where another one stands: the state of a checkpoint as particle files for `body NAME file file=…` of a
deck.

    sgmp-view map charge.out/checkpoint_0000400.h5 --space 3 --sector 90 --merge 5
    sgmp-view map column.out/checkpoint_0000200.h5 --space 2 --axis y --across -20:20 --spacing 1
    sgmp-view map charge.out/checkpoint_0000400.h5 --bodies tnt,air --move 0,0,300

An axisymmetric run becomes a body of revolution about z, or a sector of it (--sector 90: the quarter x > 0, y > 0); a
run on a line is repeated across (--across, an interval for each new axis; about an axis the one along r), a plane run
along z. Every particle becomes particles that share its mass and volume; with --merge those of a body in one cube of
that side become one, which keeps mass, momentum and energy: what kinetic energy that takes becomes heat, or is printed
as lost where the material keeps no energy. A file for each body, with velocity, density, stress and what the material
keeps. Times of lighting are counted from the state on, so the new run begins at t = 0. Not mapped: bodies with a
deformation gradient (rubbers), rigid bodies.
"""

import json
from pathlib import Path

import numpy as np

from .files import Particles, SgmpFileError, open_hdf5, read_checkpoint
from .revolve import distance_of_rings, revolve, turned

SPACES = {"1": [0], "2": [0, 1], "axisymmetric": [0, 2], "3": [0, 1, 2]}
NAMES = {"1": ["x"], "2": ["x", "y"], "axisymmetric": ["r", "z"], "3": ["x", "y", "z"]}
STRESSES = ["xx", "yy", "zz", "xy", "yz", "xz"]
# What a new run finds out for itself, and what means nothing in it.
LEFT_OUT = (
    "id", "body", "mass", "volume", "velocity", "stress", "pressure", "density", "path", "surface", "spin", "swirl",
    "compliance", "initial", "stretch",
)


def space_of(path):
    """The space of a checkpoint by its axes, and what its bodies are."""
    with open_hdf5(path) as file:
        contents = json.loads(file["contents"][()])
    space = next(name for name, axes in SPACES.items() if [axis + 1 for axis in axes] == contents["axes"])
    return space, {body["name"]: {**body, "columns": body["columns"].split()} for body in contents["bodies"]}


def interval(text):
    """Two numbers a:b, a < b."""
    low, high = (float(word) for word in text.split(":"))
    if not low < high:
        raise ValueError(f"{text}: an interval is a:b with a < b")
    return low, high


def part_of(particles, chosen):
    """Some of the particles."""
    return Particles(
        particles.path,
        particles.points[chosen],
        {name: values[chosen] for name, values in particles.fields.items()},
        particles.components,
        particles.time,
        particles.body_names,
    )


def repeated(particles, axis, low, high, spacing, rings):
    """Every particle again and again along an axis; of rings along r, each with its share of the disc."""
    count = max(1, round((high - low) / spacing))
    edges = np.linspace(low, high, count + 1)
    sizes = np.pi * np.diff(edges**2) if rings else np.diff(edges)
    middles = np.sqrt((edges[1:] ** 2 + edges[:-1] ** 2) / 2) if rings else 0.5 * (edges[1:] + edges[:-1])
    result = part_of(particles, np.repeat(np.arange(len(particles.points)), count))
    result.points[:, axis] = np.tile(middles, len(particles.points))
    for name in ("mass", "volume"):
        result.fields[name] = result.fields[name] * np.tile(sizes, len(particles.points))
    return result


def placed_along(particles, axis):
    """A run on a line, along another axis."""
    turn = np.zeros((3, 3))
    for place in range(3):
        turn[(place + axis) % 3, place] = 1
    return turned(particles, np.broadcast_to(turn, (len(particles.points), 3, 3)), np.arange(len(particles.points)))


def to_space(particles, source, options, spacing):
    """The particles in the space asked for."""
    target = options.space or source
    if target == source:
        return particles, target
    if source == "axisymmetric" and target == "3":
        return revolve(particles, options.sector, spacing, middle=options.sector / 2), target
    if source in ("1", "2") and len(SPACES[target]) > len(SPACES[source]):
        rings = target == "axisymmetric"
        axis = SPACES[target]["xyz".index(options.axis)] if not rings else 2
        if source == "1":
            particles = placed_along(particles, axis)
        new = [a for a in SPACES[target] if a != axis] if source == "1" else [2]
        if len(options.across) != len(new):
            raise ValueError(
                f"--across needs {len(new)} intervals a:b, along "
                f"{' and '.join('rxyz'[1 + a] if not rings else 'r' for a in new)}"
            )
        for a, (low, high) in zip(new, options.across):
            particles = repeated(particles, a, low, high, spacing, rings)
        return particles, target
    raise ValueError(f"--space {target}: a run of space {source} becomes none of space {target}")


def merged(particles, spacing, density):
    """Particles of a body in one cube become one, at their centre of mass. What kinetic energy that takes heats it,
    where it keeps an energy; else it is lost."""
    cubes = np.floor(particles.points / spacing + 1e-9).astype(np.int64)
    keys = np.column_stack([particles.fields["body"], cubes])
    _, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.ravel()
    mass, volume = particles.fields["mass"], particles.fields["volume"]

    def total(values):
        return np.stack([np.bincount(group, column) for column in np.atleast_2d(values.T)], axis=-1).reshape(
            (-1,) + values.shape[1:]
        )

    masses, volumes = total(mass), total(volume)
    result = Particles(
        particles.path, total(particles.points * mass[:, None]) / masses[:, None], components=particles.components,
        time=particles.time, body_names=particles.body_names,
    )
    for name, values in particles.fields.items():
        weight, whole = (volume, volumes) if name == "stress" else (mass, masses)
        shape = (-1,) + (1,) * (values.ndim - 1)
        result.fields[name] = total(values * weight.reshape(shape)) / whole.reshape(shape)
    result.fields["mass"], result.fields["volume"], result.fields["density"] = masses, volumes, masses / volumes
    taken = total(0.5 * mass * (particles.fields["velocity"] ** 2).sum(axis=1)) - 0.5 * masses * (
        result.fields["velocity"] ** 2
    ).sum(axis=1)
    if "energy" in result.fields:                       # per initial volume
        result.fields["energy"] = result.fields["energy"] + taken * density / masses
    return result, float(taken.sum())


def kinetic(particles):
    """Kinetic energy."""
    return 0.5 * float((particles.fields["mass"] * (particles.fields["velocity"] ** 2).sum(axis=1)).sum())


def columns_of(particles, space, kept):
    """Names and values of a particle file."""
    axes = SPACES[space]
    names = NAMES[space] + ["volume", "density"] + [f"velocity_{axis}" for axis in NAMES[space]]
    fields = particles.fields
    values = [*particles.points[:, axes].T, fields["volume"], fields["density"], *fields["velocity"][:, axes].T]
    if "stress" in fields:
        for number, component in enumerate(STRESSES):
            if number < 3 or set("xyz".index(c) for c in component) <= set(axes):
                names.append(f"stress_{component}")
                values.append(fields["stress"][:, number])
    for name, column in fields.items():
        if name.split("+")[0] in LEFT_OUT or name not in kept:  # the first of several columns has a bare name
            continue
        names.append(name)
        values.append(column - particles.time if name == "lighting_time" else column)
    return names, np.column_stack(values)


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "source", type=Path, metavar="CHECKPOINT", help="checkpoint_NNNNNNN.h5 of a run (card checkpoint)"
    )
    parser.add_argument("--space", choices=list(SPACES), help="dimension of the new scene (default: that of the run)")
    parser.add_argument(
        "--spacing", type=float,
        help="distance of the new particles along circles and across (default: that of the run's)",
    )
    parser.add_argument(
        "--merge", type=float, metavar="SIDE",
        help="particles of a body in a cube of this side become one (default: none do)",
    )
    parser.add_argument(
        "--sector", type=float, default=360.0, metavar="DEGREES",
        help="from axisymmetric to 3: the angle from the plane y = 0 on (default: 360)",
    )
    parser.add_argument(
        "--axis", choices=list("xyz"), default="x",
        help="along which a run on a line lies in the new scene (default: x; about an axis always z)",
    )
    parser.add_argument(
        "--across", type=lambda text: [interval(part) for part in text.split(",")], default=[], metavar="A:B[,C:D]",
        help="intervals that a run on a line or in the plane fills along the new axes",
    )
    parser.add_argument(
        "--move", type=lambda text: np.array([float(word) for word in text.split(",")]), default=np.zeros(3),
        metavar="X,Y,Z", help="added to all places",
    )
    parser.add_argument("--bodies", help="names with commas between them (default: all)")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="STEM", help="files STEM_BODY.txt (default: beside the checkpoint, map)"
    )


def chosen_bodies(options, particles, bodies):
    """Names of the bodies that are mapped; an error where one cannot be."""
    wanted = options.bodies.split(",") if options.bodies else particles.body_names
    for name in wanted:
        if name not in particles.body_names:
            raise ValueError(f"--bodies: there is no body '{name}'; there are: {', '.join(particles.body_names)}")
        if "deformation" in bodies[name]["columns"]:
            raise SgmpFileError(
                f"{options.source}: body '{name}' has a deformation gradient, which is not mapped; choose others by "
                f"--bodies"
            )
    return wanted


def run(options):
    """Writes the particle files and prints what they hold."""
    source, bodies = space_of(options.source)
    everything = read_checkpoint(options.source)
    for name in ("spacing", "merge"):
        if getattr(options, name) is not None and not getattr(options, name) > 0:
            raise ValueError(f"--{name} {getattr(options, name):g} is not positive")
    stem = options.output or options.source.with_name("map")
    for name in chosen_bodies(options, everything, bodies):
        body = part_of(everything, everything.bodies[name])
        if len(body.points) == 0:
            print(f"body {name}: has no particles left")
            continue
        if options.space == "axisymmetric" and np.abs(body.fields.get("swirl", 0)).max() > 0:
            raise SgmpFileError(f"{options.source}: body '{name}' turns around the axis, which is not mapped to rings")
        spacing = options.spacing or distance_of_rings(body.points)
        mapped, space = to_space(body, source, options, spacing)
        lost = 0.0
        if options.merge:
            mapped, lost = merged(mapped, options.merge, bodies[name]["density"])
        mapped.points = mapped.points + options.move
        path = Path(f"{stem}_{name}.txt")
        names, values = columns_of(mapped, space, bodies[name]["columns"])
        with open(path, "w", encoding="utf-8") as file:
            file.write(" ".join(names) + "\n")
            np.savetxt(file, values, fmt="%.17g")
        report(path, name, mapped, lost, options.merge or spacing)


def report(path, name, mapped, lost, spacing):
    """What a file holds, and the line for the deck."""
    mass = mapped.fields["mass"]
    momentum = (mass[:, None] * mapped.fields["velocity"]).sum(axis=0)
    print(
        f"{path}: {len(mass)} particles at t = {mapped.time:.6g}, mass {mass.sum():.10g}, momentum "
        f"({', '.join(f'{p:.6g}' for p in momentum)}), "
        f"kinetic energy {kinetic(mapped):.6g}"
        + (
            f" (merging took {lost:.3g}{', which is heat now' if 'energy' in mapped.fields else ''})"
            if lost > 0
            else ""
        )
    )
    print(f'  body {name} file material=… file="{path.name}" spacing={spacing:.6g}')
