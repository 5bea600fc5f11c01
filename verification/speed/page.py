"""Figures and tables of doc/speed-and-accuracy.md from the runs that have been made."""
import csv
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from matplotlib.ticker import LogLocator  # noqa: E402

from common import ROOT, plt, subplots  # noqa: E402
from scenes import METHODS, SCENES  # noqa: E402

PAGE = ROOT / "doc/speed-and-accuracy.md"
NAMES = {
    "sgmp": "SGMP",
    "plain": "plain SGMP",
    "mpm": "MPM",
    "gimp": "GIMP",
    "cpgimp": "cpGIMP",
    "bspline": "B-spline",
    "sgmp normalised": "SGMP, normalised",
    "sgmp usf": "SGMP USF",
    "sgmp usl": "SGMP USL",
    "sgmp usavg": "SGMP USAVG",
}
# Okabe and Ito's colours, which people with any kind of colour blindness tell apart; line and marker differ as well.
LOOKS = {
    "sgmp": ("#0072B2", "s", "-"),
    "plain": ("#56B4E9", "D", "-"),
    "mpm": ("#D55E00", "o", "-"),
    "gimp": ("#E69F00", "^", "-"),
    "cpgimp": ("#CC79A7", "v", "-"),
    "bspline": ("#009E73", "P", "-"),
    "sgmp normalised": ("#0072B2", "x", ":"),
    "sgmp usf": ("#000000", "1", "--"),
    "sgmp usl": ("#000000", "2", ":"),
    "sgmp usavg": ("#000000", "3", "-."),
}


def chosen(best, rows):
    """Of each size the run with the best Courant number, or with the largest below it that there is."""
    found = {}
    for row in rows:
        if best and row["error"] is not None and row["courant"] <= best:
            if row["size"] not in found or row["courant"] > found[row["size"]]["courant"]:
                found[row["size"]] = row
    return list(found.values())


def draw(name, scene, curves):
    """Error over seconds, of the whole process and of the solution alone."""
    figure, axes = subplots(1, 2, figsize=(10.4, 4.3), sharey=True)
    for axis, key, label in zip(
        axes, ("process", "solve"), ("CPU time of the whole process (s)", "CPU time of the time loop (s)")
    ):
        for curve, (best, rows) in curves.items():
            rows = sorted(chosen(best, rows), key=lambda row: (scene.scan + scene.fine).index(row["size"]))
            colour, marker, line = LOOKS[curve]
            axis.plot(
                [max(row[key], 1e-3) for row in rows], [row["error"] for row in rows], line, color=colour,
                marker=marker, markersize=5, linewidth=1.3, label=f"{NAMES[curve]}, C = {best:g}" if best else None,
            )
        axis.set(xscale="log", yscale="log", xlabel=label)
        for scale in (axis.xaxis, axis.yaxis):  # 1, 2, 5, 10 …: more would run into each other
            scale.set_minor_locator(LogLocator(subs=(2, 5)))
            low, high = scale.get_view_interval()
            scale.set_minor_formatter("{x:g}" if high < 500*low or scale is axis.yaxis else "")
            scale.set_major_formatter("{x:g}")
        axis.grid(which="both", alpha=0.25)
    axes[0].set_ylabel(scene.label[0].upper() + scene.label[1:])
    axes[0].set_title(scene.title, loc="left", fontweight="bold")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside right upper", handlelength=3)
    folder = PAGE.with_suffix("")
    folder.mkdir(exist_ok=True)
    figure.savefig(folder / f"{name}.png")
    plt.close(figure)


def seconds(value):
    return f"{value:.2g}" if value < 1 else f"{value:.1f}"


def cheapest(rows, goal):
    """The run that reaches an error at the least cost, with any Courant number; None where none does."""
    good = [row for row in rows if row["error"] is not None and row["error"] <= goal]
    return min(good, key=lambda row: row["process"]) if good else None


