#!/usr/bin/env python3
"""Two results of bench.py side by side, with the ratio of their medians; where the machines (or their moods) differ,
also the ratio of the gains over the plain scalar loop that each measured in its own sitting.

usage: compare_bench.py OLD/results.json NEW/results.json
"""
import json
import sys


def rows(path):
    """Rows of a result by case and threads."""
    with open(path) as file:
        return {(row["case"], row["threads"]): row for row in json.load(file)["rows"]}


def main():
    """Prints the table."""
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    old, new = rows(sys.argv[1]), rows(sys.argv[2])
    print(f"{'case':28s} th      old      new  new/old  gain/gain")
    for key in old:
        if key in new:
            a, b = old[key]["ns_median"], new[key]["ns_median"]
            gains = old[key].get("gain_over_reference"), new[key].get("gain_over_reference")
            gain = f"{gains[1]/gains[0]:10.2f}" if all(gains) else ""
            print(f"{key[0]:28s} {key[1]:2d} {a:8.1f} {b:8.1f} {b/a:8.2f} {gain}")


if __name__ == "__main__":
    main()
