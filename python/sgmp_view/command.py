"""The command sgmp-view: one word for each kind of figure, study or report."""

import argparse
import sys

import matplotlib

matplotlib.use("Agg")

from . import (
    compare,
    convergence,
    error,
    fragments,
    gauges,
    history,
    impact,
    map_,
    movie,
    picture,
    profile,
    report,
    revolve,
    slice_,  # noqa: E402
    solids,
    status,
    sweep,
    work_precision,
)
from .files import SgmpFileError  # noqa: E402

# word: module with `arguments(parser)` and `run(options)`, whose docstring is the help
COMMANDS = {
    "status": status,
    "report": report,
    "impact": impact,
    "fragments": fragments,
    "history": history,
    "gauges": gauges,
    "picture": picture,
    "slice": slice_,
    "profile": profile,
    "movie": movie,
    "revolve": revolve,
    "compare": compare,
    "error": error,
    "sweep": sweep,
    "convergence": convergence,
    "work-precision": work_precision,
    "solids": solids,
    "map": map_,
}


def parser():
    """The parser of all commands."""
    top = argparse.ArgumentParser(prog="sgmp-view", description=__doc__)
    words = top.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for word, module in COMMANDS.items():
        summary = module.__doc__.strip().split("\n", maxsplit=1)[0]
        module.arguments(words.add_parser(word, help=summary, description=module.__doc__,
                                          formatter_class=argparse.RawDescriptionHelpFormatter))
    return top


def main(words=None):
    """Runs one command: exit code 0, 1 with a message where an input is missing or malformed, 2 for the command
    line."""
    options = parser().parse_args(words)
    try:
        code = COMMANDS[options.command].run(options)
    except BrokenPipeError:
        code = 0
    except (SgmpFileError, OSError, ValueError) as problem:
        sys.exit(f"sgmp-view {options.command}: {problem}")
    sys.exit(code or 0)
