"""Closed surfaces of triangles from STL files: their volume, and the centres of a lattice's cubes inside. Needs VTK."""

import contextlib

import numpy as np

from .files import SgmpFileError, existing

BATCH = 2_000_000  # points asked at a time


def vtk_modules():
    """The parts of VTK that are used; they are heavy, and most commands do without."""
    try:
        from vtkmodules.util import numpy_support
        from vtkmodules import vtkCommonCore, vtkCommonDataModel, vtkFiltersCore, vtkFiltersModeling, vtkIOGeometry
    except ImportError:
        raise SgmpFileError("STL files need VTK: pip install vtk (from the sources: make setup-test)") from None
    return numpy_support, vtkCommonCore, vtkCommonDataModel, vtkFiltersCore, vtkFiltersModeling, vtkIOGeometry


class Surface:
    """A closed surface, scaled and moved."""

    def __init__(self, path, scale=1.0, move=(0.0, 0.0, 0.0)):
        self.path = existing(path)
        self.numpy_support, self.core, self.data, self.filters, self.modeling, self.io = vtk_modules()
        surface = self._read()
        self._refuse_open(surface)
        self.surface = self._oriented(surface)
        points = self._points() * scale + np.asarray(move)
        self._set_points(points)
        corners = points[self._triangles()]
        middle = points.mean(axis=0)
        a, b, c = (corners[:, i] - middle for i in range(3))
        self.volume = abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6  # divergence theorem
        self.lower, self.upper = points.min(axis=0), points.max(axis=0)
        if not self.volume > 1e-12 * float(np.prod(self.upper - self.lower)):
            raise SgmpFileError(f"{path}: the surface encloses no volume")

    def _read(self):
        reader = self.io.vtkSTLReader()
        reader.SetFileName(str(self.path))
        reader.MergingOn()
        with quiet(self.core):
            reader.Update()
        surface = reader.GetOutput()
        if surface.GetNumberOfCells() == 0:
            raise SgmpFileError(f"{self.path}: no triangles; is it an STL file?")
        return surface

    def _refuse_open(self, surface):
        for open_, what in (
            (True, "open: {} edges have a triangle at one side only; close the holes in the program that wrote it"),
            (False, "not the surface of a solid: {} edges have more than two triangles"),
        ):
            edges = self.filters.vtkFeatureEdges()
            edges.SetInputData(surface)
            edges.FeatureEdgesOff()
            edges.ManifoldEdgesOff()
            edges.SetBoundaryEdges(open_)
            edges.SetNonManifoldEdges(not open_)
            edges.Update()
            number = edges.GetOutput().GetNumberOfCells()
            if number > 0:
                raise SgmpFileError(f"{self.path}: the surface is {what.format(number)}")

    def _oriented(self, surface):
        normals = self.filters.vtkPolyDataNormals()
        normals.SetInputData(surface)
        normals.SplittingOff()
        normals.ConsistencyOn()
        normals.AutoOrientNormalsOff()  # it would turn the shell of a hollow outwards, too
        normals.Update()
        return normals.GetOutput()

    def _points(self):
        return self.numpy_support.vtk_to_numpy(self.surface.GetPoints().GetData()).astype(float)

    def _set_points(self, points):
        moved = self.core.vtkPoints()
        moved.SetData(self.numpy_support.numpy_to_vtk(np.ascontiguousarray(points), deep=True))
        self.surface.SetPoints(moved)

    def _triangles(self):
        return self.numpy_support.vtk_to_numpy(self.surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)

    def sides(self):
        """Sides of the box around it, for messages."""
        return " x ".join(f"{side:.4g}" for side in self.upper - self.lower)

    def fill(self, spacing, origin=None):
        """Centres (n, 3) of the cubes inside, x fastest; `origin` is a corner of one (default: the lower corner of the
        solid)."""
        origin = self.lower if origin is None else np.asarray(origin)
        first = np.floor((self.lower - origin) / spacing - 1e-9).astype(int)
        last = np.ceil((self.upper - origin) / spacing + 1e-9).astype(int)
        axes = [origin[i] + (np.arange(first[i], last[i]) + 0.5) * spacing for i in range(3)]
        layers = max(1, BATCH // (len(axes[0]) * len(axes[1])))
        inside = [self._inside(axes[0], axes[1], axes[2][k:k + layers]) for k in range(0, len(axes[2]), layers)]
        return np.concatenate(inside)

    def _inside(self, x, y, z):
        grid = np.stack(np.meshgrid(z, y, x, indexing="ij")[::-1], axis=-1).reshape(-1, 3)
        cloud = self.data.vtkPolyData()
        points = self.core.vtkPoints()
        points.SetData(self.numpy_support.numpy_to_vtk(grid, deep=True))
        cloud.SetPoints(points)
        enclosed = self.modeling.vtkSelectEnclosedPoints()
        enclosed.SetInputData(cloud)
        enclosed.SetSurfaceData(self.surface)
        enclosed.SetTolerance(1e-9)
        enclosed.Update()
        chosen = self.numpy_support.vtk_to_numpy(enclosed.GetOutput().GetPointData().GetArray("SelectedPoints"))
        return grid[chosen > 0]


@contextlib.contextmanager
def quiet(core):
    """Without VTK's own lines about what is wrong with a file."""
    before = core.vtkObject.GetGlobalWarningDisplay()
    core.vtkObject.SetGlobalWarningDisplay(0)
    try:
        yield
    finally:
        core.vtkObject.SetGlobalWarningDisplay(before)
