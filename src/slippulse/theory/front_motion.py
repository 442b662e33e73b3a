"""The steady front, block by block: a check of front speeds that uses no Wiener-Hopf factor.

The front moves by one block per period, the time 1/v. Assume that blocks are released one after
another at this interval, whatever the stress on them is. The state consists of the slips and then
the velocities of the BLOCKS_BEHIND_FRONT blocks that were released last. Block 0 is the one
released last, block 1 the one before it, and so on. The state after a period follows from the state
before it by a matrix and a constant load:

    state after = shift (period_matrix state before + period_load).

The shift renumbers the blocks: block 0 becomes block 1, and a block at rest becomes block 0. In the
steady state both sides are equal, which is one system of linear equations. It is solved for the
pre-stress 1. Since everything is proportional to the pre-stress tau_0, the stress on a block at its
release is then 1/tau_0. The front is admissible if two conditions hold: the stress ahead of it
remains below 1 until the release, and the block released last slides until the next release.
"""

from typing import NamedTuple

import numpy as np

# Number of substeps of a period at whose ends the stress is computed.
SUBSTEPS_PER_PERIOD = 16
# Number of blocks behind the front. It is much larger than b v/(v^2 - 1), the number of blocks in
# the layer of damped waves at the front, where b = beta/dx.
BLOCKS_BEHIND_FRONT = 100


class SteadyFront(NamedTuple):
    """A front at one speed: the pre-stress into which it runs, and whether it is admissible.

    ahead is the stress on the first stuck block, at SUBSTEPS_PER_PERIOD + 1 times. They go from the
    last release to the release of this block, where the stress is 1.
    """

    prestress: float
    ahead: np.ndarray
    admissible: bool


def steady_front(speed: float, damping_ratio: float, springs: float, release: str) -> SteadyFront:
    """Return the steady front at a speed v > 1 (wave speeds), from the motion of single blocks.

    damping_ratio is beta/dx. springs is the stiffness of the leaf springs, gamma dx^2. release is
    the rule by which blocks are released, "total" or "elastic".
    """
    # scipy.linalg is slow to import, and only needed here.
    from scipy.linalg import expm

    count = BLOCKS_BEHIND_FRONT
    equation = _equation_of_motion(count, damping_ratio, springs)
    # The state over a substep, and over a period, which takes the time 1/v. The last column belongs
    # to the constant 1, so that it is the load.
    substep = expm(equation / (speed * SUBSTEPS_PER_PERIOD))
    period = np.linalg.matrix_power(substep, SUBSTEPS_PER_PERIOD)
    period_matrix, period_load = period[:-1, :-1], period[:-1, -1]
    # The shift of slips and that of velocities: each row takes the value of the row before it.
    shift = np.kron(np.eye(2), np.eye(count, k=-1))
    # The steady state is the same after a period and a shift.
    steady_state = np.linalg.solve(np.eye(2 * count) - shift @ period_matrix, shift @ period_load)
    states = [np.append(steady_state, 1.0)]
    for _ in range(SUBSTEPS_PER_PERIOD):
        states.append(substep @ states[-1])
    slip_of_block_0 = np.array([state[0] for state in states])
    velocity_of_block_0 = np.array([state[count] for state in states])
    # The stress on the stuck block ahead, for the pre-stress 1. This block is pulled by block 0
    # and, under rule "total", also dragged along by the damping force.
    damping_in_stress = damping_ratio if release == "total" else 0.0
    stress_ahead = 1.0 + slip_of_block_0 + damping_in_stress * velocity_of_block_0
    # All stresses are proportional to the pre-stress, and this one is 1 at the last time, the
    # release. This condition determines the pre-stress.
    prestress = 1.0 / stress_ahead[-1]
    stays_stuck = np.all(prestress * stress_ahead[:-1] < 1.0)
    slides = np.all(velocity_of_block_0[1:] > 0.0)
    return SteadyFront(
        prestress=float(prestress),
        ahead=prestress * stress_ahead,
        admissible=bool(stays_stuck and slides),
    )


def _equation_of_motion(count: int, damping_ratio: float, springs: float) -> np.ndarray:
    """Return the matrix of d(state)/dt = matrix state, for all sliding blocks behind the front.

    The rows and columns belong to the slips of ``count`` blocks, their velocities, and the constant
    1, in this order. springs is the stiffness of the leaf springs, gamma dx^2.
    """
    # The block ahead of block 0 is stuck and has no slip. At the last block, slip has the curvature
    # of the block before.
    curvature = -2.0 * np.eye(count) + np.eye(count, k=1) + np.eye(count, k=-1)
    curvature[-1, -3:] = curvature[-2, -3:]
    slips, velocities = slice(0, count), slice(count, 2 * count)
    matrix = np.zeros((2 * count + 1, 2 * count + 1))
    matrix[slips, velocities] = np.eye(count)
    matrix[velocities, slips] = curvature - springs * np.eye(count)
    matrix[velocities, velocities] = damping_ratio * curvature
    # The pre-stress 1 is the factor of the constant.
    matrix[velocities, -1] = 1.0
    return matrix
