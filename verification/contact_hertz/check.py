"""Force of a rigid plate on an elastic sphere against Hertz."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from contact_tools import finding, run  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


def case(cells, **parameters):
    """Mean of force over Hertz's force for indentations of 1.5 to 2 % of the radius."""
    data = run(os.path.join(HERE, "hertz.inp"), cells=cells, **parameters)
    last = data["contact"][-1]["time"]
    ratios = []
    for row in data["contact"]:
        depth = 0.02*row["time"]/last
        if depth > 0.015:
            ratios.append(4*row["force_z"]/(4/3/(1 - 0.3**2)*depth**1.5))
    return sum(ratios)/len(ratios)


def main():
    """Three sizes; the finest counts."""
    results = []
    for cells in (8, 16, 24):
        ratio = case(cells)
        results.append(finding(f"{cells} cells per radius, force over Hertz's", ratio - 1, 0.05))
    return results


if __name__ == "__main__":
    sys.exit(0 if main()[-1]["pass"] else 1)
