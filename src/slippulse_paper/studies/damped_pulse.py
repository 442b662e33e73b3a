"""Tabulate exact steady pulses as functions of the damping ratio, and their limit dx -> 0."""

from typing import Any

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
    """Return one row for each pulse and quantity. The column ``role`` has these values:

    curve : one of QUANTITIES of a pulse at the spacing of the sweep ``pulse_damping``, divided by
        the paper's formula
    limit : one of QUANTITIES, or the front speed, of the pulse in the limit dx -> 0, undivided
    """
    swept_runs = [*runs(settings["sweeps"]["pulse_damping"])]
    # The runs of ``continuum_fixed_ratio`` are one scene at several spacings, so they have the same
    # limit. If an overlay adds other scenes, the figure draws only that of the first run.
    first_refined_run = next(runs(settings["sweeps"]["continuum_fixed_ratio"]))
    return pd.DataFrame(curve_rows(swept_runs) + limit_rows(first_refined_run))


def curve_rows(swept_runs: list[Run]) -> list[dict[str, Any]]:
    """Return exact pulses divided by the paper's formulas, for each level and damping ratio.

    The spacing, gamma and release rule are those of the first run. The figure draws only the runs
    that share them.
    """
    first = swept_runs[0]
    largest_ratio = max(run.damping_ratio for run in swept_runs)
    damping_ratios = largest_ratio * RELATIVE_DAMPING_RATIOS
    rows = []
    for level in sorted({run.prestress.left for run in swept_runs}):
        paper = paper_pulse(level, first.gamma)
        speeds = front_speed(level, damping_ratios, first.release)
        for damping_ratio, speed in zip(damping_ratios, speeds, strict=True):
            beta = damping_ratio * first.dx
            pulse = pulse_at_speed(level, first.gamma, beta, speed)
            for quantity in QUANTITIES:
                ratio_to_paper = getattr(pulse, quantity) / getattr(paper, quantity)
                rows.append(row_of("curve", level, damping_ratio, quantity, ratio_to_paper))
    return rows


def limit_rows(run: Run) -> list[dict[str, Any]]:
    """Return the exact pulse in the limit dx -> 0, at the level and damping ratio of a run."""
    level, damping_ratio = run.prestress.left, run.damping_ratio
    pulse = steady_pulse(level, run.gamma, damping_ratio=damping_ratio, release=run.release)
    values = {quantity: getattr(pulse, quantity) for quantity in QUANTITIES}
    values["front_speed"] = pulse.speed
    return [
        row_of("limit", level, damping_ratio, quantity, value) for quantity, value in values.items()
    ]


def row_of(
    role: str, level: float, damping_ratio: float, quantity: str, value: float
) -> dict[str, Any]:
    """Return one row of the table."""
    return {
        "role": role,
        "left": level,
        "damping_ratio": damping_ratio,
        "quantity": quantity,
        "value": value,
    }
