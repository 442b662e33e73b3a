"""A finished run against the exact solution of its scene: both at the same positions and times."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from ..model.scene import scene_of
from ..theory.rupture import Rupture

# Positions that are compared, between these fractions of the two fronts' ways: a front that stops does so sharply.
POSITIONS, FRACTIONS = 41, (0.8, 0.9)
# Time after the release and before the stick that belongs to the layers at both edges.
LAYER = 0.4


def exact_rupture(run: xr.Dataset | Mapping) -> Rupture:
    """The exact solution of a run's scene, as `scene_of` takes it."""
    scene = scene_of(run)
    return Rupture(
        scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration,
        rate_strengthening=scene.rate_strengthening,
    )  # fmt: skip


def compared_positions(rupture: Rupture) -> np.ndarray:
    """Evenly between fractions of the ways of the outermost fronts."""
    ends = rupture.front_ends
    stops = ends[0][0].reason == "stops"
    left = ends[0][0].x * (FRACTIONS[0] if stops or rupture.gamma == 0.0 else FRACTIONS[1])
    return np.linspace(left, ends[-1][1].x * FRACTIONS[1], POSITIONS)


def differences(run: xr.Dataset, rupture: Rupture) -> pd.DataFrame:
    """How far a run is from the exact solution of its scene, in the mean.

    Parameters
    ----------
    run : with fronts, fields and samples
    rupture : the exact solution

    Returns
    -------
    DataFrame of quantity (release, stick, slip, velocity), difference (mean of |run - exact| over the mean of |exact|)
    and places (how many points); a quantity that the scene does not have is left out
    """
    x, blocks, duration = compared_positions(rupture), run["x"].values, rupture.duration
    stick = rupture.stick_time(x)
    exact = {
        "release": rupture.release_time(x),
        "stick": np.where(stick > duration - LAYER, np.nan, stick),
        "slip": rupture.slip(x, duration),
    }
    names = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
    pairs = {name: (np.interp(x, blocks, run[names[name]].values), exact[name]) for name in names}
    rows = []
    for quantity, (found, known) in (pairs | {"velocity": _velocity(run, rupture, x[[0, -1]])}).items():
        both = np.isfinite(found) & np.isfinite(known)
        if both.any():
            mean = float(np.mean(np.abs(found[both] - known[both])) / np.mean(np.abs(known[both])))
            rows.append({"quantity": quantity, "difference": mean, "places": int(both.sum())})
    return pd.DataFrame(rows)


def _velocity(run: xr.Dataset, rupture: Rupture, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slip velocity at the sampled points that slide, away from both edges."""
    x, times = run["sample_position"].values, run["sample_time"].values
    inside = np.flatnonzero((x >= ends[0]) & (x <= ends[1]))
    x = x[inside]
    release, stick = rupture.release_time(x), rupture.stick_time(x)
    stick = np.where(np.isfinite(stick), stick, np.inf)
    row, column = np.nonzero((times[:, None] > release + LAYER) & (times[:, None] < stick - LAYER))
    return run["sample_velocity"].values[row, inside[column]], rupture.slip_velocity(x[column], times[row])
