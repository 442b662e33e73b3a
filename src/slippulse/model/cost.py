"""Upper bound on what a run costs.

A front goes at most at the speed that the highest level of the pre-stress drives it at, and the
blocks that it has passed slide at most until the end. So the work of a run is at most its steps
times the blocks that its fronts can reach. The shipped sweeps take at most 0.43 of that. Undamped
blocks that slip again and again may take twice as much.
"""

import math
from typing import NamedTuple

from .prestress import Interval
from .samples import Samples
from .scene import Scene

# One job may take so much without a second question: runs, block updates (days on one core), bytes
# (a small machine). A sweep in chunks may take this number of times as much in total.
LIMITS = 20_000, 4e13, 4e9
MOST_CHUNKS = 50
HOW_TO_GO_ON = "--config allow_large=true"
# Bytes of a block: seven recorded numbers; two arrays an order and sixteen others while it runs.
RECORDED, ARRAYS = 56.0, 16.0
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


def _reach(scene: Scene, side: float) -> float:
    """Upper bound on the distance from x = 0 that a front reaches on one side, 1.0 or -1.0."""
    profile = scene.prestress
    bumps = max((abs(centre) + 5.0 * width for centre, _, width in profile.bumps), default=0.0)
    start = max(bumps, profile.nucleation_reach) + 5.0 * (profile.width or 0.0)
    intervals = profile.intervals if side > 0.0 else profile.intervals[::-1]
    if not profile.points:
        highest = max(interval.left_value for interval in intervals)
        intervals = [Interval(-math.inf, math.inf, highest, highest)]
    distance, time = start, 0.0
    for left, right, *values in intervals:
        end = right if side > 0.0 else -left
        if end > distance:
            step = (end - distance) / _fastest(scene, max(0.0, *values))
            if not time + step < scene.duration:
                break
            distance, time = end, time + step
    return distance + (scene.duration - time) * _fastest(scene, max(0.0, *values))


def _fastest(scene: Scene, level: float) -> float:
    """Speed above the exact one of a front at a level, at any damping, under either rule."""
    level = min(level, HIGHEST_LEVEL)
    speed = 1.3 / math.sqrt((1.0 - level) * (1.0 + level))
    if scene.release == "total":
        speed += 1.3 * scene.damping_ratio * level / (1.0 - level)
    return speed


def bound_of(scene: Scene, samples: Samples | None = None) -> Bound:
    """Upper bound on what one run takes."""
    reach = max(_reach(scene, 1.0), _reach(scene, -1.0))
    blocks = (1.0 if scene.symmetric else 2.0) * (reach / scene.dx + 16.0)
    steps = scene.duration / (scene.max_step * scene.dx) + 2.0 * blocks / EVENTS_OF_A_STEP
    updates = EXACT_BLOCK * blocks if scene.scheme == "continuum" else steps * blocks
    recorded = 0.0 if samples is None else 16.0 * samples.times.size * samples.positions.size
    return Bound(1, START + updates, (RECORDED + ARRAYS * (scene.order + 16)) * blocks + recorded)
