"""Predicted pulses of each run under a displacement boundary, by the paper and exact."""

import numpy as np
import pandas as pd

from ..model.run import Run
from ..theory.closed_pulse import SteadyPulse, paper_pulse, pulse_at_speed
from .common import far_level, value_or
from .predicted_front import exact_front_speeds

# Friction laws for which these numbers hold.
LAWS = ("coulomb", "linear_rate")


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Return numbers of the pulses, one row for each run; NaN if there is no pulse.

    The columns are paper_pulse_NAME (without damping) and exact_pulse_NAME of the pulse on the
    right, and exact_left_pulse_NAME. There is no pulse without leaf springs, or if the front is not
    faster than the waves.
    """
    left_speeds = exact_front_speeds(runs, "left").tolist()
    right_speeds = exact_front_speeds(runs, "right").tolist()
    return pd.DataFrame([*map(_pulses, runs, left_speeds, right_speeds)])


def _pulses(run: Run, left_speed: float, right_speed: float) -> dict[str, float]:
    """Return one row of `predictions`."""
    left_level, right_level = far_level(run, "left"), far_level(run, "right")
    pulses = {
        "paper": value_or(lambda: paper_pulse(right_level, run.gamma), None),
        "exact": _exact_pulse(run, right_level, right_speed),
    }
    row: dict[str, float] = {}
    for kind, pulse in pulses.items():
        for name in ("width", "slip", "peak_velocity"):
            row[f"{kind}_pulse_{name}"] = getattr(pulse, name, np.nan)
        row[f"{kind}_pulse_acceleration"] = _acceleration(pulse) if pulse else np.nan
    left_pulse = _exact_pulse(run, left_level, left_speed)
    for name in ("slip", "peak_velocity"):
        row[f"exact_left_pulse_{name}"] = getattr(left_pulse, name, np.nan)
    return row


def _exact_pulse(run: Run, level: float, speed: float) -> SteadyPulse | None:
    """Return the steady pulse at a level of pre-stress and a front speed; None if there is none."""
    alpha = run.friction.get("alpha", 0.0)
    parameters = level, run.gamma, run.beta, speed
    return value_or(lambda: pulse_at_speed(*parameters, rate_strengthening=alpha), None)


def _acceleration(pulse: SteadyPulse) -> float:
    """Return the amplitude of slip acceleration, as `acceleration_amplitude` measures it.

    The projection on a half wave is integrated by Gauss-Legendre quadrature.
    """
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    half_wave = np.cos(np.pi * xi / pulse.width)
    acceleration = pulse.profile(xi).acceleration
    projection = np.sum(weights * acceleration * half_wave)
    return float(projection / np.sum(weights * half_wave**2))
