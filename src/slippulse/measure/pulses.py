"""The leading pulse of a finished run, in its own frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from .fronts import front_speed, path


@dataclass(frozen=True)
class LeadingPulse:
    """The pulse behind the front on one side, at the end of a run.

    Attributes
    ----------
    front : distance of the front from x = 0, between blocks
    speed : speed of the front
    width : distance from the front to where blocks stick; NaN when nothing has stuck behind it
    peak_velocity, peak_distance : largest slip velocity, from a parabola through three blocks, and where it is
    slip : slip of the blocks that stuck last, halfway between the trailing edge and the nucleation at the nearest
    """

    front: float
    speed: float
    width: float
    peak_velocity: float
    peak_distance: float
    slip: float


def leading_pulse(run: xr.Dataset, window: float, side: str = "right") -> LeadingPulse:
    """Measure the pulse behind the front on one side.

    Parameters
    ----------
    run : one run with fronts and fields
    window : fraction of the front's path that its speed is measured on
    side : "right" or "left"
    """
    sign = 1.0 if side == "right" else -1.0
    end = run.attrs["end_time"]
    speed, _, _ = front_speed(run, window, side)
    release, distance = path(run, side)
    front = float(distance[-1] + speed * (end - release[-1])) if distance.size else float("nan")

    half = sign * run["x"].values >= 0.0
    order = np.argsort(sign * run["x"].values[half], kind="stable")
    r = (sign * run["x"].values[half])[order]
    velocity = run["slip_velocity"].values[half][order]
    slip = run["slip"].values[half][order]
    peak, at = parabola_peak(r, velocity)

    stick, stuck = path(run, side, "stick_time")
    width, final = float("nan"), float("nan")
    moving = np.flatnonzero(velocity > 0.0)
    if stuck.size >= 4 and moving.size and distance.size:
        behind = stuck < at
        if np.count_nonzero(behind) >= 4:
            # The trailing edge runs as fast as the front: its position now, from the blocks that stuck last.
            last = slice(max(0, np.count_nonzero(behind) - 4), np.count_nonzero(behind))
            trailing = float(np.mean(stuck[behind][last] + speed * (end - stick[behind][last])))
            width = front - trailing
            settled = (r > 0.5 * trailing) & (r < trailing - 2.0 * run.attrs["dx"]) & (velocity <= 0.0)
            if settled.any():
                near = r > r[settled].max() - max(0.5 * width, 4.0 * run.attrs["dx"])
                final = float(np.mean(slip[settled & near]))
    return LeadingPulse(front, speed, width, peak, at, final)


def parabola_peak(x: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """Largest value of sampled y and its position, from the parabola through the largest sample and its neighbours."""
    if y.size == 0:
        return float("nan"), float("nan")
    i = int(np.argmax(y))
    if i == 0 or i == y.size - 1:
        return float(y[i]), float(x[i])
    left, middle, right = y[i - 1], y[i], y[i + 1]
    bend = left - 2.0 * middle + right
    shift = 0.5 * (left - right) / bend if bend != 0.0 else 0.0
    return float(middle - 0.25 * (left - right) * shift), float(x[i] + shift * (x[i + 1] - x[i]))


def comoving(run: xr.Dataset, pulse: LeadingPulse, side: str = "right") -> dict[str, np.ndarray]:
    """Fields in the frame of the front, xi = distance - front <= 0 behind it.

    Returns
    -------
    dict of xi, slip, slip_velocity, slip_acceleration from the nucleation point to the end of the lattice
    """
    sign = 1.0 if side == "right" else -1.0
    half = sign * run["x"].values >= 0.0
    order = np.argsort(sign * run["x"].values[half], kind="stable")
    out = {"xi": (sign * run["x"].values[half])[order] - pulse.front}
    for name in ("slip", "slip_velocity", "slip_acceleration"):
        out[name] = run[name].values[half][order]
    return out


def acceleration_amplitude(run: xr.Dataset, pulse: LeadingPulse, side: str = "right") -> float:
    """Amplitude of the slip acceleration across a pulse, by projection on the sine that spans its width.

    The undamped lattice rings at the grid scale behind the front; a projection averages the ringing out, the largest
    value would report it. NaN for a pulse without a trailing edge.
    """
    if not np.isfinite(pulse.width):
        return float("nan")
    fields = comoving(run, pulse, side)
    inside = (fields["xi"] <= 0.0) & (fields["xi"] >= -pulse.width)
    shape = np.cos(np.pi * fields["xi"][inside] / pulse.width)
    if shape.size < 4:
        return float("nan")
    return float(np.sum(fields["slip_acceleration"][inside] * shape) / np.sum(shape**2))


def slip_variation(run: xr.Dataset, pulse: LeadingPulse, side: str = "right") -> float:
    """Largest relative change of the slip left behind over the last third of the path before the pulse."""
    if not np.isfinite(pulse.width) or not np.isfinite(pulse.slip) or pulse.slip == 0.0:
        return float("nan")
    fields = comoving(run, pulse, side)
    end = -pulse.width - 4.0 * run.attrs["dx"]
    third = (fields["xi"] < end) & (fields["xi"] > end - (pulse.front - pulse.width) / 3.0)
    if not third.any():
        return float("nan")
    slip = fields["slip"][third]
    return float((slip.max() - slip.min()) / pulse.slip)
