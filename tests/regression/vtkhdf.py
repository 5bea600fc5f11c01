#!/usr/bin/env python3
"""particles.vtkhdf as VTK reads it: every step with its time, and the values of the .vtu files.

usage: vtkhdf.py SGMP SOURCE_DIR SCRATCH_DIR
"""
import os
import sys
import xml.etree.ElementTree

from _restarts import Going, checkpoints, clear, command, deck, execute, same_files, straight
from _runs import Report

try:
    import numpy
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
except ImportError as missing:
    print(
        f"SKIPPED: {missing}; scripts/setup/setup.sh --test installs it (pip install -r "
        f"scripts/setup/requirements-test.txt)"
    )
    sys.exit(77)

VERTEX = 1
BOTH = "output vtkhdf every={every} fields={fields}\noutput vtu every={every}\n"
EVERY_FIELD = "stress,pressure,density,volume,mass,von_mises,displacement,initial_position"
# Particles leave the grid, so that steps differ in their numbers.
LEAVING = """
dimension 2
grid cell=1 x=0:8 y=0:open
wall y-=slip
lost remove
time end=0.012 cfl=0.5
material m elastic density=7.85e-3 young=210 poisson=0.3
body b block material=m lower=(1,0) upper=(6,4) spacing=0.5
body c block material=m lower=(1,5) upper=(3,7) spacing=0.5
velocity b x="300" y="-40"
"""
# One particle between a wall and the open, which after some dumps is torn into two, those into more.
TORN = """
dimension 1
grid cell=1 x=0:open
wall x-=fixed
method sgmp split=0.6
time dt=0.05 steps=60
material rubber neo_hookean density=1 young=1e-6 poisson=0
body one block material=rubber lower=0 upper=0.5 ppc=2
velocity one x=1
"""
SCENES = [
    ("bar", deck("bar.inp", BOTH.format(every=0.011, fields="stress")), {"cells": 8, "steps": 100, "dt": 1e-3}, 11),
    ("leaving", LEAVING + BOTH.format(every=0.001, fields=EVERY_FIELD), {}, 13),
    ("block", deck("block.inp", BOTH.format(every=1e-4, fields="plastic_strain,temperature,stress")),
     {"cells": 3, "steps": 50, "material": "johnson_cook", "drift": 0.2}, 15),
    ("torn", TORN + BOTH.format(every=0.1, fields=EVERY_FIELD + ",path"), {}, 31),
    ("ends_only", deck("block.inp", "output vtkhdf\noutput vtu\n"), {"cells": 3, "steps": 7}, 2),
]


def read_vtu(folder):
    """Times and grids of the collection."""
    tree = xml.etree.ElementTree.parse(os.path.join(folder, "particles.pvd"))
    for item in tree.iter("DataSet"):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(os.path.join(folder, item.get("file")))
        reader.Update()
        yield float(item.get("timestep")), reader.GetOutput()


def same_grid(report, title, one, other):
    """The same points, cells and values."""
    report.check(
        one.GetNumberOfPoints() == other.GetNumberOfPoints() == one.GetNumberOfCells(),
        f"{title}: {one.GetNumberOfPoints()} points, {one.GetNumberOfCells()} cells, {other.GetNumberOfPoints()} in "
        f"the .vtu",
    )
    pairs = [("points", one.GetPoints().GetData(), other.GetPoints().GetData()),
             ("connectivity", one.GetCells().GetConnectivityArray(), other.GetCells().GetConnectivityArray()),
             ("offsets", one.GetCells().GetOffsetsArray(), other.GetCells().GetOffsetsArray())]
    names = [other.GetPointData().GetArrayName(number) for number in range(other.GetPointData().GetNumberOfArrays())]
    report.check(names and sorted(names) == sorted(one.GetPointData().GetArrayName(number)
                                                   for number in range(one.GetPointData().GetNumberOfArrays())),
                 f"{title}: other fields than {names}")
    pairs += [(name, one.GetPointData().GetArray(name), other.GetPointData().GetArray(name)) for name in names]
    for name, first, second in pairs:
        if report.check(first is not None and second is not None, f"{title}: no {name}"):
            first, second = vtk_to_numpy(first), vtk_to_numpy(second)
            report.check(first.shape == second.shape and numpy.array_equal(first, second), f"{title}: other {name}")
    report.check(
        all(one.GetCellType(cell) == VERTEX for cell in range(one.GetNumberOfCells())), f"{title}: not vertices"
    )


def compare(report, name, folder, dumps):
    """All steps of both."""
    reader = vtkHDFReader()
    reader.SetFileName(os.path.join(folder, "particles.vtkhdf"))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    expected = list(read_vtu(folder))
    report.check(len(times) >= dumps, f"{name}: {len(times)} steps, expected {dumps} at least")
    if report.check(list(times) == [time for time, _ in expected], f"{name}: times {times}"):
        for time, grid in expected:
            reader.UpdateTimeStep(time)
            same_grid(report, f"{name} at {time:g}", reader.GetOutput(), grid)


def crash(report, name, text, settings, most, least):
    """After kill -9 in the middle of the dumps the file is sound, and a restart completes it."""
    whole = straight(report, name + "_straight", text, **settings)
    clear(name)
    going = Going(command(name, text, (), settings), name)
    going.wait_for(lambda: len(checkpoints(going.folder)) > 1)
    folder = going.kill().folder
    reader = vtkHDFReader()
    reader.SetFileName(os.path.join(folder, "particles.vtkhdf"))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()) or ()
    report.check(least <= len(times) < most, f"{name}: {len(times)} steps after kill -9")
    for time in times[::5]:
        reader.UpdateTimeStep(time)
        report.check(reader.GetOutput().GetNumberOfPoints() == whole["particles"], f"{name}: {time} cannot be read")
    result = execute(command(name, text, ("--restart", "latest"), settings), name)
    if report.finished(result, name):
        same_files(report, whole.folder, folder, name)


def main():
    """All scenes, and a crash."""
    report = Report()
    for name, text, settings, dumps in SCENES:
        result = straight(report, name, text, **settings)
        if report.check(
            os.path.exists(os.path.join(result.folder, "particles.vtkhdf")), f"{name}: no file\n{result.text}"
        ):
            compare(report, name, result.folder, dumps)
    # How many dumps there will be is known, or is not.
    crash(report, "crash_known", deck("taylor_bar.inp", "output vtkhdf every=t_end/20\ncheckpoint every=30\n"),
          {"h": 1.9, "cfl": 0.5}, 21, 2)
    crash(report, "crash_unknown", deck("block.inp", "output vtkhdf every=5e-5 fields=stress\ncheckpoint every=30\n"),
          {"cells": 6, "steps": 300, "drift": 0.1}, 10**6, 20)
    report.end()


main()
