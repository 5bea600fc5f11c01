#!/usr/bin/env python3
"""layers.py must notice: each fault below is put into a copy of src/, and must be named.

usage: faults.py SOURCE_DIR
"""
import pathlib
import shutil
import sys
import tempfile

import layers

KINDS, ERRORS, MAIN = "base/kinds.f90", "base/errors.f90", "run/main.f90"
STAGES = "features/rigid/rigid_stages.f90"
# what is done: file of src/, text that is added, what must be said
FAULTS = {
    "an arrow upwards": (KINDS, "  USE, non_intrinsic :: sgmp_mesh, only: mesh_t\n", "base may not use mesh"),
    "an arrow upwards to a generic module": (KINDS, "  use sgmp_auxmesh_3d\n", "base may not use"),
    "an arrow upwards by inclusion": (KINDS, "#include \"above.inc\"\n", "base may not use run (src/run/above.inc)"),
    "a kernel that uses a feature's stages": (
        "kernels/nodes.F90", "  use sgmp_wall_friction_stages\n", "kernels may not use step",
    ),
    "a feature's point procedures that use the step": (
        "features/swirl/swirl.f90", "  use sgmp_model\n", "features may not use step",
    ),
    "a feature's stages that use the setup": (STAGES, "  use sgmp_build_model\n", "step may not use setup"),
    "a feature's card that uses the step": (
        "features/swirl/new_card.f90", "  use sgmp_model\n", "deck may not use step",
    ),
    "the step that uses a feature's construction": (
        "step/step.f90", "  use sgmp_rigid_build\n", "step may not use setup",
    ),
    "a file beside the features": (
        "features/alone.f90", "module sgmp_alone\n", "a feature is a folder of src/features",
    ),
    "a circle of files": (ERRORS, "  use sgmp_circle_test, only: a\n", "a circle of files: src/base/"),
    "a file in an unknown folder": ("driver/model.f90", "module sgmp_unknown\n", "src/driver/model.f90: in no folder"),
    "a file in no folder": ("alone.f90", "module sgmp_alone\n", "src/alone.f90: in no folder"),
    "a module that is nowhere": (KINDS, "  use sgmp_nowhere\n", "has the module sgmp_nowhere"),
    "a library in the wrong place": (KINDS, "  use mpi_f08, only: MPI_Comm\n", "mpi_f08 belongs to parallel"),
    "a serial file without one above it": (
        "files/serial/alone.f90", "module sgmp_alone\n", "of the folder above has not the same",
    ),
    "a module twice": ("run/twice.f90", "module sgmp_mesh\n", "module sgmp_mesh is also in"),
}


def errors_with(source, path, text):
    with tempfile.TemporaryDirectory() as scratch:
        shutil.copytree(source / "src", pathlib.Path(scratch, "src"))
        target = pathlib.Path(scratch, "src", path)
        target.parent.mkdir(exist_ok=True)
        with target.open("a", encoding="utf-8") as file:
            file.write(text)
        pathlib.Path(scratch, "src/run/above.inc").touch()
        pathlib.Path(scratch, "src/base/circle_test.f90").write_text("module sgmp_circle_test\n  use sgmp_errors\n")
        return layers.check(scratch)[2]


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    failures = [f"{what} was not noticed: {found}" for what, (path, text, said) in FAULTS.items()
                for found in [errors_with(root, path, text)] if not any(said in error for error in found)]
    failures += [
        f"a fault was seen where none is: {error}" for error in errors_with(root, KINDS, "! a comment: use sgmp_mesh\n")
    ]
    print("\n".join([*failures, f"{len(FAULTS)} faults, {len(failures)} failures"]))
    sys.exit(1 if failures else 0)
