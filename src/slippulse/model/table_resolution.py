"""Refusal of a table of pre-stress that a lattice does not resolve."""

import numpy as np

from .checks import check_that
from .prestress import Prestress

# A table is refused if its points lie outside of what the blocks beside them see, in the root mean
# square, by this much of the stress drop and by this fraction of the variation of the table. Points
# of a ramp or a jump lie between the blocks beside them. An ensemble of rough profiles passes on a
# lattice of twice the spacing of its points; noise without correlation does not.
LARGEST_LOSS, LARGEST_FRACTION = 0.02, 0.4


def check_resolved(prestress: Prestress, dx: float) -> None:
    """Refuse a table whose variation lies between the blocks, or that reaches 1 only there."""
    x, tau = np.array(prestress.points).T
    block = x / dx
    beside = dx * np.array([np.ceil(block) - 1.0, np.round(block), np.floor(block) + 1.0])
    released = np.any(prestress(beside) >= 1.0, axis=0)
    for row in np.flatnonzero((tau >= 1.0) & ~released)[:1].tolist():
        allowed = f"a value >= 1 at a block too, which are at multiples of dx = {dx:g}"
        check_that(False, f"prestress.points {tau[row]:g} at x", float(x[row]), allowed)
    seen = prestress.level(beside)
    lost = np.maximum(tau - seen.max(axis=0), 0.0) + np.maximum(seen.min(axis=0) - tau, 0.0)
    loss = float(np.sqrt(np.mean(lost**2)))
    if loss > max(LARGEST_LOSS, LARGEST_FRACTION * float(np.std(tau))):
        worst = int(np.argmax(lost))
        key = f"prestress.points {tau[worst]:g} between blocks at x"
        allowed = (
            f"a table that blocks at a distance dx = {dx:g} resolve: a smaller dx or fewer points"
        )
        check_that(False, key, float(x[worst]), allowed)
