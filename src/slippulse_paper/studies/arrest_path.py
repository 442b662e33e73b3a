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

    The pre-stress and the release rule are those of the first run whose left front stops. The
    figure draws only the runs that share them.

    The columns are:

    time : time at which this fraction remains, in units of the length of the path, |x_minus|
    to_go : the remaining fraction
    """
    swept_runs = [*runs(settings["sweeps"]["arrest"])]
    first = next(
        run for run in swept_runs if run.prestress.left < 0.0 and run.prestress.right == 0.0
    )
    parts = []
    # The sweep has several spacings, on which the exact path does not depend.
    for damping_ratio in sorted({run.damping_ratio for run in swept_runs}):
        crack = ArrestingCrack(first.prestress, damping_ratio, first.release)
        path_length = -crack.balance_position
        times = [crack.transition(1.0 - remaining).time for remaining in REMAINING_FRACTIONS]
        columns = {
            "damping_ratio": damping_ratio,
            "time": np.array(times) / path_length,
            "to_go": REMAINING_FRACTIONS,
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts)
