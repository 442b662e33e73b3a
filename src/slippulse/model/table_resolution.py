"""Check that a lattice resolves a pre-stress that is given as a table of points."""

import numpy as np

from .checks import index_of_first_true
from .prestress import Prestress

# The loss of a point is the amount by which its value lies outside the range of the pre-stress at
# the neighbouring blocks. It is 0 for the points of a ramp or a jump. A table is refused if its
# root-mean-square loss exceeds both of these limits. The first limit is in units of the stress
# drop, the second in units of the table's standard deviation. Rough profiles pass if the block
# spacing is at most twice the spacing of their points; uncorrelated noise does not pass.
MAX_LOSS, MAX_RELATIVE_LOSS = 0.02, 0.4


def check_resolved(prestress: Prestress, dx: float) -> None:
    """Raise ValueError if the blocks do not resolve the table of points of a pre-stress.

    If the stress reaches 1 at a point, which then slips at once, it must also do so at one of the
    blocks around it. The other values must, on the whole, be between those of the blocks around.

    dx : spacing of the blocks, which lie at its multiples
    """
    x, tau = prestress.point_arrays
    in_spacings = x / dx
    # Positions of three blocks for each point: on its left, nearest to it, and on its right. The
    # first axis of this array has length 3, and the second one is that of the points.
    left, right = np.ceil(in_spacings) - 1.0, np.floor(in_spacings) + 1.0
    neighbours = dx * np.array([left, np.round(in_spacings), right])
    is_released = np.any(prestress(neighbours) >= 1.0, axis=0)
    missed_point = index_of_first_true((tau >= 1.0) & ~is_released)
    if missed_point is not None:
        point = f"x = {x[missed_point]:g}, where the stress is {tau[missed_point]:g}"
        allowed = f"a stress >= 1 at a block; blocks are at multiples of dx = {dx:g}"
        raise ValueError(f"prestress.points: no block at {point}; allowed: {allowed}")
    # `level` is the table alone, without the nucleation peak. The loss of a point is the amount by
    # which it is above or below all of its three blocks.
    at_blocks = prestress.level(neighbours)
    above_blocks = np.maximum(tau - at_blocks.max(axis=0), 0.0)
    below_blocks = np.maximum(at_blocks.min(axis=0) - tau, 0.0)
    losses = above_blocks + below_blocks
    rms_loss = float(np.sqrt(np.mean(losses**2)))
    # A rough table may lose more, in proportion to its standard deviation.
    if rms_loss > max(MAX_LOSS, MAX_RELATIVE_LOSS * float(np.std(tau))):
        worst_point = int(np.argmax(losses))
        point = f"the stress {tau[worst_point]:g} at x = {x[worst_point]:g}"
        allowed = (
            f"a table that blocks of spacing dx = {dx:g} resolve; use a smaller dx or fewer points"
        )
        problem = f"the blocks do not resolve {point}"
        raise ValueError(f"prestress.points: {problem}; allowed: {allowed}")
