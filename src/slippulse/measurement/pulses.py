"""The leading pulse of a finished run, on the right, in its own frame."""

from typing import NamedTuple

import numpy as np

from ..data.points import AnyRun
from .front_paths import fit_front, known_until, path

# Blocks slower than this fraction of the leading pulse are remains of the nucleation, not a pulse.
REMAINS = 0.05


class LeadingPulse(NamedTuple):
    """The pulse behind the right front, at the end of a run; NaN where its part is not known."""

    front: float  # distance from x = 0, between blocks
    speed: float  # of the front
    width: float  # distance from the front to the trailing edge; NaN when nothing has stuck
    peak_velocity: float  # largest slip velocity, from a parabola through three blocks
    peak_distance: float
    slip: float  # of the blocks that stuck last, in the half of the way next to the trailing edge
    pulses: int = 1  # their number on the right; 0 where the front has stopped


def leading_pulse(run: AnyRun, window: float) -> LeadingPulse:
    """Measure the pulse of a run; its speed is that on the last fraction ``window`` of its path."""
    end, dx = run.attrs["end_time"], run.attrs["dx"]
    speed, _, _ = fit_front(run, window)
    start = np.searchsorted(run["x"], 0.0)
    r, velocity, slip = (np.asarray(run[name])[start:] for name in ("x", "slip_velocity", "slip"))
    front, stopped = front_at_end(run, r, velocity, speed)
    if np.isnan(velocity).any():
        return LeadingPulse(front, speed, np.nan, np.nan, np.nan, np.nan)
    pulses = [] if stopped else sliding_stretches(velocity)
    leading = np.zeros(r.size)
    for pulse in pulses[-1:]:
        leading[pulse] = velocity[pulse]
    peak, peak_distance = parabola_peak(r, leading)
    stick, stuck = path(run, edge="stick_time")
    width, final = np.nan, np.nan
    followed = stuck < peak_distance
    if np.count_nonzero(followed) >= 4 and pulses:
        # The trailing edge runs as fast as the front, from the blocks that stuck last.
        last, late = stuck[followed][-4:], end - stick[followed][-4:]
        trailing = float(np.mean(last + speed * late))
        width = front - trailing
        settled = (r > 0.5 * trailing) & (r < trailing - 2.0 * dx) & (velocity <= 0.0)
        if settled.any():
            near = r > r[settled].max() - max(0.5 * width, 4.0 * dx)
            final = float(np.mean(slip[settled & near]))
    return LeadingPulse(front, speed, width, peak, peak_distance, final, len(pulses))


def front_at_end(
    run: AnyRun, r: np.ndarray, velocity: np.ndarray, speed: float
) -> tuple[float, bool]:
    """Distance of the right front at the end, and whether it has stopped.

    The distance is NaN without a release, and where an exact solution does not know it.
    """
    release, distance = path(run)
    if not distance.size or np.isfinite(known_until(run)):
        return np.nan, False
    # The next block is at rest: the front is at most one block beyond the last release.
    ahead, dx = float(speed * (run.attrs["end_time"] - release[-1])), run.attrs["dx"]
    at_rest = not velocity[np.searchsorted(r, distance[-1])] > 0.0
    if at_rest and not 0.0 <= ahead <= dx:
        return float(distance[-1]), True
    return float(distance[-1]) + min(max(ahead, 0.0), dx), False


def sliding_stretches(velocity: np.ndarray) -> list[slice]:
    """Pulses on the right from left to right; the last is the leading one, however slow."""
    edges = np.flatnonzero(np.diff(velocity > 0.0, prepend=False, append=False))
    stretches = list(map(slice, edges[0::2].tolist(), edges[1::2].tolist()))
    least = REMAINS * np.max(velocity[stretches[-1]]) if stretches else 0.0
    return [part for part in stretches if np.max(velocity[part]) >= least]


def parabola_peak(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Largest value of sampled y and its position, by a parabola through the largest samples."""
    i = int(np.argmax(y))
    if not 0 < i < y.size - 1:
        return float(y[i]), float(x[i])
    left, middle, right = y[i - 1 : i + 2]
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend != 0.0 else 0.0
    return float(middle - 0.25 * (left - right) * shift), float(x[i] + shift * (x[i + 1] - x[i]))


def comoving(run: AnyRun, pulse: LeadingPulse) -> dict[str, np.ndarray]:
    """Slip and its first two derivatives in time on the right, over xi = distance - front."""
    names = ("x", "slip", "slip_velocity", "slip_acceleration")
    start = np.searchsorted(run["x"], 0.0)
    fields = {name: np.asarray(run[name])[start:] for name in names}
    return {"xi": fields.pop("x") - pulse.front} | fields


def acceleration_amplitude(run: AnyRun, pulse: LeadingPulse) -> float:
    """Amplitude of the slip acceleration across a pulse, by projection on a sine of its width."""
    # The largest value would report the ringing of the undamped lattice behind the front.
    fields = comoving(run, pulse)
    inside = (fields["xi"] <= 0.0) & (fields["xi"] >= -pulse.width)
    shape = np.cos(np.pi * fields["xi"][inside] / pulse.width)
    if shape.size < 4:
        return np.nan
    return float(np.sum(fields["slip_acceleration"][inside] * shape) / np.sum(shape**2))


def slip_variation(run: AnyRun, pulse: LeadingPulse) -> float:
    """Largest relative change of final slip over the last third of the path before the pulse."""
    fields = comoving(run, pulse)
    end = -pulse.width - 4.0 * run.attrs["dx"]
    third = (fields["xi"] < end) & (fields["xi"] > end - (pulse.front - pulse.width) / 3.0)
    if not third.any() or not np.isfinite(pulse.slip) or pulse.slip == 0.0:
        return np.nan
    return float(np.ptp(fields["slip"][third]) / pulse.slip)
