#!/usr/bin/env python3
"""How deep a ball gets that bounces slowly off a rigid frictionless wall, by finite elements on three meshes, over
Hertz's depth: its centre of mass comes less far than he says, for the patch is not small, and the ball is squeezed as a
whole. Class Hertz of the random scenes (tests/fuzz/_truths_turns.py) takes the last column.

    build/venv/bin/python verification/surfaces/balls.py        (a minute)
"""

from math import pi

from elements import ball_depth

for speed in (0.01, 0.03):
    for poisson in (0.0, 0.3):
        hertz = (15 * 4 / 3 * pi * speed**2 * (1 - poisson**2) / 16) ** 0.4
        found = [ball_depth(divisions, poisson, speed) for divisions in (12, 24, 32)]
        # what the springs give way belongs to the wall
        ratios = [(depth - into) / hertz for depth, into in found]
        print(f"speed {speed}, Poisson's ratio {poisson}: " + " ".join(f"{ratio:.4f}" for ratio in ratios), flush=True)
