"""All classes of random scenes whose truth is known, and the scene of a seed."""
import random

import _truths
import _truths_charges
import _truths_deep
import _truths_flows
import _truths_impacts
import _truths_layers
import _truths_rigid
import _truths_rubs
import _truths_solids
import _truths_turns
import _truths_water

MODULES = (_truths, _truths_solids, _truths_flows, _truths_layers, _truths_impacts, _truths_water, _truths_rigid,
           _truths_charges, _truths_rubs, _truths_deep, _truths_turns)
CLASSES = {one.__name__.lower(): one for module in MODULES for one in module.CLASSES}


def scene(seed, only=None):
    """The class, the scene and the method card of a seed; of one class, if told."""
    luck = random.Random(f"truth {seed}")
    name = only or luck.choice(sorted(CLASSES))
    truth = CLASSES[name](luck)
    card = "method sgmp"
    if luck.random() < 0.5:
        kind = luck.choice(("mpm", "gimp", "cpgimp", "bspline", "sgmp stress=plain rotation=plain surfaces=plain"))
        card = f"method {kind} update={luck.choice(('musl', 'musl', 'usf', 'usl', 'usavg'))}"
    return name, truth, truth.card or card
