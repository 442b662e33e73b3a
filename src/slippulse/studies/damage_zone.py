"""A fault with a compliant damage zone: its stress drop, and the displacement before and after slip."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..theory.dimensional import damage_zone_stress_drop

NEEDS = {"settings": ["figures.fig07_damage_zone"]}

# The example, in thicknesses of the zone: host rock, slip and imposed displacement; and G/G_r.
ROCK, SLIP, IMPOSED, STIFFNESS_RATIO = 1.6, 1.1, 1.9, 0.2


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Curves of the stress drop, and one example of the displacement over the height.

    Parameters
    ----------
    settings : figures.fig07_damage_zone: stiffness_ratios (from, to, count; G/G_r) and thickness_ratios (H_r/H)

    Returns
    -------
    role curve: thickness_ratio, stiffness_ratio, stress_drop (over G delta/H); roles before and after (slip): y,
    displacement, in thicknesses of the zone

    Source: section IV C 2 of the paper.
    """
    wanted = settings["figures"]["fig07_damage_zone"]
    span = wanted["stiffness_ratios"]
    ratios = np.geomspace(span["from"], span["to"], int(span["count"]))
    curves = []
    for thickness in wanted["thickness_ratios"]:
        drop = damage_zone_stress_drop(1.0, 1.0, 1.0 / ratios, 1.0, thickness)
        columns = {"thickness_ratio": float(thickness), "stiffness_ratio": ratios, "stress_drop": drop}
        curves.append(pd.DataFrame({"role": "curve", **columns}))
    return pd.concat([*curves, displacement("before", 0.0), displacement("after", SLIP)], ignore_index=True)


def displacement(role: str, slip: float) -> pd.DataFrame:
    """Displacement at y = 0, H and H + H_r: one stress in both layers, so strains in inverse ratio of the moduli."""
    stress = float(damage_zone_stress_drop(IMPOSED - slip, 1.0, 1.0 / STIFFNESS_RATIO, 1.0, ROCK))
    heights = np.array([0.0, 1.0, 1.0 + ROCK])
    moved = slip + stress * np.array([0.0, 1.0, 1.0 + STIFFNESS_RATIO * ROCK])
    return pd.DataFrame({"role": role, "y": heights, "displacement": moved})
