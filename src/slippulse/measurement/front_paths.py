"""Positions and speeds of fronts and trailing edges.

The release times of the blocks give the path of a front, and their stick times give the path of a
trailing edge. The argument ``edge`` of a function selects one of them by the name of its times,
"release_time" or "stick_time". The argument ``side`` is "right" or "left" of x = 0.
"""

from typing import NamedTuple

import numpy as np

from ..data.points import AnyRun

# A front pauses between two neighbouring blocks if it waits there for a large part of the time of
# the whole fitted path: for more than this fraction, and also for more than this number of mean
# waits.
PAUSE_FRACTION, PAUSE_IN_MEAN_WAITS = 0.2, 4.0
# A straight line is fitted to at least this number of blocks.
MIN_FITTED_BLOCKS = 4


class Line(NamedTuple):
    """Straight line fitted by least squares; each number is NaN if there is no fit."""

    slope: float
    intercept: float
    slope_error: float  # standard error


NO_LINE = Line(np.nan, np.nan, np.nan)


def front_path(
    run: AnyRun, side: str = "right", edge: str = "release_time"
) -> tuple[np.ndarray, np.ndarray]:
    """Return the path of a front (or trailing edge) on one side: its times, and its distances.

    There is one time and one distance from x = 0 for each block that was released (or has stuck).
    Both arrays are in the order of distance.
    """
    distances, times = np.asarray(run["x"]), np.asarray(run[edge])
    if side == "left":
        distances, times = -distances[::-1], times[::-1]
    start = np.searchsorted(distances, 0.0)
    distances, times = distances[start:], times[start:]
    was_reached = np.isfinite(times)
    return times[was_reached], distances[was_reached]


def limit_time(run: AnyRun) -> float:
    """Return the time until which all of the rupture is known.

    An exact solution may know only some blocks after this time. The time is infinite for a lattice,
    and for an exact solution that knows all blocks until the end.
    """
    limit = run.attrs.get("limit_time", np.nan)
    return np.inf if np.isnan(limit) else float(limit)


def known_until(run: AnyRun, side: str = "right", edge: str = "release_time") -> float:
    """Return the time until which a front (or trailing edge) is known; infinite if always.

    An exact solution may not know all of the rupture after its limit time. The unknown part begins
    at the limit position, and spreads at the wave speed. It may not catch up with the front, which
    is then known until the end. Otherwise the front is known until the last known release. For a
    trailing edge there is no such test: it is known until the limit time.
    """
    limit = limit_time(run)
    if np.isinf(limit) or edge == "stick_time":
        return limit
    times, distances = front_path(run, side)
    if not times.size:
        return limit
    # The front is known until the end if the next block, which it has not reached, is known.
    next_distance = distances[-1] + run.attrs["dx"]
    next_position = next_distance if side == "right" else -next_distance
    if "slip" in run:
        next_block = int(np.argmin(np.abs(np.asarray(run["x"]) - next_position)))
        is_unknown = np.isnan(run["slip"][next_block])
    else:
        # Slip at the end was not recorded. The block is unknown if waves from the limit position,
        # whose speed is 1, have reached it.
        wave_arrival = limit + abs(next_position - run.attrs["limit_position"])
        is_unknown = wave_arrival <= run.attrs["end_time"]
    return float(np.max(times)) if is_unknown else np.inf


def is_known_to_end(run: AnyRun, side: str = "right") -> bool:
    """Return whether a front is known until the end of the run, as it always is on a lattice."""
    return bool(np.isinf(known_until(run, side)))


def front_position(
    run: AnyRun, time, side: str = "right", edge: str = "release_time"
) -> np.ndarray:
    """Return the distance of a front (or trailing edge) from x = 0 at one or more times.

    The distance is NaN before the first event, and where an exact solution does not know the front.
    """
    block_times, block_distances = front_path(run, side, edge)
    time = np.asarray(time, dtype=float)
    if block_times.size == 0:
        return np.full(time.shape, np.nan)
    # The front has reached a block when this block and all blocks before it have been released.
    arrivals = np.maximum.accumulate(block_times)
    # np.interp needs increasing times. Of several blocks with the same time, the farthest is kept.
    is_farthest = np.concatenate([np.diff(arrivals) > 0.0, [True]])
    distance = np.interp(time, arrivals[is_farthest], block_distances[is_farthest])
    is_unknown = (time < arrivals[0]) | (time > known_until(run, side, edge))
    return np.where(is_unknown, np.nan, distance)


def arrival(run: AnyRun, distance: float, side: str = "right") -> tuple[float, float]:
    """Return the time at which a front reaches a distance, and its longest wait on the way there.

    A wait is the time from the release of a block to that of the next block. Both numbers are NaN
    if the front does not reach the distance.
    """
    times, distances = front_path(run, side)
    if times.size == 0 or distances[-1] < distance:
        return np.nan, np.nan
    # The front has reached a block when this block and all blocks before it have been released.
    arrivals = np.maximum.accumulate(times)
    # The blocks on the way end with the first block at or beyond the distance.
    last_block = int(np.searchsorted(distances, distance))
    waits = np.diff(arrivals[: last_block + 1])
    return float(np.interp(distance, distances, arrivals)), float(np.max(waits, initial=0.0))


def fit_front(run: AnyRun, window: float, side: str = "right") -> Line:
    """Fit a straight line, distance as a function of time, to the last part of a front's path.

    window : length of this part, as a fraction of the largest distance that the front reached

    If the front pauses within this part and is faster than the waves after the pause, only the path
    after the pause is fitted, because a line through the pause would be too slow. The line is NaN
    if there are fewer than MIN_FITTED_BLOCKS blocks, or if the front is not known until the end,
    which may be so in an exact solution.
    """
    times, distances = front_path(run, side)
    is_in_window = distances >= (1.0 - window) * np.max(distances, initial=0.0)
    if is_in_window.sum() < MIN_FITTED_BLOCKS or not is_known_to_end(run, side):
        return NO_LINE
    times, distances = times[is_in_window], distances[is_in_window]
    # The front passes a block when this block and all blocks before it have been released.
    waits = np.diff(np.maximum.accumulate(times))
    # A wait is a pause if it exceeds a fraction of the total, and a multiple of the mean wait.
    shortest_pause = max(PAUSE_FRACTION, PAUSE_IN_MEAN_WAITS / times.size) * np.sum(waits)
    pauses = np.flatnonzero(waits > shortest_pause)
    # The block whose release ends the last pause; 0 if there is no pause.
    after_pause = int(pauses[-1]) + 1 if pauses.size else 0
    if 0 < after_pause <= times.size - MIN_FITTED_BLOCKS:
        line = fit_line(times[after_pause:], distances[after_pause:])
        if line.slope > 1.0:
            return line
    return fit_line(times, distances)


def fit_line(x: np.ndarray, y: np.ndarray) -> Line:
    """Fit a straight line y(x) by least squares; the line is NaN if all x are equal."""
    mean_x, mean_y = x.sum() / x.size, y.sum() / y.size
    centred = x - mean_x
    scatter = float((centred**2).sum())
    if scatter == 0.0:
        return NO_LINE
    slope = float((centred * (y - mean_y)).sum() / scatter)
    intercept = float(mean_y - slope * mean_x)
    residuals = y - intercept - slope * x
    variance = (residuals**2).sum() / max(x.size - 2, 1)
    return Line(slope, intercept, slope_error=float(np.sqrt(variance / scatter)))
