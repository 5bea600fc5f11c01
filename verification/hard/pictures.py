"""Pictures of the cases: what the scene looks like in the end, or the curve that the table's number is taken from."""
import numpy as np
from table import COLOURS, MARKERS, NAMES, figure


def colour_of(fields, name):
    """A field by its name, or the speed."""
    return np.linalg.norm(fields["velocity"], axis=1) if name == "speed" else fields[name]


def portraits(table, name, runs, colour, caption, axes=(0, 1), names=None, size=2.0, select=None, layout=None, panel=(2.3, 2.7)):
    """The particles in the end, a panel for each run that came to its end, in one scale of places and of colours.
    `colour`: a field, or speed; `axes`: those across and up; `select`: which particles, of their places."""
    shown = [(run.particles(), (names or NAMES)[method]) for method, run in runs.items() if run.exit_code == 0]
    values = [colour_of(particles.fields, colour) for particles, _ in shown]
    rows, columns = layout or (1, len(shown))
    canvas, panels = figure(rows, columns, figsize=(panel[0]*columns, panel[1]*rows), sharex=True, sharey=True, squeeze=False)
    limits = np.percentile(np.concatenate(values), (4, 96))
    for axis, (particles, title), value in zip(panels.ravel(), shown, values):
        chosen = slice(None) if select is None else select(particles.points)
        drawn = axis.scatter(*particles.points[chosen][:, axes].T, c=value[chosen], s=size, cmap="cividis", vmin=limits[0], vmax=limits[1], linewidths=0, rasterized=True)
        axis.set(title=title, aspect="equal", xlabel="xyz"[axes[0]])
        axis.grid(False)
        axis.set_ylabel("xyz"[axes[1]])
        axis.label_outer()
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
