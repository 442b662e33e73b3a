"""Tabulate the exact final slip of a pulse that enters another pre-stress, and its memory."""

import numpy as np
import pandas as pd

from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.pulse import steady_pulse

from ..configuration.expand import expand

NEEDS = {"sweeps": ["pulses_across_a_step"]}

# Positions at which the slip is tabulated: distances before the step, and distances beyond it in
# units of the memory.
DISTANCES_BEFORE = np.linspace(-10.0, 0.0, 21)[:-1]
DISTANCES_BEYOND = np.concatenate(
    [np.linspace(0.0, 1.0, 120, endpoint=False), np.linspace(1.0, 1.4, 21)]
)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the final slip by distance from the step, with both steady slips and the memory."""
    parts = []
    for scene in expand(settings["sweeps"]["pulses_across_a_step"])[0]:
        position, level = scene.prestress.steps[-1]
        before = scene.prestress.right
        # In the limit dx -> 0 damping acts only through the front speed.
        ratio, release = scene.damping_ratio, scene.release
        old, new = (
            steady_pulse(tau, scene.gamma, damping_ratio=ratio, release=release)
            for tau in (before, level)
        )
        memory = new.width / (new.speed - 1.0)
        x = np.concatenate([DISTANCES_BEFORE, memory * DISTANCES_BEYOND])
        slip = exact_rupture(scene).final_slip(position + x)
        rows = pd.DataFrame({"level": level, "x": x, "slip": slip})
        rows = rows.assign(before=before, steady=new.slip, steady_before=old.slip, memory=memory)
        parts.append(rows)
    return pd.concat(parts, ignore_index=True)
