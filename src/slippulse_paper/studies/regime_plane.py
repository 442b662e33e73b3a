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
# Right levels along the border between crack and pulse without leaf springs. The border begins at
# the point (0, 0) and ends beyond the edge of the plane. If it does not reach the left edge, it
# continues almost to the upper one.
BORDER_RIGHT_LEVELS = np.linspace(0.0, 0.15, 31)[1:]
LONG_BORDER_RIGHT_LEVELS = np.linspace(0.0, 0.99, 100)[1:]
LEFT_EDGE = -1.0
# Boundary, left level and right level of each velocity profile.
PROFILES = [
    ("displacement", 0.5, 0.5),
    ("displacement", -0.5, 0.5),
    ("stress", 0.3, 0.3),
    ("stress", -0.5, 0.0),
]
PROFILE_TIME = 12.0
PROFILE_POINTS = 241
# Pairs of levels (left, right): ends and middle of the line on which the left level is negative and
# the right level is 0, and a point in the area of pulses next to this line.
ENDS_OF_LINE = np.array([(-1.0, 0.0), (0.0, 0.0)])
MIDDLE_OF_LINE = np.array([-0.5, 0.0])
POINT_IN_PULSE_AREA = np.array([-0.9, 1e-3])


class Series(NamedTuple):
    """Rows of one area, line or profile, and a pair of levels whose regime all of them have.

    left, right : the levels of a profile, or of a point inside the area or on the line
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
        # All rows of a series have the regime of its pair of levels.
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
    """Yield for each boundary the areas of one regime, and two lines.

    The first areas are the four quadrants of the plane of both levels. Without leaf springs, areas
    of pulses cover a part of two of them. On each line one level is 0 and the other is negative.

    still_fraction : a rupture is a pulse if its velocity at x = 0 falls below this fraction of its
        largest velocity
    """
    pulse_area = corners_of_pulse_area(damping_ratio, release, still_fraction)
    for boundary, gamma in GAMMAS.items():
        for left, right in product((-1.0, 1.0), repeat=2):
            quadrant = np.array([(0.0, 0.0), (left, 0.0), (left, right), (0.0, right)])
            middle = np.array([0.5 * left, 0.5 * right])
            yield outline("area", boundary, corners=quadrant, inside=middle)
        # The plane is symmetric, so each area or line has a mirror image with exchanged levels.
        for mirrored in (False, True):
            if gamma == 0.0:
                yield outline("area", boundary, pulse_area, POINT_IN_PULSE_AREA, mirrored)
            yield outline("line", boundary, ENDS_OF_LINE, MIDDLE_OF_LINE, mirrored)


def corners_of_pulse_area(damping_ratio: float, release: str, still_fraction: float) -> np.ndarray:
    """Return the corners (left, right) of an area of pulses in the plane without leaf springs.

    In this area the left level is negative, and the right level is positive but small compared
    with the size of the left one. With a larger right level, ruptures are cracks.

    still_fraction : a rupture is a pulse if its velocity at x = 0 falls below this fraction of its
        largest velocity
    """
    for right_levels in (BORDER_RIGHT_LEVELS, LONG_BORDER_RIGHT_LEVELS):
        # A rupture is a pulse up to this ratio of the right level to the size of the left one.
        level_ratios = largest_pulse_ratio(right_levels, damping_ratio, release, still_fraction)
        left_levels = -right_levels / level_ratios
        corners = [(0.0, 0.0), *zip(left_levels, right_levels, strict=True)]
        if left_levels[-1] < LEFT_EDGE:
            break
    else:
        corners.append((LEFT_EDGE, right_levels[-1]))
    # From its end the area reaches down to the axis on which the right level is 0.
    return np.array([*corners, (corners[-1][0], 0.0)])


def outline(
    role: str, boundary: str, corners: np.ndarray, inside: np.ndarray, mirrored: bool = False
) -> Series:
    """Return the series of an area or a line, from its corners or ends.

    corners : pairs of a left and a right level, one in each row
    inside : one pair of levels in the area or on the line, whose regime the whole series has
    mirrored : if True, the left and the right level are exchanged in all pairs
    """
    if mirrored:
        corners, inside = corners[:, ::-1], inside[::-1]
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
