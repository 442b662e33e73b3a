"""The planes of both levels of the pre-stress, cut into the regimes that ruptures end in by exact theory."""

from itertools import product

import numpy as np
import pandas as pd

from ..model.prestress import Prestress
from ..predict.final_regime import final_regime, largest_pulse_ratio
from ..theory.rupture import Rupture

NEEDS = {"settings": ["model.damping_ratio", "model.release", "measure.still"]}

GAMMAS = {"displacement": 1.0, "stress": 0.0}
# Levels on the positive side along the border between crack and pulse, to where the negative one is beyond -1.
BORDER = np.linspace(0.0, 0.15, 31)[1:]
# Boundary, and levels on the left and on the right, of the velocity profiles; their time and points.
PROFILES = (
    ("displacement", 0.5, 0.5), ("displacement", -0.5, 0.5), ("stress", 0.3, 0.3), ("stress", -0.5, 0.0)
)  # fmt: skip
TIME, POINTS = 12.0, 241


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Boundary, series, regime, left, right; role area (series: its number; its corners in order), line (the ends of a
    line on which one level is 0 and the other negative) and profile (time, x, slip_velocity, at W = 1).
    """
    still, model = settings["measure"]["still"], settings["model"]
    rules = model["damping_ratio"], model["release"]
    low = -BORDER / largest_pulse_ratio(BORDER, *rules, still)
    border = np.vstack([[(0.0, 0.0)], np.column_stack([low, BORDER]), [(low[-1], 0.0)]])
    line = np.array([(-1.0, 0.0), (0.0, 0.0)])
    # Corners, and levels inside, by boundary; on the right as on the left.
    outlines: list[tuple[str, str, np.ndarray, np.ndarray]] = []
    for boundary, gamma in GAMMAS.items():
        for levels in np.array([*product((-1.0, 1.0), repeat=2)]):
            corners = np.where([(0, 0), (1, 0), (1, 1), (0, 1)], levels, 0.0)
            outlines.append(("area", boundary, corners, 0.5 * levels))
        for sides in ([0, 1], [1, 0]):
            if gamma == 0.0:
                outlines.append(("area", boundary, border[:, sides], np.array([-0.9, 1e-3])[sides]))
            outlines.append(("line", boundary, line[:, sides], 0.5 * line[0, sides]))
    parts: list[pd.DataFrame] = []
    for role, boundary, corners, (left, right) in outlines:
        regime = final_regime(left, right, GAMMAS[boundary], *rules, still)
        labels = {"role": role, "boundary": boundary, "series": len(parts), "regime": regime}
        parts.append(pd.DataFrame(corners, columns=["left", "right"]).assign(**labels))
    for boundary, left, right in PROFILES:
        rupture = Rupture(Prestress(left, right), GAMMAS[boundary], *rules, TIME)
        x = np.linspace(*rupture.fronts_at(TIME), POINTS)
        found = pd.DataFrame({"x": x, "slip_velocity": rupture.slip_velocity(x, TIME)})
        regime = final_regime(left, right, GAMMAS[boundary], *rules, still)
        labels = {"role": "profile", "boundary": boundary, "series": len(parts), "regime": regime}
        parts.append(found.assign(time=TIME, left=left, right=right, **labels))
    return pd.concat(parts, ignore_index=True)
