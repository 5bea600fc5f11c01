"""One self-contained HTML page about a run: verdict, bodies at start and end, errors of numbers, pictures, energies, gauges, cost, deck.

    sgmp-view report taylor_bar.out                  # taylor_bar.out/report.html

Everything is in the one file, which can be mailed. Pictures are drawn of up to --frames dumps (default: 4), coloured by --field.
"""

import argparse
import base64
import html
import io
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from . import answer, error_figure, gauges, history, picture, status
from .compare import flat, text_of
from .files import SgmpFileError, dumps_of, field_label, folder_of, label, plot_style, read_dump, read_summary_if_any, read_units, run_name
from .movie import common_limits

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid #ccc}
table{border-collapse:collapse;margin-bottom:1em;max-width:100%}th{text-align:left;padding-right:1.2em}td{padding:.1em 1.2em .1em 0;vertical-align:top}td+td{font-variant-numeric:tabular-nums}
img{max-width:100%}pre{background:#f6f6f6;padding:1em;overflow:auto;font-size:13px}
.sound{color:#13641c}.doubtful{color:#a33c00}.failed,.not{color:#a30000}
.frames{display:flex;flex-wrap:wrap}.frames img{width:49%}@media(max-width:600px){.frames img{width:100%}td{overflow-wrap:anywhere;padding-right:.5em}}"""

ROWS = (
    ("Scene", (("dimension", "dimension"), ("method", "method"), ("update", "update scheme"), ("h", "cell"), ("spacing", "spacing of particles"),
               ("particles", "particles"), ("particles_lost", "particles lost"), ("steps", "steps"), ("time", "time"), ("cfl", "Courant number"),
               ("restarted_from", "restarted from"))),
    ("Can it be believed", (("energy.drift", "energy drift"), ("end_state.contact_share", "lost in contact, share of what was given"),
                            ("end_state.viscous_share", "lost in viscosity, share"),
                            ("end_state.projection_share", "lost in projection, share"), ("end_state.shortest_step", "shortest step"),
                            ("end_state.longest_step", "longest step"), ("end_state.limited_by", "last limited by"),
                            ("end_state.thinnest_body_cells", "thinnest body (cells)"),
                            ("end_state.least_particles_per_cell", "least particles per cell"),
                            ("end_state.largest_compression", "largest compression"), ("end_state.largest_expansion", "largest expansion"),
                            ("end_state.particles_out_of_reach", "particles out of reach of their bodies"),
                            ("end_state.volume_without_room", "volume without room, share"),
                            ("end_state.least_pressure", "least pressure"), ("end_state.largest_pressure", "largest pressure"))),
    ("Cost", (("solve_seconds", "solution (s)"), ("wall_seconds", "in all (s)"), ("ns_per_particle_step", "ns per particle-step"),
              ("ranks", "ranks"), ("threads", "threads"), ("peak_memory_bytes", "memory (bytes)"), ("version", "version"),
              ("commit", "commit"), ("checksum", "checksum of the final state"))),
)


def embedded(figure):
    """A figure as an image within the page."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=130)
    plt.close(figure)
    return f'<img src="data:image/png;base64,{base64.b64encode(stream.getvalue()).decode()}">'


def verdict_of(summary):
    """Word, class and reasons."""
    if summary.get("exit_status"):
        return "failed", [summary.get("message", f"exit code {summary['exit_status']}"), *summary.get("verdict_reasons", [])]
    return summary.get("verdict", "no verdict"), summary.get("verdict_reasons", [])


def tables(values):
    """The tables of numbers."""
    for title, rows in ROWS:
        yield f"<h2>{title}</h2><table>"
        for key, words in rows:
            if values.get(key) not in (None, ""):
                yield f"<tr><td>{words}</td><td>{html.escape(text_of(values[key]))}</td></tr>"
        yield "</table>"


def answers(folder, units):
    """What came out: the projectile's loss, and a table of each body at start and end."""
    if not (folder / "bodies.csv").exists():
        return
    yield "<h2>Bodies</h2>"
    projectile = answer.projectile_of(answer.Run(folder).bodies.values())
    if projectile is not None:
        before, after, share = answer.loss_of(projectile)
        yield (f"<p><b>{html.escape(projectile.name)}</b>: {before:.5g} {units['velocity']} at the start, <b>{after:.5g} {units['velocity']}</b> along "
               f"that direction at the end; {100 * share:.3g} % lost.</p>")
    for name, rows in answer.bodies_table(folder, units):
        yield f"<table><tr><th>{html.escape(name)}</th><th>start</th><th>end</th><th></th></tr>"
        for words, then, now, unit in rows:
            yield f"<tr><td>{words}</td><td>{text_of(then)}</td><td>{text_of(now)}</td><td>{unit}</td></tr>"
        yield "</table>"


def common_window(clouds):
    """Corners of the box that holds all of the first cloud and nearly all of the others: what flies away would make the rest small."""
    ends = [np.percentile(cloud.points, [0.5, 99.5], axis=0) for cloud in clouds]
    ends.append([clouds[0].points.min(axis=0), clouds[0].points.max(axis=0)])
    return np.min([end[0] for end in ends], axis=0), np.max([end[1] for end in ends], axis=0)


def errors(summary):
    """How wrong numbers of the run are, where `sgmp-view error` has looked."""
    estimates = list(summary.get("error_estimate", {}).values())
    if not estimates:
        return
    yield "<h2>How wrong the numbers are</h2><ul>"
    for estimate in estimates:
        yield f"<li><b>{html.escape(estimate['line'])}</b><br>cells: {html.escape(estimate['cells'])}; {html.escape(estimate['advice'])}</li>"
    yield "</ul>" + embedded(error_figure.figure_of(estimates))


def frames(folder, options):
    """Pictures of some dumps, or of the final particles."""
    drawing = argparse.Namespace(field=options.field, axis=options.axis, cut=options.cut, limits=None, cmap=None, title=" ",
                                 no_outline=False, most_pixels=900)
    try:
        dumps = dumps_of(folder)
        chosen = [dumps[k] for k in sorted({round(k) for k in np.linspace(0, len(dumps) - 1, min(options.frames, len(dumps)))})]
        if chosen:
            drawing.limits = common_limits(dumps[1:] or dumps, options.field)
        clouds = [dump.read() for dump in chosen] or [read_dump(folder)]
        box = common_window(clouds)
        for cloud in clouds:
            yield embedded(picture.draw(cloud, folder, drawing, box))
    except SgmpFileError as problem:
        yield f"<p>No pictures: {html.escape(str(problem))}</p>"


def gauge_figure(folder, units):
    """Pressure, or the first other column, of all gauges."""
    figure, axis = plt.subplots(figsize=(8, 3.6), layout="constrained")
    for name, rows in gauges.series(folder):
        axis.plot(rows["time"], rows["pressure"], label=name)
    axis.set(xlabel=label("time", units["time"]), ylabel=field_label("pressure", units))
    axis.legend()
    return embedded(figure)


def deck_of(folder):
    """The deck with all defaults, as the log has it."""
    log = folder / "run.log"
    lines = log.read_text(errors="replace").splitlines()[2:] if log.exists() else []
    return "\n".join(lines[:lines.index("")] if "" in lines else lines)


def page(folder, options):
    """The page."""
    summary, units = read_summary_if_any(folder), read_units(folder)
    title = summary.get("title") or run_name(folder)
    word, reasons = verdict_of(summary) if summary else ("not finished", [status.describe(folder)[0]])
    yield f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{html.escape(title)}</title><style>{STYLE}</style>'
    yield f'<h1>{html.escape(title)}</h1><p>Verdict: <b class="{word.split()[0]}">{html.escape(word)}</b></p>'
    yield "<ul>" + "".join(f"<li>{html.escape(str(reason))}</li>" for reason in reasons) + "</ul>" if reasons else ""
    if any(units.values()):
        yield f"<p>Units: {units['length']}, {units['mass']}, {units['time']}; stress in {units['stress']}.</p>"
    yield from answers(folder, units)
    with plt.rc_context(plot_style()):
        yield from errors(summary)
        yield "<h2>State</h2><div class=frames>" + "".join(frames(folder, options)) + "</div>"
        try:
            yield "<h2>Energy and momentum</h2>" + embedded(history.figure([folder]))
        except SgmpFileError as problem:
            yield f"<p>No energies: {html.escape(str(problem))}</p>"
        if (folder / "gauges.csv").exists():
            yield "<h2>Gauges</h2>" + gauge_figure(folder, units)
    yield from tables(flat({name: value for name, value in summary.items() if name != "error_estimate"}))
    yield f"<h2>Deck, with all defaults</h2><pre>{html.escape(deck_of(folder))}</pre></html>"


def arguments(parser):
    """Arguments of the command."""
    parser.add_argument("folder", type=Path, metavar="OUT_DIR", help="output folder of sgmp")
    parser.add_argument("--field", help="field of the pictures (default: plastic strain, else pressure, else speed)")
    parser.add_argument("--axis", choices="xyz", default="y", help="3D: direction of view (default: y)")
    parser.add_argument("--cut", action="store_true", help="3D: show the section")
    parser.add_argument("--frames", type=int, default=4, metavar="N", help="number of pictures (default: 4)")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE", help="page (default: report.html in the folder)")


def run(options):
    """Writes the page and prints its name."""
    folder = folder_of(options.folder)
    output = options.output or folder / "report.html"
    output.write_text("\n".join(page(folder, options)), encoding="utf-8")
    print(output)
