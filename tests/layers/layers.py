#!/usr/bin/env python3
"""The order of the house: each folder of src/ uses only itself and those before it in LAYERS; what a feature does in
the step, in the deck … ranks with these (PARTS).

usage: layers.py SOURCE_DIR

Reads the `use` statements, parents of submodules and included files of all sources. Errors (exit code 1): an arrow to a
later folder, a circle of files (a circle of folders has such an arrow), a file in no folder of LAYERS, a module that no
file and none of LIBRARIES offers, a library outside of the folders that may use it, a module in two files.
"""
import collections
import pathlib
import re
import sys

LAYERS = (
    "base", "parallel", "mesh", "geometry", "materials", "transfer", "particles", "account", "features", "deck",
    "kernels", "exchange", "step", "setup", "files", "import", "output", "checkpoint", "judge", "run",
)
# What of a feature (src/features/NAME/) ranks with a later folder, by how its file's name ends (before .f90); the rest
# ranks with features.
PARTS = {
    "_card": "deck",
    "_stages": "step",
    "_build": "setup",
    "_output": "output",
    "_state": "checkpoint",
    "_doubts": "judge",
}
# Modules from elsewhere and the folders that may use them; None: all (cmake/write_version.cmake writes sgmp_version).
LIBRARIES = {"mpi_f08": ("parallel", "files"), "hdf5": ("files",), "omp_lib": ("run",), "sgmp_version": None}
# Arrows that stand against the order until they are cut (file, file); one that is gone must go from here, too.
UNCUT = set()
SUFFIXES = (".f90", ".F90", ".inc", ".c", ".cpp", ".h")

NAME = r"(?:(?:DIM|CARTESIAN)\(\s*(\w+)\s*\)|(\w+))"
MODULE = re.compile(rf"^\s*module\s+(?!procedure\b|subroutine\b|function\b){NAME}\s*$", re.IGNORECASE)
SUBMODULE = re.compile(r"^\s*submodule\s*\(\s*(\w+)", re.IGNORECASE)
USE = re.compile(rf"^\s*use\b\s*(?:,\s*(?P<nature>\w+)\s*)?(?:::)?\s*{NAME}\s*(?:,|$)", re.IGNORECASE)
INCLUDE = re.compile(r"^\s*#?\s*include\s*['\"]([^'\"]+)['\"]", re.IGNORECASE)
STRING = re.compile(r"'[^']*'|\"[^\"]*\"")


def base_name(name):
    """The module that a source writes for all dimensions: sgmp_x for sgmp_x_1d."""
    return re.sub(r"_([123]d|rz)$", "", name.lower())


class Source:
    """A file of src/: the modules it offers, and what it uses with the line of each."""

    def __init__(self, path, root):
        self.path, self.root = path, root
        self.name = path.relative_to(root.parent).as_posix()
        parts = path.relative_to(root).parts
        self.folder = parts[0] if len(parts) > 1 else ""
        self.rank = self.folder
        self.serial = path.parent.name == "serial"
        if self.folder == "features":
            self.rank = next((folder for end, folder in PARTS.items() if path.stem.endswith(end)), self.folder)
        self.modules, self.uses, self.includes = set(), [], []
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            self.read(number, line)

    def read(self, number, line):
        included = INCLUDE.match(line)
        if included:
            self.includes.append((number, included.group(1)))
            return
        if self.path.suffix in (".c", ".cpp", ".h"):
            return
        for statement in STRING.sub("''", line).split("!", 1)[0].split(";"):
            module, parent, use = MODULE.match(statement), SUBMODULE.match(statement), USE.match(statement)
            if module:
                self.modules.add(base_name(module.group(1) or module.group(2)))
            elif parent:
                self.uses.append((number, base_name(parent.group(1))))
            elif use and (use.group("nature") or "").lower() != "intrinsic":
                self.uses.append((number, base_name(use.group(2) or use.group(3))))


def arrows(sources, errors):
    """From each file to those that it uses: {name: [(line, name)]}."""
    owner = {}
    for source in sources:
        if source.serial:  # the file above it without MPI: what others use is that one
            above = source.path.parent.parent / source.path.name
            if not any(other.path == above and other.modules == source.modules for other in sources):
                errors.append(f"{source.name}: {above.name} of the folder above has not the same module")
            continue
        for module in source.modules:
            if module in owner:
                errors.append(f"{source.name}: module {module} is also in {owner[module].name}")
            owner[module] = source
    files = {source.path.name: source for source in sources if not source.serial}
    found = collections.defaultdict(list)
    for source in sources:
        for number, module in source.uses:
            if module in owner:
                if owner[module] is not source:
                    found[source.name].append((number, owner[module]))
            elif module not in LIBRARIES:
                errors.append(f"{source.name}:{number}: no file of src/ has the module {module}")
            elif LIBRARIES[module] is not None and source.folder not in LIBRARIES[module]:
                errors.append(f"{source.name}:{number}: {module} belongs to {' and '.join(LIBRARIES[module])}")
        found[source.name] += [(number, files[name]) for number, name in source.includes if name in files]
    return found


def against_the_order(sources, found):
    rank = {folder: position for position, folder in enumerate(LAYERS)}
    uncut = set(UNCUT)
    for source in sources:
        if source.folder not in rank:
            yield f"{source.name}: in no folder of the house ({' '.join(LAYERS)})"
            continue
        if source.folder == "features" and len(source.path.relative_to(source.root).parts) != 3:
            yield f"{source.name}: a feature is a folder of src/features"
        for number, other in found[source.name]:
            if (source.name, other.name) in UNCUT:
                uncut.discard((source.name, other.name))
            elif rank.get(other.rank, -1) > rank[source.rank]:
                yield f"{source.name}:{number}: {source.rank} may not use {other.rank} ({other.name})"
    for user, used in sorted(uncut):
        yield f"{user} no longer uses {used}: take it out of UNCUT in tests/layers/layers.py"


def circles(found):
    """One circle of files per place where a walk along the arrows comes back to itself."""
    done, path = set(), []

    def walk(name):
        if name in path:
            yield "a circle of files: " + " -> ".join(path[path.index(name):] + [name])
        elif name not in done:
            path.append(name)
            for _, other in found.get(name, []):
                yield from walk(other.name)
            path.pop()
            done.add(name)

    for name in sorted(found):
        yield from walk(name)


def check(source_dir):
    """(number of files, arrows between folders, errors)"""
    root = pathlib.Path(source_dir, "src")
    sources = [Source(path, root) for path in sorted(root.rglob("*")) if path.suffix in SUFFIXES]
    errors = [] if sources else [f"{root} has no sources"]
    found = arrows(sources, errors)
    errors += list(against_the_order(sources, found)) + list(circles(found))
    between = {(source.folder, other.folder) for source in sources for _, other in found[source.name]
               if other.folder != source.folder}
    return len(sources), len(between), errors


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: layers.py SOURCE_DIR")
    count, between, wrong = check(sys.argv[1])
    print("\n".join([*wrong, f"{count} files, {between} arrows between folders, {len(wrong)} errors"]))
    sys.exit(1 if wrong else 0)
