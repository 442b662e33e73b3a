"""Tabulate the stress drop of a fault with a soft damage zone, before and after slip."""

import numpy as np
import pandas as pd

from slippulse.theory.dimensional import damage_zone_stress_drop

NEEDS = {"settings": ["figures.fig07_damage_zone"]}

# The example of the sketch, in units of the thickness of the damage zone.
ROCK_THICKNESS = 1.6
SLIP, IMPOSED_DISPLACEMENT = 1.1, 1.9
STIFFNESS_RATIO = 0.2  # G/G_r


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles curve (stress drop), before and after (displacements); section IV C 2."""
    figure = settings["figures"]["fig07_damage_zone"]
    steps = figure["stiffness_ratios"]
    ratios = np.geomspace(steps["from"], steps["to"], steps["count"])
    parts = []
    for thickness in map(float, figure["thickness_ratios"]):
        drop = damage_zone_stress_drop(1.0, 1.0, 1.0 / ratios, 1.0, thickness)
        columns = {"thickness_ratio": thickness, "stiffness_ratio": ratios, "stress_drop": drop}
        parts.append(pd.DataFrame({"role": "curve"} | columns))
    y = np.array([0.0, 1.0, 1.0 + ROCK_THICKNESS])
    for role, slip in (("before", 0.0), ("after", SLIP)):
        # Both layers have the same stress, so strains are inversely proportional to the moduli.
        drop = damage_zone_stress_drop(
            IMPOSED_DISPLACEMENT - slip, 1.0, 1.0 / STIFFNESS_RATIO, 1.0, ROCK_THICKNESS
        )
        moved = slip + float(drop) * np.array([0.0, 1.0, 1.0 + STIFFNESS_RATIO * ROCK_THICKNESS])
        parts.append(pd.DataFrame({"role": role, "y": y, "displacement": moved}))
    return pd.concat(parts, ignore_index=True)
