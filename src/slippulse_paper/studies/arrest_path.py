"""Tabulate when the left front reaches each position, by exact theory under a stress boundary.

The front approaches its final position x_minus ever more slowly, and never arrives there.
"""

import numpy as np
import pandas as pd

from slippulse.theory.arrest import ArrestingCrack

from ..configuration.runs import runs

NEEDS = {"sweeps": ["arrest"]}

# Fractions of the path that the front has yet to run, denser towards the end of the path. The
# report quotes the last one.
REMAINING_FRACTIONS = np.append(np.geomspace(1.0, 1e-4, 200)[1:], 1e-6)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each damping ratio and remaining fraction of the path.

    time : time at which this fraction remains, in units of the length of the path, |x_minus|
    to_go : the remaining fraction
    """
    # The sweep has several spacings, on which the exact path does not depend, so one run of each
    # damping ratio is enough.
    run_by_damping_ratio = {run.damping_ratio: run for run in runs(settings["sweeps"]["arrest"])}
    parts = []
    for damping_ratio, run in run_by_damping_ratio.items():
        crack = ArrestingCrack(run.prestress, damping_ratio, run.release)
        path_length = -crack.balance_position
        times = [crack.transition(1.0 - remaining).time for remaining in REMAINING_FRACTIONS]
        columns = {
            "damping_ratio": damping_ratio,
            "time": np.array(times) / path_length,
            "to_go": REMAINING_FRACTIONS,
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts)
