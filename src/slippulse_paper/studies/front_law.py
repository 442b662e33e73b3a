"""Tabulate exact front speeds as functions of pre-stress, leaf springs and spacing."""

from collections.abc import Iterator

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
    """Return the panels prestress, springs (by gamma dx^2), refined (by dx) and limit (dx -> 0).

    A line belongs to a set of parameters of the swept runs.
    """
    swept, springs, fixed_ratio, *fixed_beta = (
        pd.DataFrame(parameters(settings["sweeps"][name])) for name in NEEDS["sweeps"]
    )
    refined = [fixed_ratio.assign(held="b", fixed=fixed_ratio["damping_ratio"])]
    refined += [runs.assign(held="beta", fixed=runs["beta"]) for runs in fixed_beta]
    parts = [*prestress_lines(swept), *spring_lines(springs), refined_lines(pd.concat(refined))]
    return pd.concat(parts, ignore_index=True)


def prestress_lines(swept: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Yield the front speed as a function of the pre-stress, for each release rule and ratio."""
    for release, ratio in swept[["release", "damping_ratio"]].drop_duplicates().values:
        line = {
            "left": prestress_for_speed(SPEEDS, ratio, release),
            "speed": SPEEDS,
            "panel": "prestress",
            "release": release,
            "damping_ratio": ratio,
        }
        yield pd.DataFrame(line)


def spring_lines(springs: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Yield the front speed as a function of gamma dx^2, for each level and damping ratio."""
    for level, ratio in springs[["left", "damping_ratio"]].drop_duplicates().values:
        # Only gamma dx^2 counts, so the lattice has dx = 1.
        speeds = [_speed(level, gamma, 1.0, ratio, "total") for gamma in SPRING_STIFFNESSES]
        line = {
            "panel": "springs",
            "release": "total",
            "left": level,
            "damping_ratio": ratio,
            "springs": SPRING_STIFFNESSES,
            "speed": speeds,
        }
        yield pd.DataFrame(line)


def refined_lines(runs: pd.DataFrame) -> pd.DataFrame:
    """Return front speeds as functions of the spacing, and their limits dx -> 0.

    Along a line either beta or b = beta/dx is fixed: the column held says which of them, and the
    column fixed has its value.
    """
    rows = []
    for values, spacings in runs.query(REFINED_RUNS).groupby(LINE_COLUMNS)["dx"]:
        line = dict(zip(LINE_COLUMNS, values, strict=True))
        level, gamma = line["left"], line["gamma"]
        if line["held"] == "beta" and line["release"] == "elastic":
            speed = continuum_front_speed(level, gamma, line["fixed"])
            rows.append(line | {"panel": "limit", "speed": speed})
        # The line has even points, and the spacings of the runs.
        even = np.geomspace(spacings.min(), spacings.max(), SPACING_COUNT)
        for dx in np.union1d(even, spacings):
            ratio = line["fixed"] if line["held"] == "b" else line["fixed"] / dx
            speed = _speed(level, gamma, dx, ratio, line["release"])
            row = {"panel": "refined", "dx": dx, "damping_ratio": ratio, "speed": speed}
            rows.append(line | row)
    return pd.DataFrame(rows)


def _speed(level: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    """Return the front speed on a lattice; NaN if no front outruns the waves."""
    return value_or_nan(lambda: lattice_front_speed(level, gamma, dx, ratio, release))
