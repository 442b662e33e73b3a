"""The steady front, block by block: a check of front speeds that uses no Wiener-Hopf factor.

Assume that blocks are released one after another at times 1/v apart, whatever the stress on them
is. In the frame of the front the state after one such period (slip and velocity of the
BLOCKS_BEHIND_FRONT last released blocks) is an affine function of the state before it:

    state after = shift (period_matrix state before + period_load),

where the shift renumbers the blocks, because a block at rest has joined at the front. The steady
state is the fixed point, one solution of a linear system. The stress on a block at its release, for
unit pre-stress, is then 1/tau_0. The front is admissible if the stress ahead of it remains below 1
until the release, and if no block behind it comes to rest before the next one is released.
"""

from typing import NamedTuple

import numpy as np

# Number of substeps of a period at whose ends the stress is computed.
SUBSTEPS_PER_PERIOD = 16
# Number of blocks behind the front. It is much larger than b v/(v^2 - 1), the number of blocks in
# the layer of damped waves at the front.
BLOCKS_BEHIND_FRONT = 100


class SteadyFront(NamedTuple):
    """A front at one speed: the pre-stress into which it runs, and whether it is admissible.

    ahead is the stress on the first stuck block, at SUBSTEPS_PER_PERIOD + 1 times from the last
    release to the release of this block, where the stress is 1.
    """

    prestress: float
    ahead: np.ndarray
    admissible: bool


def steady_front(speed: float, damping_ratio: float, springs: float, release: str) -> SteadyFront:
    """Return the steady front at a speed > 1 (wave speeds); springs are gamma dx^2."""
    # scipy.linalg is slow to import, and only needed here.
    from scipy.linalg import expm

    count = BLOCKS_BEHIND_FRONT
    # Block 0 has just been released; the block ahead of it is stuck, and slip has no curvature at
    # the last block.
    curvature = -2.0 * np.eye(count) + np.eye(count, k=1) + np.eye(count, k=-1)
    curvature[-1, -3:] = curvature[-2, -3:]
    # The equation of motion for the slips, the velocities and, in the last place, the constant 1,
    # which is multiplied by the pre-stress, here 1.
    size = 2 * count
    slips, velocities = slice(0, count), slice(count, size)
    system = np.zeros((size + 1, size + 1))
    system[slips, velocities] = np.eye(count)
    system[velocities, slips] = curvature - springs * np.eye(count)
    system[velocities, velocities] = damping_ratio * curvature
    system[velocities, -1] = 1.0
    step = expm(system / (speed * SUBSTEPS_PER_PERIOD))
    period = np.linalg.matrix_power(step, SUBSTEPS_PER_PERIOD)
    period_matrix, period_load = period[:size, :size], period[:size, size]
    # One period later each block is one position farther behind, and a block at rest leads.
    shift = np.kron(np.eye(2), np.eye(count, k=-1))
    state = np.linalg.solve(np.eye(size) - shift @ period_matrix, shift @ period_load)
    states = [np.append(state, 1.0)]
    for _ in range(SUBSTEPS_PER_PERIOD):
        states.append(step @ states[-1])
    history = np.array(states)
    first_slip, first_velocity = history[:, slips][:, 0], history[:, velocities][:, 0]
    # The stress on the stuck block ahead of block 0, for unit pre-stress.
    gain = damping_ratio if release == "total" else 0.0
    ahead = 1.0 + first_slip + gain * first_velocity
    prestress = 1.0 / ahead[-1]
    stays_stuck = np.all(prestress * ahead[:-1] < 1.0)
    # The block released last must slide until the next one is released.
    slides = np.all(first_velocity[1:] > 0.0)
    return SteadyFront(float(prestress), prestress * ahead, bool(stays_stuck and slides))
