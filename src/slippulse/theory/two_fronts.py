"""Both fronts of one nucleation point at x = 0."""

from typing import NamedTuple

import numpy as np

from ..model.checks import check_number
from ..model.prestress import Prestress
from .curve import Curve, Point, turned_to_right
from .fast_front import FastFront
from .prestress_pieces import nucleation_intervals


class ExactTransition(NamedTuple):
    """T_trans, when something first sticks or a front has stopped, and L_trans, the length then."""

    time: float
    length: float


def fast_fronts(
    prestress: Prestress, damping_ratio: float, release: str, reach: float, gamma: float = 0.0
) -> Curve:
    """Both fronts of a nucleation at x = 0 alone, up to a distance, while they outrun the waves.

    Its panels resolve the waves of leaf springs of gamma.
    """
    law = FastFront(prestress, gamma, damping_ratio, release)
    check_number("prestress at x = 0", float(prestress(0.0)), at_least=1.0)
    starts = nucleation_intervals(prestress)
    if len(starts) > 1 or starts[0][0] != starts[0][1]:
        raise ValueError("prestress: reaches 1 away from x = 0; allowed: one nucleation point")
    start = Point(0.0, 0.0)
    right, _ = law.panels_to_right(start, reach, np.inf)
    left = right
    if not prestress.symmetric:
        left, _ = law.mirrored().panels_to_right(start, reach, np.inf)
    return Curve(turned_to_right(-1.0, left) + right)
