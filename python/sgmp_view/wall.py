"""A wall that has been hit: opening, crater, bulge, detached pieces, debris behind it and ejecta before it.

All is measured along the normal of the wall, in the direction of the shot. The wall is the largest connected piece of
its body that has not failed: particles that are at most a cell apart are connected. (In the plane, where a slot cuts
a wall in two, all pieces that reach its edges.) Surfaces are maps over the plane across the normal; gaps between
particles narrower than two cells count as closed, for metal that flows opens such gaps; narrower openings and craters
are not seen. Craters are where the wall is thinner by more than half a spacing, bulges where the rear surface stands
out by more than that. Where matter between the two has failed, the wall is in layers. Parts of a model behind planes
of symmetry are added for these maps; masses and momenta are those of the model.
"""

import numpy as np

from .files import SgmpFileError
from .pieces import pieces_of

MOST_PIXELS = 1500000
EDGE = 0.8  # the farthest fifth of a wall shows by how much it has moved as a whole
AT_EDGE = 0.9  # of the half width: what reaches so far is held at the edge
SLOW = 0.01  # of the speed of the shot: what is slower does not leave the wall
FOREMOST = 0.02  # share of the mass of a cloud that is its front, and its rear


class Shot:
    """What flies at the start: bodies, direction, speed, the point through which its centre passes."""

    def __init__(self, start, along=None):
        momentum = {
            name: start.mass[start.of(name)] @ start.velocity[start.of(name)]
            for name in start.names
            if start.of(name).any()
        }
        mass = {name: start.mass[start.of(name)].sum() for name in momentum}
        velocity = {name: momentum[name] / mass[name] for name in momentum}
        if start.is_round:  # the mean of radial velocities says nothing
            velocity = {name: v * (0, 0, 1) for name, v in velocity.items()}
        fastest = max((np.linalg.norm(v) for v in velocity.values()), default=0.0)
        self.bodies = [name for name, v in velocity.items() if np.linalg.norm(v) > 0.5 * fastest > 0]
        self.velocity, self.speed, self.centre = np.zeros(3), 0.0, None
        if self.bodies:
            total = sum(mass[name] for name in self.bodies)
            self.velocity = sum(momentum[name] for name in self.bodies) / total * ((0, 0, 1) if start.is_round else 1)
            self.speed = float(np.linalg.norm(self.velocity))
            own = np.isin(start.body, [start.names.index(name) + 1 for name in self.bodies])
            self.centre = start.mass[own] @ start.points[own] / start.mass[own].sum()
            if start.is_round:
                self.centre[0] = 0.0
            for k, (place, _) in start.planes.items():  # a half or a quarter flies on its plane of symmetry
                if start.points[own, k].min() - start.spacing <= place <= start.points[own, k].max() + start.spacing:
                    self.centre[k] = place
                    self.velocity[k] = 0.0
        self.direction = along
        if along is None and self.speed > 0:
            self.direction = self.velocity / np.linalg.norm(self.velocity)

    def targets(self, start):
        """Solid bodies that rest while others fly."""
        return [name for name in start.solids if name not in self.bodies and start.of(name).any()]


def normal_of(start, name, shot):
    """Normal of a wall along the shot: where it is thin; of thick bodies the axis nearest to the shot."""
    points = start.points[start.of(name)]
    if shot.direction is None:
        raise SgmpFileError("nothing flies at the start: give the direction by --along")
    axes = start.axes
    if start.is_round:
        return np.array([0.0, 0.0, np.sign(shot.direction[2]) or 1.0])
    if len(axes) == 1:
        return np.array([np.sign(shot.direction[0]) or 1.0, 0.0, 0.0])
    values, vectors = np.linalg.eigh(np.cov(points[:, axes].T))
    normal = np.zeros(3)
    if values[0] < 0.25 * values[1]:
        normal[axes] = vectors[:, 0]
    else:
        normal[int(np.argmax(np.abs(shot.direction)))] = 1.0
    if np.max(np.abs(normal)) > 0.999:
        normal = np.round(normal)
    return normal * (np.sign(normal @ shot.direction) or 1.0)


def across_of(normal, axes):
    """Directions across the normal that the scene has."""
    across = []
    for k in sorted(axes, key=lambda k: abs(normal[k])):
        vector = np.eye(3)[k] - normal[k] * normal
        for other in across:
            vector = vector - (vector @ other) * other
        if np.linalg.norm(vector) > 1e-6 and len(across) < len(axes) - 1:
            across.append(vector / np.linalg.norm(vector))
    return np.array(across).reshape(-1, 3)


# ---------------------------------------------------------------- maps across the normal


