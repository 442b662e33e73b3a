"""The exact steady pulse with damping as curves over the damping ratio, and its limit as the spacing goes to 0."""

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..theory.front_speeds import front_speed, steady_pulse
from ..theory.pulse import paper_pulse

# Simulations whose parameters the curves have.
NEEDS = {"sweeps": ["pulse_damping", "continuum_fixed_ratio"]}

QUANTITIES = ("peak_velocity", "width", "slip")
# Damping ratios over the largest, denser towards no damping, where the pulse changes most.
DAMPING = np.linspace(0.0, 1.0, 61) ** 2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Left (the level), damping_ratio, quantity and value: role curve (in units of the paper's formulas) and limit (dx
    -> 0 at the fixed ratio of the refined lattices, where beta vanishes too; with the front speed).
    """
    swept, (scene, *_) = (expand(settings["sweeps"][name])[0] for name in NEEDS["sweeps"])
    left, ratio = scene.prestress.left, scene.damping_ratio
    pulse = steady_pulse(left, scene.gamma, damping_ratio=ratio, release=scene.release)
    limits = [("limit", left, ratio, name, getattr(pulse, name)) for name in (*QUANTITIES, "speed")]
    scene, rows = swept[0], []
    ratios = max(each.damping_ratio for each in swept) * DAMPING
    for left in sorted({each.prestress.left for each in swept}):
        paper = paper_pulse(left, scene.gamma)
        for ratio, speed in zip(ratios, front_speed(left, ratios, scene.release), strict=True):
            pulse = steady_pulse(left, scene.gamma, ratio * scene.dx, speed)
            for name in QUANTITIES:
                rows.append(
                    ("curve", left, ratio, name, getattr(pulse, name) / getattr(paper, name))
                )
    found = pd.DataFrame(
        rows + limits, columns=["role", "left", "damping_ratio", "quantity", "value"]
    )
    return found.replace({"quantity": {"speed": "front_speed"}})
