"""Divide the planes of both pre-stress levels into the regimes that exact theory predicts."""

from itertools import product

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.prediction.predicted_regime import final_regime, largest_pulse_ratio
from slippulse.theory.rupture import Rupture

NEEDS = {"settings": ["model.damping_ratio", "model.release", "measure.still"]}

GAMMAS = {"displacement": 1.0, "stress": 0.0}
# Positive levels along the border between crack and pulse; it ends where the negative level is -1.
BORDER_LEVELS = np.linspace(0.0, 0.15, 31)[1:]
# Boundary, left level and right level of each velocity profile.
PROFILES = [
    ("displacement", 0.5, 0.5),
    ("displacement", -0.5, 0.5),
    ("stress", 0.3, 0.3),
    ("stress", -0.5, 0.0),
]
PROFILE_TIME, PROFILE_POINTS = 12.0, 241


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles area, line (one level is 0 along it) and profile (W = 1)."""
    still, model = settings["measure"]["still"], settings["model"]
    rules = model["damping_ratio"], model["release"]
    low = -BORDER_LEVELS / largest_pulse_ratio(BORDER_LEVELS, *rules, still)
    border = np.vstack([[(0.0, 0.0)], np.column_stack([low, BORDER_LEVELS]), [(low[-1], 0.0)]])
    parts: list[pd.DataFrame] = []

    def add(role: str, boundary: str, rows: pd.DataFrame, left: float, right: float) -> None:
        """Add a series of rows with the regime of a pair of levels."""
        regime = final_regime(left, right, GAMMAS[boundary], *rules, still)
        labels = {"role": role, "boundary": boundary, "series": len(parts), "regime": regime}
        parts.append(rows.assign(**labels))

    def outline(role: str, boundary: str, corners: np.ndarray, inside: np.ndarray) -> None:
        add(role, boundary, pd.DataFrame(corners, columns=["left", "right"]), *inside)

    # Add quadrants, the areas of cracks along a border, and lines on the axes.
    line = np.array([(-1.0, 0.0), (0.0, 0.0)])
    for boundary, gamma in GAMMAS.items():
        for levels in np.array([*product((-1.0, 1.0), repeat=2)]):
            # The corners of the quadrant of these signs.
            corners = np.where([(0, 0), (1, 0), (1, 1), (0, 1)], levels, 0.0)
            outline("area", boundary, corners, 0.5 * levels)
        # The plane is symmetric: the sides (1, 0) exchange left and right.
        for sides in ([0, 1], [1, 0]):
            if gamma == 0.0:
                outline("area", boundary, border[:, sides], np.array([-0.9, 1e-3])[sides])
            outline("line", boundary, line[:, sides], 0.5 * line[0, sides])
    for boundary, left, right in PROFILES:
        rupture = Rupture(Prestress(left, right), GAMMAS[boundary], *rules, PROFILE_TIME)
        x = np.linspace(*rupture.fronts_at(PROFILE_TIME), PROFILE_POINTS)
        rows = pd.DataFrame({"x": x, "slip_velocity": rupture.slip_velocity(x, PROFILE_TIME)})
        add(
            "profile", boundary, rows.assign(time=PROFILE_TIME, left=left, right=right), left, right
        )
    return pd.concat(parts, ignore_index=True)
