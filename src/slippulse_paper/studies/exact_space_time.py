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
        scenes, _ = expand(sweep)
        rupture = exact_rupture(scenes[0])
        left_end, right_end = rupture.front_ends[0][0].x, rupture.front_ends[-1][1].x
        # From the end of the left front to that of the right one, with x = 0 once.
        left, right = left_end * PATH_FRACTIONS[:0:-1], right_end * PATH_FRACTIONS
        x = np.concatenate([left, right])
        columns = {
            "simulation": name,
            "position": x,
            "release_time": rupture.release_time(x),
            "stick_time": rupture.stick_time(x),
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)
