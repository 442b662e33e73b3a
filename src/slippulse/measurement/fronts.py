"""Positions and speeds of fronts and trailing edges."""

import numpy as np

from ..data.points import AnyRun


def path(
    run: AnyRun, side: str = "right", edge: str = "release_time"
) -> tuple[np.ndarray, np.ndarray]:
    """Times and distances from x = 0 of a front ("release_time") or a trailing edge ("stick_time").

    They are in order of distance, on one side; blocks without the event are left out.
    """
    x, time = np.asarray(run["x"]), np.asarray(run[edge])
    if side == "left":
        x, time = -x[::-1], time[::-1]
    start = np.searchsorted(x, 0.0)
    reached = np.isfinite(time[start:])
    return time[start:][reached], x[start:][reached]


def position_at(run: AnyRun, time, side: str = "right", edge: str = "release_time") -> np.ndarray:
    """Distance from x = 0 of a front or trailing edge at given times; NaN before its first event.

    It is linear between events; a block released out of turn does not take the front back.
    """
    times, distances = path(run, side, edge)
    time = np.asarray(time, dtype=float)
    if times.size == 0:
        return np.full(time.shape, np.nan)
    latest = np.maximum.accumulate(times)
    # np.interp needs increasing times: the farthest of several blocks with one time counts.
    last = np.concatenate([np.diff(latest) > 0.0, [True]])
    return np.where(time < latest[0], np.nan, np.interp(time, latest[last], distances[last]))


def arrival(run: AnyRun, distance: float, side: str = "right") -> tuple[float, float]:
    """Time at which a front reaches a distance, and its longest wait between two blocks; or NaN."""
    times, distances = path(run, side)
    if times.size == 0 or distances[-1] < distance:
        return np.nan, np.nan
    latest = np.maximum.accumulate(times)
    waits = np.diff(latest[: np.searchsorted(distances, distance) + 1])
    return float(np.interp(distance, distances, latest)), float(np.max(waits, initial=0.0))


def fit_front(run: AnyRun, window: float, side: str = "right") -> tuple[float, float, float]:
    """Speed, intercept and standard error of the speed on the last fraction of a front's path.

    They are those of `straight_line`; NaN with fewer than 4 blocks.
    """
    times, distances = path(run, side)
    chosen = distances >= (1.0 - window) * np.max(distances, initial=0.0)
    if chosen.sum() < 4:
        return np.nan, np.nan, np.nan
    return straight_line(times[chosen], distances[chosen])


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
