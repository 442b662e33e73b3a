"""A pulse sent from one pre-stress into another, exactly: the slip that it leaves, and how far it remembers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..model.scene import Scene
from ..theory.front_law import front_speed
from ..theory.pulse import SteadyPulse, steady_pulse
from ..theory.rupture import Rupture

# The simulation whose parameters the curves have.
NEEDS = {"sweeps": ["pulses_across_a_step"]}

# How far behind the step the slip is wanted, and beyond it in units of the finite memory.
BEHIND, BEYOND = 10.0, 1.4
BEFORE_STEP, WITHIN_MEMORY, AFTER = 21, 120, 20


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Final slip around the step of each scene.

    Parameters
    ----------
    data, tables : not used
    settings : sweeps

    Returns
    -------
    DataFrame of level (beyond the step), x (distance beyond it) and slip; and the same in every row of a level: before
    (the level there), steady and steady_before (exact slip of both steady pulses), memory (the distance W_p/(v - 1)
    beyond which the past of the trailing edge does not reach)
    """
    parts = []
    for scene in expand(settings["sweeps"]["pulses_across_a_step"])[0]:
        position, level = scene.prestress.steps[-1]
        old, new = (_steady(scene, each) for each in (scene.prestress.right, level))
        memory = new.width / (new.speed - 1.0)
        x = np.concatenate(
            [
                np.linspace(-BEHIND, 0.0, BEFORE_STEP)[:-1],
                np.linspace(0.0, memory, WITHIN_MEMORY, endpoint=False),
                np.linspace(memory, BEYOND * memory, AFTER + 1),
            ]
        )
        exact = Rupture(scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration)
        rows = pd.DataFrame({"level": level, "x": x, "slip": exact.final_slip(position + x)})
        steady = {"steady": new.slip, "steady_before": old.slip, "memory": memory}
        parts.append(rows.assign(before=scene.prestress.right, **steady))
    return pd.concat(parts, ignore_index=True)


def _steady(scene: Scene, level: float) -> SteadyPulse:
    """In the limit dx -> 0 damping acts through the speed alone."""
    speed = float(front_speed(level, scene.damping_ratio, scene.release))
    return steady_pulse(level, scene.gamma, 0.0, speed)
