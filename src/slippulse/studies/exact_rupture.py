"""Whole ruptures, exact and on lattices: edges, slip, a map of slip velocity, and how their difference falls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import point
from ..predict.exact_rupture import exact_rupture
from ..theory.rupture import Rupture

NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

CURVE_POINTS, MARKS = 201, 41
# Positions that are compared, between these fractions of the two fronts' ways: a front that stops does so sharply.
POSITIONS, FRACTIONS = 41, (0.8, 0.9)
# Time after the release and before the stick that belongs to the layers at both edges.
LAYER = 0.4
# The map and the marks are of the run that is nearest this spacing.
SHOWN = 0.04


def table(data: Mapping[str, xr.Dataset], tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Exact curves, marks of a lattice, two halves of a map, and the differences.

    Returns
    -------
    DataFrame of scene and role: scene (boundary, left, right, gamma, damping_ratio), exact and lattice (position,
    release, stick, slip), map_exact and map_lattice (time, position, slip_velocity > 0), difference (quantity, dx,
    difference in the mean over the mean, places: how many it is over)
    """
    parts = []
    for name in NEEDS["data"]:
        runs = [point(data[name], index) for index in range(data[name].sizes["point"])]
        rupture = exact_rupture(runs[0].attrs)
        shown = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN)))
        kinds = ("boundary", "left", "right", "gamma", "damping_ratio", "dx")
        rows = [pd.DataFrame([{key: shown.attrs[key] for key in kinds}]).assign(role="scene")]
        if name != NEEDS["data"][-1]:
            rows += [_exact_edges(rupture), _lattice_edges(shown)]
        if name == NEEDS["data"][0]:
            rows += _map(shown, rupture)
        rows += [_differences(run, rupture).assign(role="difference", dx=run.attrs["dx"]) for run in runs]
        parts.append(pd.concat(rows).assign(scene=name))
    return pd.concat(parts, ignore_index=True)


def _exact_edges(rupture: Rupture) -> pd.DataFrame:
    ends = rupture.front_ends
    x = np.linspace(ends[0][0].x, ends[-1][1].x, CURVE_POINTS)[1:-1]
    values = {"release": rupture.release_time(x), "stick": rupture.stick_time(x)}
    values["slip"] = rupture.slip(x, rupture.duration)
    return pd.DataFrame({"role": "exact", "position": x} | values)


def _lattice_edges(run: xr.Dataset) -> pd.DataFrame:
    released = np.flatnonzero(np.isfinite(run["release_time"].values))
    kept = run.isel(x=released[:: max(1, released.size // MARKS)])
    columns = {"position": "x", "release": "release_time", "stick": "stick_time", "slip": "slip"}
    return pd.DataFrame({name: kept[of].values for name, of in columns.items()}).assign(role="lattice")


def _map(run: xr.Dataset, rupture: Rupture) -> list[pd.DataFrame]:
    """The lattice's samples right of the middle and the exact solution left of it, where they slide."""
    x, times = run["sample_position"].values, run["sample_time"].values
    left, right = x[x < 1e-9], x[x > -1e-9]
    exact = rupture.map(times, left, ("slip_velocity",))["slip_velocity"]
    lattice = run["sample_velocity"].sel(sample_position=right).values
    parts = []
    for source, half, velocity in (("exact", left, exact), ("lattice", right, lattice)):
        time, position = np.meshgrid(times, half, indexing="ij")
        values = {"time": time.ravel(), "position": position.ravel(), "slip_velocity": velocity.ravel()}
        rows = pd.DataFrame(values).round({"slip_velocity": 5, "position": 9})
        parts.append(rows[rows["slip_velocity"] > 0.0].assign(role=f"map_{source}"))
    return parts


def _differences(run: xr.Dataset, rupture: Rupture) -> pd.DataFrame:
    """How far a run is from the exact solution of its scene; a quantity that the scene does not have is left out."""
    ends, blocks, duration = rupture.front_ends, run["x"].values, rupture.duration
    stops = ends[0][0].reason == "stops" or rupture.gamma == 0.0
    x = np.linspace(ends[0][0].x * FRACTIONS[0 if stops else 1], ends[-1][1].x * FRACTIONS[1], POSITIONS)
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
