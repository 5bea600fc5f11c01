"""Particles from a solid's surface (STL) or from a mesh of LS-DYNA, for `body NAME file file=…` of a deck.

    sgmp-view solids part.stl --spacing 0.5
    sgmp-view solids part.stl --spacing 0.5 --scale 1000 --move 0,0,12 --origin 0,0,0 -o part.txt
    sgmp-view solids mesh.k --split 2
    sgmp-view solids mesh.k --part 3 --density 7.85e-3

STL: the centres of the cubes of a lattice that lie inside the surface; it must be closed. LS-DYNA (.k, .key, .dyn):
*NODE, *ELEMENT_SOLID (hexahedra, wedges, pyramids, tetrahedra with corner nodes), *ELEMENT_SPH, *PART; a particle per
element at its centroid with its exact volume, or N x N x N per element; SPH masses become volumes by --density. A file
for each part. What else is in a keyword deck is listed and left out.
"""

import sys
from pathlib import Path

import numpy as np

from .dyna import read_mesh
from .files import SgmpFileError
from .stl import Surface

KEYWORD_DECKS = (".k", ".key", ".dyn", ".dyna")


def write_particles(path, points, volumes, source):
    """A particle file: x y z volume."""
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"# x y z volume: {len(points)} particles from {source}\n")
        np.savetxt(file, np.column_stack([points, volumes]), fmt="%.10g")


def report(path, points, volumes, options, solid=None):
    """What was written, the mass or volume beside that of the solid, and the line for the deck."""
    what, unit = ("mass", options.density) if options.density else ("volume", 1.0)
    total = unit * float(volumes.sum())
    beside = "" if solid is None else f"; of the solid {unit * solid:.6g} ({100 * (volumes.sum() / solid - 1):+.2f} %)"
    low, high = points.min(axis=0), points.max(axis=0)
    print(f"{path}: {len(points)} particles, {what} {total:.6g}{beside}")
    print(f"  between ({', '.join(f'{v:.6g}' for v in low)}) and ({', '.join(f'{v:.6g}' for v in high)})")
    spacing = options.spacing or float(np.median(volumes)) ** (1 / 3)
    print(
        f"  body {''.join(c if c.isalnum() else '_' for c in path.stem)} file material=… file={path.name} "
        f"spacing={spacing:.6g}"
    )


def from_surface(options):
    """Fills an STL surface."""
    if not options.spacing:
        raise ValueError("an STL solid needs --spacing, the side of the cubes that particles stand for")
    surface = Surface(options.source, options.scale, options.move)
    points = surface.fill(options.spacing, options.origin)
    if len(points) == 0:
        raise SgmpFileError(
            f"{options.source}: no centre of a cube lies inside; its sides are {surface.sides()}: choose a smaller "
            f"--spacing"
        )
    volumes = np.full(len(points), options.spacing**3)
    path = options.output or options.source.with_suffix(".txt")
    write_particles(path, points, volumes, options.source.name)
    report(path, points, volumes, options, surface.volume)


def from_mesh(options):
    """Turns elements into particles, a file for each part."""
    mesh = read_mesh(options.source)
    wanted = [part for part in mesh.parts() if options.part in (None, part)]
    if not wanted:
        raise SgmpFileError(
            f"{options.source}: no elements of part {options.part}; there are: "
            f"{', '.join(map(str, mesh.parts())) or 'none'}"
        )
    if options.output and len(wanted) > 1:
        raise ValueError(f"-o is for one part, and there are {len(wanted)}: choose one by --part")
    for part in wanted:
        points, volumes = mesh.particles(part, options.split, options.density)
        points, volumes = points * options.scale + options.move, volumes * options.scale**3
        path = options.output or options.source.with_name(f"{options.source.stem}_part{part}.txt")
        write_particles(path, points, volumes, f"part {part} {mesh.titles.get(part, '')} of {options.source.name}")
        report(path, points, volumes, options)
    if mesh.ignored:
        print(f"left out: {', '.join(mesh.ignored)}", file=sys.stderr)


def vector(text):
    """Three numbers."""
    numbers = [float(word) for word in text.strip("()").split(",")]
    if len(numbers) != 3:
        raise ValueError("three numbers a,b,c")
    return np.array(numbers)


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("source", type=Path, metavar="FILE", help="an .stl file, or a keyword deck (.k, .key, .dyn)")
    parser.add_argument(
        "--spacing", type=float, help="STL: side of the cubes that particles stand for, in the units of the deck"
    )
    parser.add_argument(
        "--origin",
        type=vector,
        metavar="X,Y,Z",
        help="STL: a corner of the cubes (default: the lower corner of the solid)",
    )
    parser.add_argument(
        "--scale", type=float, default=1.0, help="by which the file's coordinates are multiplied (default: 1)"
    )
    parser.add_argument("--move", type=vector, metavar="X,Y,Z", default=np.zeros(3), help="added to them after that")
    parser.add_argument("--part", type=int, help="LS-DYNA: this part alone")
    parser.add_argument(
        "--split", type=int, default=1, metavar="N", help="LS-DYNA: N x N x N particles per hexahedron (default: 1)"
    )
    parser.add_argument(
        "--density", type=float, help="prints masses; needed where SPH nodes have a mass (units of the written file)"
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="file to write (default: beside the source, .txt)"
    )


def run(options):
    """Writes particle files and prints what they hold."""
    for name in ("spacing", "scale", "density", "split"):
        if getattr(options, name) is not None and not getattr(options, name) > 0:
            raise ValueError(f"--{name} {getattr(options, name):g} is not positive")
    suffix = options.source.suffix.lower()
    if suffix == ".stl":
        from_surface(options)
    elif suffix in KEYWORD_DECKS:
        from_mesh(options)
    else:
        raise ValueError(f"{options.source}: neither .stl nor {', '.join(KEYWORD_DECKS)}")
