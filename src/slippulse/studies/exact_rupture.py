"""Whole ruptures, exact and on lattices: edges, slip, a map of slip velocity, and how their difference falls."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import point
from ..predict.exact_rupture import differences, exact_rupture
from ..theory.rupture import Rupture

NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

CURVE_POINTS, MARKS = 201, 41
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
        rows += [differences(run, rupture).assign(role="difference", dx=run.attrs["dx"]) for run in runs]
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
