"""Convert sweeps to the forms that users of xarray expect.

`with_parameters` makes the parameters of the runs coordinates, so that runs can be selected by
them. `as_grid` makes the parameters the axes of a grid, if there is a run for each combination.
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from ..model.checks import check_that
from ..model.scene import ATTRIBUTES
from .parameter_index import ParameterIndex, distinct_combinations, independent_parameters
from .variables import VARIABLES

# Attribute of a sweep that names the parameters of which `sweep` was given lists.
AXES_ATTRIBUTE = "sweep_axes"
ALLOWED_SWEEP = "a Dataset that run_sweep or open_sweep returned"


def with_parameters(sweep: xr.Dataset) -> xr.Dataset:
    """Return a sweep with its parameters as coordinates along the dimension ``point``.

    The result also has the coordinate ``row_start``, the number of the first block of each run.
    This number is needed to find the blocks of a run after a selection of runs. A selection that
    was written to a file by ``to_netcdf`` already has it, and the numbers ``point`` of its runs.
    """
    if "point" not in sweep.variables:
        attributes = {"units": "1", "long_name": VARIABLES["point"]}
        sweep = sweep.assign_coords(point=("point", np.arange(sweep.sizes["point"]), attributes))
    parameters = [name for name in ATTRIBUTES if name in sweep]
    coordinates = list(parameters)
    if "row_size" in sweep:
        if "row_start" not in sweep.variables:
            sizes = sweep["row_size"].values
            # Each run begins where the previous one ends.
            starts = np.cumsum(sizes) - sizes
            attributes = {"units": "1", "long_name": VARIABLES["row_start"]}
            sweep = sweep.assign_coords(row_start=("point", starts, attributes))
        coordinates += ["row_size", "row_start"]
    # One index over all parameters takes the place of the index that xarray makes of `point`.
    sweep = sweep.drop_indexes("point").set_coords(coordinates)
    return sweep.set_xindex(["point", *parameters], ParameterIndex)


def open_sweep(path: str | Path) -> xr.Dataset:
    """Open a data file of a sweep, with its parameters as coordinates.

    Parameters
    ----------
    path : str or Path
        File of ``results/data``, or one to which a sweep of `run_sweep` was written by
        ``to_netcdf``.

    Returns
    -------
    xarray.Dataset
        The sweep in memory, as `run_sweep` returns it: ``sweep.sel(gamma=0.3)`` selects runs.

    Raises
    ------
    ValueError
        If the file does not contain a sweep.
    FileNotFoundError
        If there is no such file.

    Examples
    --------
    >>> sweep = sp.run_sweep([sp.Scene("stress", sp.Prestress(0.6, 0.6), 1.0, 0.1)])
    >>> sweep.to_netcdf("sweep.nc")
    >>> sp.open_sweep("sweep.nc").sel(left=0.6).sizes["point"]
    1
    """
    data = xr.load_dataset(path)
    check_that(is_sweep(data), "path", str(path), "the data file of a sweep, such as results/data")
    return with_parameters(data)


def is_sweep(data: object) -> bool:
    """Return True if a Dataset contains runs along the dimension ``point``."""
    if not isinstance(data, xr.Dataset) or "point" not in data.dims:
        return False
    # Every run has these parameters, and other Datasets are unlikely to have them all.
    return all(name in data.variables for name in ("boundary", "dx", "duration"))


def as_grid(sweep: xr.Dataset, over: Sequence[str] | None = None) -> xr.Dataset:
    """Return a sweep as a grid, whose axes are parameters of the runs.

    Parameters
    ----------
    sweep : xarray.Dataset
        A sweep of `sweep`, `run_sweep` or `open_sweep`, or a selection of its runs.
    over : sequence of str, optional
        Parameters that become axes. By default these are the parameters of which `sweep` was given
        lists. If it was given none, they are all parameters that differ between the runs and do
        not follow from others.

    Returns
    -------
    xarray.Dataset
        Every number of a run, along these axes in place of ``point``. The fields along ``block``
        are unchanged. `point` takes one run out of the grid, and `measure` measures all of them.

    Raises
    ------
    ValueError
        If there is not exactly one run for each combination of the values of the axes.

    Examples
    --------
    >>> runs = sp.sweep(boundary="stress", left=[-0.4, -0.2], right=0.0, width=[1.0, 2.0],
    ...                 duration=2.0, dx=0.1)
    >>> sp.as_grid(runs)["releases"].sel(left=-0.4, width=2.0).item() > 0
    True
    """
    check_that(is_sweep(sweep), "sweep", sweep, ALLOWED_SWEEP)
    names = [over] if isinstance(over, str) else over
    axes = _default_axes(sweep) if names is None else list(names)
    are_parameters = bool(axes) and all(name in sweep.coords for name in axes)
    check_that(are_parameters, "over", axes, "parameters of the sweep, at least one")
    _check_product(sweep, axes)
    # The axes take the place of the dimension `point` and of its index.
    indexed_names = [name for name in sweep.xindexes if "point" in sweep[name].dims]
    without_index = sweep.drop_indexes(indexed_names).drop_vars("point", errors="ignore")
    runs = _with_shared_as_scalars(without_index, axes)
    if len(axes) == 1:
        return runs.swap_dims(point=axes[0]).sortby(axes[0])
    # `unstack` would drop runs with the value NaN, such as the width of no Gaussian. So each value
    # is replaced by its index among the values of the axis until the grid is made.
    axis_coordinates = {}
    for name in axes:
        values, indices = np.unique(runs[name].values, return_inverse=True)
        axis_coordinates[name] = (name, values, runs[name].attrs)
        runs = runs.assign_coords({name: ("point", indices)})
    return runs.set_index(point=axes).unstack("point").assign_coords(axis_coordinates)


def _default_axes(sweep: xr.Dataset) -> list[str]:
    """Return the parameters that had a list of values when the function `sweep` made this sweep.

    If none had a list, return the parameters that differ between the runs.
    """
    listed_names = sweep.attrs.get(AXES_ATTRIBUTE, "").split()
    axes = [name for name in listed_names if name in sweep.coords]
    if axes:
        return axes
    return independent_parameters({name: sweep[name].values for name in sweep.coords})


def _check_product(sweep: xr.Dataset, axes: Sequence[str]) -> None:
    """Raise ValueError unless there is exactly one run for each combination of the axes' values."""
    values = {name: sweep[name].values for name in axes}
    needed_count = math.prod(len(np.unique(values_of_axis)) for values_of_axis in values.values())
    distinct_count = len(distinct_combinations(values, axes))
    run_count = sweep.sizes["point"]
    is_complete = distinct_count == needed_count and run_count == needed_count
    allowed = f"{needed_count}, one for each combination of {', '.join(axes)}"
    check_that(is_complete, "number of runs", run_count, allowed)


def _with_shared_as_scalars(sweep: xr.Dataset, axes: Sequence[str]) -> xr.Dataset:
    """Return a sweep in which each parameter that all runs share is a single value.

    axes : parameters that keep their values along ``point``
    """
    parameters = [name for name in ATTRIBUTES if name in sweep.coords and name not in axes]
    shared = [name for name in parameters if len(np.unique(sweep[name].values)) == 1]
    return sweep.assign_coords({name: sweep[name].variable[0] for name in shared})
