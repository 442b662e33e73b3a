"""Random scenes over the whole documented range, edges included."""

from __future__ import annotations

import math
import random

import slippulse as sp
from slippulse.model.scene import LATTICE_SCHEMES, ORDERS, RELEASES
from slippulse.model.stability import MARGIN, largest_step

LEVELS = (-100.0, -10.0, -1.0, -0.3, -0.01, 0.0, 0.01, 0.1, 0.3, 0.6, 0.9, 0.99, 0.999, 0.9999, 1.0 - 1e-8)
RATIOS = (0.0, 1e-3, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1e4)
GAMMAS = (1e-8, 1e-4, 1e-2, 0.3, 0.65, 1.0, 10.0, 1e3, 1e5)
WIDTHS = (0.5, 1.0, 3.0, 16.0, 1e3, 1e9)
DURATIONS = (0.1, 1.0, 5.0, 20.0, 60.0, 200.0)
SPACINGS = (0.005, 0.01, 0.03, 0.1, 0.3, 1.0)


def wide_scene(chance: random.Random) -> sp.Scene:
    """A valid scene; what it costs may be anything."""
    while True:
        dx, ratio = chance.choice(SPACINGS), chance.choice([0.0, 0.1, 0.1, *RATIOS])
        boundary = chance.choice(["displacement", "stress"])
        gamma = chance.choice([0.3, 0.65, *GAMMAS]) if boundary == "displacement" else 0.0
        left = chance.choice([*LEVELS, chance.uniform(-1.0, 1.0)])
        right = left if chance.random() < 0.6 else chance.choice([0.0, *LEVELS, chance.uniform(-1.0, 1.0)])
        steps, bumps = (), ()
        if chance.random() < 0.25:
            steps = (
                (chance.choice([-1, 1]) * chance.uniform(1.0, 40.0), chance.choice([-0.5, 0.0, 0.3, 0.8])),
            )
        if chance.random() < 0.25:
            bumps = (
                (
                    chance.uniform(-20.0, 20.0),
                    chance.choice([-1.0, -0.5, 0.3, 0.5]),
                    chance.uniform(0.3, 3.0),
                ),
            )
        scheme = chance.choice([*LATTICE_SCHEMES, "localised", "localised", "localised"])
        order = chance.choice(ORDERS)
        step = min(1.0, MARGIN * largest_step(scheme, order, ratio, gamma * dx**2))
        try:
            return sp.Scene(
                boundary=boundary,
                prestress=sp.Prestress(left, right, chance.choice([1.0, 1.0, *WIDTHS]), 1.0, steps, bumps),
                duration=chance.choice(DURATIONS) * math.exp(chance.uniform(-0.5, 0.5)),
                dx=dx,
                gamma=gamma,
                beta=ratio * dx,
                release=chance.choice(RELEASES),
                scheme=scheme,
                max_step=step * chance.choice([0.3, 1.0, 1.0]),
                order=order,
            )
        except ValueError:
            continue
