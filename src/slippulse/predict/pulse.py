"""Pulses of each run under a displacement boundary: the paper's, and the exact ones."""

import numpy as np
import pandas as pd

from ..model.run import Run
from ..theory.closed_pulse import SteadyPulse, paper_pulse
from ..theory.pulse import steady_pulse
from .front import exact_speeds
from .numbers import NAN, known, level


def predictions(runs: list[Run], settings: dict) -> pd.DataFrame:
    """Columns paper_pulse_NUMBER (no damping), exact_pulse_NUMBER and exact_left_pulse_NUMBER."""
    speeds = [exact_speeds(runs, side) for side in ("left", "right")]
    return pd.DataFrame([_pulses(*row) for row in zip(runs, *speeds, strict=True)])


def _pulses(run: Run, left_speed: float, right_speed: float) -> dict[str, float]:
    ahead = level(run, "right")
    paper = None
    if run.boundary == "displacement" and 0.0 < ahead < 1.0:
        paper = known(lambda: paper_pulse(ahead, run.gamma))
    row: dict[str, float] = {}
    for kind, pulse in (("paper", paper), ("exact", _exact(run, "right", right_speed))):
        for name in ("width", "slip", "peak_velocity"):
            row[f"{kind}_pulse_{name}"] = getattr(pulse, name, NAN)
        row[f"{kind}_pulse_acceleration"] = _acceleration(pulse) if pulse else NAN
    left = _exact(run, "left", left_speed)
    for name in ("slip", "peak_velocity"):
        row[f"exact_left_pulse_{name}"] = getattr(left, name, NAN)
    return row


def _exact(run: Run, side: str, speed: float) -> SteadyPulse | None:
    """Steady pulse on a side, where its front outruns the waves."""
    if run.boundary != "displacement" or not speed > 1.0:
        return None
    return known(lambda: steady_pulse(level(run, side), run.gamma, run.beta, speed))


def _acceleration(pulse: SteadyPulse) -> float:
    """Amplitude of the projection on the sine, as `measurement.pulses` measures it."""
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    shape = np.cos(np.pi * xi / pulse.width)
    return float(np.sum(weights * pulse.profile(xi)[2] * shape) / np.sum(weights * shape**2))
