"""Tabulate the exact path of the left front, which slows down for ever under held stress."""

import numpy as np
import pandas as pd

from slippulse.theory.arrest import ArrestingCrack

from ..configuration.runs import runs

NEEDS = {"sweeps": ["arrest"]}

# Remaining fractions of |x_minus|, denser towards the end, which is never reached. The report
# quotes the last one.
REMAINING_FRACTIONS = np.append(np.geomspace(1.0, 1e-4, 200)[1:], 1e-6)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the times, in units of |x_minus|, at which each fraction remains, by damping ratio."""
    # The sweep has several spacings, on which the exact path does not depend.
    run_by_ratio = {run.damping_ratio: run for run in runs(settings["sweeps"]["arrest"])}
    parts = []
    for ratio, run in run_by_ratio.items():
        crack = ArrestingCrack(run.prestress, ratio, run.release)
        distance = -crack.balance_position
        times = np.array([crack.transition(1.0 - to_go).time for to_go in REMAINING_FRACTIONS])
        columns = {
            "damping_ratio": ratio,
            "time": times / distance,
            "to_go": REMAINING_FRACTIONS,
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts)
