"""Readers for what sgmp writes: history.csv, bodies.csv, particles_end.csv, .vtu, .pvd, VTKHDF, checkpoints,
summary.json.

Needs numpy only, and h5py for VTKHDF and checkpoints. Every reader raises SgmpFileError with the file's name when
something is missing or malformed.

    from sgmp_view import read_history, read_vtu
    history = read_history("taylor_bar.out")         # dict: column -> array
    cloud = read_vtu("taylor_bar.out/particles_0000120.vtu")
    cloud.points, cloud.time, cloud.fields["stress"]  # (n, 3), float, (n, 6)
    read_dump("taylor_bar.out/checkpoint_0000120.h5").bodies["bar"]  # which particles are of a body: (n,) of bool
    cloud.frame()                                     # the same as a table of pandas
"""

import csv
import json
import re
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path
from typing import Dict, List, Optional, Tuple

import numpy as np


class SgmpFileError(Exception):
    """A file is missing, or not what its name says."""


@dataclass
class Particles:
    """Particles at one time, from a .vtu file, particles_end.csv, particles.vtkhdf or a checkpoint."""

    path: Path
    points: np.ndarray                                  # (n, 3)
    fields: Dict[str, np.ndarray] = field(default_factory=dict)  # (n,) or (n, components)
    components: Dict[str, List[str]] = field(default_factory=dict)
    time: Optional[float] = None
    body_names: List[str] = field(default_factory=list)  # where the file has them

    @property
    def bodies(self) -> Dict[str, np.ndarray]:
        """Which particles belong to each body, by its name; by its number where the file has no names."""
        numbers = self.fields["body"]
        names = self.body_names or [str(number) for number in range(1, int(numbers.max(initial=0)) + 1)]
        return {name: numbers == number for number, name in enumerate(names, 1)}

    def frame(self):
        """All of it as a table of pandas, with the names of particles_end.csv."""
        import pandas
        columns = dict(zip("xyz", self.points.T))
        for name, values in self.fields.items():
            if values.ndim == 1:
                columns[name] = values
            else:
                columns.update({f"{name}_{part}": values[:, i] for i, part in enumerate(self.components[name])})
        return pandas.DataFrame(columns)

    def column(self, name: str) -> np.ndarray:
        """One number per particle: a scalar field, `stress_xx`, `velocity_z`, or the size of a vector."""
        if name in self.fields:
            values = self.fields[name]
            if values.ndim == 1:
                return values
            if values.shape[1] == 6:
                return von_mises(values)
            return np.linalg.norm(values, axis=1)
        base, _, suffix = name.rpartition("_")
        if suffix in self.components.get(base, []):
            return self.fields[base][:, self.components[base].index(suffix)]
        raise SgmpFileError(f"{self.path}: no field '{name}'; there are: {', '.join(self.names())}")

    def names(self) -> List[str]:
        """All names that `column` knows."""
        names = list(self.fields)
        for base, suffixes in self.components.items():
            names += [f"{base}_{suffix}" for suffix in suffixes]
        return names

    def first_of(self, *names: str) -> Optional[str]:
        """The first of these names that exists."""
        known = set(self.names())
        return next((name for name in names if name in known), None)


PLASTIC_STRAIN = ("plastic_strain", "equivalent_plastic_strain", "epeff", "ep")


def von_mises(stress: np.ndarray) -> np.ndarray:
    """Equivalent stress of (n, 6) tensors in the order xx yy zz xy yz xz."""
    xx, yy, zz, xy, yz, xz = stress.T
    return np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + xz**2))


# ---------------------------------------------------------------- tables

def read_table(path: Path) -> Dict[str, np.ndarray]:
    """A CSV table with one header line as a dict of columns; a last line cut short is ignored."""
    path = existing(path)
    with open(path, newline="") as stream:
        rows = [row for row in csv.reader(stream) if row and not row[0].lstrip().startswith("#")]
    if not rows:
        raise SgmpFileError(f"{path}: empty")
    names, rows = [name.strip() for name in rows[0]], rows[1:]
    if rows and len(rows[-1]) != len(names):
        rows.pop()
    return {name: as_column([row[i] for row in rows], name, path) for i, name in enumerate(names)}


