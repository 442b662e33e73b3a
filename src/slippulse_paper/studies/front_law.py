"""Tabulate exact front speeds as functions of pre-stress, leaf springs and spacing."""

import numpy as np
import pandas as pd

from slippulse.prediction.common import value_or_nan
from slippulse.theory.front_speeds import prestress_for_speed
from slippulse.theory.front_speeds_with_springs import continuum_front_speed, lattice_front_speed

from ..configuration.runs import parameters

NEEDS = {
    "sweeps": [
        "front_speed",
        "front_speed_springs",
        "continuum_fixed_ratio",
        "continuum_fixed_beta",
        "front_speed_fixed_beta",
    ]
}

# Computing the pre-stress for a given speed is faster than the inverse, so the lines start from
# these speeds.
SPEEDS = 1.0 + np.geomspace(1e-3, 299.0, 60)
# Values of gamma dx^2, denser where the speed falls and the lines end.
SPRING_STIFFNESSES = np.concatenate([np.geomspace(3e-3, 0.3, 8), np.geomspace(0.34, 6.0, 34)])
SPACING_COUNT = 33
# Refined lattices of one level. At a larger beta the pulse would be as narrow as the damped
# layer at its front.
REFINED_RUNS = "left == 0.5 and beta <= 0.1"
LINE_COLUMNS = ["release", "left", "gamma", "held", "fixed"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the panels prestress, springs (by gamma dx^2), refined (by dx) and limit (dx -> 0)."""
    sweeps = (parameters(settings["sweeps"][name]) for name in NEEDS["sweeps"])
    swept, springs, fixed_ratio, *fixed_beta = map(pd.DataFrame, sweeps)
    held = [fixed_ratio.assign(held="b", fixed=fixed_ratio["damping_ratio"])]
    held += [scenes.assign(held="beta", fixed=scenes["beta"]) for scenes in fixed_beta]
    parts = []
    for release, ratio in swept[["release", "damping_ratio"]].drop_duplicates().values:
        line = {"left": prestress_for_speed(SPEEDS, ratio, release), "speed": SPEEDS}
        line |= {"panel": "prestress", "release": release, "damping_ratio": ratio}
        parts.append(pd.DataFrame(line))
    for left, ratio in springs[["left", "damping_ratio"]].drop_duplicates().values:
        line = {"panel": "springs", "release": "total", "left": left}
        line |= {"damping_ratio": ratio, "springs": SPRING_STIFFNESSES}
        line["speed"] = [_speed(left, spring, 1.0, ratio, "total") for spring in SPRING_STIFFNESSES]
        parts.append(pd.DataFrame(line))
    return pd.concat([*parts, over_spacing(pd.concat(held))], ignore_index=True)


def over_spacing(scenes: pd.DataFrame) -> pd.DataFrame:
    """Return lines as functions of the spacing, at fixed beta or beta/dx, and their limits."""
    rows = []
    for values, dx in scenes.query(REFINED_RUNS).groupby(LINE_COLUMNS)["dx"]:
        line = dict(zip(LINE_COLUMNS, values, strict=True))
        left, gamma = line["left"], line["gamma"]
        if line["held"] == "beta" and line["release"] == "elastic":
            speed = continuum_front_speed(left, gamma, line["fixed"])
            rows.append(line | {"panel": "limit", "speed": speed})
        for spacing in np.union1d(np.geomspace(dx.min(), dx.max(), SPACING_COUNT), dx):
            ratio = line["fixed"] / (1.0 if line["held"] == "b" else spacing)
            speed = _speed(left, gamma, spacing, ratio, line["release"])
            point = {"panel": "refined", "dx": spacing, "damping_ratio": ratio, "speed": speed}
            rows.append(line | point)
    return pd.DataFrame(rows)


def _speed(left: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    """Return the front speed on a lattice; NaN if no front outruns the waves."""
    return value_or_nan(lambda: lattice_front_speed(left, gamma, dx, ratio, release))
