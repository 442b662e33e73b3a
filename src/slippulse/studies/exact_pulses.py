"""What the paper neglects at the nucleation point: the curvature of slip there, halfway to the transition, exactly."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..theory.rupture import Rupture

NEEDS = {"sweeps": ["space_time_displacement"]}

# A derivative in space by a difference over this.
STEP = 1e-3


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Curvature of slip over the pre-stress, which is 1 there; of runs with a transition.

    Returns
    -------
    DataFrame of simulation, run, quantity (strain_term) and difference (from 0, which the paper has)
    """
    rows = []
    for simulation, sweep in settings["sweeps"].items():
        for run, scene in enumerate(expand(sweep)[0]):
            rupture = Rupture(
                scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration
            )
            if np.isfinite(rupture.transition_time):
                strain = rupture.strain(np.array([STEP]), 0.5 * rupture.transition_time)[0]
                rows.append((simulation, run, "strain_term", float(abs(strain / STEP))))
    return pd.DataFrame(rows, columns=["simulation", "run", "quantity", "difference"])