def as_column(words: List[str], name: str, path: Path) -> np.ndarray:
    """Numbers; names (of a body, a gauge, the bodies of a pair) are text."""
    if name in ("name", "bodies"):
        return np.array(words)
    try:
        return np.array([float(word) for word in words])
    except ValueError as problem:
        raise SgmpFileError(f"{path}: column '{name}' has what is not a number: {problem}") from None


def read_history(folder: Path) -> Dict[str, np.ndarray]:
    """history.csv of an output folder (or the file itself)."""
    folder = Path(folder)
    return read_table(folder / "history.csv" if folder.is_dir() else folder)


def read_particles_csv(path: Path) -> Particles:
    """particles_end.csv of an output folder (or the file itself)."""
    path = Path(path)
    path = existing(path / "particles_end.csv" if path.is_dir() else path)
    with open(path) as stream:
        names = stream.readline().strip().split(",")
    try:
        values = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    except ValueError as problem:
        raise SgmpFileError(f"{path}: {problem}") from None
    columns = dict(zip(names, values.T))
    try:
        points = np.column_stack([columns.pop(axis) for axis in "xyz"])
    except KeyError as missing:
        raise SgmpFileError(f"{path}: no column {missing}") from None
    particles = Particles(path, points)
    for base, suffixes in (("initial_position", "x0 y0 z0"), ("velocity", "velocity_x velocity_y velocity_z"),
                           ("stress", " ".join(f"stress_{c}" for c in ("xx", "yy", "zz", "xy", "yz", "xz")))):
        group = suffixes.split()
        if group[0] in columns:  # shear stresses that vanish in one and two dimensions are not written
            particles.fields[base] = np.column_stack([columns.pop(name, np.zeros(len(points))) for name in group])
            particles.components[base] = [
                name[len(base) + 1 :] if base != "initial_position" else name[0] for name in group
            ]
    for name, column in columns.items():
        particles.fields[name] = column.astype(int) if name in ("id", "body") else column
    return particles


def read_summary(folder: Path) -> dict:
    """summary.json of an output folder (or the file itself)."""
    path = Path(folder)
    path = existing(path / "summary.json" if path.is_dir() else path)
    try:
        return json.loads(path.read_text())
    except json.JSONDecodeError as problem:
        raise SgmpFileError(f"{path}: {problem}") from None


def read_summary_if_any(folder: Path) -> dict:
    """The same, empty where a run has not ended."""
    return read_summary(folder) if (Path(folder) / "summary.json").exists() else {}


def folder_of(source: Path) -> Path:
    """The output folder that a path names or lies in."""
    source = Path(source)
    return source if source.is_dir() else source.parent


def run_name(source: Path) -> str:
    """What to call a run in a legend: its folder without .out."""
    name = folder_of(source).resolve().name
    return name[:-4] if name.endswith(".out") else name


def lookup(summary: dict, *keys: str, default=None):
    """The first of these dotted keys that is in a summary, else `default`."""
    for key in keys:
        value = summary
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        if value is not None:
            return value
    return default


# ---------------------------------------------------------------- VTK

VTK_TYPES = {"Float64": "f8", "Float32": "f4", "Int64": "i8", "Int32": "i4", "UInt64": "u8", "UInt32": "u4",
             "UInt8": "u1", "Int8": "i1"}


