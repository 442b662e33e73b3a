"""The two fast fronts of a single nucleation point at x = 0."""

from typing import NamedTuple

import numpy as np

from ..model.checks import check_number
from ..model.prestress import Prestress
from .curve import Curve, Point, turned_to_right
from .fast_front import FastFront
from .prestress_pieces import nucleation_intervals


class ExactTransition(NamedTuple):
    """The transition from crack to pulse: its time T_trans and its length L_trans.

    T_trans is the time of the first stick. Only for an `ArrestingCrack` it is the time at which the
    left front has covered a given fraction of its way. L_trans is the distance between the two
    fronts at that time.
    """

    time: float
    length: float


def fast_fronts(
    prestress: Prestress, damping_ratio: float, release: str, reach: float, gamma: float = 0.0
) -> Curve:
    """Return both fronts of a single nucleation point at x = 0, up to the distance ``reach``.

    The fronts end earlier where they are not faster than the waves. The panels are short enough for
    the waves behind the fronts, at the elasticity ratio gamma.
    """
    law = FastFront(prestress=prestress, gamma=gamma, damping_ratio=damping_ratio, release=release)
    check_number("prestress at x = 0", float(prestress(0.0)), at_least=1.0)
    (first_released, last_released), *others = nucleation_intervals(prestress)
    if others or first_released != last_released:
        raise ValueError(
            "prestress: reaches 1 away from x = 0; allowed: a profile that reaches 1 only at x = 0"
        )
    start = Point(0.0, 0.0)
    right_front, _ = law.panels_to_right(start, stop=reach, until=np.inf)
    # The left front is computed as the right front of the pre-stress mirrored at x = 0.
    mirrored_left_front = right_front
    if not prestress.symmetric:
        mirrored_left_front, _ = law.mirrored().panels_to_right(start, stop=reach, until=np.inf)
    left_front = turned_to_right(-1.0, mirrored_left_front)
    return Curve(left_front + right_front)
