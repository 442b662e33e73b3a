"""Pulses of each run under a displacement boundary: the paper's, and the exact ones."""

import numpy as np
import pandas as pd

from ..model.run import Run
from ..theory.closed_pulse import SteadyPulse, paper_pulse, pulse_at_speed
from .common import SIDES, known, level
from .predicted_front import exact_speeds

# Laws of friction that these numbers hold for.
LAWS = ("coulomb", "linear_rate")


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Columns paper_pulse_NUMBER (no damping), exact_pulse_NUMBER and exact_left_pulse_NUMBER."""
    speeds = (exact_speeds(runs, side).tolist() for side in SIDES)
    return pd.DataFrame([*map(_pulses, runs, *speeds)])


def _pulses(run: Run, left_speed: float, right_speed: float) -> dict[str, float]:
    behind, ahead = level(run, "left"), level(run, "right")
    # Without leaf springs, or where a front does not outrun the waves, there is no pulse.
    pulses = {
        "paper": known(lambda: paper_pulse(ahead, run.gamma), None),
        "exact": _exact(run, ahead, right_speed),
    }
    row: dict[str, float] = {}
    for kind, pulse in pulses.items():
        for name in ("width", "slip", "peak_velocity"):
            row[f"{kind}_pulse_{name}"] = getattr(pulse, name, np.nan)
        row[f"{kind}_pulse_acceleration"] = _acceleration(pulse) if pulse else np.nan
    left = _exact(run, behind, left_speed)
    for name in ("slip", "peak_velocity"):
        row[f"exact_left_pulse_{name}"] = getattr(left, name, np.nan)
    return row


def _exact(run: Run, level: float, speed: float) -> SteadyPulse | None:
    alpha = run.friction.get("alpha", 0.0)
    physics = level, run.gamma, run.beta, speed
    return known(lambda: pulse_at_speed(*physics, rate_strengthening=alpha), None)


def _acceleration(pulse: SteadyPulse) -> float:
    """Amplitude of the projection on the sine, as `measurement.pulses` measures it."""
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    shape = np.cos(np.pi * xi / pulse.width)
    return float(np.sum(weights * pulse.profile(xi)[2] * shape) / np.sum(weights * shape**2))
