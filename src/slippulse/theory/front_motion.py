"""The steady front block by block: independent numbers of front speeds, and admissible fronts.

Let blocks be released one after another, 1/v apart, whatever their stress. In the frame of the
front the state a period later is an affine function of the state, so the steady state solves one
linear system; the stress on a block at its release, per unit pre-stress, is then 1/tau_0. A front
is admissible when the stress ahead of it stays below 1 until the release, and no block behind it
comes to rest before the next one is released.
"""

from dataclasses import dataclass

import numpy as np

from ..model.checks import check_choice, check_number
from ..model.release import RELEASES

# Velocity and stress are known at this number of substeps of a period.
SUBSTEPS = 16


@dataclass(frozen=True)
class SteadyFront:
    """A front at one speed, in lattice units: lengths in dx, velocity in dx.

    Parameters
    ----------
    prestress : float, tau_0 into which the front runs
    distance, velocity : arrays, distance behind the front, and slip velocity there
    ahead : array, stress on the first stuck block at SUBSTEPS + 1 times from the last release to
        the release of this block, where it is 1
    """

    prestress: float
    distance: np.ndarray
    velocity: np.ndarray
    ahead: np.ndarray

    @property
    def admissible(self) -> bool:
        """True if stress ahead is below 1 until the release, when the last block still slides."""
        last_block = self.velocity[1:][self.distance[1:] <= 1.0]
        return bool(np.all(self.ahead[:-1] < 1.0) and np.all(last_block > 0.0))


def steady_front(
    speed: float,
    damping_ratio: float,
    springs: float = 0.0,
    release: str = "total",
    blocks: int = 100,
) -> SteadyFront:
    """The steady front at a given speed, without sticking behind it. Source: module docstring.

    Raises ValueError: outside these ranges.

    Parameters
    ----------
    speed : float, wave speeds, > 1 and <= 1e100
    damping_ratio, springs : floats, beta/dx and gamma dx^2, 0 to 100
    release : "total" or "elastic"
    blocks : int, blocks behind the front, 10 to 500, and many more than the b v/(v^2 - 1) of the
        layer of damped waves at the front

    Returns
    -------
    SteadyFront

    Examples
    --------
    >>> round(steady_front(2.5, 1.0).prestress, 6)
    0.6
    """
    check_number("speed", speed, above=1.0, at_most=1e100)
    check_number("damping_ratio", damping_ratio, at_least=0.0, at_most=100.0)
    check_number("springs", springs, at_least=0.0, at_most=100.0)
    check_choice("release", release, RELEASES)
    check_number("blocks", blocks, integer=True, at_least=10, at_most=500)
    # scipy.linalg is slow to load, and needed here only.
    from scipy.linalg import expm

    count = int(blocks)
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
    trusted = count // 2
    distance = np.arange(trusted * SUBSTEPS) / SUBSTEPS
    velocity = tau * velocity[:-1, :trusted].T.ravel()
    return SteadyFront(float(tau), distance, velocity, tau * ahead)
