"""Tabulate the exact fronts and trailing edges of the two runs of the space-time figure."""

import numpy as np
import pandas as pd

from slippulse.simulation.exact_rupture import exact_rupture

from ..configuration.expand import expand

NEEDS = {"sweeps": ["space_time_displacement", "space_time_stress"]}

# Positions are dense near the end of the path of a front, where it may be slow.
PATH_FRACTIONS = 1.0 - np.linspace(1.0, 0.0, 121)[:-1] ** 3


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the release and stick times of positions; NaN for a stick time if sliding goes on."""
    parts = []
    for name, sweep in settings["sweeps"].items():
        rupture = exact_rupture(expand(sweep)[0][0])
        ends = rupture.front_ends
        x = np.concatenate([ends[0][0].x * PATH_FRACTIONS[:0:-1], ends[-1][1].x * PATH_FRACTIONS])
        edges = {"release_time": rupture.release_time(x), "stick_time": rupture.stick_time(x)}
        parts.append(pd.DataFrame({"simulation": name, "position": x} | edges))
    return pd.concat(parts, ignore_index=True)
