"""The steady front block by block: an independent evaluation of the front law, and whether the front is admissible.

Let blocks be released one after another, 1/v apart, whatever their stress. In the frame of the front the state a
period later is an affine function of the state, so the steady state solves one linear system; the stress on a block at
its release, per unit pre-stress, is then 1/tau_0. A front is admissible when the stress ahead of it stays below 1
until the release, and no block behind it comes to rest before the next is released.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from ..model.checks import as_numbers, check_choice, check_number
from ..model.scene import RELEASES

# Substeps of a period at which velocity and stress are looked at.
SUBSTEPS = 16


@dataclass(frozen=True)
class SteadyFront:
    """A front at one speed, in lattice units: lengths in dx, slip in dx^2, velocity in dx.

    It runs into tau_0 = prestress, with slip and velocity at distances behind it; ahead is the stress on the first
    stuck block at SUBSTEPS + 1 times from the last release to its own, where it is 1.
    """

    prestress: float
    distance: np.ndarray
    slip: np.ndarray
    velocity: np.ndarray
    ahead: np.ndarray

    @property
    def first_rest(self) -> float:
        """Distance behind the front, in blocks, where slip velocity first returns to 0; infinite if it does not."""
        rest = np.flatnonzero(self.velocity[1:] <= 0.0)
        return float(self.distance[rest[0] + 1]) if rest.size else np.inf

    @property
    def admissible(self) -> bool:
        """Whether stress ahead rises to 1 at the release only, and no block rests before the next is released."""
        return bool(np.all(self.ahead[:-1] < 1.0) and self.first_rest > 1.0)


def steady_front(
    speed: float,
    damping_ratio: float,
    springs: float = 0.0,
    release: str = "total",
    blocks: int = 100,
) -> SteadyFront:
    """The steady front at a given speed, without sticking behind it.

    Parameters
    ----------
    speed : in wave speeds, > 1 and <= 1e100
    damping_ratio, springs : beta/dx and gamma dx^2, 0 to 100
    release : "total" or "elastic"
    blocks : kept behind the front, 10 to 500; many more than b v/(v^2 - 1), the layer through which damping looks ahead

    Raises ValueError: outside these ranges.
    """
    check_number("speed", speed, above=1.0, at_most=1e100)
    check_number("damping_ratio", damping_ratio, at_least=0.0, at_most=100.0)
    check_number("springs", springs, at_least=0.0, at_most=100.0)
    check_choice("release", release, RELEASES)
    check_number("blocks", blocks, integer=True, at_least=10, at_most=500)
    # Slow to load, and needed here only.
    from scipy.linalg import expm

    count = int(blocks)
    # Block 0 has just been released; the one ahead of it is stuck, and behind the last slip has no curvature.
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
    # A period later each block is one farther behind, and a block at rest leads.
    shift = np.kron(np.eye(2), np.eye(count, k=-1))
    state = np.linalg.solve(
        np.eye(size) - shift @ period[:size, :size], shift @ period[:size, size]
    )
    states = [np.append(state, 1.0)]
    for _ in range(SUBSTEPS):
        states.append(step @ states[-1])
    history = np.array(states)[:, :size]
    slip, velocity = history[:, :count], history[:, count:]
    gain = damping_ratio if release == "total" else 0.0
    ahead = 1.0 + slip[:, 0] + gain * velocity[:, 0]
    tau = 1.0 / ahead[-1]
    trusted = count // 2
    return SteadyFront(
        prestress=float(tau),
        distance=np.arange(trusted * SUBSTEPS) / SUBSTEPS,
        slip=tau * slip[:-1, :trusted].T.ravel(),
        velocity=tau * velocity[:-1, :trusted].T.ravel(),
        ahead=tau * ahead,
    )


def admissibility_table(speeds, ratios, springs, release: str = "total") -> list[dict]:
    """One row for each of speeds, ratios and springs, arrays of arguments of `steady_front`: the pre-stress, the
    largest stress ahead before the release, the first rest behind the front in blocks, and whether it is admissible.
    """
    given = {"springs": springs, "ratios": ratios, "speeds": speeds}
    rows = []
    for g, b, v in product(*(as_numbers(*each).flat for each in given.items())):
        front = steady_front(v, b, g, release)
        row = {
            "speed": v,
            "damping_ratio": b,
            "springs": g,
            "release": release,
            "prestress": front.prestress,
        }
        row |= {"stress_ahead": float(front.ahead[:-1].max()), "rest": front.first_rest}
        rows.append(row | {"admissible": front.admissible})
    return rows
