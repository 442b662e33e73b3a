"""Planes of both levels of the pre-stress, cut into the regimes of ruptures by exact theory."""

from itertools import product

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.prediction.predicted_regime import final_regime, largest_pulse_ratio
from slippulse.theory.rupture import Rupture

NEEDS = {"settings": ["model.damping_ratio", "model.release", "measure.still"]}

GAMMAS = {"displacement": 1.0, "stress": 0.0}
# Levels on the positive side along the border between crack and pulse, until the negative one is
# below -1.
BORDER = np.linspace(0.0, 0.15, 31)[1:]
# Boundary, and levels on the left and on the right, of the velocity profiles.
PROFILES = [
    ("displacement", 0.5, 0.5),
    ("displacement", -0.5, 0.5),
    ("stress", 0.3, 0.3),
    ("stress", -0.5, 0.0),
]
TIME, POINTS = 12.0, 241


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Roles area, line (ends of a line on which one level is 0), and profile (at W = 1)."""
    still, model = settings["measure"]["still"], settings["model"]
    rules = model["damping_ratio"], model["release"]
    low = -BORDER / largest_pulse_ratio(BORDER, *rules, still)
    border = np.vstack([[(0.0, 0.0)], np.column_stack([low, BORDER]), [(low[-1], 0.0)]])
    parts: list[pd.DataFrame] = []

    def add(role: str, boundary: str, rows: pd.DataFrame, left: float, right: float) -> None:
        """Add a series of rows, whose regime is that of a pair of levels."""
        regime = final_regime(left, right, GAMMAS[boundary], *rules, still)
        labels = {"role": role, "boundary": boundary, "series": len(parts), "regime": regime}
        parts.append(rows.assign(**labels))

    def outline(role: str, boundary: str, corners: np.ndarray, inside: np.ndarray) -> None:
        add(role, boundary, pd.DataFrame(corners, columns=["left", "right"]), *inside)

    # Quadrants, the areas of cracks along a border, and lines on the axes.
    line = np.array([(-1.0, 0.0), (0.0, 0.0)])
    for boundary, gamma in GAMMAS.items():
        for levels in np.array([*product((-1.0, 1.0), repeat=2)]):
            # The corners of the quadrant of these signs.
            corners = np.where([(0, 0), (1, 0), (1, 1), (0, 1)], levels, 0.0)
            outline("area", boundary, corners, 0.5 * levels)
        # Each is on the right as on the left: sides (1, 0) mirrors it.
        for sides in ([0, 1], [1, 0]):
            if gamma == 0.0:
                outline("area", boundary, border[:, sides], np.array([-0.9, 1e-3])[sides])
            outline("line", boundary, line[:, sides], 0.5 * line[0, sides])
    for boundary, left, right in PROFILES:
        rupture = Rupture(Prestress(left, right), GAMMAS[boundary], *rules, TIME)
        x = np.linspace(*rupture.fronts_at(TIME), POINTS)
        rows = pd.DataFrame({"x": x, "slip_velocity": rupture.slip_velocity(x, TIME)})
        add("profile", boundary, rows.assign(time=TIME, left=left, right=right), left, right)
    return pd.concat(parts, ignore_index=True)
