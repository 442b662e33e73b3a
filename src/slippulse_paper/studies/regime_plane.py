"""Find the regime of a rupture for each pair of pre-stress levels, by exact theory.

There is a plane for each boundary condition. Its axes are the level on the left and the level on
the right. The study divides each plane into areas of one regime, and computes some velocity
profiles.
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
# Positive levels along the border between crack and pulse without leaf springs. The border begins
# at the point (0, 0) and ends beyond the edge of the plane.
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
# Pairs of levels (left, right): corners of the quadrant in which both are positive, ends of the
# axis on which the left level is negative, and a point in an area of pulses next to this axis.
QUADRANT = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
NEGATIVE_AXIS = np.array([(-1.0, 0.0), (0.0, 0.0)])
NEAR_NEGATIVE_AXIS = np.array([-0.9, 1e-3])


class Series(NamedTuple):
    """Rows that belong together, and the pair of levels whose regime they all have.

    For the corners of an area, this is a point inside the area.
    """

    role: str
    boundary: str
    rows: pd.DataFrame
    left: float
    right: float


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure. The column ``role`` has these values:

    area : corners of the area of a regime in the plane of both levels
    line : ends of a line along which one level is 0
    profile : slip velocity as a function of the position, for a nucleation of width W = 1
    """
    # A rupture is a pulse if its velocity at x = 0 falls below this fraction of its largest one.
    still_fraction = settings["measure"]["still"]
    model = settings["model"]
    damping_ratio, release = model["damping_ratio"], model["release"]
    all_series = [
        *areas_and_lines(damping_ratio, release, still_fraction),
        *profiles(damping_ratio, release),
    ]
    parts = []
    for number, series in enumerate(all_series):
        regime = final_regime(
            series.left,
            series.right,
            GAMMAS[series.boundary],
            damping_ratio,
            release,
            still_fraction,
        )
        rows = series.rows.assign(
            role=series.role, boundary=series.boundary, series=number, regime=regime
        )
        parts.append(rows)
    return pd.concat(parts, ignore_index=True)


def areas_and_lines(damping_ratio: float, release: str, still_fraction: float) -> Iterator[Series]:
    """Yield the four quadrants of each plane, the areas next to its axes, and lines on its axes.

    An area that comes later covers a part of an earlier one. Next to the axes there are areas of
    another regime only without leaf springs.

    still_fraction : a rupture is a pulse if its velocity at x = 0 falls below this fraction of its
        largest velocity
    """
    next_to_axis = area_next_to_axis(damping_ratio, release, still_fraction)
    for boundary, gamma in GAMMAS.items():
        for left_sign, right_sign in product((-1.0, 1.0), repeat=2):
            signs = np.array([left_sign, right_sign])
            # The corners of the quadrant in which the levels have these signs.
            corners = np.where(QUADRANT > 0.0, signs, 0.0)
            yield outline("area", boundary, corners, inside=0.5 * signs)
        # The plane is symmetric: the order (1, 0) exchanges the left and the right level.
        for order in ([0, 1], [1, 0]):
            if gamma == 0.0:
                inside = NEAR_NEGATIVE_AXIS[order]
                yield outline("area", boundary, next_to_axis[:, order], inside)
            middle_of_axis = 0.5 * NEGATIVE_AXIS[0, order]
            yield outline("line", boundary, NEGATIVE_AXIS[:, order], middle_of_axis)


def area_next_to_axis(damping_ratio: float, release: str, still_fraction: float) -> np.ndarray:
    """Return the corners of the area of pulses next to the axis with a negative left level.

    Without leaf springs, a rupture is a pulse if its positive level is small compared with the size
    of its negative level. Otherwise it is a crack.
    """
    # A rupture is a pulse up to this ratio of the positive level to the size of the negative one.
    level_ratios = largest_pulse_ratio(BORDER_LEVELS, damping_ratio, release, still_fraction)
    negative_levels = -BORDER_LEVELS / level_ratios
    border = np.column_stack([negative_levels, BORDER_LEVELS])
    return np.vstack([[(0.0, 0.0)], border, [(negative_levels[-1], 0.0)]])


def outline(role: str, boundary: str, corners: np.ndarray, inside: np.ndarray) -> Series:
    """Return a series of corners, or of the ends of a line.

    corners : pairs of a left and a right level, one in each row
    inside : one pair of levels in the area or on the line
    """
    rows = pd.DataFrame(corners, columns=["left", "right"])
    return Series(role, boundary, rows, left=inside[0], right=inside[1])


def profiles(damping_ratio: float, release: str) -> Iterator[Series]:
    """Yield the exact slip velocity of each of PROFILES at PROFILE_TIME."""
    for boundary, left, right in PROFILES:
        gamma = GAMMAS[boundary]
        prestress = Prestress(left, right)
        rupture = Rupture(prestress, gamma, damping_ratio, release, PROFILE_TIME)
        left_front, right_front = rupture.fronts_at(PROFILE_TIME)
        x = np.linspace(left_front, right_front, PROFILE_POINTS)
        rows = pd.DataFrame({"x": x, "slip_velocity": rupture.slip_velocity(x, PROFILE_TIME)})
        rows = rows.assign(time=PROFILE_TIME, left=left, right=right)
        yield Series("profile", boundary, rows, left, right)
