"""Energies of bodies and of materials over time: table, figure, CSV file."""

import numpy as np

from .files import SgmpFileError, folder_of, label, plot_style, read_table, read_units
from .matter import cards_of

KINDS = ("kinetic_energy", "internal_energy")


def materials_of(folder):
    """Material of each body by the deck in the log of the run; bodies from files may have others in them."""
    words = [card.split() for card in cards_of(folder)]
    return {card[1]: word[9:] for card in words if card[0] == "body" for word in card if word.startswith("material=")}


def energies(folder):
    """Times, and by 'body NAME' and 'material NAME' their kinetic and internal energies over time."""
    table, materials = read_table(folder / "bodies.csv"), materials_of(folder)
    steps, place = np.unique(table["step"], return_inverse=True)
    time = np.zeros(len(steps))
    time[place] = table["time"]
    series = {}
    for name in dict.fromkeys(str(name) for name in table["name"]):
        rows = table["name"] == name
        for key in (f"body {name}", f"material {materials[name]}") if name in materials else (f"body {name}",):
            both = series.setdefault(key, np.zeros((2, len(steps))))
            for values, kind in zip(both, KINDS):
                np.add.at(values, place[rows], table[kind][rows])
    return time, dict(sorted(series.items(), key=lambda item: item[0].startswith("material")))


def draw_energies(options, output):
    """Prints and draws the energies of a run, and writes them where that is asked for."""
    import matplotlib.pyplot as plt
    if len(options.folders) > 1:
        raise SgmpFileError("--energies takes one run")
    folder = folder_of(options.folders[0])
    (time, series), units = energies(folder), read_units(folder)
    print(
        f"{'':<24}{'kinetic: start':>16}{'largest':>14}{'end':>14}{'internal: start':>18}{'largest':>14}{'end':>14} "
        f"{units['energy']}".rstrip()
    )
    for name, (kinetic, internal) in series.items():
        print(
            f"{name:<24}{kinetic[0]:16.6g}{kinetic.max():14.6g}{kinetic[-1]:14.6g}"
            f"{internal[0]:18.6g}{internal.max():14.6g}{internal[-1]:14.6g}"
        )
    if options.csv:
        columns = [time] + [values for both in series.values() for values in both]
        names = ["time"] + [f"{name} {kind}" for name in series for kind in ("kinetic", "internal")]
        np.savetxt(options.csv, np.column_stack(columns), delimiter=",", header=",".join(names), comments="")
        print(options.csv)
    with plt.rc_context(plot_style()):
        figure, axes = plt.subplots(1, 2, figsize=(11, 4), layout="constrained", sharey=True)
        for axis, kind in zip(axes, ("body", "material")):
            for number, (name, (kinetic, internal)) in enumerate(
                item for item in series.items() if item[0].startswith(kind)
            ):
                axis.plot(time, kinetic, color=f"C{number % 7}", label=name.partition(" ")[2])
                axis.plot(time, internal, "--", color=f"C{number % 7}")
            axis.set(
                xlabel=label("time", units["time"]),
                title={"body": "Bodies", "material": "Materials"}[kind] + ": kinetic, - - internal",
            )
            axis.legend(fontsize=8)
        axes[0].set_ylabel(label("energy", units["energy"]))
        figure.savefig(output)
        plt.close(figure)
