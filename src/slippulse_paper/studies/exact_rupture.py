"""Compare whole ruptures on lattices with the exact solution: edges, slip and slip velocity."""

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.point import point
from slippulse.model.scene import Scene
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.rupture import Rupture

NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

CURVE_POINTS, MARK_COUNT = 201, 41
# Positions are compared up to these fractions of the paths of the left and the right front. A front
# that stops does so abruptly, so a smaller fraction of its path is compared.
POSITION_COUNT = 41
STOPPING_FRONT_FRACTION, RUNNING_FRONT_FRACTION = 0.8, 0.9
# Velocities are not compared within this time after a release and before a stick.
EDGE_LAYER_TIME = 0.4
# The map and the markers show the run whose spacing is nearest to this one.
SHOWN_SPACING = 0.04
# Variables of a run, by the name of the compared quantity.
COLUMNS = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
PARAMETERS = ["boundary", "left", "right", "gamma", "damping_ratio", "dx"]


def table(data: dict[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles scene, exact and lattice (edges), map_exact, map_lattice and difference."""
    parts = []
    for name in NEEDS["data"]:
        runs = [point(data[name], index) for index in range(data[name].sizes["point"])]
        rupture = exact_rupture(Scene.from_attributes(runs[0].attrs))
        shown = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN_SPACING)))
        rows = [pd.DataFrame([shown.attrs])[PARAMETERS].assign(role="scene")]
        left, right = rupture.front_ends[0][0], rupture.front_ends[-1][1]
        if name != NEEDS["data"][-1]:
            # Edges and slip: curves of the exact solution, and markers of the lattice.
            x = np.linspace(left.x, right.x, CURVE_POINTS)[1:-1]
            rows.append(pd.DataFrame({"role": "exact", "position": x} | _exact(rupture, x)))
            released = np.flatnonzero(np.isfinite(shown["release_time"].values))
            kept = shown.isel(x=released[:: max(1, released.size // MARK_COUNT)])
            marks = {column: kept[variable].values for column, variable in COLUMNS.items()}
            marks = {"position": kept["x"].values} | marks
            rows.append(pd.DataFrame(marks).assign(role="lattice"))
        if name == NEEDS["data"][0]:
            rows += _map(shown, rupture)
        stops = left.reason == "stops" or rupture.gamma == 0.0
        fraction = STOPPING_FRONT_FRACTION if stops else RUNNING_FRONT_FRACTION
        x = np.linspace(left.x * fraction, right.x * RUNNING_FRONT_FRACTION, POSITION_COUNT)
        known = _exact(rupture, x)
        known["stick"][known["stick"] > rupture.duration - EDGE_LAYER_TIME] = np.nan
        rows += [_differences(run, rupture, x, known) for run in runs]
        parts.append(pd.concat(rows).assign(scene=name))
    return pd.concat(parts, ignore_index=True)


def _exact(rupture: Rupture, x: np.ndarray) -> dict[str, np.ndarray]:
    edges = {"release": rupture.release_time(x), "stick": rupture.stick_time(x)}
    return edges | {"slip": rupture.slip(x, rupture.duration)}


def _map(run: xr.Dataset, rupture: Rupture) -> list[pd.DataFrame]:
    """Return slip velocities of sliding points: exact on the left half, a lattice on the right."""
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
    """Return the differences between a run and the exact solution, for each quantity."""
    blocks = run["x"].values
    lattice = {name: np.interp(x, blocks, run[column].values) for name, column in COLUMNS.items()}
    # Slip velocity is compared at sampled points that slide and are away from both edges.
    sampled, times = run["sample_position"].values, run["sample_time"].values
    inside = np.flatnonzero((sampled >= x[0]) & (sampled <= x[-1]))
    x = sampled[inside]
    release, stick = rupture.release_time(x), np.nan_to_num(rupture.stick_time(x), nan=np.inf)
    row, column = np.nonzero(
        (times[:, None] > release + EDGE_LAYER_TIME) & (times[:, None] < stick - EDGE_LAYER_TIME)
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
