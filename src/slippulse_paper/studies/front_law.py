"""Exact front speeds as curves over the pre-stress, the leaf springs and the spacing."""

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

# The pre-stress for a speed takes less time than the inverse: lines over it are found over speed.
SPEEDS = 1.0 + np.geomspace(1e-3, 299.0, 60)
# gamma dx^2, denser where the speed falls and the lines end.
SPRINGS = np.concatenate([np.geomspace(3e-3, 0.3, 8), np.geomspace(0.34, 6.0, 34)])
SPACINGS = 33
# Refined lattices of one level; at a larger beta the pulse is as narrow as the layer at its front.
REFINED = "left == 0.5 and beta <= 0.1"
LINE = ["release", "left", "gamma", "held", "fixed"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Panels prestress, springs (over gamma dx^2), refined (over dx), and limit (dx -> 0)."""
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
        line |= {"damping_ratio": ratio, "springs": SPRINGS}
        line["speed"] = [_speed(left, spring, 1.0, ratio, "total") for spring in SPRINGS]
        parts.append(pd.DataFrame(line))
    return pd.concat([*parts, over_spacing(pd.concat(held))], ignore_index=True)


def over_spacing(scenes: pd.DataFrame) -> pd.DataFrame:
    """Lines over the spacing, at a fixed damping or damping ratio, and their limits."""
    rows = []
    for values, dx in scenes.query(REFINED).groupby(LINE)["dx"]:
        line = dict(zip(LINE, values, strict=True))
        left, gamma = line["left"], line["gamma"]
        if line["held"] == "beta" and line["release"] == "elastic":
            speed = continuum_front_speed(left, gamma, line["fixed"])
            rows.append(line | {"panel": "limit", "speed": speed})
        for spacing in np.union1d(np.geomspace(dx.min(), dx.max(), SPACINGS), dx):
            ratio = line["fixed"] / (1.0 if line["held"] == "b" else spacing)
            speed = _speed(left, gamma, spacing, ratio, line["release"])
            point = {"panel": "refined", "dx": spacing, "damping_ratio": ratio, "speed": speed}
            rows.append(line | point)
    return pd.DataFrame(rows)


def _speed(left: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    """The lattice's front speed; NaN where no front outruns the waves."""
    return value_or_nan(lambda: lattice_front_speed(left, gamma, dx, ratio, release))
