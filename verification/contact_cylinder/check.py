"""A cylinder on a slope in plane strain: rolling below tan(angle) = 3 friction, sliding beyond."""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from contact_tools import finding, run  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


def main():
    """Rolling at 45 and sliding at 60 degrees."""
    results = []
    for angle, h, limit in ((45, 0.1, 0.02), (60, 0.1, 0.02)):
        data = run(os.path.join(HERE, "cylinder.inp"), angle=angle, h=h)
        ball = [row for row in data["bodies"] if row["body"] == 1]
        slope = math.radians(angle)
        if math.tan(slope) <= 3*0.4:
            exact = 10/3*math.sin(slope)*ball[-1]["time"]**2
        else:
            exact = 5*(math.sin(slope) - 0.4*math.cos(slope))*ball[-1]["time"]**2
        results.append(finding(f"{angle} degrees, h = {h}, way", (ball[-1]["x"] - ball[0]["x"])/exact - 1, limit))
    return results


if __name__ == "__main__":
    sys.exit(0 if all(result["pass"] for result in main()) else 1)
