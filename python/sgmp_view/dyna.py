"""Nodes, solid elements and SPH nodes of a keyword deck of LS-DYNA, strictly: what is not understood is an error with
its line.

Of the readers on PyPI, lsdyna-mesh-reader has no SPH and does not come back from a deck with commas, ansys-dyna-core
wants pandas, DPF and docker, lasso-python and meshio do not read keyword decks.
"""

import re
from dataclasses import dataclass, field

import numpy as np

from .files import SgmpFileError, existing

NODE_FIELDS = (8, 16, 16, 16, 8, 8)
ELEMENT_FIELDS = (8,) * 10
SPH_FIELDS = (8, 8, 16, 8)
# corners of the parametric cube in LS-DYNA's order
CUBE = np.array([(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)])
# what may follow *NODE, *ELEMENT_SOLID, … and would be read wrongly
REFUSED = ("INCLUDE", "PARAMETER", "NODE_", "ELEMENT_SOLID_", "ELEMENT_SPH_")
READ = ("KEYWORD", "TITLE", "END", "NODE", "ELEMENT_SOLID", "ELEMENT_SPH", "PART")
SIZE = {"tetrahedron": 4, "hexahedron": 8}


@dataclass
class Mesh:
    """What was read; lines are for messages."""

    path: object
    nodes: dict = field(default_factory=dict)      # id: (x, y, z)
    solids: dict = field(default_factory=dict)     # id: (part, 8 nodes, line)
    spheres: dict = field(default_factory=dict)    # node: (part, mass; negative: volume, line)
    titles: dict = field(default_factory=dict)     # part: title
    ignored: list = field(default_factory=list)    # keywords

    def parts(self):
        """Parts that have elements."""
        return sorted({entry[0] for entry in self.solids.values()} | {entry[0] for entry in self.spheres.values()})

    def particles(self, part, split=1, density=None):
        """Places (n, 3) and volumes (n) of a part: n**3 per hexahedron, one per tetrahedron and SPH node."""
        places, volumes = [], []
        for element, (its_part, nodes, line) in self.solids.items():
            if its_part != part:
                continue
            different = list(dict.fromkeys(nodes))
            if len(different) == SIZE["tetrahedron"]:
                where, volume = tetrahedron(np.array([self.node(n, line) for n in different]))
            else:
                where, volume = hexahedron(np.array([self.node(n, line) for n in nodes]), split)
            if not np.all(volume > 0):
                raise SgmpFileError(
                    f"{self.path}:{line}: element {element} is inside out or flat (volume {volume.sum():.4g}): its "
                    f"nodes in LS-DYNA's order?"
                )
            places.append(where)
            volumes.append(volume)
        for node, (its_part, mass, line) in self.spheres.items():
            if its_part != part:
                continue
            if mass > 0 and not density:
                raise SgmpFileError(f"{self.path}:{line}: SPH node {node} has a mass: --density turns it into a volume")
            places.append(np.array([self.node(node, line)]))
            volumes.append(np.array([mass / density if mass > 0 else -mass]))
        return np.concatenate(places), np.concatenate(volumes)

    def node(self, number, line):
        """Its place."""
        if number not in self.nodes:
            raise SgmpFileError(f"{self.path}:{line}: there is no node {number}")
        return self.nodes[number]


def tetrahedron(corners):
    """Centroid and volume."""
    edges = corners[1:] - corners[0]
    return corners.mean(axis=0)[None], np.array([np.linalg.det(edges) / 6])


