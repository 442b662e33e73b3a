"""The exact path of the left front that slows for ever under a stress boundary."""

import numpy as np
import pandas as pd

from slippulse.theory.arrest import ArrestingCrack

from ..configuration.runs import runs

NEEDS = {"sweeps": ["arrest"]}

# Fractions of |x_minus| still to go, denser towards the end, which takes for ever; the last one is
# for the text.
TO_GO = np.append(np.geomspace(1.0, 1e-4, 200)[1:], 1e-6)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Time, in units of |x_minus|, at which a fraction is still to go, by damping ratio."""
    parts = []
    swept = {run.damping_ratio: run for run in runs(settings["sweeps"]["arrest"])}
    for ratio, run in swept.items():
        crack = ArrestingCrack(run.prestress, ratio, run.release)
        times = np.array([crack.transition(1.0 - to_go).time for to_go in TO_GO])
        times /= -crack.balance_position
        parts.append(pd.DataFrame({"damping_ratio": ratio, "time": times, "to_go": TO_GO}))
    return pd.concat(parts)
