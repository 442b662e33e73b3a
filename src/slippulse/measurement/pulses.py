"""The leading pulse of a finished run: the pulse behind the front on the right.

`leading_pulse` measures it. The functions that need the shape of the pulse use the frame that moves
with it. The coordinate of this frame is xi = x - front, which is negative behind the front.
"""

from typing import NamedTuple

import numpy as np

from ..data.points import AnyRun
from .front_paths import fit_front, front_path, is_known_to_end

# A stretch of sliding blocks is a pulse if its peak velocity is at least this fraction of that of
# the leading pulse. Slower stretches are remains of the nucleation.
MIN_RELATIVE_PEAK = 0.05


class LeadingPulse(NamedTuple):
    """The pulse behind the right front, at the end of a run.

    All numbers except the front, its speed and the number of pulses are NaN if an exact solution
    does not know slip velocity everywhere on the right.
    """

    front: float  # distance from x = 0; it can lie between two blocks
    speed: float  # front speed
    width: float = np.nan  # from the front to the trailing edge; NaN if no block has stuck
    peak_velocity: float = np.nan  # largest slip velocity, from a parabola through three blocks
    peak_distance: float = np.nan  # distance of the peak from x = 0
    slip: float = np.nan  # mean final slip over half a width behind the trailing edge, if any
    pulses: int = 1  # number of pulses on the right; 0 if the front has stopped, 1 if not known


def leading_pulse(run: AnyRun, window: float) -> LeadingPulse:
    """Measure the leading pulse at the end of a run.

    window : the last fraction of the front's path, from which its speed is measured
    """
    speed = fit_front(run, window).slope
    # The blocks on the right.
    start = np.searchsorted(run["x"], 0.0)
    distance, velocity = np.asarray(run["x"])[start:], np.asarray(run["slip_velocity"])[start:]
    slip = np.asarray(run["slip"])[start:]
    front, has_stopped = front_at_end(run, distance, velocity, speed)
    # An exact solution may not know all slip velocities.
    if np.isnan(velocity).any():
        return LeadingPulse(front, speed)
    # The slices of the blocks in each pulse.
    pulses = [] if has_stopped else sliding_stretches(velocity)
    # Slip velocity of the leading pulse alone: it is 0 outside it, or everywhere without a pulse.
    leading_velocity = np.zeros(distance.size)
    if pulses:
        leading_velocity[pulses[-1]] = velocity[pulses[-1]]
    peak_velocity, peak_distance = parabola_peak(distance, leading_velocity)
    trailing_edge = _trailing_edge_distance(run, peak_distance, speed) if pulses else np.nan
    width = front - trailing_edge
    # The slip is measured at stuck blocks that are close behind the trailing edge. Those in the
    # inner half of its path are left out, because the nucleation has influenced them.
    dx = run.attrs["dx"]
    is_in_outer_half = (distance > 0.5 * trailing_edge) & (distance < trailing_edge - 2.0 * dx)
    has_stuck = is_in_outer_half & (velocity <= 0.0)
    averaging_length = max(0.5 * width, 4.0 * dx)
    return LeadingPulse(
        front=front,
        speed=speed,
        width=width,
        peak_velocity=peak_velocity,
        peak_distance=peak_distance,
        slip=_mean_near_end(distance[has_stuck], slip[has_stuck], averaging_length),
        pulses=len(pulses),
    )


def _mean_near_end(distance: np.ndarray, values: np.ndarray, length: float) -> float:
    """Return the mean of the values within a length from the largest distance; NaN if none."""
    if not distance.size:
        return np.nan
    is_near_end = distance > distance.max() - length
    return float(np.mean(values[is_near_end]))


def _trailing_edge_distance(run: AnyRun, peak_distance: float, speed: float) -> float:
    """Return the distance of the trailing edge from x = 0 at the end of a run.

    The four blocks behind the peak that stuck last are extrapolated to the end at the front speed.
    NaN if there are fewer of them.

    peak_distance, speed : distance of the peak slip velocity from x = 0, and front speed
    """
    stick_times, distances = front_path(run, edge="stick_time")
    is_behind_peak = distances < peak_distance
    if np.count_nonzero(is_behind_peak) < 4:
        return np.nan
    last_distances = distances[is_behind_peak][-4:]
    elapsed = run.attrs["end_time"] - stick_times[is_behind_peak][-4:]
    return float(np.mean(last_distances + speed * elapsed))


