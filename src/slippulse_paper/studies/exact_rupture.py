"""Compare ruptures on lattices with the exact solution in space and time.

The compared quantities are release time, stick time, slip and slip velocity.
"""

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.point import point
from slippulse.model.scene import Scene
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.theory.rupture import Rupture

from .outermost_fronts import outermost_fronts

NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

# The map shows one scene. Curves and markers show two, since no point sticks in the third one.
SCENE_OF_MAP = "exact_displacement"
SCENES_OF_CURVES = ("exact_displacement", "exact_asymmetric")
# Number of points of each exact curve, and approximate number of markers of each lattice.
CURVE_POINTS = 201
MARKER_COUNT = 41
# Lattices and exact solution are compared at this number of positions. They lie within a fraction
# of the path of each front, which is smaller for a front that stops, because it stops abruptly.
POSITION_COUNT = 41
STOPPING_FRONT_FRACTION = 0.8
RUNNING_FRONT_FRACTION = 0.9
# Velocities are not compared within this time after a release and before a stick, where a lattice
# does not resolve them.
EDGE_LAYER_TIME = 0.4
# The map and the markers show the run whose spacing is nearest to this one.
SHOWN_SPACING = 0.04
# Variables of a run, by the name of the compared quantity.
VARIABLES = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
PARAMETERS = ["boundary", "left", "right", "gamma", "damping_ratio", "dx"]
# Values by the name of the compared quantity, one for each position.
Values = dict[str, np.ndarray]


