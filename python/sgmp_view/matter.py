"""The matter of a run at one time: particles with masses, bodies by name, what has failed, planes of symmetry."""

import re
from dataclasses import dataclass, field
from typing import Dict, List, Optional, Tuple

import numpy as np

from .coarse import divided
from .files import SgmpFileError, dumps_of, folder_of, read_dump, read_summary_if_any, read_table
from .turning import cloud_of

AXES = "xyz"
NO_DAMAGE = "the dump has no field damage, so that failed matter counts as whole: add damage to the fields of `output`"
EQUAL_MASSES = (
    "the dump has no field mass: particles of a body have equal shares of its mass"
    " (in axisymmetric scenes by their first radius)"
)


@dataclass
class Matter:
    """Particles at one time. Masses are those of the whole body in axisymmetric scenes, else of the modelled part."""

    points: np.ndarray
    velocity: np.ndarray
    mass: np.ndarray
    body: np.ndarray  # number, 1, 2, …
    failed: np.ndarray  # bool
    names: List[str]  # of bodies
    time: Optional[float]
    cell: float
    spacing: float
    dimension: int  # 1, 2, 3; 2 where axisymmetric
    is_round: bool  # axisymmetric
    planes: Dict[int, Tuple[float, int]] = field(
        default_factory=dict
    )  # axis: place and side (-1: matter lies above it)
    notes: List[str] = field(default_factory=list)
    fluids: List[str] = field(default_factory=list)  # bodies of a fluid or an explosive, which have no pieces

    @property
    def solids(self):
        """Names of the bodies that are neither fluid nor explosive."""
        return [name for name in self.names if name not in self.fluids]

    @property
    def axes(self):
        """The axes of space that the scene has."""
        return [0, 2] if self.is_round else list(range(self.dimension))

    def of(self, name):
        """Which particles are of a body."""
        if name not in self.names:
            raise SgmpFileError(f"no body '{name}'; there are: {', '.join(self.names)}")
        return self.body == self.names.index(name) + 1


def cards_of(folder):
    """The cards of the deck in the log of a run, lines that go on joined."""
    log = folder / "run.log"
    lines = log.read_text(errors="replace").splitlines()[2:] if log.exists() else []
    lines = lines[: lines.index("")] if "" in lines else lines
    return [line for line in re.sub(r"\s*&\n\s*", " ", "\n".join(lines)).splitlines() if not line.startswith("!")]


def space_of(folder, points):
    """What the deck says of its dimension; of a run that has not ended by its log, without one by its particles."""
    said = read_summary_if_any(folder).get("dimension")
    for card in [] if said else cards_of(folder):
        if card.startswith("dimension "):
            return card.split()[1]
    return said or max(1, int(np.count_nonzero(np.ptp(points, axis=0) > 0)))


def fluids_of(folder):
    """Names of bodies whose material is a fluid or an explosive."""
    words = [card.split() for card in cards_of(folder)]
    flow = {card[1] for card in words if card[0] == "material" and len(card) > 2 and card[2] in ("fluid", "explosive")}
    of_body = {
        card[1]: word[9:] for card in words if card[0] == "body" for word in card if word.startswith("material=")
    }
    return [name for name, material in of_body.items() if material in flow]


def planes_of(folder, points, spacing):
    """Planes of symmetry: a slip wall that matter touches, where the other end of the axis has none."""
    walls, bounds = {}, {}
    for card in cards_of(folder):
        word, _, rest = card.partition(" ")
        if word == "wall":
            walls.update(re.findall(r"([xyz][-+])=(\w+)", rest))
        elif word == "grid":
            bounds.update(
                {
                    axis: (low, high)
                    for axis, low, high in re.findall(r"\b([xyz])=([-+.\deE]+|open):([-+.\deE]+|open)", rest)
                }
            )
    planes = {}
    for k, axis in enumerate(AXES):
        for side, (sign, other) in enumerate((("-", "+"), ("+", "-"))):
            place = bounds.get(axis, ("open", "open"))[side]
            if (
                walls.get(axis + sign) != "slip"
                or walls.get(axis + other) == "slip"
                or place == "open"
                or np.ptp(points[:, k]) == 0
            ):
                continue
            nearest = points[:, k].min() if side == 0 else points[:, k].max()
            if abs(nearest - float(place)) <= 1.5 * spacing:
                planes[k] = (float(place), 2 * side - 1)
    return planes


