"""The steady front block by block: independent numbers of front speeds, and admissible fronts.

Let blocks be released one after another, 1/v apart, whatever their stress. In the frame of the
front the state a period later is an affine function of the state, so the steady state solves one
linear system; the stress on a block at its release, per unit pre-stress, is then 1/tau_0. A front
is admissible when the stress ahead of it stays below 1 until the release, and no block behind it
comes to rest before the next one is released.
"""

from typing import NamedTuple

import numpy as np

# Stress is known at this number of substeps of a period.
SUBSTEPS = 16
# Blocks behind the front: many more than the b v/(v^2 - 1) of the layer of damped waves at it.
BLOCKS = 100


class SteadyFront(NamedTuple):
    """A front at one speed: the pre-stress into which it runs, and whether it is admissible.

    ahead is the stress on the first stuck block at SUBSTEPS + 1 times from the last release to that
    of this block, where it is 1.
    """

    prestress: float
    ahead: np.ndarray
    admissible: bool


def steady_front(speed: float, damping_ratio: float, springs: float, release: str) -> SteadyFront:
    """The steady front at a speed > 1 (wave speeds); springs are gamma dx^2."""
    # scipy.linalg is slow to load, and needed here only.
    from scipy.linalg import expm

    count = BLOCKS
    # Block 0 has just been released; the block ahead of it is stuck, and slip has no curvature at
    # the last block.
    bend = -2.0 * np.eye(count) + np.eye(count, k=1) + np.eye(count, k=-1)
    bend[-1, -3:] = bend[-2, -3:]
    size = 2 * count
    system = np.zeros((size + 1, size + 1))
    system[:count, count:size] = np.eye(count)
    system[count:size, :count] = bend - springs * np.eye(count)
    system[count:size, count:size] = damping_ratio * bend
    system[count:size, -1] = 1.0
    step = expm(system / (speed * SUBSTEPS))
    period = np.linalg.matrix_power(step, SUBSTEPS)
    # A period later each block is one position farther behind, and a block at rest leads.
    shift = np.kron(np.eye(2), np.eye(count, k=-1))
    matrix, load = np.eye(size) - shift @ period[:size, :size], shift @ period[:size, size]
    state = np.linalg.solve(matrix, load)
    states = [np.append(state, 1.0)]
    for _ in range(SUBSTEPS):
        states.append(step @ states[-1])
    history = np.array(states)[:, :size]
    slip, velocity = history[:, :count], history[:, count:]
    gain = damping_ratio if release == "total" else 0.0
    ahead = 1.0 + slip[:, 0] + gain * velocity[:, 0]
    tau = 1.0 / ahead[-1]
    # The last block must slide until the next one is released.
    admissible = np.all(tau * ahead[:-1] < 1.0) and np.all(velocity[1:, 0] > 0.0)
    return SteadyFront(float(tau), tau * ahead, bool(admissible))
