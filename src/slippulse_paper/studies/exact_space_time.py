"""Tabulate the exact fronts and trailing edges of both ruptures of the space-time figure."""

import numpy as np
import pandas as pd

from slippulse.simulation.exact_rupture import exact_rupture

from ..configuration.expand import expand
from .outermost_fronts import outermost_fronts

NEEDS = {"sweeps": ["space_time_displacement", "space_time_stress"]}

# Positions divided by the length of the path of a front, from 0 to nearly 1. They are dense near
# the end of the path, where the front may be slow.
PATH_FRACTIONS = 1.0 - np.linspace(1.0, 0.0, 121)[:-1] ** 3


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return release times and stick times by position; NaN where a point has not stuck again."""
    parts = []
    for name, sweep in settings["sweeps"].items():
        scenes, _ = expand(sweep)
        rupture = exact_rupture(scenes[0])
        fronts = outermost_fronts(rupture)
        # Positions in ascending order. Those on the left do not include x = 0 again.
        x_on_left = fronts.left.x * PATH_FRACTIONS[:0:-1]
        x_on_right = fronts.right.x * PATH_FRACTIONS
        x = np.concatenate([x_on_left, x_on_right])
        columns = {
            "simulation": name,
            "position": x,
            "release_time": rupture.release_time(x),
            "stick_time": rupture.stick_time(x),
        }
        parts.append(pd.DataFrame(columns))
    return pd.concat(parts, ignore_index=True)