def mass_of_bodies(folder, time):
    """Mass of each body, by its number, in the row of bodies.csv that is nearest in time; none without the file."""
    if not (folder / "bodies.csv").exists():
        return {}
    table = read_table(folder / "bodies.csv")
    masses = {}
    for number in np.unique(table["body"]):
        rows = np.flatnonzero(table["body"] == number)
        row = rows[-1] if time is None else rows[np.argmin(np.abs(table["time"][rows] - time))]
        masses[int(number)] = float(table["mass"][row])
    return masses


def shares_of(cloud, first, is_round):
    """What a particle has of the mass of its body, up to a factor, and whether the dump says so."""
    fields = cloud.fields
    if "mass" in fields:
        return fields["mass"], True
    if "density" in fields and "volume" in fields:
        return fields["density"] * fields["volume"], True
    shares = first_radii(cloud, first) if is_round else np.ones(len(cloud.points))
    return shares / parts_of_one(fields, len(shares)), False


def first_radii(cloud, first):
    """Radii of particles at the start, as far as they are known."""
    fields = cloud.fields
    if "initial_position" in fields:
        return np.maximum(fields["initial_position"][:, 0], 1e-300)
    if first is None or "id" not in fields or "id" not in first.fields:
        return np.maximum(cloud.points[:, 0], 1e-300)
    radius = np.zeros(int(max(fields["id"].max(), first.fields["id"].max())) + 1)
    radius[first.fields["id"].astype(int)] = first.points[:, 0]
    return np.maximum(radius[fields["id"].astype(int)], 1e-300)


def parts_of_one(fields, number):
    """Into how many parts the particle has been split that each was at the start; they share its id."""
    if "id" not in fields:
        return np.ones(number)
    _, place, counts = np.unique(fields["id"], return_inverse=True, return_counts=True)
    return counts[place.reshape(-1)]


def matter_of(folder, cloud, first=None):
    """The matter of one dump of a run; `first`: its first dump, where there is one."""
    if first is not None:
        cloud, first = divided(folder, cloud, first), divided(folder, first, first)
    summary = read_summary_if_any(folder)
    dimension = space_of(folder, cloud.points)
    is_round = dimension == "axisymmetric"
    body = cloud.fields.get("body", np.ones(len(cloud.points), int)).astype(int)
    table = read_table(folder / "bodies.csv") if (folder / "bodies.csv").exists() else {}
    names = {int(number): str(name) for number, name in zip(table.get("body", ()), table.get("name", ()))}
    names = [names.get(number, str(number)) for number in range(1, max([*names, int(body.max(initial=1))]) + 1)]
    shares, is_given = shares_of(cloud, first, is_round)
    mass = np.array(shares, float)
    for number, total in mass_of_bodies(folder, cloud.time).items():
        own = body == number
        if own.any():
            mass[own] *= total / mass[own].sum()
    notes = [] if is_given else [EQUAL_MASSES]
    failed = cloud.fields["damage"] >= 1 - 1e-9 if "damage" in cloud.fields else np.zeros(len(cloud.points), bool)
    if "damage" not in cloud.fields and any(
        card.startswith("failure ") or "failure=yes" in card for card in cards_of(folder)
    ):
        notes.append(NO_DAMAGE)
    spacing = float(summary.get("spacing") or spacing_of(cloud.points if first is None else first.points))
    start = cloud if first is None else first
    return Matter(
        cloud.points,
        cloud.fields.get("velocity", np.zeros_like(cloud.points)),
        mass,
        body,
        failed,
        names,
        cloud.time,
        float(summary.get("h") or 2 * spacing),
        spacing,
        2 if is_round else int(dimension),
        is_round,
        {} if is_round else planes_of(folder, start.points, spacing),
        notes,
        fluids_of(folder),
    )


def spacing_of(points):
    """Median distance to the nearest neighbour of some particles."""
    sample = points[np.linspace(0, len(points) - 1, min(len(points), 100)).astype(int)]
    squares = ((sample[:, None] - points[None]) ** 2).sum(axis=2)
    squares[squares == 0] = np.inf
    return float(np.sqrt(np.median(squares.min(axis=1))))


def start_and_dump(source, step="last"):
    """The matter of the first dump and that of the wanted one."""
    folder = folder_of(source)
    dumps = dumps_of(folder)
    first = cloud_of(folder, dumps[0].read()) if dumps else None
    cloud = cloud_of(folder, read_dump(source, step))
    if first is None:
        raise SgmpFileError(
            f"{folder}: no dumps, so no state at the start (add `output vtu every=…` or `output vtkhdf every=…`)"
        )
    return matter_of(folder, first, first), matter_of(folder, cloud, first)
