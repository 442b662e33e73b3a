"""Positions and speeds of fronts and trailing edges.

The release times of the blocks give the path of a front, and their stick times give the path of a
trailing edge. Each function takes the name of these times as ``edge``.
"""

from typing import NamedTuple

import numpy as np

from ..data.points import AnyRun

# A front pauses if one wait between two neighbouring blocks takes a large part of the time in which
# the measured stretch is crossed: more than this fraction, and more than this number of times the
# mean wait.
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
    """Return the event times of the blocks on one side, and the distances of these blocks from 0.

    Both arrays are in the order of distance. Blocks without the event are left out.
    """
    x, time = np.asarray(run["x"]), np.asarray(run[edge])
    if side == "left":
        x, time = -x[::-1], time[::-1]
    start = np.searchsorted(x, 0.0)
    reached = np.isfinite(time[start:])
    return time[start:][reached], x[start:][reached]


def limit_time(run: AnyRun) -> float:
    """Return the time until which all of the rupture is known.

    An exact solution may know only some blocks after this time. The time is infinite for a lattice,
    and for an exact solution that knows all blocks until the end.
    """
    limit = run.attrs.get("limit_time", np.nan)
    return np.inf if np.isnan(limit) else float(limit)


def known_until(run: AnyRun, side: str = "right", edge: str = "release_time") -> float:
    """Return the time until which a front (or trailing edge) is known; infinite if always."""
    if np.isinf(limit_time(run)) or edge == "stick_time":
        return limit_time(run)
    times, distances = front_path(run, side)
    if not times.size:
        return limit_time(run)
    # No wave from the unknown part of the rupture catches up with a supersonic front. The front is
    # unknown only if nothing is known of the block ahead of it. If slip was not recorded, this
    # is so from the time at which a wave from the limit of the exact solution reaches the block.
    ahead = (1.0 if side == "right" else -1.0) * (distances[-1] + run.attrs["dx"])
    wave_arrival = limit_time(run) + abs(ahead - run.attrs["limit_position"])
    block = int(np.argmin(np.abs(np.asarray(run["x"]) - ahead)))
    if "slip" in run:
        is_unknown = np.isnan(run["slip"][block])
    else:
        is_unknown = wave_arrival <= run.attrs["end_time"]
    return float(np.max(times)) if is_unknown else np.inf


def front_position(
    run: AnyRun, time, side: str = "right", edge: str = "release_time"
) -> np.ndarray:
    """Return the distance of a front (or trailing edge) from x = 0 at one or more times.

    It is NaN before the first event, and where an exact solution does not know it.
    """
    times, distances = front_path(run, side, edge)
    time = np.asarray(time, dtype=float)
    if times.size == 0:
        return np.full(time.shape, np.nan)
    # If a block is released after a block that is farther away, the front does not move back.
    latest = np.maximum.accumulate(times)
    # np.interp needs increasing times. Of several blocks with the same time, the farthest is kept.
    is_farthest = np.concatenate([np.diff(latest) > 0.0, [True]])
    distance = np.interp(time, latest[is_farthest], distances[is_farthest])
    is_unknown = (time < latest[0]) | (time > known_until(run, side, edge))
    return np.where(is_unknown, np.nan, distance)


def arrival(run: AnyRun, distance: float, side: str = "right") -> tuple[float, float]:
    """Return when a front reaches a distance, and how long it waited at most between two blocks.

    Both are NaN if the front does not reach the distance.
    """
    times, distances = front_path(run, side)
    if times.size == 0 or distances[-1] < distance:
        return np.nan, np.nan
    latest = np.maximum.accumulate(times)
    waits = np.diff(latest[: np.searchsorted(distances, distance) + 1])
    return float(np.interp(distance, distances, latest)), float(np.max(waits, initial=0.0))


def fit_front(run: AnyRun, window: float, side: str = "right") -> Line:
    """Fit a straight line, distance as a function of time, to the last part of a front's path.

    window : length of this part, as a fraction of the largest distance that the front reached

    If the front pauses within this part and is faster than the waves after the pause, only the path
    after the pause is fitted. The line is NaN if there are fewer than MIN_FITTED_BLOCKS blocks, or
    if an exact solution does not know the whole path.
    """
    times, distances = front_path(run, side)
    chosen = distances >= (1.0 - window) * np.max(distances, initial=0.0)
    if chosen.sum() < MIN_FITTED_BLOCKS or np.isfinite(known_until(run, side)):
        return NO_LINE
    times, distances = times[chosen], distances[chosen]
    waits = np.diff(np.maximum.accumulate(times))
    longest_wait = max(PAUSE_FRACTION, PAUSE_IN_MEAN_WAITS / times.size) * np.sum(waits)
    # The number of the first block after the last pause; 0 if there is no pause.
    after_pause = int(np.max(np.flatnonzero(waits > longest_wait) + 1, initial=0))
    if 0 < after_pause <= times.size - MIN_FITTED_BLOCKS:
        line = fit_line(times[after_pause:], distances[after_pause:])
        if line.slope > 1.0:
            return line
    return fit_line(times, distances)


def fit_line(x: np.ndarray, y: np.ndarray) -> Line:
    """Fit a straight line y(x) by least squares; NaN if all x are equal."""
    mean_x, mean_y = x.sum() / x.size, y.sum() / y.size
    centred = x - mean_x
    scatter = float((centred**2).sum())
    if scatter == 0.0:
        return NO_LINE
    slope = float((centred * (y - mean_y)).sum() / scatter)
    intercept = float(mean_y - slope * mean_x)
    residuals = y - intercept - slope * x
    variance = (residuals**2).sum() / max(x.size - 2, 1)
    return Line(slope, intercept, float(np.sqrt(variance / scatter)))