def table(data: dict[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of the parts of the figure. The column ``role`` has these values:

    scene : parameters of the lattice that is shown, one row for each scene
    exact, lattice : release time, stick time and slip, by exact theory and on the lattice
    map_exact, map_lattice : slip velocity by time and position, for one scene
    difference : mean differences between each lattice and the exact solution
    """
    tables_by_scene = []
    for name in NEEDS["data"]:
        # All runs of a simulation are the same scene at several spacings.
        runs = [point(data[name], index) for index in range(data[name].sizes["point"])]
        tables_by_scene.append(_table_of_scene(name, runs).assign(scene=name))
    return pd.concat(tables_by_scene, ignore_index=True)


def _table_of_scene(name: str, runs: list[xr.Dataset]) -> pd.DataFrame:
    """Return the rows of one scene, from its runs on lattices with several spacings."""
    rupture = exact_rupture(Scene.from_attributes(runs[0].attrs))
    # The run whose spacing is nearest to SHOWN_SPACING, on a logarithmic scale.
    shown_run = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN_SPACING)))
    parts = [pd.DataFrame([shown_run.attrs])[PARAMETERS].assign(role="scene")]
    if name in SCENES_OF_CURVES:
        parts += [_exact_curves(rupture), _lattice_markers(shown_run)]
    if name == SCENE_OF_MAP:
        parts += _velocity_map(shown_run, rupture)
    x = _compared_positions(rupture)
    exact_values = _exact_values(rupture, x)
    # A stick near the end of the run is not compared, because on a lattice it may come later.
    is_near_end = exact_values["stick"] > rupture.duration - EDGE_LAYER_TIME
    exact_values["stick"][is_near_end] = np.nan
    parts += [_differences(run, rupture, x, exact_values) for run in runs]
    return pd.concat(parts)


def _exact_curves(rupture: Rupture) -> pd.DataFrame:
    """Return exact release time, stick time and slip at positions between the two fronts."""
    left_end, right_end = outermost_fronts(rupture)
    x = np.linspace(left_end.x, right_end.x, CURVE_POINTS)[1:-1]
    return pd.DataFrame({"role": "exact", "position": x} | _exact_values(rupture, x))


def _lattice_markers(run: xr.Dataset) -> pd.DataFrame:
    """Return release time, stick time and slip of some of the released blocks of a run."""
    released = np.flatnonzero(np.isfinite(run["release_time"].values))
    stride = max(1, released.size // MARKER_COUNT)
    blocks = run.isel(x=released[::stride])
    markers = {"position": blocks["x"].values}
    for quantity, variable in VARIABLES.items():
        markers[quantity] = blocks[variable].values
    return pd.DataFrame(markers).assign(role="lattice")


def _compared_positions(rupture: Rupture) -> np.ndarray:
    """Return the positions at which lattices are compared with the exact solution.

    The positions cover a fraction of the path of the left front and of that of the right front. The
    fraction is smaller for a front that stops, because it stops abruptly.
    """
    left_end, right_end = outermost_fronts(rupture)
    left_fraction = RUNNING_FRONT_FRACTION
    # Without leaf springs the left front does not stop, but it becomes very slow.
    if left_end.reason == "stops" or rupture.gamma == 0.0:
        left_fraction = STOPPING_FRONT_FRACTION
    first, last = left_end.x * left_fraction, right_end.x * RUNNING_FRONT_FRACTION
    return np.linspace(first, last, POSITION_COUNT)


def _exact_values(rupture: Rupture, x: np.ndarray) -> Values:
    """Return the exact release time, stick time and slip at the end, at some positions."""
    return {
        "release": rupture.release_time(x),
        "stick": rupture.stick_time(x),
        "slip": rupture.slip(x, rupture.duration),
    }


def _velocity_map(run: xr.Dataset, rupture: Rupture) -> list[pd.DataFrame]:
    """Return slip velocities of sliding points, as two tables by time and position.

    The table for x <= 0 comes from the exact solution, and that for x >= 0 from a lattice run.
    """
    x, times = run["sample_position"].values, run["sample_time"].values
    # Both halves include x = 0, whose sample may be off by a rounding error.
    left_x, right_x = x[x < 1e-9], x[x > -1e-9]
    exact = rupture.map(times, left_x, ("slip_velocity",))["slip_velocity"]
    on_lattice = run["sample_velocity"].sel(sample_position=right_x).values
    parts = []
    for source, half, velocity in (("exact", left_x, exact), ("lattice", right_x, on_lattice)):
        grid = xr.DataArray(velocity, [("time", times), ("position", half)], name="slip_velocity")
        # Rounded numbers make the file of this large table smaller.
        rows = grid.to_series().reset_index().round({"slip_velocity": 5, "position": 9})
        is_sliding = rows["slip_velocity"] > 0.0
        parts.append(rows[is_sliding].assign(role=f"map_{source}"))
    return parts


def _differences(
    run: xr.Dataset, rupture: Rupture, x: np.ndarray, exact_values: Values
) -> pd.DataFrame:
    """Return the mean difference between a run and the exact solution, one row per quantity.

    The difference is divided by the mean of the exact values. The column places has the number of
    compared values.

    x, exact_values : positions, and exact values there of all quantities except slip velocity.
        Slip velocity is compared at the samples of the run between the first and last position.
    """
    pairs: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    for quantity, variable in VARIABLES.items():
        on_lattice = np.interp(x, run["x"].values, run[variable].values)
        pairs[quantity] = on_lattice, exact_values[quantity]
    pairs["velocity"] = _sliding_velocities(run, rupture, x[0], x[-1])
    rows = []
    for quantity, (on_lattice, exact) in pairs.items():
        is_known = np.isfinite(on_lattice) & np.isfinite(exact)
        if is_known.any():
            difference = np.mean(np.abs(on_lattice[is_known] - exact[is_known]))
            relative = float(difference / np.mean(np.abs(exact[is_known])))
            count = int(is_known.sum())
            rows.append({"quantity": quantity, "difference": relative, "places": count})
    return pd.DataFrame(rows).assign(role="difference", dx=run.attrs["dx"])


def _sliding_velocities(
    run: xr.Dataset, rupture: Rupture, first: float, last: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return slip velocities on the lattice, and the exact ones at the same positions and times.

    The velocities are all samples of the run between the positions ``first`` and ``last`` that
    slide, except those within EDGE_LAYER_TIME of a release or a stick, which a lattice does not
    resolve.
    """
    positions, times = run["sample_position"].values, run["sample_time"].values
    columns = np.flatnonzero((positions >= first) & (positions <= last))
    x = positions[columns]
    release = rupture.release_time(x)
    # A point that never sticks slides until the end.
    stick = np.nan_to_num(rupture.stick_time(x), nan=np.inf)
    # The arrays below have one row for each time and one column for each position.
    sample_times = times[:, np.newaxis]
    is_after_release = sample_times > release + EDGE_LAYER_TIME
    is_before_stick = sample_times < stick - EDGE_LAYER_TIME
    time_index, x_index = np.nonzero(is_after_release & is_before_stick)
    on_lattice = run["sample_velocity"].values[time_index, columns[x_index]]
    return on_lattice, rupture.slip_velocity(x[x_index], times[time_index])
