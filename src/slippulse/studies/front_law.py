"""Exact front speeds as curves: over the pre-stress, over the leaf springs, and over the spacing."""

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..predict.numbers import or_nan
from ..theory.front_speeds import continuum_front_speed, lattice_front_speed, prestress_for_speed

# Simulations whose parameters the curves have.
NEEDS = {
    "sweeps": [
        "front_speed", "front_speed_springs", "continuum_fixed_ratio", "continuum_fixed_beta", "front_speed_fixed_beta"
    ]
}  # fmt: skip

# The inverse is the cheaper one: lines over the pre-stress are found over the speed.
SPEEDS = 1.0 + np.geomspace(1e-3, 299.0, 60)
# gamma dx^2, denser where the speed falls and the lines end.
SPRINGS = np.concatenate([np.geomspace(3e-3, 0.3, 8), np.geomspace(0.34, 6.0, 34)])
SPRINGS_RELEASE = "total"
SPACINGS = 33
# Refined lattices of one level; at a larger beta the pulse is as narrow as the layer at its front.
REFINED = "left == 0.5 and beta <= 0.1"
LINE = ["release", "left", "gamma", "held", "fixed"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Panel, release, left (the level), damping_ratio, speed: panel prestress (over left), springs (over springs =
    gamma dx^2; NaN where no front outruns the waves), refined (over dx; held: b or beta, at the value fixed), and limit
    (dx -> 0 under the elastic rule at fixed beta).
    """
    sweeps = (expand(settings["sweeps"][name])[0] for name in NEEDS["sweeps"])
    tabulated = (pd.DataFrame([scene.attributes() for scene in scenes]) for scenes in sweeps)
    swept, springs, fixed_ratio, *fixed_beta = tabulated
    parts, rows = [], []
    for release, ratio in swept[["release", "damping_ratio"]].drop_duplicates().values:
        line = {
            "left": prestress_for_speed(SPEEDS, ratio, release),
            "speed": SPEEDS,
            "panel": "prestress",
        }
        parts.append(pd.DataFrame(line | {"release": release, "damping_ratio": ratio}))
    for left, ratio in springs[["left", "damping_ratio"]].drop_duplicates().values:
        line = {
            "panel": "springs",
            "release": SPRINGS_RELEASE,
            "left": left,
            "damping_ratio": ratio,
        }
        line["speed"] = [_speed(left, each, 1.0, ratio, SPRINGS_RELEASE) for each in SPRINGS]
        parts.append(pd.DataFrame(line | {"springs": SPRINGS}))
    held = [fixed_ratio.assign(held="b", fixed=fixed_ratio["damping_ratio"])]
    held += [each.assign(held="beta", fixed=each["beta"]) for each in fixed_beta]
    for values, dx in pd.concat(held).query(REFINED).groupby(LINE)["dx"]:
        line = dict(zip(LINE, values, strict=True))
        if line["held"] == "beta" and line["release"] == "elastic":
            speed = continuum_front_speed(line["left"], line["gamma"], line["fixed"])
            rows.append(line | {"panel": "limit", "speed": speed})
        for spacing in np.union1d(np.geomspace(dx.min(), dx.max(), SPACINGS), dx):
            ratio = line["fixed"] / (1.0 if line["held"] == "b" else spacing)
            speed = _speed(line["left"], line["gamma"], spacing, ratio, line["release"])
            rows.append(
                line | {"panel": "refined", "dx": spacing, "damping_ratio": ratio, "speed": speed}
            )
    return pd.concat([*parts, pd.DataFrame(rows)], ignore_index=True)


def _speed(*scene) -> float:
    """The lattice's front speed; NaN where no front outruns the waves."""
    return or_nan(lambda: lattice_front_speed(*scene))
