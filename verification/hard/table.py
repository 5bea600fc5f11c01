"""The table of hard cases: quantities of several methods beside a reference, with what the program itself said of its
runs."""
import json
import math
import sys
from pathlib import Path

from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import common  # noqa: E402
from common import COLOURS, MARKERS, NAMES, Case, plt, solve, subplots  # noqa: E402

METHODS = ("sgmp", "gimp", "mpm", "bspline")


class Bound:
    """What a value has to be."""

    def __init__(self, words, test):
        self.words, self.test = words, test

    def holds(self, value):
        """Whether a value does it."""
        return math.isfinite(value) and bool(self.test(value))


def at_most(bound):
    """Not above a bound."""
    return Bound(f"at most {bound:g}", lambda value: value <= bound)


def within(reference, relative):
    """Near a reference, in parts of it."""
    return Bound(f"within {100*relative:g} %", lambda value: abs(value - reference) <= relative*abs(reference))


def near(reference, absolute):
    """Near a reference."""
    return Bound(f"within {absolute:g}", lambda value: abs(value - reference) <= absolute)


def run_methods(deck, methods=METHODS, **parameters):
    """The same deck of verification/hard, or of another folder of verification (folder/name), by every method: runs by
    name, failed ones too."""
    path = f"verification/{deck if '/' in deck else f'hard/{deck}'}.inp"
    cases = [Case(path, method=method, **parameters) for method in methods]
    return dict(zip(methods, solve(cases, may_fail=True)))


def value_of(run, measure):
    """A measure of a run that came to its end, NaN of one that failed."""
    return float(measure(run)) if run.exit_code == 0 else math.nan


class Table:
    """All cases."""

    def __init__(self, output):
        self.output = Path(output)
        self.output.mkdir(parents=True, exist_ok=True)
        self.cases = []

    def case(self, title, statement):
        """Begins a case; the statement is all that one needs to repeat it."""
        self.cases.append({"title": title, "statement": statement, "rows": [], "pictures": [], "commands": []})
        print(f"\n{title}", flush=True)

    def row(self, quantity, values, reference, bound, runs=None, reasons=None):
        """A quantity by method. `runs`: from which their verdicts are taken; `reasons`: why a method misses the bound,
        which then is a weakness that is known."""
        reasons = reasons or {}
        cells = {}
        for method, value in values.items():
            run = (runs or {}).get(method)
            verdict = run.summary.get("verdict", "failed") if run is not None else ""
            if run is not None and run.exit_code:
                verdict = f"exit code {run.exit_code}"
            met = bound.holds(value)
            cells[method] = {"value": value if math.isfinite(value) else None, "met": met, "verdict": verdict,
                             "reason": "" if met else reasons.get(method, reasons.get("all", ""))}
        self.cases[-1]["rows"].append(
            {"quantity": quantity, "reference": reference, "bound": bound.words, "methods": cells}
        )
        print(
            f"  {quantity}: "
            + ", ".join(
                f"{method} {value:.5g}{'' if cells[method]['met'] else ' (!)'}" for method, value in values.items()
            )
            + f"; {bound.words} of {reference:g}",
            flush=True,
        )
        if runs:
            self.cases[-1]["commands"].append(next(iter(runs.values())).case.command())

    def picture(self, name, figure, caption):
        """A figure of the case."""
        figure.savefig(self.output / f"{name}.png")
        plt.close(figure)
        self.cases[-1]["pictures"].append((name, caption))

    def cells(self):
        """All of them, as (case, quantity, method, cell)."""
        for case in self.cases:
            for row in case["rows"]:
                for method, cell in row["methods"].items():
                    yield case["title"], row["quantity"], method, cell

    def unexplained(self):
        """What misses its bound without a reason."""
        return [f"{title}: {quantity}, {method} = {cell['value']}" for title, quantity, method, cell in self.cells()
                if not cell["met"] and not cell["reason"]]

    def write(self, command):
        """results.json, the same for the same executable: no times, no dates."""
        results = [{"case": case["title"], **row} for case in self.cases for row in case["rows"]]
        (self.output / "results.json").write_text(json.dumps({"command": command, "results": results}, indent=1) + "\n")

    def publish(self, path, head, keep):
        """The page of documents, with its pictures beside it; `keep`: other cases stay as they are there."""
        parts = {case["title"]: self.page_of(case, path.with_suffix("").name) for case in self.cases}
        if keep and path.exists():
            before = path.read_text().split("\n## ")[1:]
            parts = {part.split("\n")[0]: f"## {part.rstrip()}\n" for part in before} | parts
        path.with_suffix("").mkdir(exist_ok=True)
        for name in (name for case in self.cases for name, _ in case["pictures"]):
            with Image.open(self.output / f"{name}.png") as image:  # few colours are a third of the bytes
                image.convert("RGB").quantize(64).save(path.with_suffix("") / f"{name}.png", optimize=True)
        path.write_text("\n".join([head, *parts.values()]).rstrip() + "\n")

    @staticmethod
    def page_of(case, folder):
        """What the page says of a case; `folder`: that of the pictures."""
        lines = [f"## {case['title']}", "", case["statement"].strip(), ""]
        lines += [
            "| quantity | " + " | ".join(NAMES[m] for m in METHODS) + " | reference | bound | verdict of the runs |",
            "|" + "---|" * (len(METHODS) + 4),
        ]
        lines += [markdown_row(row) for row in case["rows"]] + [""]
        reasons = {}
        for row in case["rows"]:
            for method, cell in row["methods"].items():
                if cell["reason"]:
                    reasons.setdefault(cell["reason"], []).append(NAMES[method])
        lines += [f"* {', '.join(dict.fromkeys(who))}: {why}." for why, who in reasons.items()]
        lines += [""]*bool(reasons)
        if case["commands"]:
            deck, _, words = case["commands"][0].partition(" --set ")
            words = f" with\n`--set {words}`" if words else ""
            lines += [f"First row: `{deck}`{words};\nthe other methods and rows by `--set`.", ""]
        lines += [f"![{name}]({folder}/{name}.png)\n\n{caption}\n" for name, caption in case["pictures"]]
        return "\n".join(lines)


def markdown_row(row):
    """A row of the page; what misses its bound is bold."""
    cells = []
    for method in METHODS:
        cell = row["methods"].get(method)
        if cell is None:
            cells.append("")
            continue
        text = "failed" if cell["value"] is None else f"{cell['value']:.4g}"
        cells.append(text if cell["met"] else f"**{text}**")
    return (
        f"| {row['quantity']} | "
        + " | ".join(cells)
        + f" | {row['reference']:.4g} | {row['bound']} | {verdicts(row)} |"
    )


def verdicts(row):
    """One word where all methods have the same; else whom each verdict but sound is about."""
    found = {}
    for method in METHODS:
        verdict = row["methods"].get(method, {}).get("verdict", "")
        if verdict:
            found.setdefault(verdict, []).append(NAMES[method])
    if len(found) == 1:
        return next(iter(found))
    return "; ".join(f"{verdict}: {', '.join(who)}" for verdict, who in found.items() if verdict != "sound")


def figure(*arguments, **keywords):
    """plt.subplots in the common style."""
    return subplots(*arguments, **keywords)
