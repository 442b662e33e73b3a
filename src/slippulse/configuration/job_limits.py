"""Time and memory that a job may take on a cluster, and its threads."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from .cost import expected_cost
from .expand import expand

# Expected seconds on one core from which two threads pay; shorter sweeps run side by side and waste less on starting.
LONG_SWEEP = 120.0
# The factor to which the estimate is right.
ESTIMATE_WITHIN = 3.0
# Start of a job in minutes, and the interpreter with its libraries in MB.
START_MINUTES, START_MEGABYTES = 10, 1000
# What joining the grid studies of a sweep takes a run, measured over a million: 1.2 kB and 0.12 s a thousand, and as
# much again for other sweeps.
JOINED_BYTES, JOINED_SECONDS = 2.4e3, 2.4e-4


@dataclass(frozen=True)
class Limits:
    """Threads of a job, minutes with so many, and megabytes."""

    threads: int
    minutes: int
    megabytes: int


def sweep_limits(sweep: Mapping) -> Limits:
    """Limits of a resolved simulation: three times the expected time, twice the recorded data on top."""
    cost = expected_cost(*expand(sweep))
    seconds = cost.hours * 3600.0
    threads = 2 if seconds > LONG_SWEEP else 1
    return Limits(
        threads,
        START_MINUTES + math.ceil(ESTIMATE_WITHIN * seconds / 60.0 / threads),
        START_MEGABYTES + math.ceil(2.0 * cost.bytes / 1e6),
    )


def joining_limits(runs: int) -> Limits:
    """Limits for joining the grid studies of the chunks of a sweep of so many runs."""
    return Limits(
        1,
        START_MINUTES + math.ceil(ESTIMATE_WITHIN * JOINED_SECONDS * runs / 60.0),
        START_MEGABYTES + math.ceil(JOINED_BYTES * runs / 1e6),
    )
