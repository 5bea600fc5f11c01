"""One self-contained HTML page about a run: what came out, whether to believe it, what it cost.

    sgmp-view report taylor_bar.out                  # taylor_bar.out/report.html

First the answer: what the projectile has lost, walls (opening, crater, bulge, spall, debris), each body at start and
end, fragments, pictures. Then the verdict with its reasons and the errors of numbers, energies, gauges, cost, and the
deck with all defaults. Everything is in the one file, which can be mailed. Pictures are drawn of up to --frames dumps
(default: 4), coloured by --field.
"""

import argparse
import base64
import html
import io
import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from . import answer, error_figure, fragments, gauges, history, impact, picture, status
from .compare import flat, text_of
from .files import (
    SgmpFileError,
    dumps_of,
    field_label,
    folder_of,
    label,
    plot_style,
    read_dump,
    read_summary_if_any,
    read_units,
    run_name,
)
from .matter import cards_of, matter_of
from .movie import limits_of
from .picture import field_of
from .wall import Shot

MOST_BODIES = 7  # whose energies are drawn
SHRINK = 0.62  # pictures are drawn smaller than alone, so that their letters can be read on narrow screens
STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:68em;margin:1.5em auto;padding:0 1em;color:#222}
h1{font-size:1.5em;margin-bottom:.2em}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid #ccc}
.facts{color:#555;margin-top:0}
.badge{font-size:.6em;vertical-align:middle;border:1px solid;border-radius:1em;padding:.15em .8em}
.badge{text-decoration:none;white-space:nowrap}
table{border-collapse:collapse;margin-bottom:1em;max-width:100%}th{text-align:left;padding-right:1.2em}
td{padding:.1em 1.2em .1em 0;vertical-align:top}td+td{font-variant-numeric:tabular-nums}
td.of{padding-left:1em;color:#555}.words td:first-child{min-width:11em}
.bodies{display:flex;flex-wrap:wrap;gap:0 2em}.bodies td{padding-right:.7em}
.bodies td:last-child{white-space:nowrap;padding-right:0}.wide{overflow-x:auto}
img{max-width:100%;height:auto}pre{background:#f6f6f6;padding:1em;overflow:auto;font-size:13px}
.sound{color:#13641c}.coarse{color:#7a5b00}.doubtful{color:#a33c00}.failed,.not{color:#a30000}
.frames{display:flex;flex-wrap:wrap;align-items:flex-start}
.frames img{width:49%;margin-bottom:.8em}.three img{width:33%}
@media(max-width:600px){.frames img,.three img{width:100%}td{overflow-wrap:anywhere;padding-right:.5em}
.words td:first-child{min-width:6em}
.wide td{overflow-wrap:normal;white-space:nowrap}}"""

ROWS = (
    (
        "Scene",
        (
            ("dimension", "dimension"),
            ("method", "method"),
            ("update", "update scheme"),
            ("h", "cell"),
            ("spacing", "spacing of particles"),
            ("particles", "particles"),
            ("particles_lost", "particles lost"),
            ("steps", "steps"),
            ("time", "time"),
            ("cfl", "Courant number"),
            ("restarted_from", "restarted from"),
        ),
    ),
    (
        "In numbers",
        (
            ("energy.drift", "energy drift"),
            ("end_state.contact_share", "lost in contact, share of what was given"),
            ("end_state.viscous_share", "lost in viscosity, share"),
            ("end_state.projection_share", "lost in projection, share"),
            ("end_state.shortest_step", "shortest step"),
            ("end_state.longest_step", "longest step"),
            ("end_state.limited_by", "last limited by"),
            ("end_state.thinnest_body_cells", "thinnest body (cells)"),
            ("end_state.least_particles_per_cell", "least particles per cell"),
            ("end_state.largest_compression", "largest compression"),
            ("end_state.largest_expansion", "largest expansion"),
            ("end_state.particles_out_of_reach", "particles out of reach of their bodies"),
            ("end_state.volume_without_room", "volume without room, share"),
            ("end_state.least_pressure", "least pressure"),
            ("end_state.largest_pressure", "largest pressure"),
        ),
    ),
    (
        "Cost",
        (
            ("solve_seconds", "solution (s)"),
            ("wall_seconds", "in all (s)"),
            ("ns_per_particle_step", "ns per particle-step"),
            ("ranks", "ranks"),
            ("threads", "threads"),
            ("peak_memory_bytes", "memory (bytes)"),
            ("version", "version"),
            ("commit", "commit"),
            ("checksum", "checksum of the final state"),
        ),
    ),
)


def embedded(figure, words):
    """A figure as an image within the page; `words` say what it shows."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=170)
    plt.close(figure)
    return (
        f'<img alt="{html.escape(words)}" src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'
    )


def verdict_of(summary):
    """Word, class and reasons."""
    if summary.get("exit_status"):
        return "failed", [
            summary.get("message", f"exit code {summary['exit_status']}"),
            *summary.get("verdict_reasons", []),
        ]
    word, error = summary.get("verdict", "no verdict"), summary.get("verdict_error")
    if word == "coarse" and error:
        word += f": expect errors of {math.ceil(100 * error - 1e-9)} %"
    return word, summary.get("verdict_reasons", [])


def tables(values, titles):
    """The tables of numbers."""
    for title, rows in ROWS:
        known = [(words, values[key]) for key, words in rows if values.get(key) not in (None, "")]
        if title in titles and known:
            yield f"<h2>{title}</h2><table>"
            yield from (f"<tr><td>{words}</td><td>{html.escape(text_of(value))}</td></tr>" for words, value in known)
            yield "</table>"


# ---------------------------------------------------------------- the answer


class Dumps:
    """The dumps of a run, each read once: the first and the last as matter, some as pictures."""

    def __init__(self, folder, frames):
        self.folder, self.dumps, self.clouds, self.problem = folder, [], {}, None
        try:
            self.dumps = dumps_of(folder)
        except SgmpFileError as problem:
            self.problem = problem
        self.chosen = (
            sorted({round(k) for k in np.linspace(0, len(self.dumps) - 1, min(frames, len(self.dumps)))})
            if self.dumps
            else []
        )

    def cloud(self, k):
        """The particles of a dump."""
        k = k % len(self.dumps)
        if k not in self.clouds:
            self.clouds[k] = self.dumps[k].read()
        return self.clouds[k]

    def ends(self):
        """First and last dump, none where there are fewer than two or they name no bodies."""
        if len(self.dumps) < 2 or not all("body" in self.cloud(k).fields for k in (0, -1)):
            return []
        return [self.cloud(0), self.cloud(-1)]


def answers(folder, units, dumps):
    """What came out: the projectile's loss, walls, pieces, and a table of each body at start and end."""
    yield "<h2>What came out</h2>"
    ends = dumps.ends()
    try:
        start, now = (matter_of(folder, cloud, ends[0]) for cloud in ends) if ends else (None, None)
    except (SgmpFileError, KeyError):
        start = now = None
    broken = None if now is None else fragments.broken(now)
    if (folder / "bodies.csv").exists():
        projectile = answer.projectile_of(answer.Run(folder).bodies.values())
        if projectile is not None:
            before, after, share = answer.loss_of(projectile)
            yield (
                f"<p><b>{html.escape(projectile.name)}</b>: {before:.5g} {units['velocity']} at the start, "
                f"<b>{after:.5g} {units['velocity']}</b> along that direction at the end; {100 * share:.3g} % lost."
                f"{remains(projectile, broken, units)}</p>"
            )
    if now is not None:
        yield from walls(folder, start, now, units)
    if (folder / "bodies.csv").exists():
        yield "<div class=bodies>"
        for name, rows in answer.bodies_table(folder, units, ends):
            yield f"<table><tr><th>{html.escape(name)}</th><th>start</th><th>end</th><th></th></tr>"
            for words, then, last, unit in rows:
                yield f"<tr><td>{words}</td><td>{text_of(then)}</td><td>{text_of(last)}</td><td>{unit}</td></tr>"
            yield "</table>"
        yield "</div>"
        notes = [] if now is None else impact.model_note(["xyz"[k] for k in sorted(now.planes)])
        notes += [note for note in [answer.no_temperature(cards_of(folder), ends)] if note]
        yield "".join(f"<p>{html.escape(note[0].upper() + note[1:])}.</p>" for note in notes)
    if now is not None:
        yield from pieces(folder, now, units, *broken)


def walls(folder, start, now, units):
    """Opening, crater, bulge, spall and debris of the walls that were hit."""
    shot = Shot(start)
    if shot.speed == 0 or len(now.axes) < 2 or not shot.targets(start):
        return
    try:
        result = impact.with_clouds_before(impact.measured(start, now, shot), folder, start, shot)
    except (SgmpFileError, np.linalg.LinAlgError) as problem:
        yield f"<p>Walls were not measured: {html.escape(str(problem))}</p>"
        return
    for wall in result["walls"]:
        if not wall["hit"]:
            continue
        yield f"<table class=words><tr><th>{html.escape(wall['name'])}</th><th></th></tr>"
        for label, words in impact.lines_of(wall, units, now.dimension == 2 and not now.is_round):
            indent = " class=of" if label.startswith(" ") else ""
            yield f"<tr><td{indent}>{html.escape(label)}</td><td>{html.escape(words)}</td></tr>"
        yield "</table>"


def remains(projectile, broken, units):
    """What is whole of a projectile that has come apart."""
    body = {} if broken is None else broken[0]["bodies"].get(projectile.name, {})
    if not body or (len(body["pieces"]) == 1 and not body["failed_mass"] and not body["small_pieces"]):
        return ""
    if not body["pieces"]:
        return " No piece of it is whole."
    largest = body["pieces"][0]
    mass, speed = (impact.number(largest[key], units[unit]) for key, unit in (("mass", "mass"), ("speed", "velocity")))
    whole = impact.number(body["mass"], units["mass"])
    return f" Its largest piece: {html.escape(mass)} of {html.escape(whole)}, {html.escape(speed)}."


def pieces(folder, now, units, result, rank):
    """The pieces of bodies that have come apart: the heaviest in a table, all in a picture, their distribution."""
    apart = {
        name: body
        for name, body in result["bodies"].items()
        if len(body["pieces"]) != 1 or body["small_pieces"] or body["failed_mass"]
    }
    if not apart:
        return
    yield "<h2>Fragments</h2><ul>"
    for name, body in apart.items():
        yield f"<li><b>{html.escape(name)}</b>: {html.escape(fragments.body_line(body, units))}</li>"
    yield "</ul>"
    rows = list(fragments.rows_of(result, 10))
    if rows:
        heads = (
            "body",
            label("mass", units["mass"]),
            "particles",
            label("speed", units["velocity"]),
            "velocity",
            label("extent", units["length"]),
        )
        yield "<div class=wide><table><tr>" + "".join(f"<th>{html.escape(head)}</th>" for head in heads) + "</tr>"
        yield "".join(
            "<tr>" + "".join(f"<td>{html.escape(word)}</td>" for word in row) + "</tr>" for row in rows
        ) + "</table></div>"
    yield "".join(f"<p>{html.escape(note[0].upper() + note[1:])}.</p>" for note in result["notes"])
    with plt.rc_context(plot_style()):
        images = [embedded(fragments.figure_of_pieces(folder, now, rank, shrink=SHRINK), "pieces, each in a colour")]
        masses = fragments.figure_of_masses(folder, result)
        images += [embedded(masses, "distribution of the masses of pieces")] if masses is not None else []
    yield "<div class=frames>" + "".join(images) + "</div>"


def common_window(clouds):
    """Corners of a box that holds the first cloud and nearly all of every body in the others."""
    ends = [np.percentile(cloud.points, [0.5, 99.5], axis=0) for cloud in clouds]
    for cloud in clouds:
        body = cloud.fields.get("body", np.zeros(0, int))
        ends += [np.percentile(cloud.points[body == number], [2, 98], axis=0) for number in np.unique(body)]
    ends.append([clouds[0].points.min(axis=0), clouds[0].points.max(axis=0)])
    return np.min([end[0] for end in ends], axis=0), np.max([end[1] for end in ends], axis=0)


def errors(summary):
    """How wrong numbers of the run are, where `sgmp-view error` has looked."""
    estimates = list(summary.get("error_estimate", {}).values())
    if not estimates:
        return
    yield "<h2>How wrong the numbers are</h2><ul>"
    for estimate in estimates:
        yield (
            f"<li><b>{html.escape(estimate['line'])}</b><br>cells: {html.escape(estimate['cells'])}; "
            f"{html.escape(estimate['advice'])}</li>"
        )
    yield "</ul>" + embedded(error_figure.figure_of(estimates), "errors by cell and cost")


def frames(folder, options, dumps):
    """Pictures of some dumps, or of the final particles."""
    drawing = argparse.Namespace(
        field=options.field,
        axis=options.axis,
        cut=options.cut,
        limits=None,
        cmap=None,
        title=" ",
        no_outline=False,
        most_pixels=900,
        shrink=SHRINK,
    )
    try:
        if dumps.problem:
            raise dumps.problem
        clouds = [dumps.cloud(k) for k in dumps.chosen] or [read_dump(folder)]
        if dumps.chosen:
            drawing.limits = limits_of([field_of(cloud, options.field)[1] for cloud in clouds[len(clouds) // 2 :]])
        box = common_window(clouds)
        for cloud in clouds:
            when = "" if cloud.time is None else f" at {cloud.time:.4g}"
            yield embedded(picture.draw(cloud, folder, drawing, box), f"particles{when}")
    except SgmpFileError as problem:
        yield f"<p>No pictures: {html.escape(str(problem))}</p>"


def energies(folder):
    """Energies, drift and momentum over time."""
    drawings = [plt.subplots(figsize=(4.6, 3.4), layout="constrained") for _ in range(3)]
    try:
        history.figure([folder], [axis for _, axis in drawings])
    except SgmpFileError:
        for drawing, _ in drawings:
            plt.close(drawing)
        raise
    words = ("energies", "energy drift", "momentum")
    images = [embedded(drawing, f"{word} over time") for (drawing, _), word in zip(drawings, words)]
    bodies = answer.Run(folder).bodies if (folder / "bodies.csv").exists() else {}
    if 1 < len(bodies) <= MOST_BODIES and len(next(iter(bodies.values())).series["time"]) > 1:
        drawing, axis = plt.subplots(figsize=(4.6, 3.4), layout="constrained")
        history.energies_of_bodies(axis, folder)
        images.append(embedded(drawing, "energies of bodies over time"))
    return images


def gauge_figure(folder, units):
    """Pressure, or the first other column, of all gauges."""
    figure, axis = plt.subplots(figsize=(6, 3.4), layout="constrained")
    for name, rows in gauges.series(folder):
        axis.plot(rows["time"], rows["pressure"], label=name)
    axis.set(xlabel=label("time", units["time"]), ylabel=field_label("pressure", units))
    axis.legend()
    return embedded(figure, "pressure at the gauges")


def gauge_table(folder, units):
    """Largest pressure of each gauge, its time and the impulse."""
    unit, time = units["stress"], units["time"]
    heads = ("gauge", label("largest pressure", unit), label("at", time), label("impulse", f"{unit} {time}".strip()))
    yield "<table><tr>" + "".join(f"<th>{html.escape(head)}</th>" for head in heads) + "</tr>"
    for name, rows in gauges.series(folder):
        found = gauges.summary_of(rows["time"], rows["pressure"])
        numbers = (found[key] for key in ("largest", "time_of_largest", "impulse"))
        yield f"<tr><td>{html.escape(name)}</td>" + "".join(f"<td>{number:.5g}</td>" for number in numbers) + "</tr>"
    yield "</table>"


def deck_of(folder):
    """The deck with all defaults, as the log has it."""
    log = folder / "run.log"
    lines = log.read_text(errors="replace").splitlines()[2:] if log.exists() else []
    return "\n".join(lines[: lines.index("")] if "" in lines else lines)


def head_of(title, word, summary, units):
    """Title, word of the verdict, and what was run in a line."""
    yield (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
        'content="width=device-width, initial-scale=1">'
        f'<title>{html.escape(title)}</title><link rel="icon" href="data:,"><style>{STYLE}</style></head><body>'
    )
    yield (
        f'<h1>{html.escape(title)} <a class="badge {word.split(":")[0].split()[0]}" '
        f'href="#verdict">{html.escape(word)}</a></h1>'
    )
    facts = []
    if summary:
        space = {"axisymmetric": "axisymmetric"}.get(summary.get("dimension"), f"{summary.get('dimension')}D")
        facts = (
            [
                space,
                f"method {summary.get('method')}",
                f"cells of {summary.get('h'):g} {units['length']}".strip(),
                f"{summary.get('particles')} particles",
                f"t = {summary.get('time'):.6g} {units['time']}".strip(),
            ]
            if summary.get("h") and summary.get("time") is not None
            else [space]
        )
    if any(units.values()):
        facts.append(f"units {units['length']}, {units['mass']}, {units['time']}, stress in {units['stress']}")
    yield f"<p class=facts>{html.escape('; '.join(facts))}</p>" if facts else ""


def page(folder, options):
    """The page: the answer, whether to believe it, what it cost."""
    summary, units = read_summary_if_any(folder), read_units(folder)
    word, reasons = verdict_of(summary) if summary else ("not finished", [status.describe(folder)[0]])
    dumps, values = Dumps(folder, options.frames), flat(
        {name: value for name, value in summary.items() if name != "error_estimate"}
    )
    yield from head_of(summary.get("title") or run_name(folder), word, summary, units)
    yield from answers(folder, units, dumps)
    with plt.rc_context(plot_style()):
        yield "<h2>State</h2><div class=frames>" + "".join(frames(folder, options, dumps)) + "</div>"
        yield (
            f'<h2 id=verdict>Can it be believed</h2><p>Verdict: <b '
            f'class="{word.split(":")[0].split()[0]}">{html.escape(word)}</b></p>'
        )
        yield (
            "<ul>" + "".join(f"<li>{html.escape(str(reason))}</li>" for reason in reasons) + "</ul>" if reasons else ""
        )
        yield from errors(summary)
        yield from tables(values, ["In numbers"])
        try:
            images = energies(folder)
            kind = "frames three" if len(images) == 3 else "frames"
            yield f"<h2>Energy and momentum</h2><div class='{kind}'>" + "".join(images) + "</div>"
        except SgmpFileError as problem:
            yield f"<p>No energies: {html.escape(str(problem))}</p>"
        if (folder / "gauges.csv").exists():
            yield "<h2>Gauges</h2>" + gauge_figure(folder, units) + "".join(gauge_table(folder, units))
    yield from tables(values, ["Scene", "Cost"])
    yield f"<h2>Deck, with all defaults</h2><pre>{html.escape(deck_of(folder))}</pre></body></html>"


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folder", type=Path, metavar="OUT_DIR", help="output folder of sgmp")
    parser.add_argument("--field", help="field of the pictures (default: plastic strain, else pressure, else speed)")
    parser.add_argument("--axis", choices="xyz", default="y", help="3D: direction of view (default: y)")
    parser.add_argument("--cut", action="store_true", default=True, help="3D: the section (the default)")
    parser.add_argument("--outside", dest="cut", action="store_false", help="3D: from outside")
    parser.add_argument("--frames", type=int, default=4, metavar="N", help="number of pictures (default: 4)")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="page (default: report.html in the folder)")


def run(options):
    """Writes the page and prints its name."""
    folder = folder_of(options.folder)
    output = options.output or folder / "report.html"
    output.write_text("\n".join(page(folder, options)), encoding="utf-8")
    print(output)
