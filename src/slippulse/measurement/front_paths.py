"""Positions and speeds of fronts and trailing edges."""

import numpy as np

from ..data.points import AnyRun

# A front pauses where one wait between two blocks takes this fraction of a stretch of its path, and
# this many times a block's part of it.
PAUSE, PAUSE_BLOCKS = 0.2, 4.0


def path(
    run: AnyRun, side: str = "right", edge: str = "release_time"
) -> tuple[np.ndarray, np.ndarray]:
    """Times of an event, and distances from x = 0 in their order, of the blocks that have it."""
    x, time = np.asarray(run["x"]), np.asarray(run[edge])
    if side == "left":
        x, time = -x[::-1], time[::-1]
    start = np.searchsorted(x, 0.0)
    reached = np.isfinite(time[start:])
    return time[start:][reached], x[start:][reached]


def limit_time(run: AnyRun) -> float:
    """Time until which an exact solution knows the whole rupture; inf for a lattice, or the end."""
    limit = run.attrs.get("limit_time", np.nan)
    return np.inf if np.isnan(limit) else float(limit)


def known_until(run: AnyRun, side: str = "right", edge: str = "release_time") -> float:
    """Time until which a front or a trailing edge is known; inf for all of its path."""
    if np.isinf(limit_time(run)) or edge == "stick_time":
        return limit_time(run)
    times, distances = path(run, side)
    if not times.size:
        return limit_time(run)
    # The front outruns all waves unless nothing is known of the block ahead of it.
    ahead = (1.0 if side == "right" else -1.0) * (distances[-1] + run.attrs["dx"])
    cone = limit_time(run) + abs(ahead - run.attrs["limit_position"])
    block = int(np.argmin(np.abs(np.asarray(run["x"]) - ahead)))
    unknown = np.isnan(run["slip"][block]) if "slip" in run else cone <= run.attrs["end_time"]
    return float(np.max(times)) if unknown else np.inf


def position_at(run: AnyRun, time, side: str = "right", edge: str = "release_time") -> np.ndarray:
    """Distance of a front or trailing edge from x = 0 at some times.

    It is NaN before the first event, and where an exact solution does not know it.
    """
    times, distances = path(run, side, edge)
    time = np.asarray(time, dtype=float)
    if times.size == 0:
        return np.full(time.shape, np.nan)
    # A block released out of turn does not take the front back.
    latest = np.maximum.accumulate(times)
    # np.interp needs increasing times: the farthest of several blocks with one time counts.
    last = np.concatenate([np.diff(latest) > 0.0, [True]])
    unknown = (time < latest[0]) | (time > known_until(run, side, edge))
    return np.where(unknown, np.nan, np.interp(time, latest[last], distances[last]))


def arrival(run: AnyRun, distance: float, side: str = "right") -> tuple[float, float]:
    """Time at which a front reaches a distance, and its longest wait between two blocks; or NaN."""
    times, distances = path(run, side)
    if times.size == 0 or distances[-1] < distance:
        return np.nan, np.nan
    latest = np.maximum.accumulate(times)
    waits = np.diff(latest[: np.searchsorted(distances, distance) + 1])
    return float(np.interp(distance, distances, latest)), float(np.max(waits, initial=0.0))


def fit_front(run: AnyRun, window: float, side: str = "right") -> tuple[float, float, float]:
    """`straight_line` through the last fraction of a front's path.

    NaN with fewer than 4 blocks, and where an exact solution does not know the last fraction.
    """
    times, distances = path(run, side)
    chosen = distances >= (1.0 - window) * np.max(distances, initial=0.0)
    if chosen.sum() < 4 or np.isfinite(known_until(run, side)):
        return np.nan, np.nan, np.nan
    times, distances = times[chosen], distances[chosen]
    # A front that outruns the waves after a pause is measured after it.
    waits = np.diff(np.maximum.accumulate(times))
    longest = max(PAUSE, PAUSE_BLOCKS / times.size) * np.sum(waits)
    start = int(np.max(np.flatnonzero(waits > longest) + 1, initial=0))
    if 0 < start <= times.size - 4:
        line = straight_line(times[start:], distances[start:])
        if line[0] > 1.0:
            return line
    return straight_line(times, distances)


def straight_line(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float]:
    """Slope, intercept and standard error of the slope by least squares; NaN if all x are equal."""
    mean_x, mean_y = x.sum() / x.size, y.sum() / y.size
    centred = x - mean_x
    scatter = float((centred**2).sum())
    if scatter == 0.0:
        return np.nan, np.nan, np.nan
    slope = float((centred * (y - mean_y)).sum() / scatter)
    intercept = float(mean_y - slope * mean_x)
    rest = y - intercept - slope * x
    return slope, intercept, float(np.sqrt((rest**2).sum() / max(x.size - 2, 1) / scatter))
