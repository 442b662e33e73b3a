"""The exact path of the left front that slows for ever under a stress boundary."""

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..theory.arrest import ArrestingCrack

# The simulation whose parameters the path has.
NEEDS = {"sweeps": ["arrest"]}

# What is still to go, in units of |x_minus|: denser towards the end, which takes for ever; last a value for the text.
TO_GO = np.append(np.geomspace(1.0, 1e-4, 200)[1:], 1e-6)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """When which fraction of the way is still to go, for each damping ratio; time in units of |x_minus|."""
    parts = {}
    for scene in expand(settings["sweeps"]["arrest"])[0]:
        if scene.damping_ratio not in parts:
            crack = ArrestingCrack(scene.prestress, scene.damping_ratio, scene.release)
            time = (
                np.array([crack.time_at_fraction(1.0 - left) for left in TO_GO])
                / -crack.balance_position
            )
            parts[scene.damping_ratio] = pd.DataFrame({"time": time, "to_go": TO_GO})
    return pd.concat(parts, names=["damping_ratio"]).reset_index("damping_ratio")
