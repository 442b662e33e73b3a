"""Tabulate the exact steady pulse as a function of the damping ratio, and its limit dx -> 0."""

import numpy as np
import pandas as pd

from slippulse.model.run import Run
from slippulse.theory.closed_pulse import paper_pulse, pulse_at_speed
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.pulse import steady_pulse

from ..configuration.runs import runs

NEEDS = {"sweeps": ["pulse_damping", "continuum_fixed_ratio"]}

QUANTITIES = ("peak_velocity", "width", "slip")
# Damping ratios divided by the largest one, denser towards 0, where the pulse changes most.
RELATIVE_DAMPING_RATIOS = np.linspace(0.0, 1.0, 61) ** 2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each pulse and quantity, in two parts, which the column role names.

    curve : pulses at the spacing of the sweep, divided by the paper's formulas
    limit : the pulse as dx -> 0, with its front speed
    """
    swept, refined = ([*runs(settings["sweeps"][name])] for name in NEEDS["sweeps"])
    # All refined runs are the same scene at several spacings, so they have the same limit.
    rows = curve_rows(swept) + limit_rows(refined[0])
    columns = ["role", "left", "damping_ratio", "quantity", "value"]
    return pd.DataFrame(rows, columns=columns)


def curve_rows(swept: list[Run]) -> list[tuple]:
    """Return exact pulses divided by the paper's formula, for each level and damping ratio."""
    first = swept[0]
    largest_ratio = max(run.damping_ratio for run in swept)
    ratios = largest_ratio * RELATIVE_DAMPING_RATIOS
    rows = []
    for level in sorted({run.prestress.left for run in swept}):
        paper = paper_pulse(level, first.gamma)
        speeds = front_speed(level, ratios, first.release)
        for ratio, speed in zip(ratios, speeds, strict=True):
            pulse = pulse_at_speed(level, first.gamma, ratio * first.dx, speed)
            for quantity in QUANTITIES:
                value = getattr(pulse, quantity) / getattr(paper, quantity)
                rows.append(("curve", level, ratio, quantity, value))
    return rows


def limit_rows(run: Run) -> list[tuple]:
    """Return the exact pulse in the limit dx -> 0 at the damping ratio of a run."""
    level, ratio = run.prestress.left, run.damping_ratio
    pulse = steady_pulse(level, run.gamma, damping_ratio=ratio, release=run.release)
    values = {quantity: getattr(pulse, quantity) for quantity in QUANTITIES}
    values["front_speed"] = pulse.speed
    return [("limit", level, ratio, quantity, value) for quantity, value in values.items()]
