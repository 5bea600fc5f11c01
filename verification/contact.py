"""What the contact checks share."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from common import NAMES, ROOT, Case  # noqa: E402,F401

sys.path.insert(0, str(ROOT / "scripts"))
from sgmp_io import read_table  # noqa: E402

METHODS = ("sgmp", "mpm", "gimp")


def deck(name, **parameters):
    """A case of a deck of verification/, named by folder and file."""
    return Case(f"verification/{name}.inp", **parameters)


def body(run, number):
    """Rows of one body in bodies.csv, as columns."""
    table = read_table(run.folder / "bodies.csv")
    return {name: column[table["body"] == number] for name, column in table.items()}


def contact(run):
    """Rows of contact.csv of a deck with one pair, as columns."""
    return read_table(run.folder / "contact.csv")
