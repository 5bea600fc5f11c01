#!/usr/bin/env python3
"""A feature lives in one place: how many files outside of its folder name it.

usage: features.py SOURCE_DIR [--list]

A feature is named by a word of its own in the code, its texts included: a module, a procedure, a component, a word of
the deck. Comments do not count. To take a feature out, its folder goes and its lines in these files. More files than
BOUNDS says are an error, and so are fewer: then the bound goes down. A feature of the recipe in doc/developer-guide.md
has 5 at most.
"""
import pathlib
import re
import sys

# Feature (a folder of src/features): the words that name it, and the files outside that do.
BOUNDS = {
    "splitting": (r"\w*splitting\w*|split_(?:particles|most)|sum_split|split(?==)|(?<=')split(?=')", 5),
    "wall_friction": (
        r"\w*wall_?friction\w*|walls_rub|wall_nodes_(?:rub|stick)|wall_velocity_rubbed|"
        r"nodes_(?:friction|pressed|pulled)|friction_power",
        5,
    ),
    "swirl": (r"\w*swirl\w*", 29),
}
STRING = re.compile(r"'[^']*'|\"[^\"]*\"")


def code(line):
    """The line without its comment."""
    bare = STRING.sub(lambda match: "_"*len(match.group()), line)
    return line[:bare.index("!")] if "!" in bare else line


def naming(root, feature):
    """Files outside the folder of a feature that name it."""
    words = re.compile(rf"(?<![A-Za-z0-9_])(?:{BOUNDS[feature][0]})(?![A-Za-z0-9_])", re.IGNORECASE)
    folder = root/"features"/feature
    return [
        path.relative_to(root).as_posix()
        for path in sorted(root.rglob("*.[fF]90"))
        if folder not in path.parents
        and any(words.search(code(line)) for line in path.read_text(encoding="utf-8").splitlines())
    ]


def main():
    root = pathlib.Path(sys.argv[1], "src")
    wrong = 0
    for feature, (_, bound) in BOUNDS.items():
        files = naming(root, feature)
        print(
            f"{feature}: {len(files)} files outside of its folder"
            + (": " + " ".join(files) if "--list" in sys.argv else "")
        )
        if len(files) != bound:
            wrong += 1
            print(
                f"  the bound is {bound}: "
                + ("it goes down" if len(files) < bound else "see the recipe in doc/developer-guide.md")
                + "\n  "
                + "\n  ".join(files)
            )
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
