"""Tabulate the exact final slip of pulses that enter another pre-stress.

A pulse depends only on the pre-stress that it has met within a finite distance, its memory.
"""

from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.scene import Scene
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.pulse import steady_pulse

from ..configuration.expand import expand

NEEDS = {"sweeps": ["pulses_across_a_step"]}

# Positions at which the slip is tabulated, relative to the step of the pre-stress. Those beyond the
# step are in units of the memory.
DISTANCES_BEFORE = np.linspace(-10.0, 0.0, 21)[:-1]
DISTANCES_BEYOND = np.concatenate(
    [np.linspace(0.0, 1.0, 120, endpoint=False), np.linspace(1.0, 1.4, 21)]
)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each scene and distance x from the step, with the final slip there.

    The columns are:

    before, level : pre-stress before the step and beyond it
    steady_before, steady : slip of a steady pulse in each of the two levels of pre-stress
    memory : distance beyond the step from which on the pulse is steady again
    """
    scenes, _ = expand(settings["sweeps"]["pulses_across_a_step"])
    return pd.concat([rows_of_scene(scene) for scene in scenes], ignore_index=True)


def rows_of_scene(scene: Scene) -> pd.DataFrame:
    """Return the rows of one scene, in which a pulse passes from one level to another at a step."""
    # Each step is a pair of its position and its level. The outermost one on the right is taken.
    position, level = max(scene.prestress.steps)
    before = scene.prestress.right
    # In the limit dx -> 0 damping acts only through the front speed.
    front_parameters: dict[str, Any] = {
        "damping_ratio": scene.damping_ratio,
        "release": scene.release,
    }
    pulse_before = steady_pulse(before, scene.gamma, **front_parameters)
    pulse_beyond = steady_pulse(level, scene.gamma, **front_parameters)
    # After this distance, a pulse has forgotten what it met.
    memory = pulse_beyond.width / (pulse_beyond.speed - 1.0)
    x = np.concatenate([DISTANCES_BEFORE, memory * DISTANCES_BEYOND])
    slip = exact_rupture(scene).final_slip(position + x)
    rows = pd.DataFrame({"level": level, "x": x, "slip": slip})
    return rows.assign(
        before=before, steady=pulse_beyond.slip, steady_before=pulse_before.slip, memory=memory
    )