def hexahedron(corners, split=1):
    """Centroids (n, 3) and volumes (n) of the split**3 parts of a trilinear hexahedron, by two Gauss points along each
    axis of a part: exact."""
    gauss = np.array([-1, 1]) / np.sqrt(3)
    at = ((2 * np.arange(split) + 1)[:, None] + gauss) / split - 1            # (part, point)
    cells = np.stack(np.meshgrid(*[np.arange(split)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    places, volumes = np.zeros((len(cells), 3)), np.zeros(len(cells))
    for point in np.ndindex(2, 2, 2):
        xi = np.stack([at[cells[:, i], point[i]] for i in range(3)], axis=-1)  # (n, 3)
        factors = 1 + CUBE * xi[:, None]                                        # (n, 8, 3)
        shape = factors.prod(axis=2) / 8
        slope = np.stack([CUBE[:, i] * np.delete(factors, i, axis=2).prod(axis=2) / 8 for i in range(3)], axis=-1)
        weight = np.linalg.det(np.einsum("nai,aj->nij", slope, corners)) / split**3
        places += weight[:, None] * (shape @ corners)
        volumes += weight
    safe = np.where(volumes == 0, 1, volumes)
    return places / safe[:, None], volumes


class Reader:
    """Goes through a deck line by line."""

    def __init__(self, path):
        self.mesh = Mesh(existing(path))
        self.keyword, self.pending, self.rows, self.title = None, None, 0, ""
        try:
            text = self.mesh.path.read_text(encoding="latin-1")
        except OSError as problem:
            raise SgmpFileError(f"{path}: {problem}") from None
        lines = text.splitlines()
        if not any(line.startswith("*") for line in lines):
            raise SgmpFileError(f"{path}: no keyword; is it a keyword deck of LS-DYNA?")
        for self.number, line in enumerate(lines, 1):
            if line.startswith("$") or (not line.strip() and self.keyword != "PART"):
                continue
            if line.startswith("*"):
                self.begin(line)
                if self.keyword == "END":
                    break
            else:
                self.data(line)
        self.end_of_block()

    def fail(self, message):
        """An error at this line."""
        raise SgmpFileError(f"{self.mesh.path}:{self.number}: {message}")

    def begin(self, line):
        """A keyword."""
        self.end_of_block()
        words = line[1:].split()
        self.keyword = words[0].upper() if words else ""
        if line.rstrip()[-1] in "+-%" or "LONG=" in line.upper().replace(" ", ""):
            self.fail("the long format is not read: write the deck in the standard format")
        if self.keyword.startswith(REFUSED):
            self.fail(
                f"*{self.keyword} is not read: have the pre-processor write plain *NODE, *ELEMENT_SOLID and "
                f"*ELEMENT_SPH into one file"
            )
        self.rows = 0
        name = f"*{self.keyword}"
        if self.keyword not in READ and name not in self.mesh.ignored:
            self.mesh.ignored.append(name)

    def end_of_block(self):
        """An element of two lines must have its second."""
        if self.pending:
            self.fail(f"element {self.pending[0]} has no line of nodes")

    def fields(self, line, widths):
        """Its words: separated by commas, else in columns."""
        if "," in line:
            return [word.strip() for word in line.split(",")]
        ends = np.cumsum(widths)
        if len(line.rstrip()) > ends[-1]:
            self.fail(f"longer than its columns ({', '.join(map(str, widths))}): {line.strip()!r}")
        return [line[end - width:end].strip() for width, end in zip(widths, ends)]

    def whole(self, word):
        """A whole number; 0 where there is none."""
        if word and not re.fullmatch(r"[+-]?\d+", word):
            self.fail(f"{word!r} is not a whole number: columns of 8, or commas")
        return int(word or 0)

    def real(self, word):
        """A number, also 1.5-3 and 1d5; 0 where there is none."""
        match = re.fullmatch(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]?([+-]?\d+))?", word or "0")
        if not match:
            self.fail(f"{word!r} is not a number: columns of 8 and 16, or commas")
        return float(f"{match.group(1)}e{match.group(2) or 0}")

    def data(self, line):
        """A line of a block."""
        self.rows += 1
        if self.keyword == "NODE":
            words = self.fields(line, NODE_FIELDS) + ["", "", ""]
            self.once(self.mesh.nodes, self.whole(words[0]), tuple(self.real(word) for word in words[1:4]), "node")
        elif self.keyword == "ELEMENT_SPH":
            words = self.fields(line, SPH_FIELDS) + ["", ""]
            if self.real(words[2]) == 0:
                self.fail(f"SPH node {words[0]} has neither mass nor volume")
            self.once(
                self.mesh.spheres, self.whole(words[0]), (self.whole(words[1]), self.real(words[2]), self.number),
                "SPH node",
            )
        elif self.keyword == "ELEMENT_SOLID":
            self.solid([self.whole(word) for word in self.fields(line, ELEMENT_FIELDS)])
        elif self.keyword == "PART":
            if self.rows % 2:
                self.title = line.strip()
            else:
                self.mesh.titles[self.whole(self.fields(line, (10,) * 8)[0])] = self.title

    def solid(self, words):
        """An element in one line, or the first or second of two."""
        if self.pending:
            element, part = self.pending
            nodes, self.pending = words, None
        elif any(words[2:]):
            element, part, nodes = words[0], words[1], words[2:]
        else:
            self.pending = words[:2]
            return
        if any(nodes[8:]):
            self.fail(f"element {element} has nodes between its corners: write it with corner nodes alone")
        nodes = [node for node in nodes[:8] if node]
        if len(nodes) not in SIZE.values():
            self.fail(f"element {element} has {len(nodes)} nodes: a solid has 8, or 4")
        if len(set(nodes)) not in (4, 5, 6, 8):
            self.fail(
                f"element {element} has {len(set(nodes))} different nodes: no tetrahedron, pyramid, wedge or hexahedron"
            )
        self.once(self.mesh.solids, element, (part, nodes, self.number), "element")

    def once(self, table, number, entry, what):
        """Notes it; numbers are positive and come once."""
        if number <= 0:
            self.fail(f"{what} {number}: numbers are positive")
        if number in table:
            self.fail(f"there are two of {what} {number}")
        table[number] = entry


def read_mesh(path):
    """A mesh; an error that names file and line where something is not understood."""
    mesh = Reader(path).mesh
    if not mesh.solids and not mesh.spheres:
        raise SgmpFileError(f"{path}: neither *ELEMENT_SOLID nor *ELEMENT_SPH")
    return mesh
