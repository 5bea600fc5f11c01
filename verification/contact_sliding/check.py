"""A block slides down a rigid incline at 0, 30 and 45 degrees to the grid: way against Coulomb friction."""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from contact_tools import finding, run  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


def main():
    """All methods and angles."""
    results = []
    for method in ("sgmp", "mpm", "gimp"):
        for turn in (0, 30, 45):
            data = run(os.path.join(HERE, "slide.inp"), method=method, turn=turn)
            block = [row for row in data["bodies"] if row["body"] == 2]
            way = math.hypot(block[-1]["x"] - block[0]["x"], block[-1]["y"] - block[0]["y"])
            exact = 5*(math.sin(math.pi/6) - 0.3*math.cos(math.pi/6))*block[-1]["time"]**2
            results.append(finding(f"{method} at {turn} degrees to the grid, way", way/exact - 1, 0.01))
    return results


if __name__ == "__main__":
    sys.exit(0 if all(result["pass"] for result in main()) else 1)
