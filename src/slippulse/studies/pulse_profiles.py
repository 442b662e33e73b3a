"""Exact pulses of the runs of figures 3, 8 and 9 over the distance from their largest velocity."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..model.scene import Scene
from ..theory.arrest import ArrestingCrack
from ..theory.front_law import front_speed
from ..theory.pulse import SteadyPulse, pulse_behind_front

NEEDS = {"sweeps": ["steady_displacement", "steady_stress"]}

# Points of a curve, and how far it goes on ahead of a pulse and behind it, as fractions of the width.
POINTS, AHEAD, BEHIND = 200, 0.08, 0.25
# Of the largest velocity: below it the tail of a pulse that never ends is cut.
TAIL = 1e-3


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Profiles of each run.

    Returns
    -------
    simulation, run (its row), x (0 at the largest velocity), slip, slip_velocity, slip_acceleration

    Source: `pulse_behind_front` under a displacement boundary, `ArrestingCrack.far_pulse` under a stress boundary.
    """
    parts = []
    for name, sweep in settings["sweeps"].items():
        scenes, _ = expand(sweep)
        for run, scene in enumerate(scenes):
            if scene.boundary == "stress":
                found = far_profile(scene)
            else:
                level = scene.prestress.right
                speed = float(front_speed(level, scene.damping_ratio, scene.release))
                found = profile(pulse_behind_front(level, scene.gamma, scene.beta, speed))
            parts.append(found.assign(simulation=name, run=run))
    return pd.concat(parts, ignore_index=True)


def profile(pulse: SteadyPulse) -> pd.DataFrame:
    """A steady pulse, its corners at the front and at the trailing edge kept sharp."""
    even = np.linspace(-(1.0 + BEHIND), AHEAD, POINTS) * pulse.width
    edges = [-pulse.width, np.nextafter(-pulse.width, -np.inf), 0.0, 1e-12 * pulse.width]
    xi = np.unique(np.concatenate([even, edges]))
    slip, velocity, acceleration = pulse.profile(xi)
    fields = {"slip": slip, "slip_velocity": velocity, "slip_acceleration": acceleration}
    return pd.DataFrame({"x": xi - pulse.peak_position, **fields})


def far_profile(scene: Scene) -> pd.DataFrame:
    """The pulse far from its nucleation under a stress boundary, with its integral and its derivative."""
    crack = ArrestingCrack(scene.prestress, scene.damping_ratio, scene.release)
    delay, velocity = crack.far_pulse()
    order = np.argsort(delay, kind="stable")
    delay, velocity = delay[order], velocity[order]
    start = max(0, int(np.argmax(velocity > TAIL * velocity.max())) - 1)
    x, v = delay[start:] - delay[int(np.argmax(velocity))], velocity[start:]
    apart = np.concatenate([[True], np.diff(x) > 1e-9 * np.ptp(x)])
    x, v = x[apart], v[apart]
    # The pulse moves at the wave speed without changing, so slip is the integral of its velocity over distance.
    slip = np.concatenate([np.cumsum((0.5 * (v[1:] + v[:-1]) * np.diff(x))[::-1])[::-1], [0.0]])
    found = pd.DataFrame({"x": x, "slip": slip, "slip_velocity": v, "slip_acceleration": -np.gradient(v, x)})
    return found.iloc[:: max(1, len(found) // (2 * POINTS))]