class Maps:
    """Pixels over the plane across the normal (over a line in two dimensions); surfaces by them."""

    def __init__(self, places, spacing, cell, is_round):
        self.count = places.shape[1]
        self.reach, self.back = cell, cell - 0.5 * spacing
        self.pixel = 0.5 * spacing / (1 if self.count > 1 else 2)
        if self.count:
            lower, upper = places.min(axis=0) - 2 * cell, places.max(axis=0) + 2 * cell
            self.pixel = max(self.pixel, float(np.prod(upper - lower) / MOST_PIXELS) ** (1 / self.count))
            self.lower = (
                np.floor(lower / self.pixel - 0.5) * self.pixel + 0.5 * self.pixel
            )  # a line of particles falls into the middle of pixels
            self.shape = tuple(int(n) for n in np.ceil((upper - self.lower) / self.pixel))
        else:
            self.lower, self.shape = np.zeros(0), ()
        self.is_round = is_round
        grids = np.meshgrid(
            *(self.lower[k] + (np.arange(n) + 0.5) * self.pixel for k, n in enumerate(self.shape)), indexing="ij"
        )
        self.centres = np.stack(grids, axis=-1) if self.count else np.zeros((0,))
        self.area = np.full(self.shape, self.pixel**self.count)
        if is_round:
            self.area = np.pi * self.pixel * np.abs(self.centres[..., 0])  # both sides of the axis: half a ring each

    def inside(self, places):
        """Which places lie on the map."""
        return np.all((places >= self.lower) & (places < self.lower + np.array(self.shape) * self.pixel), axis=1)

    def least(self, places, heights):
        """The lowest particle of each pixel with the gaps between particles closed; infinite where there is none."""
        surface = np.full(self.shape, np.inf)
        on_map = self.inside(places)
        index = tuple(np.floor((places[on_map] - self.lower) / self.pixel).astype(int).T)
        np.minimum.at(surface, index, heights[on_map])
        widened = self.filtered(surface, self.reach, np.minimum, np.inf)
        return self.filtered(widened, self.back, np.maximum, -np.inf)

    def filtered(self, values, radius, choose, beyond):
        """Least or largest value within a disc around each pixel."""
        n = int(np.floor(radius / self.pixel + 1e-9))
        padded = np.pad(values, n, constant_values=beyond) if self.count else values
        result = values.copy()
        steps = np.arange(-n, n + 1)
        for offset in np.stack(np.meshgrid(*[steps] * self.count, indexing="ij"), -1).reshape(-1, self.count):
            if (offset**2).sum() * self.pixel**2 <= radius**2 * (1 + 1e-9):
                choose(result, padded[tuple(slice(n + o, n + o + m) for o, m in zip(offset, self.shape))], out=result)
        return result

    def regions(self, mask):
        """Connected regions of a mask, as masks, the largest first."""
        index = np.argwhere(mask)
        piece = pieces_of(index.astype(float), 1.01)
        regions = []
        for number in range(piece.max(initial=-1) + 1):
            region = np.zeros(self.shape, bool)
            region[tuple(index[piece == number].T)] = True
            regions.append(region)
        return sorted(regions, key=lambda region: -self.area[region].sum())

    def size(self, region):
        """Area (in two dimensions width), diameter of the circle of this area, and of the largest circle in it."""
        area = float(self.area[region].sum())
        across = area if self.count == 1 and not self.is_round else 2 * float(np.sqrt(area / np.pi))
        return {"area": area, "diameter": across, "circle": self.circle(region)}

    def circle(self, region):
        """Diameter of the largest circle in a region (of the largest gap in two dimensions)."""
        if not region.any():
            return 0.0
        edge = self.filtered(region.astype(float), self.pixel, np.maximum, 0.0) > region
        rim, own = self.centres[edge], self.centres[region]
        if len(own) > 4000:
            own = own[:: len(own) // 4000 + 1]
        nearest = 0.0
        for part in np.array_split(own, max(1, len(own) * len(rim) // 4000000)):
            nearest = max(nearest, float(((part[:, None] - rim[None]) ** 2).sum(axis=2).min(axis=1).max()))
        return max(2 * np.sqrt(nearest) - self.pixel, 0.0)


def completed(points, matter, normal):
    """Points with their images behind planes of symmetry, for scenes about an axis those on its other side."""
    if matter.is_round:
        return np.vstack([points, points * (-1, 1, 1)])
    for k, (place, _) in matter.planes.items():
        if abs(normal[k]) < 1e-6:
            image = points.copy()
            image[:, k] = 2 * place - image[:, k]
            points = np.vstack([points, image])
    return points


# ---------------------------------------------------------------- what is measured


def largest_piece(matter, own):
    """Which particles are of the largest piece of a body, and the number of the piece of each whole particle."""
    whole = own & ~matter.failed
    piece = np.full(len(own), -1)
    piece[whole] = pieces_of(matter.points[whole], matter.cell * (1 + 1e-9))
    if not whole.any():
        return whole, piece
    heaviest = int(np.argmax(np.bincount(piece[whole], matter.mass[whole])))
    return whole & (piece == heaviest), piece


def cloud_of(matter, chosen, normal, middle, across):
    """Mass, momentum, speeds of front and rear, radius of some particles."""
    mass = matter.mass[chosen]
    if mass.sum() == 0:
        return None
    depth, speed = matter.points[chosen] @ normal, matter.velocity[chosen] @ normal
    radius = np.linalg.norm((matter.points[chosen] - middle) @ across.T, axis=1)
    order = np.argsort(depth)
    below = np.cumsum(mass[order]) - 0.5 * mass[order]

    def end(wanted):
        own = order[wanted]
        return float(mass[own] @ speed[own] / mass[own].sum())

    share = FOREMOST * mass.sum()
    rear, front = below <= max(share, below[0]), below >= min(mass.sum() - share, below[-1])
    by_radius = np.argsort(radius)
    return {
        "mass": float(mass.sum()),
        "momentum": float(mass @ speed),
        "velocity": float(mass @ speed / mass.sum()),
        "kinetic_energy": float(0.5 * mass @ (matter.velocity[chosen] ** 2).sum(axis=1)),
        "front_speed": end(front),
        "rear_speed": end(rear),
        "front": float(depth.max()),
        "rear": float(depth.min()),
        "radius": float(np.interp(0.95 * mass.sum(), np.cumsum(mass[by_radius]), radius[by_radius])),
        "largest_radius": float(radius.max()),
        "failed_share": float(mass[matter.failed[chosen]].sum() / mass.sum()),
        "places": radius,
        "masses": mass,
        "mass_of": {
            name: float(matter.mass[chosen & matter.of(name)].sum())
            for name in matter.names
            if np.any(chosen & matter.of(name))
        },
    }


def wall_of(start, now, name, shot):
    """All that is measured of one wall."""
    normal = normal_of(start, name, shot)
    across = across_of(normal, now.axes)
    own = now.of(name)
    wall, piece = largest_piece(now, own)
    if now.dimension == 2 and not now.is_round:  # a slot cuts a wall in the plane in two
        places, width = (
            now.points @ across[0],
            np.abs(start.points[start.of(name)] @ across[0] - (start.points[start.of(name)] @ across[0]).mean()).max(),
        )
        far = (
            own & (piece >= 0) & (np.abs(places - (start.points[start.of(name)] @ across[0]).mean()) > AT_EDGE * width)
        )
        wall = np.isin(piece, np.unique(piece[far])) & (piece >= 0) | wall
    result = {
        "name": name,
        "normal": [float(v) for v in normal],
        "mass_at_start": float(start.mass[start.of(name)].sum()),
        "mass_left": float(now.mass[wall].sum()),
        "failed_mass": float(now.mass[own & now.failed].sum()),
    }
    middle = start.points[start.of(name)].mean(axis=0) if shot.centre is None else shot.centre
    if (
        shot.speed > 0 and abs(shot.velocity @ normal) > 1e-6 * shot.speed
    ):  # where its line meets the middle of the wall
        depth = (start.points[start.of(name)] @ normal).mean()
        middle = middle + shot.velocity * (depth - middle @ normal) / (shot.velocity @ normal)
    if not wall.any():
        return {**result, "hit": True, "perforated": True, "broken_up": True}
    moved = surfaces(start, now, wall, name, normal, across, middle, result)
    result["shot"] = strikers(start, now, name, shot, normal)
    inside = [striker["depth"] for striker in result["shot"].values() if striker["inside"]]
    if inside:
        # What is open before its nose has failed, and may bear pressure.
        result["perforated"] = False
        if result["openings"]:
            result["crater"]["depth"] = max(inside)
    speed = now.velocity @ normal - float(now.mass[wall] @ (now.velocity[wall] @ normal) / now.mass[wall].sum())
    result["velocity"] = float(now.mass[wall] @ (now.velocity[wall] @ normal) / now.mass[wall].sum())
    first = start.points[start.of(name)] @ normal
    before = [
        other
        for other in start.solids
        if other == name or (start.of(other).any() and (start.points[start.of(other)] @ normal).mean() < first.mean())
    ]
    loose = np.isin(now.body, [now.names.index(other) + 1 for other in before]) & ~wall
    depth, slow = now.points @ normal - moved, SLOW * (shot.speed or np.abs(speed).max(initial=0.0))
    half = 0.5 * now.spacing
    result["detached"] = detached(now, own & ~wall, piece, speed, slow)
    result["cloud"] = cloud_of(now, loose & (depth > first.max() + half) & (speed > slow), normal, middle, across)
    result["ejecta"] = cloud_of(now, loose & (depth < first.min() - half) & (speed < -slow), -normal, middle, across)
    reach = np.linalg.norm((start.points[start.of(name)] - middle) @ across.T, axis=1).max() + half
    for key in ("cloud", "ejecta"):
        if result[key]:
            beyond = result[key].pop("places") > reach
            result[key]["beyond_edge_mass"] = float(result[key].pop("masses")[beyond].sum())
    result["hit"] = bool(
        result["perforated"]
        or result["crater"]["depth"] > half
        or result["bulge"]["height"] > half
        or result["failed_mass"] > 0
        or result["detached"]["mass"] > 0
    )
    return result


def strikers(start, now, name, shot, normal):
    """Where the largest whole pieces of what was shot are: depth of the nose below the front face that the wall had at
    the start, velocity along its normal, whether it is inside. None of a body that has broken up."""
    first, half = start.points[start.of(name)] @ normal, 0.5 * now.spacing
    front, rear = first.min() - half, first.max() + half
    result = {}
    for body in shot.bodies:
        if body == name or not now.of(body).any():
            continue
        piece, _ = largest_piece(now, now.of(body))
        mass = now.mass[piece]
        if mass.sum() < 0.5 * start.mass[start.of(body)].sum():
            continue
        depth = now.points[piece] @ normal
        nose, tail = float(depth.max() + half), float(depth.min() - half)
        velocity = mass @ now.velocity[piece] / mass.sum() * ((0, 0, 1) if now.is_round else 1)
        result[body] = {
            "depth": nose - front,
            "velocity": float(velocity @ normal),
            "speed": float(np.linalg.norm(velocity)),
            "inside": bool(front < nose < rear),
            "through": bool(tail > rear),
        }
    return result


def cloud_before(dumps, first, start, name, shot, matter_of_dump):
    """The cloud behind a wall in the last dump before any of it meets the next body; None where there is none."""
    normal = normal_of(start, name, shot)
    rear = (start.points[start.of(name)] @ normal).max()
    behind = {
        other: (start.points[start.of(other)] @ normal).min()
        for other in start.names
        if start.of(other).any() and other != name
    }
    behind = {other: depth for other, depth in behind.items() if depth > rear}
    if not behind:
        return None
    following = min(behind, key=behind.get)
    flying = [start.names.index(other) + 1 for other in start.names if other not in behind]
    last = None
    for dump in dumps:  # forwards: what has met the next body and bounced off it is no longer the cloud
        now = matter_of_dump(dump.read(), first)
        if (now.points[np.isin(now.body, flying)] @ normal).max(initial=-np.inf) >= behind[following] - now.cell:
            break
        last = now
    found = last and wall_of(start, last, name, shot).get("cloud")
    return {"time": last.time, "next": following, **found} if found else None


def surfaces(start, now, wall, name, normal, across, middle, result):
    """Opening, crater, bulge and thickness into `result`; how far the wall has moved as a whole along its normal."""
    first, last = completed(start.points[start.of(name)], start, normal), completed(now.points[wall], now, normal)
    places = [(points - middle) @ across.T for points in (first, last)]
    maps = Maps(np.vstack(places), now.spacing, now.cell, now.is_round)
    half = 0.5 * now.spacing
    front0, rear0 = maps.least(places[0], first @ normal - half), -maps.least(places[0], -(first @ normal) - half)
    front, rear = maps.least(places[1], last @ normal - half), -maps.least(places[1], -(last @ normal) - half)
    footprint, covered = np.isfinite(front0), np.isfinite(front)
    distance = np.linalg.norm(maps.centres, axis=-1) if maps.count else np.zeros(())
    edge = footprint & covered & (distance >= np.quantile(distance[footprint], EDGE))
    if not edge.any():
        edge = footprint & covered
    both = footprint & covered
    dents, bulges = np.zeros(maps.shape), np.zeros(maps.shape)
    moved = float(np.median(front[edge] - front0[edge])) if edge.any() else 0.0
    dents[both] = front[both] - front0[both] - moved
    bulges[both] = rear[both] - rear0[both] - (float(np.median(rear[edge] - rear0[edge])) if edge.any() else 0.0)
    openings, outer = openings_of(maps, footprint, covered)
    result["perforated"] = bool(openings)
    result["opening"] = maps.size(openings[0]) if openings else {"area": 0.0, "diameter": 0.0, "circle": 0.0}
    result["openings"] = len(openings)
    result["open_to_edge"] = outer
    hole = openings[0] if openings else np.zeros(maps.shape, bool)
    thickness = float(np.median(rear0[footprint] - front0[footprint]))
    lost = np.zeros(maps.shape)
    lost[both] = rear0[both] - front0[both] - rear[both] + front[both]
    lost[hole] = rear0[hole] - front0[hole]
    deep = maps.regions((lost > half) | hole)
    crater = max(deep, key=lambda region: float((maps.area * lost)[region].sum())) if deep else hole
    inner = both & ~edge
    result["thickness"] = {
        "start": thickness,
        "least": 0.0 if openings else float((rear[inner] - front[inner]).min(initial=thickness)),
    }
    result["crater"] = {
        "depth": thickness if openings else float(dents[crater].max(initial=0.0)),
        "radius": 0.5 * maps.size(crater)["diameter"],
        "volume": float((maps.area * lost)[crater].sum()),
        "lip": abs(float(dents.min(initial=0.0))),
    }
    swollen = both & (bulges > half)
    result["bulge"] = {"height": float(bulges.max(initial=0.0)), "radius": 0.5 * maps.size(swollen)["diameter"]}
    result["moved"] = moved
    result["failed_inside"] = failed_inside(now, name, maps, (normal, across, middle), (front, rear))
    return moved


def failed_inside(now, name, maps, frame, faces):
    """The largest area over which matter between the faces of a wall has failed, a cell below each of them or deeper,
    and which is at least two cells wide: there the wall has come apart in layers though it has no opening."""
    normal, across, middle = frame
    points = completed(now.points[now.of(name) & now.failed], now, normal)
    places, depth = (points - middle) @ across.T, points @ normal
    on_map = maps.inside(places)
    index = np.floor((places[on_map] - maps.lower) / maps.pixel).astype(int)
    front, rear = (face[tuple(index.T)] for face in faces)
    index = index[(depth[on_map] > front + now.cell) & (depth[on_map] < rear - now.cell)]
    mask = np.zeros(maps.shape)
    mask[tuple(index.T)] = 1.0
    mask = maps.filtered(maps.filtered(mask, maps.reach, np.maximum, 0.0), maps.back, np.minimum, 1.0) > 0
    wide = [region for region in maps.regions(mask) if maps.circle(region) + maps.pixel >= 2 * maps.reach]
    return maps.size(wide[0]) if wide else {"area": 0.0, "diameter": 0.0, "circle": 0.0}


def openings_of(maps, footprint, covered):
    """Openings wider than two cells inside the outline of the wall, the largest first; whether one reaches its edge."""
    gone = footprint & ~covered
    beyond = (
        maps.filtered((~footprint).astype(float), 1.5 * maps.pixel, np.maximum, 1.0) > 0 if maps.count else ~footprint
    )
    openings, outer = [], False
    for region in maps.regions(gone):
        if region.sum() == 0 or maps.circle(region) + maps.pixel < 2 * maps.reach:
            continue
        if np.any(region & beyond):
            outer = True
        else:
            openings.append(region)
    return openings, outer


def detached(matter, chosen, piece, speed, slow):
    """Pieces of a wall that have come off and leave it forwards (spall) and backwards; `mass` is that of all pieces."""
    moving = chosen & (piece >= 0)
    least = resolved(matter)
    result = {"mass": float(matter.mass[moving].sum())}
    for side, leaving in (("spall", 1), ("backwards", -1)):
        pieces = []
        if moving.any():
            number = piece[moving]
            mass, count = np.bincount(number, matter.mass[moving]), np.bincount(number)
            mean = np.divide(
                np.bincount(number, (matter.mass * speed)[moving]), mass, out=np.zeros(len(mass)), where=mass > 0
            )
            pieces = [k for k in np.flatnonzero(count >= least) if leaving * mean[k] > slow]
        result[side] = {
            "pieces": len(pieces),
            "mass": float(sum(mass[k] for k in pieces)),
            "largest": float(max((mass[k] for k in pieces), default=0.0)),
            "velocity": float(sum(mass[k] * mean[k] for k in pieces) / sum(mass[k] for k in pieces)) if pieces else 0.0,
        }
    return result


def resolved(matter):
    """Number of particles from which on a piece counts as one: those of a cell."""
    return max(2, round((matter.cell / matter.spacing) ** len(matter.axes)))
