"""A pulse sent from one pre-stress into another, exactly: its final slip and its memory."""

import numpy as np
import pandas as pd

from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.pulse import steady_pulse

from ..configuration.expand import expand

NEEDS = {"sweeps": ["pulses_across_a_step"]}

# Distances at which the slip is tabulated: before the step, and beyond it in units of the memory.
BEHIND = np.linspace(-10.0, 0.0, 21)[:-1]
BEYOND = np.concatenate([np.linspace(0.0, 1.0, 120, endpoint=False), np.linspace(1.0, 1.4, 21)])


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Final slip over the distance beyond the step, with both steady pulses and the memory."""
    parts = []
    for scene in expand(settings["sweeps"]["pulses_across_a_step"])[0]:
        position, level = scene.prestress.steps[-1]
        before = scene.prestress.right
        # In the limit dx -> 0 damping acts through the speed alone.
        ratio, release = scene.damping_ratio, scene.release
        old, new = (
            steady_pulse(tau, scene.gamma, damping_ratio=ratio, release=release)
            for tau in (before, level)
        )
        memory = new.width / (new.speed - 1.0)
        x = np.concatenate([BEHIND, memory * BEYOND])
        slip = exact_rupture(scene).final_slip(position + x)
        rows = pd.DataFrame({"level": level, "x": x, "slip": slip})
        rows = rows.assign(before=before, steady=new.slip, steady_before=old.slip, memory=memory)
        parts.append(rows)
    return pd.concat(parts, ignore_index=True)
