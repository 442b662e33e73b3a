"""Tabulate exact front speeds as functions of the pre-stress, the leaf springs and the spacing."""

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

# A line of speed against pre-stress has the pre-stress for each of these speeds. It is faster to
# compute than the speed for a given pre-stress.
SPEEDS = 1.0 + np.geomspace(1e-3, 299.0, 60)
# Values of gamma dx^2, denser where the speed falls and the lines end.
SPRING_STIFFNESSES = np.concatenate([np.geomspace(3e-3, 0.3, 8), np.geomspace(0.34, 6.0, 34)])
# Number of points of a line of speed against spacing, without those of the runs.
SPACING_COUNT = 33
# Condition for runs that have such a line: one level, and a small beta. At a larger beta the pulse
# would be as narrow as the damped layer at its front.
HAS_LINE_BY_SPACING = "left == 0.5 and beta <= 0.1"
# Columns that name such a line. What is fixed along it, "b" or "beta", is in the column held, and
# its value is in the column fixed.
LINE_COLUMNS = ["release", "left", "gamma", "held", "fixed"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the points of theoretical lines in four panels. The column ``panel`` has these values:

    prestress : front speed as a function of the pre-stress
    springs : front speed as a function of gamma dx^2
    refined : front speed as a function of dx, with either beta or b = beta/dx fixed
    limit : front speed in the limit dx -> 0 at fixed beta

    There is a line for each combination of the other parameters in the simulated sweeps.
    """
    # One table for each sweep, with the parameters of its runs.
    tables_by_sweep = {
        name: pd.DataFrame(parameters(sweep)) for name, sweep in settings["sweeps"].items()
    }
    # While dx varies along a line, either b = beta/dx or beta is fixed. The column held names
    # the fixed parameter, and the column fixed has its value.
    at_fixed_ratio = tables_by_sweep["continuum_fixed_ratio"]
    runs_by_spacing = [at_fixed_ratio.assign(held="b", fixed=at_fixed_ratio["damping_ratio"])]
    for name in ("continuum_fixed_beta", "front_speed_fixed_beta"):
        at_fixed_beta = tables_by_sweep[name]
        runs_by_spacing.append(at_fixed_beta.assign(held="beta", fixed=at_fixed_beta["beta"]))
    parts = [
        *prestress_lines(tables_by_sweep["front_speed"]),
        *spring_lines(tables_by_sweep["front_speed_springs"]),
        # This has the rows of two panels, refined and limit.
        lines_by_spacing(pd.concat(runs_by_spacing)),
    ]
    return pd.concat(parts, ignore_index=True)


def prestress_lines(runs: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Yield front speeds as functions of the pre-stress, by release rule and damping ratio."""
    for release, damping_ratio in runs[["release", "damping_ratio"]].drop_duplicates().values:
        line = {
            "left": prestress_for_speed(SPEEDS, damping_ratio, release),
            "speed": SPEEDS,
            "panel": "prestress",
            "release": release,
            "damping_ratio": damping_ratio,
        }
        yield pd.DataFrame(line)


def spring_lines(runs: pd.DataFrame) -> Iterator[pd.DataFrame]:
    """Yield front speeds as functions of gamma dx^2, by level and damping ratio.

    The figure shows leaf springs under the total release rule only.
    """
    for level, damping_ratio in runs[["left", "damping_ratio"]].drop_duplicates().values:
        # The speed depends on gamma and dx only through gamma dx^2, so dx = 1 is enough.
        speeds = [
            _speed(level, gamma=stiffness, dx=1.0, damping_ratio=damping_ratio, release="total")
            for stiffness in SPRING_STIFFNESSES
        ]
        line = {
            "panel": "springs",
            "release": "total",
            "left": level,
            "damping_ratio": damping_ratio,
            "springs": SPRING_STIFFNESSES,
            "speed": speeds,
        }
        yield pd.DataFrame(line)


def lines_by_spacing(runs: pd.DataFrame) -> pd.DataFrame:
    """Return front speeds as functions of the spacing dx, and their limits dx -> 0.

    There is a line of speeds for each combination of values in LINE_COLUMNS. While dx varies along
    a line, a parameter is fixed. The column held has its name, "beta" or "b" (for beta/dx), and the
    column fixed has its value.

    runs : parameters of simulated runs, one row for each run
    """
    rows = []
    # There are lines for the level 0.5 only. At a large beta there is none, because the pulse would
    # be as narrow as the damped layer at its front.
    for line_values, spacings in runs.query(HAS_LINE_BY_SPACING).groupby(LINE_COLUMNS)["dx"]:
        line = dict(zip(LINE_COLUMNS, line_values, strict=True))
        level, gamma, release = line["left"], line["gamma"], line["release"]
        beta_is_fixed = line["held"] == "beta"
        # Under the total rule there is no limit at fixed beta.
        if beta_is_fixed and release == "elastic":
            limit = continuum_front_speed(level, gamma, beta=line["fixed"])
            rows.append(line | {"panel": "limit", "speed": limit})
        # The points are evenly spaced in the logarithm of dx, and those of the runs are added.
        even_spacings = np.geomspace(spacings.min(), spacings.max(), SPACING_COUNT)
        for dx in np.union1d(even_spacings, spacings):
            damping_ratio = line["fixed"] / dx if beta_is_fixed else line["fixed"]
            speed = _speed(level, gamma, dx, damping_ratio, release)
            row = {"panel": "refined", "dx": dx, "damping_ratio": damping_ratio, "speed": speed}
            rows.append(line | row)
    return pd.DataFrame(rows)


def _speed(level: float, gamma: float, dx: float, damping_ratio: float, release: str) -> float:
    """Return the front speed on a lattice; NaN if no front is faster than the waves."""
    return value_or_nan(lambda: lattice_front_speed(level, gamma, dx, damping_ratio, release))
