"""Right pulse of each run under a displacement boundary: the paper's, and the exact one."""

import numpy as np
import pandas as pd

from ..model.scene import Scene
from ..theory.pulse import SteadyPulse, paper_pulse, pulse_behind_front
from .front import exact_speeds
from .numbers import NAN, known, level


def predictions(scenes: list[Scene], settings: dict) -> pd.DataFrame:
    """Columns paper_pulse_SIZE (no damping) and exact_pulse_SIZE.

    SIZE is width, slip, peak_velocity or acceleration.
    """
    pairs = zip(scenes, exact_speeds(scenes, "right"), strict=True)
    return pd.DataFrame([_pulse(scene, speed) for scene, speed in pairs])


def _pulse(scene: Scene, speed: float) -> dict[str, float]:
    ahead = level(scene, "right")
    paper = exact = None
    if scene.boundary == "displacement" and 0.0 < ahead < 1.0:
        paper = known(lambda: paper_pulse(ahead, scene.gamma))
        if speed > 1.0:
            exact = known(lambda: pulse_behind_front(ahead, scene.gamma, scene.beta, speed))
    row: dict[str, float] = {}
    for kind, pulse in (("paper", paper), ("exact", exact)):
        for name in ("width", "slip", "peak_velocity"):
            row[f"{kind}_pulse_{name}"] = getattr(pulse, name, NAN)
        row[f"{kind}_pulse_acceleration"] = _acceleration(pulse) if pulse else NAN
    return row


def _acceleration(pulse: SteadyPulse) -> float:
    """Amplitude of the projection on the sine, as `measurement.pulses` measures it."""
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    shape = np.cos(np.pi * xi / pulse.width)
    return float(np.sum(weights * pulse.profile(xi)[2] * shape) / np.sum(weights * shape**2))
