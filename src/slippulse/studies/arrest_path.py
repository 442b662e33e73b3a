"""The exact path of the left front that slows for ever under a stress boundary."""

import numpy as np
import pandas as pd

from ..configuration.runs import runs
from ..theory.arrest import ArrestingCrack

# The simulation whose parameters the path has.
NEEDS = {"sweeps": ["arrest"]}

# Fractions of |x_minus| still to go, denser towards the end, which takes for ever; the last one is
# for the text.
TO_GO = np.append(np.geomspace(1.0, 1e-4, 200)[1:], 1e-6)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Time, in units of |x_minus|, at which a fraction is still to go, by damping ratio."""
    parts = {}
    for run in runs(settings["sweeps"]["arrest"]):
        if run.damping_ratio not in parts:
            crack = ArrestingCrack(run.prestress, run.damping_ratio, run.release)
            times = np.array([crack.time_at_fraction(1.0 - to_go) for to_go in TO_GO])
            columns = {"time": times / -crack.balance_position, "to_go": TO_GO}
            parts[run.damping_ratio] = pd.DataFrame(columns)
    return pd.concat(parts, names=["damping_ratio"]).reset_index("damping_ratio")
