#!/usr/bin/env python3
"""Three to five bodies in contact, drawn by seed: unequal densities and stiffnesses, any friction, rigid tools, at an
angle to the grid.

    python3 verification/contact_scenes/check.py [--full]      some scenes, or all
    python3 verification/contact_scenes/check.py --show pile 3 the deck of one
"""
import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from common import BUILD, Case, main, solve  # noqa: E402
from contact import body, contact, excess, pairs_of  # noqa: E402
from scenes import PRESSED, SLOPE, Scene  # noqa: E402

QUICK = (0, 3, 7, 10, 14, 17)  # both dimensions, all angles and frictions
KINDS = ("pile", "rest", "incline", "flight", "press")


def case(scene):
    """The scene's deck, written for the solver."""
    path = BUILD/"decks"/f"{scene.kind}_{scene.seed}_{scene.fine}.inp"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(scene.deck())
    return Case(path)


def along_and_up(scene, rows, prefix):
    """A vector of a table along the scene's axes."""
    angle = math.radians(scene.turn)
    x, y = rows[f"{prefix}x"], rows[f"{prefix}y"]
    return x*math.cos(angle) + y*math.sin(angle), y*math.cos(angle) - x*math.sin(angle)


def reaction(scene, run):
    """Means over each row's time of the force on the base, along and up."""
    rows = contact(run)
    chosen = np.isin(rows["pair"], pairs_of(run, "b0"))
    times = np.unique(rows["time"])
    along, up = along_and_up(scene, rows, "force_")
    at = np.searchsorted(times, rows["time"][chosen])
    return times, np.bincount(at, along[chosen], len(times)), np.bincount(at, up[chosen], len(times))


def energy(book, scene, run):
    """Nothing from nowhere, and nothing lost that is not booked."""
    history = run.history()
    supplied = max(np.abs(history["external_work"]).max(), history["total_energy"].max())
    late, most, _, _ = excess(history, scene.update, supplied)
    book.at_most(scene.name, "largest energy of unknown origin over the supplied", most, 1e-3)
    if scene.flip == 1:
        book.at_most(scene.name, "its mean over the last fifth", abs(late), 1e-3)


def momentum(book, scene, run):
    """What the bodies have is what gravity and the support gave them."""
    history = run.history()
    time = history["time"]
    mass = sum(block.mass for block in scene.soft())
    if scene.kind == "flight":
        scale = sum(
            np.linalg.norm([body(run, b + 1)[f"velocity_{a}"][0] for a in "xyz"]) * block.mass
            for b, block in enumerate(scene.blocks)
        )
        wrong = max(np.abs(history[f"momentum_{a}"] - history[f"momentum_{a}"][0]).max() for a in "xyz")
        return book.at_most(scene.name, "momentum from nowhere over the bodies'", wrong/scale, 1e-12)
    along, up = along_and_up(scene, history, "momentum_")
    _, push, lift = reaction(scene, run)
    slope = SLOPE if scene.kind == "incline" else 0.0
    span = np.diff(time)
    # The support's force on the bodies is minus that on the base.
    wrong_up = np.diff(up) + mass*scene.gravity*math.cos(slope)*span + lift[1:]*span
    wrong_along = np.diff(along) - mass*scene.gravity*math.sin(slope)*span + push[1:]*span
    scale = np.abs(lift[1:]*span).sum()
    wrong = max(np.abs(np.cumsum(wrong_up[1:])).max(), np.abs(np.cumsum(wrong_along[1:])).max())
    return book.at_most(scene.name, "momentum from nowhere over the support's impulse", wrong/scale, 1e-12)


def pile(book, scene, run):
    """Energy and momentum of what vibrates on a base."""
    energy(book, scene, run)
    momentum(book, scene, run)


def rest(book, scene, run):
    """Comes to rest; the base carries the weight and nothing else; frictionless contact never gives energy (MUSL: an
    identity at each node, but for the first step of a contact)."""
    momentum(book, scene, run)
    if scene.friction == 0:
        book.at_most(scene.name, "falls of the energy taken by contact", excess(run.history(), scene.update)[2], 1e-9)
    times, push, lift = reaction(scene, run)
    late = times > 0.8*times[-1]
    weight = scene.gravity*sum(block.mass for block in scene.soft())
    book.within(scene.name, "support force over the weight", -lift[late].mean()/weight, 1.0, 0.01)
    book.at_most(scene.name, "force along the base over the weight", abs(push[late].mean())/weight, 0.01)
    ways = []
    for number, block in enumerate(scene.blocks, 1):
        if block.young > 0:
            along, _ = along_and_up(scene, body(run, number), "")
            ways.append(np.ptp(along[len(along)//2:]))
    book.at_most(scene.name, "way of a block along the base in the second half (cells)", max(ways), 1e-3)


def incline(book, scene, run):
    """Slides as Coulomb's law has it, or sticks."""
    taken = scene.gravity*(math.sin(SLOPE) - min(scene.friction, math.tan(SLOPE))*math.cos(SLOPE))
    for number in (2, 3):
        rows = body(run, number)
        along, _ = along_and_up(scene, rows, "")
        name = f"{scene.name}, block {number - 1}"
        if scene.friction < 1:
            book.within(name, "way along the slope (cells)", along[-1] - along[0], 0.5*taken*rows["time"][-1]**2, 0.02)
        else:
            book.at_most(name, "way along the slope (cells)", abs(along[-1] - along[0]), 0.02)


def flight(book, scene, run):
    """Momentum to round-off, energy as booked."""
    momentum(book, scene, run)
    energy(book, scene, run)


def press(book, scene, run):
    """Springs in series. Nodes up to half a cell inside a block obey the contact of its face, too: the springs are up
    to a cell shorter than the blocks of four cells, 4/3 as stiff. The work of the tools is the energy of the blocks.
    """
    energy(book, scene, run)
    book.within(scene.name, "force over that of springs in series", stiffness(scene, run), 1.12, 0.24)


def stiffness(scene, run):
    """Force on the base at the end of a press over that of springs in series."""
    times, _, lift = reaction(scene, run)
    width = math.prod(scene.soft()[0].size)/scene.soft()[0].size[1]
    force = PRESSED*width/sum(block.size[1]/block.young for block in scene.soft())
    return -lift[times > 0.98*times[-1]].mean()/force


def press_refined(book):
    """The stiffest of the presses comes to the springs' force to the first order in h."""
    scenes = [Scene("press", 16, fine) for fine in (1, 2, 4)]
    excess = [stiffness(scene, run) - 1 for scene, run in zip(scenes, solve([case(scene) for scene in scenes]))]
    for coarse, fine, scene in zip(excess, excess[1:], scenes[1:]):
        book.near(
            scene.name, f"order in h of what the force is too large by ({coarse:.3f}, {fine:.3f})",
            math.log2(coarse / fine), 1, 0.5,
        )


def check(book, full):
    """The kinds of scenes, some seeds each."""
    book.section("Contact: scenes by seed")
    for kind in KINDS:
        drawn = [Scene(kind, seed) for seed in (range(18) if full else QUICK)]
        runs = solve([case(scene) for scene in drawn])
        for scene, run in zip(drawn, runs):
            globals()[kind](book, scene, run)
        book.command(runs[0].case)
    if full:
        press_refined(book)


if __name__ == "__main__":
    if "--show" in sys.argv:
        kind, seed = sys.argv[sys.argv.index("--show") + 1:][:2]
        sys.exit(print(Scene(kind, int(seed)).deck()))
    main(check, __doc__)