def summary(found):
    """CPU seconds for an error, by methods; the least is bold."""
    lines = [
        "| scene | error | " + " | ".join(NAMES[method] for method in METHODS) + " | SGMP, other words |",
        "|" + "---|" * (len(METHODS) + 3),
    ]
    for name, curves in found.items():
        for goal in SCENES[name].goals:
            runs = {method: cheapest(curves[method][1], goal) if method in curves else None for method in METHODS}
            others = [run for curve in curves if curve not in METHODS and (run := cheapest(curves[curve][1], goal))]
            runs["other"] = min(others, key=lambda run: run["process"], default=None)
            least = min((run["process"] for run in runs.values() if run), default=None)
            cells = [
                "–"
                if run is None
                else f"**{seconds(run['process'])}**"
                if run["process"] <= 1.1 * least
                else seconds(run["process"])
                for run in runs.values()
            ]
            if runs["other"]:
                cells[-1] += " " + NAMES[runs["other"]["curve"]].split()[-1]
            unit = SCENES[name].label[SCENES[name].label.rindex("("):]
            lines.append(
                f"| {SCENES[name].title} | {goal:g}{' ' + unit[1:-1] if unit != '(1)' else ''} | "
                + " | ".join(cells)
                + " |"
            )
    return lines


def counts(found):
    """Of the rows of the summary, how many each method reaches, and in how many it is within a tenth of the least, and
    within a factor of two."""
    reached, near, factor, rows = ({method: 0 for method in METHODS} for _ in range(4))
    for name, curves in found.items():
        for goal in SCENES[name].goals:
            runs = {curve: cheapest(of[1], goal) for curve, of in curves.items()}
            least = min((run["process"] for run in runs.values() if run), default=None)
            for method in METHODS:
                run = runs.get(method)
                rows[method] += 1
                reached[method] += run is not None
                near[method] += run is not None and run["process"] <= 1.1*least
                factor[method] += run is not None and run["process"] <= 2*least
    return [
        "| | " + " | ".join(NAMES[method] for method in METHODS) + " |",
        "|" + "---|"*(len(METHODS) + 1),
        *(
            f"| {text} | " + " | ".join(f"{of[method]} of {rows[method]}" for method in METHODS) + " |"
            for text, of in (
                ("reaches the error", reached), ("within a tenth of the least time", near),
                ("within twice the least time", factor),
            )
        ),
    ]


def curves_table(scene, curves):
    """Each curve's best Courant number and what it reaches at the finest size."""
    lines = [
        f"| method | best Courant number | finest ({scene.unit}) | error | process, CPU s | time loop, CPU s | steps |",
        "|---|---|---|---|---|---|---|",
    ]
    for curve, (best, rows) in curves.items():
        made, rows = len(rows), chosen(best, rows)
        if not rows:
            lines.append(f"| {NAMES[curve]} | {'none' if made else 'not run'} | | | | | |")
            continue
        finest = max(rows, key=lambda row: (scene.scan + scene.fine).index(row["size"]))
        lower = f" ({finest['courant']:g} there)" if finest["courant"] < best else ""
        lines.append(
            f"| {NAMES[curve]} | {best:g}{lower} | {finest['size']:g} | {finest['error']:.3g} | "
            f"{seconds(finest['process'])} | {seconds(finest['solve'])} | {finest['steps']} |"
        )
    return lines


def write(found, table):
    """Page, figures and a table of all runs."""
    found = {name: curves for name, curves in found.items() if any(chosen(*curve) for curve in curves.values())}
    text = (Path(__file__).with_name("head.md")).read_text()
    text = text.replace("@SUMMARY@", "\n".join(summary(found))).replace("@COUNTS@", "\n".join(counts(found)))
    for name, curves in found.items():
        scene = SCENES[name]
        draw(name, scene, curves)
        text += "\n".join(["", f"## {scene.title}", "", f"Against {scene.reference}. `{scene.deck}`.", "",
                           f"![{scene.title}](speed-and-accuracy/{name}.png)", "", *curves_table(scene, curves), ""])
        text += f"\n{scene.seen}\n" if scene.seen else ""
    PAGE.write_text(text)
    with open(table, "w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(
            [
                "scene", "curve", "size", "unit", "courant", "error", "process CPU s", "time loop CPU s",
                "process wall s", "steps", "particles",
            ]
        )
        for name, curves in found.items():
            for curve, (_, rows) in curves.items():
                for row in rows:
                    writer.writerow(
                        [
                            name, curve, row["size"], SCENES[name].unit, row["courant"],
                            "failed" if row["error"] is None else row["error"], row["process"], row["solve"],
                            row["wall"], row["steps"], row["particles"],
                        ]
                    )
    print(f"written: {PAGE.relative_to(ROOT)}, {table.relative_to(ROOT)}")
