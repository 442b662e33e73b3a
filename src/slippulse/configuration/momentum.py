"""How far momentum carries the fronts of a rupture without leaf springs, and for how long: roughly, for costs.

By d'Alembert, behind fronts at the wave speed that leave from x = 0, the velocity is half the integral of the
pre-stress from (x - t)/2 to (x + t)/2: half the push at (x + t)/2 minus that at (x - t)/2.
"""

from __future__ import annotations

import math

import numpy as np


def momentum_limits(x: np.ndarray, push: np.ndarray, nucleus: float) -> tuple[np.ndarray, np.ndarray]:
    """What momentum adds to the time at which a front comes by, and when that of a block is used up.

    Parameters
    ----------
    x : positions from where the run begins, ascending
    push : integral of the pre-stress up to there
    nucleus : half the width of the region that drives the start

    Returns
    -------
    both per position; infinite where a front does not come, or where momentum lasts
    """
    right = x > 0.0
    push = push - np.interp(0.0, x, push)
    # What drives a front is first the nucleus, then all that the other front has come by.
    later, ends = np.full(x.size, math.inf), (-nucleus, nucleus)
    for _ in range(2):
        later = _waits(x, push, ends)
        never = np.isinf(later)
        ends = np.max(x[~right & never], initial=-math.inf), np.min(x[right & never], initial=math.inf)
    if np.any(np.isfinite(later) & (later > 2.0 * nucleus)):
        # A front that momentum from far behind drives on: what it has passed slides on as well.
        return later, np.full(x.size, math.inf)

    other_end, end = ends
    # Times since the front came by; beyond a front that has arrested, the pre-stress mirrored with the other sign.
    times = 2.0 * x[right]
    ahead, behind = np.maximum(x, 0.0)[:, None] + 0.5 * times, np.minimum(x, 0.0)[:, None] - 0.5 * times
    ahead = np.where(ahead > end, 2.0 * end - ahead, ahead)
    behind = np.where(behind < other_end, 2.0 * other_end - behind, behind)
    nothing = 1e-6 * float(np.max(np.abs(push[np.abs(x) < nucleus]), initial=0.0))
    ended = np.interp(ahead, x, push) <= np.interp(behind, x, push) + nothing
    return later, np.where(ended.any(axis=1), np.abs(x) + times[np.argmax(ended, axis=1)], math.inf)


def _waits(x: np.ndarray, push: np.ndarray, ends: tuple[float, float]) -> np.ndarray:
    """How long fronts wait for push from the other side to come by, from between the ends; infinite if in vain."""
    right, left = x > 0.0, x <= 0.0
    driving = (x > ends[0]) & (x < ends[1])
    rightwards = _wait(push[right], push[left & driving][::-1], -x[left & driving][::-1])
    leftwards = _wait(-push[left][::-1], -push[right & driving], x[right & driving])
    return np.concatenate([leftwards[::-1], rightwards])


def _wait(push: np.ndarray, push_behind: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The same for the right front, from the push on its way and that at distances on the other side."""
    needed = np.searchsorted(-np.minimum.accumulate(push_behind), -push)
    return np.maximum.accumulate(2.0 * np.append(distance, math.inf)[needed])
