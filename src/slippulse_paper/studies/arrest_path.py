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
    parts = []
    swept = {run.damping_ratio: run for run in runs(settings["sweeps"]["arrest"])}
    for ratio, run in swept.items():
        crack = ArrestingCrack(run.prestress, ratio, run.release)
        times = np.array([crack.transition(1.0 - to_go).time for to_go in REMAINING_FRACTIONS])
        times /= -crack.balance_position
        parts.append(
            pd.DataFrame({"damping_ratio": ratio, "time": times, "to_go": REMAINING_FRACTIONS})
        )
    return pd.concat(parts)
