"""Pictures of the cases: what the scene looks like in the end, or the curve that the table's number is taken from."""
import numpy as np
from table import COLOURS, MARKERS, NAMES, figure  # the viewer is found by what it imports
from sgmp_view.picture import draw_particles


def colour_of(fields, name):
    """A field by its name, or the speed."""
    return np.linalg.norm(fields["velocity"], axis=1) if name == "speed" else fields[name]


def portraits(table, name, runs, colour, caption, axes=(0, 1), names=None, cut=False, layout=None, panel=(2.3, 2.7)):
    """The particles in the end, drawn as the viewer draws them: a panel for each run that came to its end, in one scale
    of places and of colours. `colour`: a field, or speed; `axes`: those across and up, in 3D a third one towards the
    viewer; `cut`: the section through the middle instead of what is seen from outside."""
    spacing = next(run.summary["spacing"] for run in runs.values() if run.exit_code == 0)
    shown = [(run.particles(), (names or NAMES)[method]) for method, run in runs.items() if run.exit_code == 0]
    values = [colour_of(particles.fields, colour) for particles, _ in shown]
    rows, columns = layout or (1, len(shown))
    canvas, panels = figure(
        rows, columns, figsize=(panel[0] * columns, panel[1] * rows), sharex=True, sharey=True, squeeze=False
    )
    ends = []
    limits = tuple(np.percentile(np.concatenate(values), (4, 96)))
    for axis, (particles, title), value in zip(panels.ravel(), shown, values):
        places = np.zeros((len(particles.points), 3))
        places[:, :len(axes)] = particles.points[:, axes]
        scale = limits if colour != "body" else (0.5, value.max() + 0.5)
        drawn = draw_particles(axis, places, value.astype(float), spacing, view="z", cut=cut, limits=scale, most=900,
                               whole_numbers=colour == "body")
        ends.append([*axis.get_xlim(), *axis.get_ylim()])
        axis.set(title=title, xlabel="xyz"[axes[0]], ylabel="xyz"[axes[1]])
        axis.label_outer()
    ends = np.array(ends)                               # of all panels, which share their scales
    panels.ravel()[0].set(xlim=(ends[:, 0].min(), ends[:, 1].max()), ylim=(ends[:, 2].min(), ends[:, 3].max()))
    if colour != "body":
        canvas.colorbar(drawn, ax=panels, label=colour.replace("_", " "), shrink=0.8, pad=0.01)
    table.picture(name, canvas, caption)


def curves(table, name, lines, caption, **labels):
    """Curves in one panel: (x, y, style by keywords) each."""
    canvas, axis = figure(figsize=(6.4, 3.2))
    for x, y, style in lines:
        axis.plot(x, y, **style)
    axis.set(**labels)
    canvas.legend(loc="outside upper center", ncols=3 if len(lines) > 4 else 4)
    table.picture(name, canvas, caption)


def method_styles(method, **changes):
    """How a curve of a method is drawn."""
    return {"color": COLOURS[method], "marker": MARKERS[method], "markersize": 4, "label": NAMES[method]} | changes
