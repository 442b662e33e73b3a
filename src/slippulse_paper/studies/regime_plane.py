"""Divide the planes of both pre-stress levels into the regimes that exact theory predicts.

Each boundary condition has a plane, with the level on the left and the level on the right as axes.
The figure draws its areas and lines in the colour of their regime, and some velocity profiles.
"""

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

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
PROFILE_TIME = 12.0
PROFILE_POINTS = 241
# Corners of the quadrant with positive levels: left and right level.
QUADRANT = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
# A pair of levels inside the areas of cracks next to the borders: the negative and the positive.
CRACK_LEVELS = np.array([-0.9, 1e-3])


class Series(NamedTuple):
    """Rows that belong together, such as the corners of an area, and a pair of levels inside.

    The regime at this pair of levels is the regime of the whole series.
    """

    role: str
    boundary: str
    rows: pd.DataFrame
    left: float
    right: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    area : corners of the area of a regime in the plane of both levels
    line : ends of a line along which one level is 0
    profile : slip velocity as a function of the position, for a nucleation of width W = 1
    """
    still_fraction, model = settings["measure"]["still"], settings["model"]
    ratio, release = model["damping_ratio"], model["release"]
    all_series = [*areas_and_lines(ratio, release, still_fraction), *profiles(ratio, release)]
    parts = []
    for number, series in enumerate(all_series):
        gamma = GAMMAS[series.boundary]
        regime = final_regime(series.left, series.right, gamma, ratio, release, still_fraction)
        rows = series.rows.assign(
            role=series.role, boundary=series.boundary, series=number, regime=regime
        )
        parts.append(rows)
    return pd.concat(parts, ignore_index=True)


def areas_and_lines(ratio: float, release: str, still_fraction: float) -> Iterator[Series]:
    """Yield the quadrants of both planes, areas of cracks in them, and lines on the axes.

    Where one level is negative, a rupture without leaf springs is a pulse. Only near the axis,
    where the negative level is small compared with the positive one, is it a crack.
    """
    # A rupture is a pulse up to this ratio of the positive level to the size of the negative one.
    level_ratios = largest_pulse_ratio(BORDER_LEVELS, ratio, release, still_fraction)
    negative_levels = -BORDER_LEVELS / level_ratios
    border = np.column_stack([negative_levels, BORDER_LEVELS])
    crack_area = np.vstack([[(0.0, 0.0)], border, [(negative_levels[-1], 0.0)]])
    axis = np.array([(-1.0, 0.0), (0.0, 0.0)])
    for boundary, gamma in GAMMAS.items():
        for left_sign, right_sign in product((-1.0, 1.0), repeat=2):
            signs = np.array([left_sign, right_sign])
            corners = np.where(QUADRANT > 0.0, signs, 0.0)
            yield outline("area", boundary, corners, inside=0.5 * signs)
        # The plane is symmetric: the order (1, 0) exchanges left and right.
        for order in ([0, 1], [1, 0]):
            if gamma == 0.0:
                yield outline("area", boundary, crack_area[:, order], inside=CRACK_LEVELS[order])
            yield outline("line", boundary, axis[:, order], inside=0.5 * axis[0, order])


def outline(role: str, boundary: str, corners: np.ndarray, inside: np.ndarray) -> Series:
    """Return a series from pairs of levels: the corners, and one pair inside."""
    rows = pd.DataFrame(corners, columns=["left", "right"])
    return Series(role, boundary, rows, left=inside[0], right=inside[1])


def profiles(ratio: float, release: str) -> Iterator[Series]:
    """Yield the exact slip velocity of each of PROFILES at PROFILE_TIME."""
    for boundary, left, right in PROFILES:
        gamma = GAMMAS[boundary]
        rupture = Rupture(Prestress(left, right), gamma, ratio, release, PROFILE_TIME)
        left_front, right_front = rupture.fronts_at(PROFILE_TIME)
        x = np.linspace(left_front, right_front, PROFILE_POINTS)
        rows = pd.DataFrame({"x": x, "slip_velocity": rupture.slip_velocity(x, PROFILE_TIME)})
        rows = rows.assign(time=PROFILE_TIME, left=left, right=right)
        yield Series("profile", boundary, rows, left, right)
