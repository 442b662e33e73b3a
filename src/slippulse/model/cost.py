"""Upper bound on what a run costs.

A front goes at most at the speed that the highest level of the pre-stress drives it at, and the
blocks that it has passed slide at most until the end. So the work of a run is at most its steps
times the blocks that its fronts can reach. The shipped sweeps take at most 0.43 of that. Undamped
blocks that slip again and again may take twice as much.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .prestress import Prestress
from .samples import Samples
from .scene import Scene

# One job may take so much without a second question: runs, block updates (days on one core), bytes
# (a small machine). A sweep in chunks may take this number of times as much in total.
LIMITS = 20_000, 4e13, 4e9
MOST_CHUNKS = 50
HOW_TO_GO_ON = "--config allow_large=true"
# Bytes of a block: seven recorded numbers; two arrays an order and sixteen others while it runs.
RECORDED, ARRAYS = 56.0, 16.0
# Bytes of a point of a table: two numbers, and the text that a data file has.
POINT = 400.0
# Block updates that take as long as a run that does nothing, and as a block of the exact solution.
START, EXACT_BLOCK = 1e5, 3e4
# A front that crosses a table where it reaches 1 is taken to be this fast.
HIGHEST_LEVEL = 1.0 - 1e-9
# A step ends early after this number of events.
EVENTS_OF_A_STEP = 64
# Seconds of a block update at the highest order on a slow machine, and the number of block updates
# from which a second thread pays.
UPDATE_SECONDS, LONG_SWEEP = 2e-8, 1e11
# Minutes to start a job, and MB of the interpreter with its libraries.
START_MINUTES, START_MEGABYTES = 10, 1000


class Bound(NamedTuple):
    """Upper bound on what a list of runs takes."""

    runs: float
    block_updates: float
    bytes: float

    def exceeded(self, chunks: int = 1, remedy: str = f"with more chunks or {HOW_TO_GO_ON}") -> str:
        """The limit that one job, or all jobs together, exceed, in words; empty if none is."""
        fraction = min(1.0, MOST_CHUNKS / chunks)
        shared = f" in each of {chunks} chunks" if chunks > 1 else ""
        for name, value, limit in zip(self._fields, self, LIMITS, strict=True):
            allowed = fraction * limit
            if not value <= allowed:
                takes = f"up to {value:.3g} {name.replace('_', ' ')}{shared}"
                return f"cost: {takes}; allowed: {allowed:.3g}, {remedy}"
        return ""

    @property
    def threads(self) -> int:
        """Threads of the job; short sweeps run side by side instead, and start faster."""
        return 2 if self.block_updates > LONG_SWEEP else 1

    @property
    def minutes(self) -> int:
        """Time limit of the job on a cluster."""
        return START_MINUTES + math.ceil(UPDATE_SECONDS * self.block_updates / 60.0 / self.threads)

    @property
    def megabytes(self) -> int:
        """Memory limit of the job on a cluster."""
        return START_MEGABYTES + math.ceil(2.0 * self.bytes / 1e6)


def reach_of(
    profile: Prestress, start: float, duration: float, speeds_at: Callable[[np.ndarray], np.ndarray]
) -> float:
    """Largest distance from x = 0 of fronts that begin at a distance ``start`` on both sides.

    ``speeds_at`` returns speeds at levels of pre-stress; an interval has its higher level.
    """
    intervals = profile.interval_table
    speeds = speeds_at(intervals[:, 2:].max(axis=1))
    right = _distance(intervals[:, 1], speeds, start, duration)
    left = _distance(-intervals[::-1, 0], speeds[::-1], start, duration)
    return max(left, right)


def _distance(ends: np.ndarray, speeds: np.ndarray, start: float, duration: float) -> float:
    """Distance of a front that crosses intervals with these ends at these speeds."""
    ahead = ends > start
    ends, speeds = ends[ahead], speeds[ahead]
    times = np.cumsum(np.diff(ends, prepend=start) / speeds)
    last = int(np.searchsorted(times, duration))
    begin, began = (ends[last - 1], times[last - 1]) if last else (start, 0.0)
    return float(begin + (duration - began) * speeds[last])


def _upper_bound_of_reach(scene: Scene) -> float:
    """Upper bound on the distance from x = 0 that a front reaches on either side."""
    profile = scene.prestress
    bumps = max((abs(centre) + 5.0 * width for centre, _, width in profile.bumps), default=0.0)
    width = profile.width or 0.0
    start = max(bumps, profile.nucleation_reach) + 5.0 * width

    def fastest(levels: np.ndarray) -> np.ndarray:
        # This is above the exact speed at any damping, under either release rule.
        level = np.clip(levels if profile.points else np.max(levels), 0.0, HIGHEST_LEVEL)
        speed = 1.3 / np.sqrt((1.0 - level) * (1.0 + level))
        if scene.release == "total":
            speed = speed + 1.3 * scene.damping_ratio * level / (1.0 - level)
        return np.broadcast_to(speed, levels.shape)

    return reach_of(profile, start, scene.duration, fastest)


def bound_of(scene: Scene, samples: Samples | None = None) -> Bound:
    """Upper bound on what one run takes."""
    reach = _upper_bound_of_reach(scene)
    blocks = (1.0 if scene.symmetric else 2.0) * (reach / scene.dx + 16.0)
    steps = scene.duration / (scene.max_step * scene.dx) + 2.0 * blocks / EVENTS_OF_A_STEP
    updates = EXACT_BLOCK * blocks if scene.scheme == "continuum" else steps * blocks
    recorded = 0.0 if samples is None else 16.0 * samples.times.size * samples.positions.size
    recorded += POINT * len(scene.prestress.points)
    return Bound(1, START + updates, (RECORDED + ARRAYS * (scene.order + 16)) * blocks + recorded)
