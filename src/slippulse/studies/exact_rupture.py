"""Whole ruptures, exact and on lattices: edges, slip, a map of slip velocity, and how their difference falls."""

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
# What is compared of a run, by its name there.
EDGES = {"release": "release_time", "stick": "stick_time", "slip": "slip"}


def table(data: dict[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Scene and role: scene (boundary, left, right, gamma, damping_ratio), exact and lattice (position, release, stick,
    slip), map_exact and map_lattice (time, position, slip_velocity > 0), difference (quantity, dx, difference in the
    mean over the mean, places: how many it is over).
    """
    parts = []
    for name in NEEDS["data"]:
        runs = [point(data[name], index) for index in range(data[name].sizes["point"])]
        rupture = exact_rupture(runs[0].attrs)
        shown = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN)))
        kinds = ("boundary", "left", "right", "gamma", "damping_ratio", "dx")
        rows = [pd.DataFrame([{key: shown.attrs[key] for key in kinds}]).assign(role="scene")]
        left, right = rupture.front_ends[0][0].x, rupture.front_ends[-1][1].x
        if name != NEEDS["data"][-1]:
            x = np.linspace(left, right, CURVE_POINTS)[1:-1]
            rows.append(pd.DataFrame({"role": "exact", "position": x} | _exact(rupture, x)))
            released = np.flatnonzero(np.isfinite(shown["release_time"].values))
            kept = shown.isel(x=released[:: max(1, released.size // MARKS)])
            marks = {key: kept[of].values for key, of in ({"position": "x"} | EDGES).items()}
            rows.append(pd.DataFrame(marks).assign(role="lattice"))
        if name == NEEDS["data"][0]:
            rows += _map(shown, rupture)
        stops = rupture.front_ends[0][0].reason == "stops" or rupture.gamma == 0.0
        x = np.linspace(left * FRACTIONS[0 if stops else 1], right * FRACTIONS[1], POSITIONS)
        known = _exact(rupture, x)
        known["stick"][known["stick"] > rupture.duration - LAYER] = np.nan
        rows += [_differences(run, rupture, x, known) for run in runs]
        parts.append(pd.concat(rows).assign(scene=name))
    return pd.concat(parts, ignore_index=True)


def _exact(rupture: Rupture, x: np.ndarray) -> dict[str, np.ndarray]:
    edges = {"release": rupture.release_time(x), "stick": rupture.stick_time(x)}
    return edges | {"slip": rupture.slip(x, rupture.duration)}


def _map(run: xr.Dataset, rupture: Rupture) -> list[pd.DataFrame]:
    """The lattice's samples right of the middle and the exact solution left of it, where they slide."""
    x, times = run["sample_position"].values, run["sample_time"].values
    left, right = x[x < 1e-9], x[x > -1e-9]
    exact = rupture.map(times, left, ("slip_velocity",))["slip_velocity"]
    lattice = run["sample_velocity"].sel(sample_position=right).values
    parts = []
    for source, half, velocity in (("exact", left, exact), ("lattice", right, lattice)):
        grid = xr.DataArray(velocity, [("time", times), ("position", half)], name="slip_velocity")
        rows = grid.to_series().reset_index().round({"slip_velocity": 5, "position": 9})
        parts.append(rows[rows["slip_velocity"] > 0.0].assign(role=f"map_{source}"))
    return parts


def _differences(
    run: xr.Dataset, rupture: Rupture, x: np.ndarray, exact: dict[str, np.ndarray]
) -> pd.DataFrame:
    """How far a run is from the exact solution of its scene, in each quantity that it has."""
    found = {name: np.interp(x, run["x"].values, run[of].values) for name, of in EDGES.items()}
    # Slip velocity at the sampled points that slide, away from both edges.
    sampled, times = run["sample_position"].values, run["sample_time"].values
    inside = np.flatnonzero((sampled >= x[0]) & (sampled <= x[-1]))
    x = sampled[inside]
    release, stick = rupture.release_time(x), np.nan_to_num(rupture.stick_time(x), nan=np.inf)
    row, column = np.nonzero((times[:, None] > release + LAYER) & (times[:, None] < stick - LAYER))
    found["velocity"] = run["sample_velocity"].values[row, inside[column]]
    known = exact | {"velocity": rupture.slip_velocity(x[column], times[row])}
    rows = []
    for quantity in found:
        both = np.isfinite(found[quantity]) & np.isfinite(known[quantity])
        if both.any():
            expected = known[quantity][both]
            mean = float(
                np.mean(np.abs(found[quantity][both] - expected)) / np.mean(np.abs(expected))
            )
            rows.append({"quantity": quantity, "difference": mean, "places": int(both.sum())})
    return pd.DataFrame(rows).assign(role="difference", dx=run.attrs["dx"])
