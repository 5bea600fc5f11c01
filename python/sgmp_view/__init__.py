"""What sgmp writes, as numpy arrays, figures, films and reports."""

from .files import (
    Particles, SgmpFileError, read_dump, read_history, read_particles_csv, read_pvd, read_summary, read_table,
    read_units, read_vtu,
)
from .runs import Body, Run, RunError, run

__version__ = "1.0.0"
__all__ = [
    "Body", "Particles", "Run", "RunError", "SgmpFileError", "read_dump", "read_history", "read_particles_csv",
    "read_pvd", "read_summary", "read_table", "read_units", "read_vtu", "run",
]
