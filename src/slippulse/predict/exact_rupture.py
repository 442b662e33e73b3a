"""A finished run against the exact solution of its scene: both at the same positions and times."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import pandas as pd
import xarray as xr

from ..model.prestress import Prestress
from ..model.scene import scene_of
from ..theory.rupture import Rupture

# Positions that are compared, between these fractions of the two fronts' ways: a front that stops does so sharply.
POSITIONS, FRACTIONS = 41, (0.8, 0.9)
# Time after the release and before the stick that belongs to the layers at both edges.
LAYER = 0.4


def exact_rupture(run: xr.Dataset | Mapping) -> Rupture:
    """The exact solution of a run's scene, as `scene_of` takes it."""
    scene = scene_of(run)
    return _rupture(scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration)


@lru_cache(maxsize=64)
def _rupture(prestress: Prestress, gamma: float, ratio: float, release: str, duration: float) -> Rupture:
    return Rupture(prestress, gamma, ratio, release, duration)


def compared_positions(rupture: Rupture) -> np.ndarray:
    """Evenly between fractions of the ways of the outermost fronts."""
    ends = rupture.front_ends
    stops = ends[0][0].reason == "stops"
    left = ends[0][0].x * (FRACTIONS[0] if stops or rupture.gamma == 0.0 else FRACTIONS[1])
    return np.linspace(left, ends[-1][1].x * FRACTIONS[1], POSITIONS)


def differences(run: xr.Dataset, rupture: Rupture) -> pd.DataFrame:
    """How far a run is from the exact solution, in the mean.

    Parameters
    ----------
    run : with fronts, fields and samples
    rupture : the exact solution of its scene

    Returns
    -------
    DataFrame of quantity (release, stick, slip, velocity), difference (mean of |run - exact| over the mean of |exact|)
    and places (how many points); a quantity that the scene does not have is left out
    """
    rows = []
    for quantity, found, exact in (*_edges(run, rupture), _velocity(run, rupture)):
        known = np.isfinite(found) & np.isfinite(exact)
        if known.any():
            found, exact = found[known], exact[known]
            mean = float(np.mean(np.abs(found - exact)) / np.mean(np.abs(exact)))
            rows.append({"quantity": quantity, "difference": mean, "places": int(known.sum())})
    return pd.DataFrame(rows)


def _edges(run: xr.Dataset, rupture: Rupture) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Release, stick and slip at the end, at fixed positions."""
    x = compared_positions(rupture)
    blocks, duration = run["x"].values, rupture.duration
    exact = rupture.stick_time(x)
    exact[exact > duration - LAYER] = np.nan
    return [
        ("release", np.interp(x, blocks, run["release_time"].values), rupture.release_time(x)),
        ("stick", np.interp(x, blocks, run["stick_time"].values), exact),
        ("slip", np.interp(x, blocks, run["slip"].values), rupture.slip(x, duration)),
    ]


def _velocity(run: xr.Dataset, rupture: Rupture) -> tuple[str, np.ndarray, np.ndarray]:
    """Slip velocity at the sampled points that slide, away from both edges."""
    x, times = run["sample_position"].values, run["sample_time"].values
    inside = np.flatnonzero((x >= compared_positions(rupture)[0]) & (x <= compared_positions(rupture)[-1]))
    x = x[inside]
    release, stick = rupture.release_time(x), rupture.stick_time(x)
    stick = np.where(np.isfinite(stick), stick, np.inf)
    sliding = (times[:, None] > release + LAYER) & (times[:, None] < stick - LAYER)
    found = np.where(sliding, run["sample_velocity"].values[:, inside], np.nan)
    row, column = np.nonzero(sliding)
    exact = np.full(found.shape, np.nan)
    exact[row, column] = rupture.slip_velocity(x[column], times[row])
    return "velocity", found.ravel(), exact.ravel()
