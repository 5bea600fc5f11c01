"""Turn the half-plane of an axisymmetric run into the body of revolution that it stands for: particles for pictures in
3D.

    sgmp-view revolve taylor_bar_axisymmetric.out
    sgmp-view revolve taylor_bar_axisymmetric.out --step 3 --angle 360
    sgmp-view revolve taylor_bar_axisymmetric.out/particles_0000120.vtu -o bar.vtu

Input: an output folder (particles.pvd, or particles_end.csv), a .vtu file, a particles CSV, or a checkpoint. Every ring
becomes particles on its circle, as far apart as rings are from each other; vectors and tensors turn with them, mass and
volume are shared out. Without an angle of 360 degrees the section can be seen. Writes a .vtu file for ParaView or
`sgmp-view picture`.
"""

import sys
from pathlib import Path

import numpy as np

from .files import Particles, read_dump

SHARED = ("mass", "volume")  # what a ring has and its particles have parts of
TENSOR = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))
VTK_NAMES = {
    "f8": "Float64",
    "f4": "Float32",
    "i8": "Int64",
    "i4": "Int32",
    "u8": "UInt64",
    "u4": "UInt32",
    "u1": "UInt8",
    "i1": "Int8",
}


def distance_of_rings(points):
    """Median distance of a ring to the nearest one."""
    sample = points[np.linspace(0, len(points) - 1, min(len(points), 100)).astype(int)]
    squares = ((sample[:, None] - points[None]) ** 2).sum(axis=2)
    squares[squares == 0] = np.inf
    return float(np.sqrt(np.median(squares.min(axis=1))))


def revolve(particles, degrees, spacing, middle=90.0):
    """Particles on the circles of rings about the axis z, half of the angle to each side of a direction: of y, so that
    the open side looks along -y."""
    radius = particles.points[:, 0]
    copies = np.maximum(np.ceil(np.radians(degrees) * radius / spacing), 4).astype(int)
    ring = np.repeat(np.arange(len(radius)), copies)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(copies) - copies, copies)
    angle = np.radians(middle + degrees * ((place + 0.5) / copies[ring] - 0.5))
    turn = np.zeros((len(ring), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1
    result = turned(particles, turn, ring)
    for name in SHARED:
        if name in result.fields:
            result.fields[name] = result.fields[name] * degrees / 360 / copies[ring]
    return result


def turned(particles, turn, chosen):
    """Particles (chosen, by number) with places, vectors and tensors turned by matrices (n, 3, 3)."""
    result = Particles(
        particles.path, np.einsum("nij,nj->ni", turn, particles.points[chosen]), components=particles.components,
        time=particles.time, body_names=particles.body_names,
    )
    for name, values in particles.fields.items():
        values = values[chosen]
        if values.ndim == 2 and values.shape[1] == 3:
            values = np.einsum("nij,nj->ni", turn, values)
        elif values.ndim == 2 and values.shape[1] == 6:
            full = np.empty((len(values), 3, 3))
            for component, (i, j) in enumerate(TENSOR):
                full[:, i, j] = full[:, j, i] = values[:, component]
            full = turn @ full @ turn.transpose(0, 2, 1)
            values = np.column_stack([full[:, i, j] for i, j in TENSOR])
        result.fields[name] = values
    return result


def write_vtu(particles, path):
    """A .vtu file with appended raw data, as sgmp writes it."""
    blocks = []

    def array(name, values, suffixes=()):
        values = np.ascontiguousarray(values)
        offset = sum(len(block) + 8 for block in blocks)
        blocks.append(values.tobytes())
        width = values.shape[1] if values.ndim == 2 else 1
        names = "".join(f' ComponentName{i}="{name}_{suffix}"' for i, suffix in enumerate(suffixes))
        return (
            f'<DataArray type="{VTK_NAMES[values.dtype.str[1:]]}" Name="{name}" NumberOfComponents="{width}"{names} '
            f'format="appended" offset="{offset}"/>\n'
        )

    n = len(particles.points)
    data = "".join(array(name, values, particles.components.get(name, ())) for name, values in particles.fields.items())
    points = array("Points", particles.points)
    cells = (
        array("connectivity", np.arange(n)) + array("offsets", np.arange(1, n + 1)) + array("types", np.ones(n, "u1"))
    )
    time = (
        ""
        if particles.time is None
        else "<FieldData>\n" + array("TimeValue", np.array([particles.time])) + "</FieldData>\n"
    )
    order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
    head = (
        f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="{order}" '
        f'header_type="UInt64">\n<UnstructuredGrid>\n'
        f'{time}<Piece NumberOfPoints="{n}" NumberOfCells="{n}">\n<PointData>\n{data}</PointData>\n'
        f'<Points>\n{points}</Points>\n<Cells>\n{cells}</Cells>\n'
        f'</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_'
    )
    with open(path, "wb") as file:
        file.write(head.encode())
        for block in blocks:
            file.write(np.uint64(len(block)).tobytes() + block)
        file.write(b"\n</AppendedData>\n</VTKFile>\n")


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument(
        "source", type=Path, metavar="OUT_DIR|FILE", help="output folder, .vtu file, particles CSV or checkpoint"
    )
    parser.add_argument(
        "--step", default="last", metavar="last|N", help="which dump of a folder, counted from 0 (default: last)"
    )
    parser.add_argument("--angle", type=float, default=180, help="degrees about the axis, 0 to 360 (default: 180)")
    parser.add_argument("--spacing", type=float, help="distance of particles on a circle (default: that of the rings)")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="file to write (default: beside the data, …_revolved.vtu)"
    )


def run(options):
    """Writes the dump and prints its name."""
    if not 0 < options.angle <= 360:
        raise ValueError(f"--angle {options.angle:g} is not in (0,360]")
    rings = read_dump(options.source, options.step)
    if np.any(rings.points[:, 1] != 0) or np.any(rings.points[:, 0] < 0):
        raise ValueError(f"{rings.path} is no axisymmetric scene: particles do not lie in the half-plane x > 0, y = 0")
    solid = revolve(rings, options.angle, options.spacing or distance_of_rings(rings.points))
    output = options.output or rings.path.with_name(rings.path.stem + "_revolved.vtu")
    write_vtu(solid, output)
    print(output)
