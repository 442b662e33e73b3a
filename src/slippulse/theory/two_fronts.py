"""The two fast fronts of a single nucleation point at x = 0."""

from typing import NamedTuple

import numpy as np

from ..model.checks import check_number
from ..model.prestress import Prestress
from .curve import Curve, Point, turned_to_right
from .fast_front import FastFront
from .prestress_pieces import nucleation_intervals


class ExactTransition(NamedTuple):
    """The crack-pulse transition: T_trans and L_trans.

    T_trans is the time at which something first sticks, or a front has stopped; L_trans is the
    length of the rupture at that time.
    """

    time: float
    length: float


def fast_fronts(
    prestress: Prestress, damping_ratio: float, release: str, reach: float, gamma: float = 0.0
) -> Curve:
    """Return both fronts of a single nucleation point at x = 0, up to a distance.

    They end where they are not faster than the waves. The panels resolve the waves of leaf springs
    with the elasticity ratio gamma.
    """
    law = FastFront(prestress=prestress, gamma=gamma, damping_ratio=damping_ratio, release=release)
    check_number("prestress at x = 0", float(prestress(0.0)), at_least=1.0)
    (first_released, last_released), *others = nucleation_intervals(prestress)
    if others or first_released != last_released:
        raise ValueError("prestress: reaches 1 away from x = 0; allowed: one nucleation point")
    start = Point(0.0, 0.0)
    right, _ = law.panels_to_right(start, reach, np.inf)
    left = right
    if not prestress.symmetric:
        left, _ = law.mirrored().panels_to_right(start, reach, np.inf)
    return Curve(turned_to_right(-1.0, left) + right)
