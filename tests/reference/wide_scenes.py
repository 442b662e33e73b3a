"""Random scenes over the whole documented range, edges included."""

import math
import random

import slippulse as sp
from slippulse.model.scene import ORDERS, RELEASES
from slippulse.model.stability import MARGIN, largest_step
from slippulse.solver.fixed_step import LATTICES

LEVELS = (-100.0, -10.0, -1.0, -0.3, -0.01, 0.0, 0.01, 0.1, 0.3, 0.6, 0.9, 0.99, 0.999, 0.9999, 1.0 - 1e-8)
RATIOS = (0.0, 1e-3, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0, 1e4)
GAMMAS = (1e-8, 1e-4, 1e-2, 0.3, 0.65, 1.0, 10.0, 1e3, 1e5)
WIDTHS = (0.5, 1.0, 3.0, 16.0, 1e3, 1e9)
DURATIONS = (0.1, 1.0, 5.0, 20.0, 60.0, 200.0)
SPACINGS = (0.005, 0.01, 0.03, 0.1, 0.3, 1.0)


def wide_scene(chance: random.Random) -> sp.Scene:
    """A valid scene; what it costs may be anything."""
    pick, uniform = chance.choice, chance.uniform
    while True:
        dx, ratio = pick(SPACINGS), pick([0.0, 0.1, 0.1, *RATIOS])
        boundary = pick(["displacement", "stress"])
        gamma = pick([0.3, 0.65, *GAMMAS]) if boundary == "displacement" else 0.0
        left = pick([*LEVELS, uniform(-1.0, 1.0)])
        right = left if chance.random() < 0.6 else pick([0.0, *LEVELS, uniform(-1.0, 1.0)])
        step = (pick([-1, 1]) * uniform(1.0, 40.0), pick([-0.5, 0.0, 0.3, 0.8]))
        bump = (uniform(-20.0, 20.0), pick([-1.0, -0.5, 0.3, 0.5]), uniform(0.3, 3.0))
        steps, bumps = ((part,) if chance.random() < 0.25 else () for part in (step, bump))
        scheme, order = pick([*LATTICES, "localised", "localised", "localised"]), pick(ORDERS)
        longest = min(1.0, MARGIN * largest_step(scheme, order, ratio, gamma * dx**2))
        try:
            profile = sp.Prestress(left, right, pick([1.0, 1.0, *WIDTHS]), 1.0, steps, bumps)
            duration, release = pick(DURATIONS) * math.exp(uniform(-0.5, 0.5)), pick(RELEASES)
            max_step = longest * pick([0.3, 1.0, 1.0])
            return sp.Scene(
                boundary, profile, duration, dx, gamma, ratio * dx, release, scheme, max_step, order
            )
        except ValueError:
            continue
