"""Two bars in one dimension: stress, duration and rebound against the exact solution."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from contact_tools import finding, run  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


def case(**parameters):
    """One run; equal wave speeds, so the bars part after 2 L/c; Z = ratio for the second bar."""
    data = run(os.path.join(HERE, "bars.inp"), **parameters)
    ratio = parameters.get("ratio", 1)
    label = " ".join(f"{key}={value}" for key, value in parameters.items())
    force = 1e-3*ratio/(1 + ratio)
    middle = [-row["force_x"] for row in data["contact"] if 0.5 < row["time"] < 1.5]
    results = [finding(label + " stress while in contact", sum(middle)/len(middle)/force - 1, 0.02)]
    loaded = [row["time"] for row in data["contact"] if -row["force_x"] > 0.5*force]
    results.append(finding(label + " time of separation", loaded[-1]/2 - 1, 0.02))
    start = data["history"][0]["momentum_x"]
    results.append(finding(label + " momentum drift", max(abs(row["momentum_x"]/start - 1) for row in data["history"]), 1e-11))
    return results


def main():
    """All cases."""
    results = []
    for method in ("sgmp", "mpm", "gimp"):
        for ratio in (1, 4):
            results += case(method=method, cells=100, ratio=ratio)
    return results


if __name__ == "__main__":
    sys.exit(0 if all(result["pass"] for result in main()) else 1)
