"""Compare whole ruptures on lattices with the exact solution: edges, slip and slip velocity."""

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.point import point
from slippulse.model.scene import Scene
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.rupture import Rupture

NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

CURVE_POINTS = 201
MARK_COUNT = 41
# Positions are compared up to these fractions of the paths of the left and the right front. A front
# that stops does so abruptly, so a smaller fraction of its path is compared.
POSITION_COUNT = 41
STOPPING_FRONT_FRACTION = 0.8
RUNNING_FRONT_FRACTION = 0.9
# Velocities are not compared within this time after a release and before a stick.
EDGE_LAYER_TIME = 0.4
# The map and the markers show the run whose spacing is nearest to this one.
SHOWN_SPACING = 0.04
# Variables of a run, by the name of the compared quantity.
COLUMNS = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
PARAMETERS = ["boundary", "left", "right", "gamma", "damping_ratio", "dx"]


def table(data: dict[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Return the roles scene, exact and lattice (edges), map_exact, map_lattice and difference."""
    first_name, *_, last_name = NEEDS["data"]
    parts = []
    for name in NEEDS["data"]:
        # All runs of a simulation are the same scene at several spacings.
        runs = [point(data[name], index) for index in range(data[name].sizes["point"])]
        rupture = exact_rupture(Scene.from_attributes(runs[0].attrs))
        shown = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN_SPACING)))
        rows = [pd.DataFrame([shown.attrs])[PARAMETERS].assign(role="scene")]
        if name != last_name:
            rows += [_exact_curves(rupture), _lattice_markers(shown)]
        if name == first_name:
            rows += _map(shown, rupture)
        x = _compared_positions(rupture)
        exact = _exact(rupture, x)
        # Near the end of the run a lattice may not have stuck yet.
        exact["stick"][exact["stick"] > rupture.duration - EDGE_LAYER_TIME] = np.nan
        rows += [_differences(run, rupture, x, exact) for run in runs]
        parts.append(pd.concat(rows).assign(scene=name))
    return pd.concat(parts, ignore_index=True)


def _exact_curves(rupture: Rupture) -> pd.DataFrame:
    """Return edges and slip of the exact solution at points between the ends of both fronts."""
    left_end, right_end = rupture.front_ends[0][0], rupture.front_ends[-1][1]
    x = np.linspace(left_end.x, right_end.x, CURVE_POINTS)[1:-1]
    return pd.DataFrame({"role": "exact", "position": x} | _exact(rupture, x))


def _lattice_markers(run: xr.Dataset) -> pd.DataFrame:
    """Return edges and slip of a lattice run at some of its released blocks."""
    released = np.flatnonzero(np.isfinite(run["release_time"].values))
    stride = max(1, released.size // MARK_COUNT)
    blocks = run.isel(x=released[::stride])
    markers = {"position": blocks["x"].values}
    for quantity, variable in COLUMNS.items():
        markers[quantity] = blocks[variable].values
    return pd.DataFrame(markers).assign(role="lattice")


def _compared_positions(rupture: Rupture) -> np.ndarray:
    """Return positions at which lattices are compared with the exact solution."""
    left_end, right_end = rupture.front_ends[0][0], rupture.front_ends[-1][1]
    left_stops = left_end.reason == "stops" or rupture.gamma == 0.0
    left_fraction = STOPPING_FRONT_FRACTION if left_stops else RUNNING_FRONT_FRACTION
    first, last = left_end.x * left_fraction, right_end.x * RUNNING_FRONT_FRACTION
    return np.linspace(first, last, POSITION_COUNT)


def _exact(rupture: Rupture, x: np.ndarray) -> dict[str, np.ndarray]:
    """Return the release time, the stick time and the slip at the end, at some positions."""
    edges = {"release": rupture.release_time(x), "stick": rupture.stick_time(x)}
    return edges | {"slip": rupture.slip(x, rupture.duration)}


def _map(run: xr.Dataset, rupture: Rupture) -> list[pd.DataFrame]:
    """Return slip velocities of sliding points: exact on the left half, a lattice on the right."""
    x, times = run["sample_position"].values, run["sample_time"].values
    # Both halves include x = 0.
    left, right = x[x < 1e-9], x[x > -1e-9]
    exact = rupture.map(times, left, ("slip_velocity",))["slip_velocity"]
    lattice = run["sample_velocity"].sel(sample_position=right).values
    parts = []
    for source, half, velocity in (("exact", left, exact), ("lattice", right, lattice)):
        grid = xr.DataArray(velocity, [("time", times), ("position", half)], name="slip_velocity")
        rows = grid.to_series().reset_index().round({"slip_velocity": 5, "position": 9})
        is_sliding = rows["slip_velocity"] > 0.0
        parts.append(rows[is_sliding].assign(role=f"map_{source}"))
    return parts


def _differences(
    run: xr.Dataset, rupture: Rupture, x: np.ndarray, exact: dict[str, np.ndarray]
) -> pd.DataFrame:
    """Return the mean difference between a run and the exact solution, one row per quantity.

    Release time, stick time and slip are compared at the positions ``x``, at which ``exact`` has
    the exact values. Slip velocity is compared at the samples of the run between these positions.
    The mean is relative to the mean exact value.
    """
    pairs: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for quantity, variable in COLUMNS.items():
        on_lattice = np.interp(x, run["x"].values, run[variable].values)
        pairs[quantity] = on_lattice, exact[quantity]
    pairs["velocity"] = _sliding_velocities(run, rupture, x[0], x[-1])
    rows = []
    for quantity, (lattice_values, exact_values) in pairs.items():
        is_known = np.isfinite(lattice_values) & np.isfinite(exact_values)
        if is_known.any():
            difference = np.mean(np.abs(lattice_values[is_known] - exact_values[is_known]))
            relative = float(difference / np.mean(np.abs(exact_values[is_known])))
            count = int(is_known.sum())
            rows.append({"quantity": quantity, "difference": relative, "places": count})
    return pd.DataFrame(rows).assign(role="difference", dx=run.attrs["dx"])


def _sliding_velocities(
    run: xr.Dataset, rupture: Rupture, first: float, last: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return slip velocities on the lattice and exact ones, at samples that slide.

    The samples lie between the positions ``first`` and ``last``, and at least EDGE_LAYER_TIME away
    from both edges of the rupture.
    """
    positions, times = run["sample_position"].values, run["sample_time"].values
    inside = np.flatnonzero((positions >= first) & (positions <= last))
    x = positions[inside]
    release = rupture.release_time(x)
    # A point that never sticks slides until the end.
    stick = np.nan_to_num(rupture.stick_time(x), nan=np.inf)
    sample_times = times[:, np.newaxis]
    after_release = sample_times > release + EDGE_LAYER_TIME
    before_stick = sample_times < stick - EDGE_LAYER_TIME
    time_index, x_index = np.nonzero(after_release & before_stick)
    on_lattice = run["sample_velocity"].values[time_index, inside[x_index]]
    return on_lattice, rupture.slip_velocity(x[x_index], times[time_index])