def front_at_end(
    run: AnyRun, distance: np.ndarray, velocity: np.ndarray, speed: float
) -> tuple[float, bool]:
    """Return the distance of the right front from x = 0 at the end, and True if it has stopped.

    The distance is NaN if no block was released, or if the front is not known until the end, which
    may be so in an exact solution.

    distance, velocity : distances and slip velocities of the blocks on the right
    speed : front speed
    """
    release_times, released_distances = front_path(run)
    if not released_distances.size or not is_known_to_end(run):
        return np.nan, False
    last_distance, dx = float(released_distances[-1]), run.attrs["dx"]
    # The distance that the front has moved since the last release, if it has kept its speed.
    moved = float(speed * (run.attrs["end_time"] - release_times[-1]))
    # The front has stopped if the last released block is at rest, and if the front would otherwise
    # have released the next block by now. If the speed is NaN, it counts as stopped, too.
    is_at_rest = not velocity[np.searchsorted(distance, last_distance)] > 0.0
    if is_at_rest and not 0.0 <= moved <= dx:
        return last_distance, True
    # Since the next block has not been released, the front has not reached it.
    return last_distance + min(max(moved, 0.0), dx), False


def sliding_stretches(velocity: np.ndarray) -> list[slice]:
    """Return the pulses in a row of blocks: a slice for each stretch of blocks that slide.

    velocity : slip velocities of the blocks

    The last stretch is the leading pulse. Stretches that are much slower than it are left out.
    """
    # Numbers of blocks, in turns: the first block of a stretch, and the first block after it.
    changes = np.flatnonzero(np.diff(velocity > 0.0, prepend=False, append=False)).tolist()
    stretches = [slice(first, end) for first, end in zip(changes[0::2], changes[1::2], strict=True)]
    if not stretches:
        return []
    least_peak = MIN_RELATIVE_PEAK * np.max(velocity[stretches[-1]])
    return [stretch for stretch in stretches if np.max(velocity[stretch]) >= least_peak]


def parabola_peak(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Return the largest value of sampled y, and its position.

    Value and position are those of the parabola through the largest sample and its two neighbours,
    or of the sample itself if it is the first or the last.
    """
    top = int(np.argmax(y))
    if not 0 < top < y.size - 1:
        return float(y[top]), float(x[top])
    left, middle, right = y[top - 1 : top + 2]
    curvature = left - 2.0 * middle + right
    # Distance of the vertex of the parabola from the largest sample, in sample distances.
    shift = 0.5 * (left - right) / curvature if curvature != 0.0 else 0.0
    value = middle - 0.25 * (left - right) * shift
    position = x[top] + shift * (x[top + 1] - x[top])
    return float(value), float(position)


def comoving(run: AnyRun, pulse: LeadingPulse) -> dict[str, np.ndarray]:
    """Return slip, slip velocity and slip acceleration of the blocks on the right, by name.

    The positions of these blocks relative to the front of the pulse have the name "xi".
    """
    names = ("x", "slip", "slip_velocity", "slip_acceleration")
    start = np.searchsorted(run["x"], 0.0)
    fields = {name: np.asarray(run[name])[start:] for name in names}
    return {"xi": fields.pop("x") - pulse.front} | fields


def acceleration_amplitude(run: AnyRun, pulse: LeadingPulse) -> float:
    """Return the amplitude of the slip acceleration across a pulse.

    The result is the amplitude of the half cosine wave that fits the acceleration best between the
    front and the trailing edge. (The largest acceleration would not do: on an undamped lattice it
    belongs to the oscillations behind the front.) NaN if the pulse has fewer than 4 blocks.
    """
    fields = comoving(run, pulse)
    is_in_pulse = (fields["xi"] <= 0.0) & (fields["xi"] >= -pulse.width)
    wave = np.cos(np.pi * fields["xi"][is_in_pulse] / pulse.width)
    if wave.size < 4:
        return np.nan
    return float(np.sum(fields["slip_acceleration"][is_in_pulse] * wave) / np.sum(wave**2))


def slip_variation(run: AnyRun, pulse: LeadingPulse) -> float:
    """Return by how much the final slip varies along the last third of the trailing edge's path.

    The result is the largest minus the smallest slip there, divided by the slip of the pulse. NaN
    if there is no such path.
    """
    fields = comoving(run, pulse)
    # The path of the trailing edge begins at x = 0. Four blocks at its end are left out, because
    # the trailing edge is known only to within a few blocks, and they may still slide.
    path_length = pulse.front - pulse.width
    end = -pulse.width - 4.0 * run.attrs["dx"]
    is_in_last_third = (fields["xi"] < end) & (fields["xi"] > end - path_length / 3.0)
    if not is_in_last_third.any() or not np.isfinite(pulse.slip) or pulse.slip == 0.0:
        return np.nan
    return float(np.ptp(fields["slip"][is_in_last_third]) / pulse.slip)
