"""The report: one self-contained HTML page from a Book, and its copy in doc/verification/."""

import base64
import html
import json
import platform
import shutil
import time
from pathlib import Path

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 1080px; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.7em; } h2 { margin-top: 2.2em; border-bottom: 2px solid #1f5fb4; padding-bottom: .2em; }
table { border-collapse: collapse; margin: .8em 0; font-size: 13.5px; }
td, th { padding: .2em .7em; border-bottom: 1px solid #ddd; text-align: right; } th { background: #f2f5fa; }
td:first-child, th:first-child, .word { text-align: left; }
summary { color: #1f5fb4; cursor: pointer; font-size: 13.5px; }
.pass, .unchanged { color: #17803d; font-weight: 600; } .fail { color: #c0182a; font-weight: 600; }
.deviates { color: #b36b00; font-weight: 600; }
figure { margin: 1em 0; } figure img { max-width: 100%; }
figcaption, caption { color: #555; font-size: 13.5px; text-align: left; }
pre { background: #f5f5f5; padding: .7em; overflow-x: auto; font-size: 12.5px; } nav a { margin-right: 1.1em; }
"""


LONG = 16  # a table of more rows is folded away until the reader opens it


def number(value):
    """A number as a reader wants it."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    if isinstance(value, int) or value == 0:
        return str(value)
    return f"{value:.3e}" if abs(value) < 1e-3 or abs(value) >= 1e5 else f"{value:.4g}"


def table_html(header, rows, caption):
    lines = [
        "<table>",
        f"<caption>{html.escape(caption)}</caption>",
        "<tr>"
        + "".join(
            f"<th{' class=word' if rows and isinstance(rows[0][i], str) else ''}>{html.escape(h)}</th>"
            for i, h in enumerate(header)
        )
        + "</tr>",
    ]
    for row in rows:
        cells = "".join(f"<td{' class=word' if isinstance(c, str) else ''}>{html.escape(number(c))}</td>" for c in row)
        lines.append(f"<tr>{cells}</tr>")
    folded = len(rows) > LONG
    return "\n".join(
        [f"<details><summary>{html.escape(caption)} ({len(rows)} rows)</summary>"] * folded
        + lines
        + ["</table>"]
        + ["</details>"] * folded
    )


def results_html(results):
    lines = [
        "<table>",
        "<tr><th>case</th><th>quantity</th><th>value</th><th>target</th><th>result</th><th>note</th></tr>",
    ]
    for r in results:
        word = word_of(r)
        lines.append(
            f"<tr><td>{html.escape(r['case'])}</td><td "
            f"class=word>{html.escape(r['quantity'])}</td><td>{number(r['value'])}</td>"
            f"<td>{html.escape(r['tolerance'])} {number(r['reference'])}</td><td class={word}>{word}</td>"
            f"<td class=word>{html.escape(r['note'])}</td></tr>"
        )
    return "\n".join(lines + ["</table>"])


def word_of(result):
    if result["pass"] and result.get("regression"):
        return "unchanged"
    return "pass" if result["pass"] else "deviates" if result["known_deviation"] else "fail"


def deviations(results):
    """Header and rows of the known deviations: where each must stay."""
    rows = [[r["case"], r["quantity"], f"{r['tolerance']} {number(r['reference'])}",
             f"{number(r['known'] - r['band'])} to {number(r['known'] + r['band'])}", number(r["value"]), r["note"]]
            for r in results if "band" in r and not r["pass"]]
    return ["case", "quantity", "target", "known band", "value", "reason"], rows


def anchor(title):
    return "".join(c if c.isalnum() else "-" for c in title.lower())


def write(book, command, version, took):
    """report.html and results.json of a book."""
    passed = sum(r["pass"] for r in book.results)
    failed = len(book.failed())
    body = [
        "<!doctype html><html lang=en><head><meta charset=utf-8><title>sgmp: verification</title>",
        f"<style>{STYLE}</style></head><body>",
        "<h1>sgmp: the examples of the SGMP paper beside their references</h1>",
        f"<p>{html.escape(version)} · <code>{html.escape(command)}</code> · {time.strftime('%Y-%m-%d')} · "
        f"{html.escape(platform.machine())}, one core per run, {took}</p>",
        f"<p class={'fail' if failed else 'pass'}>{len(book.results)} checks: {passed} pass, "
        f"{len(book.results) - passed - failed} deviate for a "
        f"known reason, {failed} fail.</p>",
        "<nav>"
        + "".join(f"<a href='#{anchor(s.title)}'>{html.escape(s.title)}</a>" for s in book.sections)
        + "<a href='#deviations'>Known deviations</a><a href='#checks'>All checks</a></nav>",
    ]
    for section in book.sections:
        body.append(f"<h2 id='{anchor(section.title)}'>{html.escape(section.title)}</h2>")
        for kind, content in section.text:
            if kind == "text":
                body.append(f"<p>{content}</p>")
            elif kind == "table":
                body.append(table_html(*content[1:]))
            else:
                data = base64.b64encode(content[0].read_bytes()).decode()
                body.append(f"<figure><img alt='{html.escape(content[0].stem)}' src='data:image/png;base64,{data}'>"
                            f"<figcaption>{html.escape(content[1])}</figcaption></figure>")
        chosen = [r for r in book.results if r["section"] == section.title]
        if chosen:
            body += ["<h3>Checks</h3>", results_html(chosen)]
        if section.commands:
            body += ["<h3>Commands</h3>", "<pre>" + html.escape("\n".join(dict.fromkeys(section.commands))) + "</pre>"]
    body += [
        "<h2 id=deviations>Known deviations</h2>",
        table_html(*deviations(book.results), "Targets that are missed for a reason that is understood"),
    ]
    body += ["<h2 id=checks>All checks</h2>", results_html(book.results), "</body></html>"]
    (book.output / "report.html").write_text("\n".join(body))
    (book.output / "results.json").write_text(
        json.dumps(
            {
                "version": version,
                "command": command,
                "date": time.strftime("%Y-%m-%d"),
                "checks": len(book.results),
                "passed": passed,
                "failed": failed,
                "results": book.results,
            },
            indent=1,
        )
    )


def publish(book, folder, command, version, took):
    """A copy of figures and tables, with the results as a page of Markdown."""
    folder = Path(folder)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    lines = [
        "# Verification report",
        "",
        f"Written by `{command}` on {time.strftime('%Y-%m-%d')} in {took}, {version}; do not edit.",
        "The program has changed since that day: `make verify` runs today's. [Results](../results.md) are kept up "
        "to date.",
        "The run also leaves `build/verification/report.html`, one page with all of this.",
        "",
    ]
    for section in book.sections:
        lines += [f"## {section.title}", ""]
        for kind, content in section.text:
            if kind == "text":
                lines += [content, ""]
            elif kind == "table":
                name, header, rows, caption = content
                shutil.copy(book.output / f"{name}.csv", folder)
                lines += [
                    f"{caption} ([{name}.csv]({name}.csv))", "", "| " + " | ".join(header) + " |",
                    "|" + "---|" * len(header),
                ]
                lines += ["| " + " | ".join(number(cell) for cell in row) + " |" for row in rows[:40]] + [""]
            else:
                shutil.copy(content[0], folder)
                lines += [f"![{content[0].stem}]({content[0].name})", "", content[1], ""]
        chosen = [r for r in book.results if r["section"] == section.title]
        if chosen:
            lines += ["| case | quantity | value | target | result | note |", "|---|---|---|---|---|---|"]
            lines += [
                f"| {r['case']} | {r['quantity']} | {number(r['value'])} | {r['tolerance']} {number(r['reference'])} | "
                f"{word_of(r)} | {r['note']} |"
                for r in chosen
            ] + [""]
    header, rows = deviations(book.results)
    lines += ["## Known deviations", "", "| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows] + [""]
    (folder / "README.md").write_text("\n".join(lines))
