#!/usr/bin/env python3
"""Draws the roofline of a result of bench.py: flops per second of every case against its flops per byte of particle
data.

usage: plot_bench.py [build/bench/results.json] [-o PICTURE]
"""
import argparse
import json
import pathlib

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
COLOURS = {1: "tab:blue", 2: "tab:orange"}


def draw(results, picture):
    """Ceilings as lines, cases as numbered points."""
    figure, axes = plt.subplots(figsize=(8.5, 5.2))
    intensities = [0.3, 30.0]
    for threads, ceiling in results["ceilings"].items():
        colour = COLOURS.get(int(threads), "grey")
        peak, stream = ceiling["gigaflops"], ceiling["gigabytes_per_second"]
        axes.plot(
            [intensities[0], peak / stream, intensities[1]], [intensities[0] * stream, peak, peak], color=colour, lw=1.5
        )
        label = "thread" if threads == "1" else "threads"
        axes.annotate(
            f"{threads} {label}: {peak:.0f} Gflop/s, {stream:.0f} GB/s", (intensities[1], peak), xytext=(-2, 4),
            textcoords="offset points", ha="right", color=colour, fontsize=9,
        )
    names = list(dict.fromkeys(row["case"] for row in results["rows"]))
    for row in results["rows"]:
        x, y = row["flops"]/row["bytes"], row["flops"]/row["ns_median"]
        colour = COLOURS.get(row["threads"], "grey")
        axes.plot(x, y, "o", color=colour, ms=4)
        axes.annotate(str(names.index(row["case"]) + 1), (x, y), xytext=(4, 3), textcoords="offset points", fontsize=8,
                      color=colour)
    axes.plot([], [], " ", label="\n".join(f"{number + 1:2d}  {name}" for number, name in enumerate(names)))
    axes.legend(loc="lower right", fontsize=8, handlelength=0, frameon=False)
    axes.set(xscale="log", yscale="log", xlim=intensities, ylim=[0.5, 200.0], ylabel="Gflop/s",
             xlabel="flops per byte of particle data", title=f"Roofline, {results['processor']}, double precision")
    axes.grid(alpha=0.3, which="both")
    figure.tight_layout()
    picture.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(picture, dpi=110)
    print(f"written: {picture}")


def main():
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="?", default=str(ROOT/"build"/"bench"/"results.json"))
    parser.add_argument("-o", "--output", default=str(ROOT/"build"/"bench"/"roofline.png"))
    options = parser.parse_args()
    draw(json.loads(pathlib.Path(options.results).read_text()), pathlib.Path(options.output))


if __name__ == "__main__":
    main()
