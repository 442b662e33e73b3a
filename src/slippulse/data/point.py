"""Take one run out of the Dataset of a sweep."""

from itertools import islice

import xarray as xr

from ..model.checks import check_number, check_that
from .points import over_points, runs_in


def point(sweep: xr.Dataset, index: int = 0) -> xr.Dataset:
    """Take one run out of a sweep, in the form in which `simulate` returns a run.

    Parameters
    ----------
    sweep : xarray.Dataset
        A sweep from `run_sweep` or from a file in ``results/data``, or a selection of its runs,
        such as ``sweep.sel(gamma=0.3)``.
    index : int
        Number of the run in it, from 0.

    Returns
    -------
    xarray.Dataset
        The fields that were recorded, as functions of x. Single numbers are attributes.

    Raises
    ------
    ValueError
        If ``sweep`` is not a sweep, has no run of this number, or has the wrong number of blocks.

    Examples
    --------
    >>> run = sp.point(xarray.open_dataset("results/data/arrest.nc"), 0)
    """
    is_dataset = isinstance(sweep, xr.Dataset)
    is_sweep = is_dataset and ("point" in sweep.sizes or "run_flags" in sweep.variables)
    check_that(
        is_sweep, "sweep", sweep, "a Dataset that run_sweep returned, or one of results/data"
    )
    sweep = over_points(sweep)
    check_number("index", index, integer=True, at_least=0, at_most=sweep.sizes["point"] - 1)
    return next(islice(runs_in(sweep), index, None)).dataset()