def read_vtu(path: Path) -> Particles:
    """A .vtu file with appended raw data and UInt64 block sizes, as sgmp writes it."""
    path = existing(path)
    content = path.read_bytes()
    start = re.search(rb'<AppendedData encoding="raw">\s*_', content)
    if not start:
        raise SgmpFileError(f"{path}: no appended raw data (is it a .vtu file written by sgmp?)")
    try:
        root = ElementTree.fromstring(content[:start.start()] + b"</VTKFile>")
    except ElementTree.ParseError as problem:
        raise SgmpFileError(f"{path}: {problem}") from None
    if root.get("header_type") != "UInt64" or root.get("compressor"):
        raise SgmpFileError(f"{path}: only uncompressed data with UInt64 headers can be read")
    order = "<" if root.get("byte_order") == "LittleEndian" else ">"

    def array(element) -> np.ndarray:
        first = start.end() + int(element.get("offset"))
        size = int(np.frombuffer(content, order + "u8", 1, first)[0])
        kind = np.dtype(order + VTK_TYPES[element.get("type")])
        if first + 8 + size > len(content):
            raise SgmpFileError(f"{path}: cut short in array '{element.get('Name')}'")
        values = np.frombuffer(content, kind, size // kind.itemsize, first + 8)
        width = int(element.get("NumberOfComponents", "1"))
        return values.reshape(-1, width) if width > 1 else values

    particles = Particles(path, array(root.find(".//Points/DataArray")))
    for element in root.iterfind(".//PointData/DataArray"):
        name = element.get("Name")
        particles.fields[name] = array(element)
        names = [element.get(f"ComponentName{i}") for i in range(int(element.get("NumberOfComponents", "1")))]
        if names[0]:
            particles.components[name] = [c[len(name) + 1:] if c.startswith(name + "_") else c for c in names]
    for element in root.iterfind(".//FieldData/DataArray"):
        if element.get("Name") == "TimeValue":
            particles.time = float(array(element)[0])
    return particles


def read_pvd(path: Path) -> List[Tuple[float, Path]]:
    """Times and files of a .pvd collection."""
    path = existing(path)
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as problem:
        raise SgmpFileError(f"{path}: {problem}") from None
    return [(float(entry.get("timestep")), path.parent / entry.get("file")) for entry in root.iterfind(".//DataSet")]


def read_dump(source: Path, step: str = "last") -> Particles:
    """Particles of a .vtu or .csv file or a checkpoint, or of dump `step` (number in the series, or 'last') of an
    output folder."""
    source = existing(source)
    if source.is_file():
        if source.suffix in (".h5", ".old"):
            return read_checkpoint(source)
        return read_vtu(source) if source.suffix == ".vtu" else read_particles_csv(source)
    dumps = dumps_of(source)
    if not dumps:
        if step == "last" and (source / "particles_end.csv").exists():
            return read_particles_csv(source)
        checkpoints = sorted(source.glob("checkpoint_*.h5"), key=lambda path: int(path.stem[11:]))
        if step == "last" and checkpoints:
            return read_checkpoint(checkpoints[-1])
        raise SgmpFileError(
            f"{source}: no dumps (add `output vtu every=…`, `output vtkhdf every=…` or `output csv at=end`)"
        )
    try:
        return dumps[-1 if step == "last" else int(step)].read()
    except (ValueError, IndexError):
        raise SgmpFileError(f"{source}: no dump '{step}'; give 'last' or 0 to {len(dumps) - 1}") from None


@dataclass
class Dump:
    """One dump of a series, not yet read."""

    path: Path
    time: float
    step: int = -1                                      # place in a VTKHDF file

    def read(self) -> Particles:
        """Its particles."""
        particles = read_vtu(self.path) if self.step < 0 else read_vtkhdf(self.path, self.step)
        particles.time = self.time
        return particles


def dumps_of(folder: Path) -> List[Dump]:
    """The dumps of an output folder in the order of time: .vtu by particles.pvd, else particles.vtkhdf."""
    folder = Path(folder)
    if (folder / "particles.pvd").exists():
        return [Dump(path, time) for time, path in read_pvd(folder / "particles.pvd")]
    path = folder / "particles.vtkhdf"
    if not path.exists():
        return []
    with open_hdf5(path) as file:
        return [Dump(path, float(time), step) for step, time in enumerate(file["VTKHDF/Steps/Values"][()])]


def open_hdf5(path: Path):
    """An HDF5 file, or an error that says what is missing."""
    try:
        import h5py
    except ImportError:
        raise SgmpFileError(
            f"{path}: reading HDF5 needs h5py (pip install h5py), or `output vtu` in the deck"
        ) from None
    try:
        return h5py.File(existing(path), "r")
    except OSError as problem:
        raise SgmpFileError(f"{path}: {problem}") from None


def read_vtkhdf(path: Path, step: int) -> Particles:
    """The particles of one step of a VTKHDF file of particles."""
    with open_hdf5(path) as file:
        root = file["VTKHDF"]
        steps = root["Steps"]
        parts = root["NumberOfPoints"]
        first_part = int(steps["PartOffsets"][step])
        width = int(steps["NumberOfParts"][step]) if "NumberOfParts" in steps else 1
        count = int(parts[first_part:first_part + width].sum())
        start = int(steps["PointOffsets"][step])
        particles = Particles(path, root["Points"][start:start + count])
        for name, data in root["PointData"].items():
            first = int(steps[f"PointDataOffsets/{name}"][step])
            particles.fields[name] = data[first:first + count]
            if data.ndim == 2:
                particles.components[name] = (
                    ["x", "y", "z"] if data.shape[1] == 3 else ["xx", "yy", "zz", "xy", "yz", "xz"]
                )
    return particles


def read_checkpoint(path: Path) -> Particles:
    """The particles of a checkpoint in the order of their bodies and ids, with all that they carry."""
    with open_hdf5(path) as file:
        if "contents" not in file:
            raise SgmpFileError(f"{path}: not a checkpoint of sgmp, or one of a version before format 8")
        contents = json.loads(file["contents"][()])
        bodies = [
            read_checkpoint_body(file[f"body_{number}"], number, body, contents)
            for number, body in enumerate(contents["bodies"], 1)
        ]
    names = dict.fromkeys(name for body in bodies for name in body)  # materials differ in what they carry
    together = {name: np.concatenate([body.get(name, np.zeros(len(body["id"]))) for body in bodies]) for name in names}
    particles = Particles(
        path, together.pop("position"), time=contents["time"], body_names=[body["name"] for body in contents["bodies"]]
    )
    if "stress_xx" in together:
        together["stress"] = np.column_stack(
            [together.pop(f"stress_{c}", np.zeros(len(particles.points))) for c in STRESSES]
        )
        together["pressure"] = -together["stress"][:, :3].mean(axis=1)
    together["density"] = together["mass"] / together["volume"]
    particles.fields = together
    particles.components = {"velocity": list("xyz"), "stress": STRESSES}
    return particles


STRESSES = ["xx", "yy", "zz", "xy", "yz", "xz"]


def read_checkpoint_body(group, number: int, body: dict, contents: dict) -> Dict[str, np.ndarray]:
    """The columns of a body's particles by name, in the order of their ids (of halves of one that was split, of their
    paths)."""
    values, ids, given = group["particles"][()], group["ids"][()].ravel(), group["given_ids"][()].ravel()
    axes = [axis - 1 for axis in contents["axes"]]
    names = body["columns"].split()[2:]                 # behind position and velocity, a column along each axis
    columns = dict(zip(names, values[:, 2 * len(axes):].T))
    order = np.lexsort((columns.get("path", ids), ids))
    position, velocity = np.zeros((len(ids), 3)), np.zeros((len(ids), 3))
    position[:, axes] = np.array(contents["origin"]) + contents["cell"] * values[:, :len(axes)]
    velocity[:, axes] = values[:, len(axes):2 * len(axes)]
    if "swirl" in columns:                              # around the axis: moment over radius, both in cells
        velocity[:, 1] = columns["swirl"] / values[:, 0]
    if "mean_stress" in columns:
        mean = columns.pop("mean_stress")
        columns.update({f"stress_{c}": mean for c in ("xx", "yy", "zz")})
    table = {"id": given[ids - body["first_id"]] if len(given) else ids, "body": np.full(len(ids), number),
             "position": position, "velocity": velocity, **columns}
    return {name: column[order] for name, column in table.items()}


def first_dump(source: Path) -> Optional[Particles]:
    """The first dump of an output folder, if there is a series."""
    try:
        return dumps_of(folder_of(source))[0].read()
    except (SgmpFileError, IndexError):
        return None


# ---------------------------------------------------------------- units

KNOWN_UNITS = {  # (length, mass, time): (energy, stress, velocity, momentum)
    ("m", "kg", "s"): ("J", "Pa", "m/s", "N s"),
    ("mm", "g", "ms"): ("mJ", "MPa", "m/s", "mN s"),
    ("mm", "kg", "ms"): ("J", "GPa", "m/s", "N s"),
    ("cm", "g", "us"): ("100 kJ", "Mbar", "cm/us", "g cm/us"),
    ("m", "kg", "ms"): ("MJ", "MPa", "km/s", "kN s"),
    ("mm", "mg", "us"): ("J", "GPa", "km/s", "mN s"),
    ("mm", "t", "s"): ("mJ", "MPa", "mm/s", "N s"),
}


def read_units(folder: Path) -> Dict[str, str]:
    """Unit labels of an output folder: length, mass, time, energy, stress, velocity, momentum ('' if not declared)."""
    folder = Path(folder)
    base = ("", "", "")
    try:
        units = read_summary(folder).get("units")
        if isinstance(units, dict):
            base = tuple(units.get(key) or "" for key in ("length", "mass", "time"))
    except SgmpFileError:
        pass
    if not all(base) and (folder / "run.log").exists():  # of a run that has not ended: the deck in its log
        found = re.search(r"^units (\S+) (\S+) (\S+)(?: .*)?$", (folder / "run.log").read_text(errors="replace"), re.M)
        base = found.groups() if found else base
    if not all(base):
        return dict.fromkeys(("length", "mass", "time", "energy", "stress", "velocity", "momentum"), "")
    length, mass, time = base
    energy, stress, velocity, momentum = KNOWN_UNITS.get(
        base, (f"{mass} {length}²/{time}²", f"{mass}/({length} {time}²)", f"{length}/{time}", f"{mass} {length}/{time}")
    )
    return dict(length=length, mass=mass, time=time, energy=energy, stress=stress, velocity=velocity, momentum=momentum)


def label(text: str, unit: str) -> str:
    """An axis label with its unit, if there is one."""
    return f"{text} ({unit})" if unit else text


def field_unit(name, units):
    """Unit of a field by its name."""
    if name in ("x", "y", "z", "displacement", "initial_position"):
        return units["length"]
    for start, unit in (
        ("stress", units["stress"]), ("pressure", units["stress"]), ("yield", units["stress"]),
        ("velocity", units["velocity"]), ("temperature", "K"), ("volume", units["length"] and units["length"] + "³"),
        ("density", units["mass"] and f"{units['mass']}/{units['length']}³"), ("mass", units["mass"]),
        ("energy", units["energy"]),
    ):
        if name.startswith(start):
            return unit
    return ""


def field_label(name, units):
    """Words and unit of a field."""
    words = {"stress": "von Mises stress", "velocity": "speed"}.get(name, name.replace("_", " "))
    if name in PLASTIC_STRAIN:
        words = "equivalent plastic strain"
    return label(words, field_unit(name, units))


def plot_style() -> dict:
    """Settings that all figures share; colours that colour-blind readers can tell apart (Okabe and Ito)."""
    from matplotlib import cycler
    colours = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
    return {
        "axes.prop_cycle": cycler(color=colours),
        "font.size": 10,
        "axes.grid": True,
        "grid.alpha": 0.25,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "legend.frameon": False,
        "figure.dpi": 110,
        "savefig.dpi": 200,
        "lines.linewidth": 1.6,
        "axes.formatter.limits": (-3, 4),
        "axes.formatter.use_mathtext": True,
    }


def existing(path: Path) -> Path:
    """The path, or an error that says it is missing."""
    path = Path(path)
    if not path.exists():
        raise SgmpFileError(f"{path}: no such file or folder")
    return path
