"""Upper bounds on the computing time and the memory of a run.

A front is at most as fast as the highest level of the pre-stress drives it. The blocks that it has
passed slide at most until the end of the run. The number of block updates is therefore at most the
number of time steps times the number of blocks that the fronts can reach. The shipped sweeps
need at most 0.43 of this estimate. Undamped blocks that slip many times may need up to twice the
estimate.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from .prestress import Prestress
from .samples import Samples
from .scene import Scene

# A job that exceeds one of these limits is refused unless the user allows it. The block updates
# take days on one core, and the bytes are the memory of a small machine.
JOB_LIMITS = {"runs": 20_000, "block_updates": 4e13, "bytes": 4e9}
# All jobs of a sweep together may need at most this number of times the limits of one job.
SWEEP_LIMIT_IN_JOBS = 50
OPTION_TO_ALLOW = "--config allow_large=true"
# Bytes of a block: its recorded numbers, and each of its numbers in the solver. The solver has one
# number for each order of the Taylor step and sixteen others.
RECORDED_BYTES_PER_BLOCK, SOLVER_BYTES_PER_NUMBER = 56.0, 16.0
OTHER_SOLVER_NUMBERS = 16
# Bytes of a sample: the slip and the slip velocity.
BYTES_PER_SAMPLE = 16.0
# Bytes of a point of a table: two numbers, and their text in a data file.
BYTES_PER_TABLE_POINT = 400.0
# Two times, as the numbers of block updates that take equally long: the time to start a run, and
# the time to solve one block of the exact solution.
UPDATES_PER_START, UPDATES_PER_EXACT_BLOCK = 1e5, 3e4
# Where a table reaches 1 the front speed is taken at this level, since it is infinite at 1.
MAX_LEVEL = 1.0 - 1e-9
# Beyond this number of widths from its centre, a Gaussian no longer makes fronts faster.
GAUSSIAN_END_IN_WIDTHS = 5.0
# Factor by which the bound on a front speed is larger than simple estimates of it.
SPEED_MARGIN = 1.3
# A step ends early after this number of events. A block usually has two events in a run, a release
# and a stick.
MAX_EVENTS_PER_STEP = 64
EVENTS_PER_BLOCK = 2.0
# Number of blocks at rest beyond each front.
MARGIN_BLOCKS = 16.0
# Seconds for one block update at the highest order on a slow machine.
SECONDS_PER_UPDATE = 2e-8
# Number of block updates above which a second thread makes a job faster.
UPDATES_FOR_TWO_THREADS = 1e11
# Time to start a job, and memory of the interpreter with its libraries.
START_MINUTES, START_MEGABYTES = 10, 1000


class Bound(NamedTuple):
    """Upper bound on the cost of one or more runs.

    ``data_bytes`` is the memory of their results. ``solver_bytes`` is that of the solver, which
    only runs need that are not finished.
    """

    runs: float
    block_updates: float
    data_bytes: float
    solver_bytes: float

    @property
    def bytes(self) -> float:
        """Memory for the results of all runs, and for the solver in each thread."""
        return self.data_bytes + self.solver_bytes * min(self.runs, self.threads)

    def exceeded(
        self, chunks: int = 1, remedy: str = f"use more chunks or {OPTION_TO_ALLOW}"
    ) -> str:
        """Describe the first limit that is exceeded; return an empty string if there is none.

        This bound is that of one job, and ``chunks`` equal jobs make the sweep. Each job has the
        limits JOB_LIMITS. If there are many jobs, their limits are lower, so that all jobs together
        stay within SWEEP_LIMIT_IN_JOBS times the limits of one.

        remedy : advice to the user, with which the description ends
        """
        fraction_of_limits = min(1.0, SWEEP_LIMIT_IN_JOBS / chunks)
        where = f" in each of {chunks} chunks" if chunks > 1 else ""
        for name, limit in JOB_LIMITS.items():
            value, allowed = getattr(self, name), fraction_of_limits * limit
            # Written with ``not`` so that a value of NaN exceeds the limit.
            if not value <= allowed:
                cost = f"up to {value:.3g} {name.replace('_', ' ')}{where}"
                return f"cost: {cost}; allowed: {allowed:.3g}; {remedy}"
        return ""

    @property
    def threads(self) -> int:
        """Number of threads for the job: 2 if it is long, otherwise 1.

        Short jobs do not need a second thread, because several of them run at the same time.
        """
        return 2 if self.block_updates > UPDATES_FOR_TWO_THREADS else 1

    @property
    def minutes(self) -> int:
        """Time limit of the job on a cluster, in minutes."""
        seconds = SECONDS_PER_UPDATE * self.block_updates
        return START_MINUTES + math.ceil(seconds / 60.0 / self.threads)

    @property
    def megabytes(self) -> int:
        """Memory limit of the job on a cluster, in MB."""
        return START_MEGABYTES + math.ceil(2.0 * self.bytes / 1e6)


def bound_front_reach(
    profile: Prestress, start: float, duration: float, speeds_at: Callable[[np.ndarray], np.ndarray]
) -> float:
    """Return the largest distance from x = 0 that a front can reach, on either side.

    Within an interval of the background, the front has the speed of the higher one of the two
    levels at its ends.

    start : distance from x = 0 at which both fronts begin at t = 0
    duration : time for which the fronts run
    speeds_at : function that returns the front speeds at an array of pre-stress levels
    """
    left_ends, right_ends, left_levels, right_levels = profile.interval_table.T
    speeds = speeds_at(np.maximum(left_levels, right_levels))
    on_right = _distance_reached(right_ends, speeds, start, duration)
    # The mirror image: the left front crosses the intervals in the reverse order.
    on_left = _distance_reached(-left_ends[::-1], speeds[::-1], start, duration)
    return max(on_right, on_left)


def _distance_reached(ends: np.ndarray, speeds: np.ndarray, start: float, duration: float) -> float:
    """Return the distance from x = 0 that a front reaches, with one speed in each interval.

    ends : distances of the far ends of the intervals, in the order in which the front crosses them;
        the last one is infinite
    speeds : front speed in each interval
    start : distance at which the front begins at t = 0
    duration : time for which it runs
    """
    is_ahead = ends > start
    ends, speeds = ends[is_ahead], speeds[is_ahead]
    # The times at which the front reaches the ends.
    arrival_times = np.cumsum(np.diff(ends, prepend=start) / speeds)
    # The interval in which the front is at the end of the run.
    last = int(np.searchsorted(arrival_times, duration))
    entry, entry_time = (ends[last - 1], arrival_times[last - 1]) if last else (start, 0.0)
    return float(entry + (duration - entry_time) * speeds[last])


def _bound_scene_reach(scene: Scene) -> float:
    """Return an upper bound on the distance from x = 0 that a front reaches on either side.

    In this bound, both fronts are assumed to begin at t = 0 beyond all Gaussians and all positions
    where the rupture may nucleate, as if they had crossed them in no time.
    """
    profile = scene.prestress
    end_of_bumps = max(
        (abs(centre) + GAUSSIAN_END_IN_WIDTHS * width for centre, _, width in profile.bumps),
        default=0.0,
    )
    # The width is None if there is no Gaussian at x = 0.
    end_of_peak = GAUSSIAN_END_IN_WIDTHS * (profile.width or 0.0)
    # A sum instead of the largest of these distances is safe, and an upper bound may be too large.
    start = max(end_of_bumps, profile.nucleation_reach) + end_of_peak
    return bound_front_reach(profile, start, scene.duration, partial(_bound_speeds, scene))


def _bound_speeds(scene: Scene, levels: np.ndarray) -> np.ndarray:
    """Return an upper bound on the speed of a front of the scene at each level of pre-stress.

    The bounds are larger than the exact speeds at any damping and under both release rules.
    """
    # A table can have a few high values, so that each level has its own bound. Other profiles have
    # few levels, and the bound at the highest one is used for all. MAX_LEVEL is slightly below 1,
    # the level at which the speed would be infinite.
    level = np.clip(levels if scene.prestress.points else np.max(levels), 0.0, MAX_LEVEL)
    # Without damping, the front speed is 1/sqrt(1 - tau^2).
    speed = SPEED_MARGIN / np.sqrt((1.0 - level) * (1.0 + level))
    if scene.release == "total":
        # Under this release rule, strong damping makes fronts faster without limit.
        speed = speed + SPEED_MARGIN * scene.damping_ratio * level / (1.0 - level)
    return np.broadcast_to(speed, levels.shape)


def bound_cost(scene: Scene, samples: Samples | None = None) -> Bound:
    """Return an upper bound on the cost of one run, which may record samples."""
    # Only one half of a symmetric lattice is simulated.
    sides = 1.0 if scene.symmetric else 2.0
    blocks = sides * (_bound_scene_reach(scene) / scene.dx + MARGIN_BLOCKS)
    if scene.scheme == "continuum":
        updates = UPDATES_PER_EXACT_BLOCK * blocks
    else:
        # Steps of full length, and steps that end early because of the many events in them.
        full_steps = scene.duration / (scene.max_step * scene.dx)
        short_steps = EVENTS_PER_BLOCK * blocks / MAX_EVENTS_PER_STEP
        updates = (full_steps + short_steps) * blocks
    sample_bytes = 0.0
    if samples is not None:
        sample_bytes = BYTES_PER_SAMPLE * samples.times.size * samples.positions.size
    table_bytes = BYTES_PER_TABLE_POINT * len(scene.prestress.points)
    # Numbers that the solver keeps for each block.
    solver_numbers = scene.order + OTHER_SOLVER_NUMBERS
    return Bound(
        runs=1,
        block_updates=UPDATES_PER_START + updates,
        data_bytes=RECORDED_BYTES_PER_BLOCK * blocks + (sample_bytes + table_bytes),
        solver_bytes=SOLVER_BYTES_PER_NUMBER * solver_numbers * blocks,
    )
