"""The right pulse of each run under a displacement boundary, by the paper's formulas and with damping."""

import numpy as np
import pandas as pd

from ..model.scene import Scene
from ..theory.pulse import SteadyPulse, paper_pulse, pulse_behind_front
from .front import exact_speeds
from .numbers import NAN, known, level


def predictions(scenes: list[Scene], settings: dict) -> pd.DataFrame:
    """paper_pulse_SIZE (undamped) and exact_pulse_SIZE: width, slip, peak_velocity, acceleration."""
    pairs = zip(scenes, exact_speeds(scenes, "right"), strict=True)
    return pd.DataFrame([_pulse(scene, speed) for scene, speed in pairs])


def _pulse(scene: Scene, speed: float) -> dict[str, float]:
    ahead = level(scene, "right")
    paper = exact = None
    if scene.boundary == "displacement" and 0.0 < ahead < 1.0:
        paper = known(lambda: paper_pulse(ahead, scene.gamma))
        if speed > 1.0:
            exact = known(lambda: pulse_behind_front(ahead, scene.gamma, scene.beta, speed))
    out: dict[str, float] = {}
    for kind, pulse in (("paper", paper), ("exact", exact)):
        for name in ("width", "slip", "peak_velocity"):
            out[f"{kind}_pulse_{name}"] = getattr(pulse, name, NAN)
        out[f"{kind}_pulse_acceleration"] = _acceleration(pulse) if pulse else NAN
    return out


def _acceleration(pulse: SteadyPulse) -> float:
    """Amplitude by projection on the sine, as it is measured (`measure.pulses.acceleration_amplitude`)."""
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    shape = np.cos(np.pi * xi / pulse.width)
    return float(np.sum(weights * pulse.profile(xi)[2] * shape) / np.sum(weights * shape**2))
