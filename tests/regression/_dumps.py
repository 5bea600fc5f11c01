"""Output folders as sgmp writes them, of clouds of particles that a test makes: what is in them is known."""

import json
import os
import shutil

from sgmp_view.files import Particles
from sgmp_view.revolve import write_vtu
import numpy as np

HEAD = "step,time,body,mass,x,y,z,velocity_x,velocity_y,velocity_z,kinetic_energy,internal_energy,particles,name\n"


def lattice(lower, upper, spacing):
    """Centres of the cubes (squares in the plane y = 0) that fill a box."""
    axes = [
        np.arange(low + 0.5 * spacing, high, spacing) if high > low else np.array([low])
        for low, high in zip(lower, upper)
    ]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


class Cloud:
    """Particles of one body at one time."""

    def __init__(self, points, velocity=(0, 0, 0), density=1.0, failed=False, ids=None):
        self.points = np.array(points, float)
        self.velocity = np.broadcast_to(np.array(velocity, float), self.points.shape).copy()
        self.failed = np.broadcast_to(np.array(failed), len(points)).copy()
        self.density = density
        self.ids = np.arange(1, len(points) + 1) if ids is None else np.asarray(ids)

    def kept(self, chosen):
        """Some of them."""
        new = Cloud(self.points[chosen], self.velocity[chosen], self.density, self.failed[chosen], self.ids[chosen])
        return new


def write_run(folder, dumps, *, spacing, cell, dimension=3, log="", with_mass=True, with_damage=True):
    """An output folder. `dumps`: (time, {name: Cloud}) each; masses are density times volume, of rings all of it."""
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    names = list(dumps[0][1])
    rows, entries, offset = [], [], 0
    for number, (time, bodies) in enumerate(dumps):
        fields = {"id": [], "body": [], "mass": [], "velocity": [], "damage": [], "points": []}
        offset = 0
        for k, name in enumerate(names, 1):
            cloud = bodies[name]
            size = spacing ** (2 if dimension in (2, "axisymmetric") else 3)
            mass = np.full(len(cloud.points), cloud.density * size)
            if dimension == "axisymmetric":
                mass = mass * 2 * np.pi * dumps[0][1][name].points[cloud.ids - 1, 0]
            for key, values in (
                ("id", cloud.ids + offset),
                ("body", np.full(len(mass), k)),
                ("mass", mass),
                ("velocity", cloud.velocity),
                ("damage", cloud.failed.astype(float)),
                ("points", cloud.points),
            ):
                fields[key].append(values)
            offset += len(dumps[0][1][name].points)
            total = max(mass.sum(), 1e-300)
            mean = mass @ cloud.velocity / total
            place = mass @ cloud.points / total
            energy = 0.5 * mass @ (cloud.velocity**2).sum(axis=1)
            rows.append(
                ",".join(str(v) for v in (number, time, k, mass.sum(), *place, *mean, energy, 0.0, len(mass), name))
            )
        joined = {key: np.concatenate(values) for key, values in fields.items()}
        points = joined.pop("points")
        joined = {
            key: values
            for key, values in joined.items()
            if (with_mass or key != "mass") and (with_damage or key != "damage")
        }
        joined["id"], joined["body"] = joined["id"].astype("i4"), joined["body"].astype("i4")
        write_vtu(
            Particles(None, points, joined, {"velocity": list("xyz")}, time=float(time)),
            os.path.join(folder, f"particles_{number}.vtu"),
        )
        entries.append(f'<DataSet timestep="{time}" file="particles_{number}.vtu"/>')
    for file, text in (
        ("particles.pvd", f"<VTKFile><Collection>{''.join(entries)}</Collection></VTKFile>"),
        ("bodies.csv", HEAD + "\n".join(rows) + "\n"),
        (
            "summary.json",
            json.dumps(
                {
                    "dimension": dimension,
                    "h": cell,
                    "spacing": spacing,
                    "exit_status": 0,
                    "verdict": "sound",
                    "time": dumps[-1][0],
                    "steps": 1,
                    "particles": offset,
                    "method": "sgmp",
                    "title": "made <by> hand & known",
                    "units": {"length": "mm", "mass": "g", "time": "ms"},
                }
            ),
        ),
        ("run.log", "sgmp\ndeck\n" + log + "\n\n"),
        ("history.csv", "time,kinetic_energy,internal_energy,total_energy,momentum_z\n0,1,0,1,-1\n1,0.5,0.5,1,-1\n"),
    ):
        with open(os.path.join(folder, file), "w", encoding="utf-8") as stream:
            stream.write(text)
