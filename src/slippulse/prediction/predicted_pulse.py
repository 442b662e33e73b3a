"""Predicted pulses of each run under a displacement boundary, by the paper and exact."""

import numpy as np
import pandas as pd

from ..model.run import Run
from ..theory.closed_pulse import SteadyPulse, paper_pulse, pulse_at_speed
from .common import far_level, value_or
from .predicted_front import exact_front_speeds

# Friction laws for which these numbers are valid.
LAWS = ("coulomb", "linear_rate")


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return numbers of the steady pulses of each run, one row for each run.

    For the pulse on the right the columns are paper_pulse_NAME (the paper's pulse, without damping)
    and exact_pulse_NAME, and for the pulse on the left exact_left_pulse_NAME. The names are width,
    slip, peak_velocity and acceleration, on the left only slip and peak_velocity. They are NaN
    if there is no pulse: without leaf springs, or if the front is not faster than the waves. The
    settings, which other predictions need, are not used.
    """
    left_speeds = exact_front_speeds(runs, "left").tolist()
    right_speeds = exact_front_speeds(runs, "right").tolist()
    return pd.DataFrame([*map(_row, runs, left_speeds, right_speeds)])


def _row(run: Run, left_speed: float, right_speed: float) -> dict[str, float]:
    """Return the row of `predictions` for one run, given its exact front speeds."""
    left_level, right_level = far_level(run, "left"), far_level(run, "right")
    right_pulses = {
        "paper": value_or(lambda: paper_pulse(right_level, run.gamma), None),
        "exact": _exact_pulse(run, right_level, right_speed),
    }
    row: dict[str, float] = {}
    # A pulse that does not exist is None and has none of the attributes, so that all numbers are
    # NaN.
    for source, pulse in right_pulses.items():
        for name in ("width", "slip", "peak_velocity"):
            row[f"{source}_pulse_{name}"] = getattr(pulse, name, np.nan)
        row[f"{source}_pulse_acceleration"] = _acceleration_amplitude(pulse) if pulse else np.nan
    left_pulse = _exact_pulse(run, left_level, left_speed)
    for name in ("slip", "peak_velocity"):
        row[f"exact_left_pulse_{name}"] = getattr(left_pulse, name, np.nan)
    return row


def _exact_pulse(run: Run, level: float, speed: float) -> SteadyPulse | None:
    """Return the steady pulse at a level of pre-stress and a front speed; None if there is none."""
    # The coefficient of friction that is linear in slip rate. Other laws do not have it.
    alpha = run.friction.get("alpha", 0.0)
    return value_or(
        lambda: pulse_at_speed(level, run.gamma, run.beta, speed, rate_strengthening=alpha), None
    )


def _acceleration_amplitude(pulse: SteadyPulse) -> float:
    """Return the amplitude of slip acceleration, as `acceleration_amplitude` measures it.

    This amplitude is the projection of the acceleration on a half wave of a cosine, from the front
    to the rear of the pulse. The integrals are computed by Gauss-Legendre quadrature.
    """
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    half_wave = np.cos(np.pi * xi / pulse.width)
    acceleration = pulse.profile(xi).acceleration
    integral = np.sum(weights * acceleration * half_wave)
    return float(integral / np.sum(weights * half_wave**2))
