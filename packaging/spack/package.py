"""Recipe for Spack: put this folder as packages/sgmp into a repository of your own (spack repo create), then
spack install sgmp."""
from spack.package import *


class Sgmp(CMakePackage):
    """Explicit solver for impact, penetration and blast with the staggered grid material point method."""

    git = "file:///path/to/sgmp"  # a clone of the sources

    license("BSD-3-Clause")

    version("main", branch="main")
    version("1.0.0", tag="v1.0.0")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.21:", type="build")
    depends_on("mpi")
    depends_on("hdf5+mpi+fortran")
    depends_on("muparser")

    conflicts("%gcc@:10", msg="std::to_chars of numbers needs g++ 11")

    def cmake_args(self):
        # Spack's compiler wrapper chooses the machine.
        return [self.define("SGMP_BUILD_TESTS", False), self.define("SGMP_ARCH", "x86-64-v3")]
