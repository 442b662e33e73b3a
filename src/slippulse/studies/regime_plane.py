"""The planes of both levels of the pre-stress, cut into the regimes that ruptures end in by exact theory."""

from __future__ import annotations

from collections.abc import Mapping
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
# Boundary, levels on the left and on the right, and time of the velocity profiles; their points.
PROFILES = (
    ("displacement", 0.5, 0.5, 12.0),
    ("displacement", -0.5, 0.5, 12.0),
    ("stress", 0.3, 0.3, 12.0),
    ("stress", -0.5, 0.0, 12.0),
)
POINTS = 241


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Outlines of the regimes, and slip velocity over position in some of them.

    Returns
    -------
    boundary, series, regime, left, right; role area (series: its number; its corners in order), line (the ends of a
    line on which one level is 0 and the other negative) and profile (time, x, slip_velocity: of one pre-stress, W = 1)

    Source: `final_regime`, `Rupture`.
    """
    measure, model = settings["measure"], settings["model"]
    rules = model["damping_ratio"], model["release"]
    parts: list[pd.DataFrame] = []

    def add(role: str, boundary: str, corners: np.ndarray, inside: tuple[float, float]) -> None:
        regime = final_regime(*inside, GAMMAS[boundary], *rules, measure["still"])
        rows = pd.DataFrame(corners, columns=["left", "right"])
        parts.append(rows.assign(role=role, boundary=boundary, series=len(parts), regime=regime))

    for boundary, gamma in GAMMAS.items():
        for left, right in product((-1.0, 1.0), repeat=2):
            add(
                "area",
                boundary,
                np.array([(0, 0), (left, 0), (left, right), (0, right)]),
                (left / 2, right / 2),
            )
        for sides in ((0, 1), (1, 0)):
            if gamma == 0.0:
                low = -BORDER / largest_pulse_ratio(BORDER, *rules, measure["still"])
                border = np.vstack([[(0.0, 0.0)], np.column_stack([low, BORDER]), [(low[-1], 0.0)]])
                add("area", boundary, border[:, sides], tuple(np.array([-0.9, 1e-3])[[*sides]]))
            line = np.array([(-1.0, 0.0), (0.0, 0.0)])[:, sides]
            add("line", boundary, line, tuple(line[0] / 2))
    for boundary, left, right, time in PROFILES:
        rupture = Rupture(Prestress(left, right), GAMMAS[boundary], *rules, time)
        fronts = rupture.fronts_at(time)
        x = np.linspace(*fronts, POINTS)
        found = pd.DataFrame({"x": x, "slip_velocity": rupture.slip_velocity(x, time)})
        regime = final_regime(left, right, GAMMAS[boundary], *rules, measure["still"])
        labels = {"boundary": boundary, "series": len(parts), "regime": regime, "left": left, "right": right}
        parts.append(found.assign(role="profile", time=time, **labels))
    return pd.concat(parts, ignore_index=True)
