"""Tabulate the exact pulses for figures 3, 8 and 9, with their largest velocity at x = 0."""

import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid

from slippulse.model.run import Run
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.pulse import steady_pulse

from ..configuration.runs import runs

NEEDS = {"sweeps": ["steady_displacement", "steady_stress"]}

POINT_COUNT = 200
# A curve extends ahead of the pulse and behind it by these fractions of the pulse width.
MARGIN_AHEAD, MARGIN_BEHIND = 0.08, 0.25
# An infinite tail is cut off where the velocity is below this fraction of the largest one.
TAIL_CUT = 1e-3
FIELDS = ("slip", "slip_velocity", "slip_acceleration")


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return slip, velocity and acceleration of each pulse, as functions of the position x.

    The columns simulation and run name the pulse.
    """
    parts = []
    for name, sweep in settings["sweeps"].items():
        for number, run in enumerate(runs(sweep)):
            rows = stress_profile(run) if run.boundary == "stress" else displacement_profile(run)
            parts.append(rows.assign(simulation=name, run=number))
    return pd.concat(parts, ignore_index=True)


def displacement_profile(run: Run) -> pd.DataFrame:
    """Return the exact steady pulse under a displacement boundary.

    The curves of this pulse have sharp corners at the front and at the trailing edge. There are
    points on both sides of each corner.
    """
    level, damping_ratio = run.prestress.right, run.damping_ratio
    pulse = steady_pulse(
        level, run.gamma, run.beta, damping_ratio=damping_ratio, release=run.release
    )
    # Positions are relative to the front, so they are negative behind it.
    trailing_edge, front = -pulse.width, 0.0
    both_sides_of_corners = [
        np.nextafter(trailing_edge, -np.inf),
        trailing_edge,
        front,
        # The number next to 0 would be lost to rounding when the peak position is subtracted.
        front + 1e-12 * pulse.width,
    ]
    in_widths = np.linspace(-(1.0 + MARGIN_BEHIND), MARGIN_AHEAD, POINT_COUNT)
    xi = np.unique(np.concatenate([in_widths * pulse.width, both_sides_of_corners]))
    fields = dict(zip(FIELDS, pulse.profile(xi), strict=True))
    return pd.DataFrame({"x": xi - pulse.peak_position} | fields)


def stress_profile(run: Run) -> pd.DataFrame:
    """Return the exact pulse under a stress boundary, far from its nucleation.

    Theory gives its velocity. The slip is the integral of the velocity over time, and the
    acceleration is its derivative.
    """
    crack = ArrestingCrack(run.prestress, run.damping_ratio, run.release)
    # The pulse moves unchanged at the wave speed 1, so it depends on x - t only.
    x_minus_t, velocity = crack.far_pulse()
    curve = pd.DataFrame({"x": x_minus_t, "velocity": velocity})
    curve = curve.sort_values("x", kind="stable", ignore_index=True)
    peak = curve["velocity"].argmax()
    # From here on x is measured from the position of the largest velocity.
    curve["x"] -= curve["x"][peak]
    # Behind the pulse is an infinite tail. It is cut off, except the last point at which the
    # velocity is below the fraction TAIL_CUT of the largest one.
    is_in_pulse = curve["velocity"] > TAIL_CUT * curve["velocity"][peak]
    first_in_pulse = is_in_pulse.argmax()
    curve = curve[max(0, first_in_pulse - 1) :]
    # Points that nearly coincide with the one before are left out, because derivatives would fail.
    distance_to_previous = curve["x"].diff().fillna(np.inf)
    curve = curve[distance_to_previous > 1e-9 * np.ptp(curve["x"])]
    x, velocity = curve["x"].to_numpy(), curve["velocity"].to_numpy()
    # A derivative with respect to t is minus that with respect to x. The integral begins at the
    # front, where the slip is 0.
    slip = cumulative_trapezoid(velocity[::-1], -x[::-1], initial=0.0)[::-1]
    acceleration = -np.gradient(velocity, x)
    curves = dict(zip(FIELDS, (slip, velocity, acceleration), strict=True))
    rows = pd.DataFrame({"x": x} | curves)
    # Theory has more points than a figure needs.
    stride = max(1, len(rows) // (2 * POINT_COUNT))
    return rows.iloc[::stride]
