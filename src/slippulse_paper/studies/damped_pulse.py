"""Tabulate the exact steady pulse as a function of the damping ratio, and its limit dx -> 0."""

import numpy as np
import pandas as pd

from slippulse.theory.closed_pulse import paper_pulse, pulse_at_speed
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.pulse import steady_pulse

from ..configuration.runs import runs

NEEDS = {"sweeps": ["pulse_damping", "continuum_fixed_ratio"]}

QUANTITIES = ("peak_velocity", "width", "slip")
# Damping ratios divided by the largest one, denser towards 0, where the pulse changes most.
RELATIVE_DAMPING_RATIOS = np.linspace(0.0, 1.0, 61) ** 2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles curve (in units of the paper's formulas) and limit (dx -> 0)."""
    swept, (refined, *_) = ([*runs(settings["sweeps"][name])] for name in NEEDS["sweeps"])
    left, ratio = refined.prestress.left, refined.damping_ratio
    pulse = steady_pulse(left, refined.gamma, damping_ratio=ratio, release=refined.release)
    limits = [("limit", left, ratio, name, getattr(pulse, name)) for name in QUANTITIES]
    limits.append(("limit", left, ratio, "front_speed", pulse.speed))
    first, rows = swept[0], []
    ratios = max(one.damping_ratio for one in swept) * RELATIVE_DAMPING_RATIOS
    for left in sorted({one.prestress.left for one in swept}):
        paper = paper_pulse(left, first.gamma)
        for ratio, speed in zip(ratios, front_speed(left, ratios, first.release), strict=True):
            pulse = pulse_at_speed(left, first.gamma, ratio * first.dx, speed)
            for name in QUANTITIES:
                value = getattr(pulse, name) / getattr(paper, name)
                rows.append(("curve", left, ratio, name, value))
    columns = ["role", "left", "damping_ratio", "quantity", "value"]
    return pd.DataFrame(rows + limits, columns=columns)
