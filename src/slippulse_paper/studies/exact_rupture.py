"""Whole ruptures, exact and on lattices: edges, slip, slip velocity, and their differences."""

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.point import point
from slippulse.model.scene import Scene
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.rupture import Rupture

NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

CURVE_POINTS, MARKS = 201, 41
# Positions are compared between these fractions of the ways of the left and the right front. A
# front that stops does so sharply, so that less of its way is compared.
POSITIONS = 41
STOPPING, RUNNING = 0.8, 0.9
# Time after the release and before the stick that belongs to the layers at both edges.
NEAR_EDGES = 0.4
# The map and the marks are of the run that is nearest this spacing.
SHOWN = 0.04
# Variables of a run, by the name of what is compared.
COLUMNS = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
PARAMETERS = ["boundary", "left", "right", "gamma", "damping_ratio", "dx"]


def table(data: dict[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Roles scene, exact and lattice (edges), map_exact and map_lattice, and difference."""
    parts = []
    for name in NEEDS["data"]:
        runs = [point(data[name], index) for index in range(data[name].sizes["point"])]
        rupture = exact_rupture(Scene.from_attributes(runs[0].attrs))
        shown = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN)))
        rows = [pd.DataFrame([shown.attrs])[PARAMETERS].assign(role="scene")]
        left, right = rupture.front_ends[0][0], rupture.front_ends[-1][1]
        if name != NEEDS["data"][-1]:
            # Edges and slip: curves, and marks of the lattice.
            x = np.linspace(left.x, right.x, CURVE_POINTS)[1:-1]
            rows.append(pd.DataFrame({"role": "exact", "position": x} | _exact(rupture, x)))
            released = np.flatnonzero(np.isfinite(shown["release_time"].values))
            kept = shown.isel(x=released[:: max(1, released.size // MARKS)])
            marks = {column: kept[variable].values for column, variable in COLUMNS.items()}
            marks = {"position": kept["x"].values} | marks
            rows.append(pd.DataFrame(marks).assign(role="lattice"))
        if name == NEEDS["data"][0]:
            rows += _map(shown, rupture)
        stops = left.reason == "stops" or rupture.gamma == 0.0
        fraction = STOPPING if stops else RUNNING
        x = np.linspace(left.x * fraction, right.x * RUNNING, POSITIONS)
        known = _exact(rupture, x)
        known["stick"][known["stick"] > rupture.duration - NEAR_EDGES] = np.nan
        rows += [_differences(run, rupture, x, known) for run in runs]
        parts.append(pd.concat(rows).assign(scene=name))
    return pd.concat(parts, ignore_index=True)


def _exact(rupture: Rupture, x: np.ndarray) -> dict[str, np.ndarray]:
    edges = {"release": rupture.release_time(x), "stick": rupture.stick_time(x)}
    return edges | {"slip": rupture.slip(x, rupture.duration)}


def _map(run: xr.Dataset, rupture: Rupture) -> list[pd.DataFrame]:
    """The exact solution left of the middle and a lattice right of it, where they slide."""
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
    """Differences of a run from the exact solution of its scene, in each quantity that it has."""
    blocks = run["x"].values
    lattice = {name: np.interp(x, blocks, run[column].values) for name, column in COLUMNS.items()}
    # Slip velocity is compared at the sampled points that slide, away from both edges.
    sampled, times = run["sample_position"].values, run["sample_time"].values
    inside = np.flatnonzero((sampled >= x[0]) & (sampled <= x[-1]))
    x = sampled[inside]
    release, stick = rupture.release_time(x), np.nan_to_num(rupture.stick_time(x), nan=np.inf)
    row, column = np.nonzero(
        (times[:, None] > release + NEAR_EDGES) & (times[:, None] < stick - NEAR_EDGES)
    )
    lattice["velocity"] = run["sample_velocity"].values[row, inside[column]]
    known = exact | {"velocity": rupture.slip_velocity(x[column], times[row])}
    rows = []
    for quantity in lattice:
        both = np.isfinite(lattice[quantity]) & np.isfinite(known[quantity])
        if both.any():
            expected = known[quantity][both]
            error = np.mean(np.abs(lattice[quantity][both] - expected))
            mean = float(error / np.mean(np.abs(expected)))
            rows.append({"quantity": quantity, "difference": mean, "places": int(both.sum())})
    return pd.DataFrame(rows).assign(role="difference", dx=run.attrs["dx"])
