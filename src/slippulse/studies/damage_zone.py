"""A fault with a compliant damage zone: its stress drop, and the displacement before and after slip."""

import numpy as np
import pandas as pd

from ..theory.dimensional import damage_zone_stress_drop

NEEDS = {"settings": ["figures.fig07_damage_zone"]}

# The example, in thicknesses of the zone: host rock, slip and imposed displacement; and G/G_r.
ROCK, SLIP, IMPOSED, STIFFNESS_RATIO = 1.6, 1.1, 1.9, 0.2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Role curve: thickness_ratio (H_r/H), stiffness_ratio (G/G_r), stress_drop (over G delta/H); roles before and
    after (slip): y, displacement, in thicknesses of the zone. Source: section IV C 2 of the paper.
    """
    wanted = settings["figures"]["fig07_damage_zone"]
    ratios, parts = (
        np.geomspace(*(wanted["stiffness_ratios"][key] for key in ("from", "to", "count"))),
        [],
    )
    for thickness in map(float, wanted["thickness_ratios"]):
        drop = damage_zone_stress_drop(1.0, 1.0, 1.0 / ratios, 1.0, thickness)
        columns = {"thickness_ratio": thickness, "stiffness_ratio": ratios, "stress_drop": drop}
        parts.append(pd.DataFrame({"role": "curve"} | columns))
    for role, slip in (("before", 0.0), ("after", SLIP)):
        # One stress in both layers, so strains in inverse ratio of the moduli.
        stress = float(
            damage_zone_stress_drop(IMPOSED - slip, 1.0, 1.0 / STIFFNESS_RATIO, 1.0, ROCK)
        )
        moved = slip + stress * np.array([0.0, 1.0, 1.0 + STIFFNESS_RATIO * ROCK])
        parts.append(
            pd.DataFrame({"role": role, "y": [0.0, 1.0, 1.0 + ROCK], "displacement": moved})
        )
    return pd.concat(parts, ignore_index=True)
