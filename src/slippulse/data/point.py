"""One run of a sweep as a Dataset."""

from itertools import islice

import xarray as xr

from ..model.checks import check_number, check_that
from .points import over_points, runs_in


def point(sweep: xr.Dataset, index: int = 0) -> xr.Dataset:
    """Take one run out of a sweep, as `simulate` returned it.

    Parameters
    ----------
    sweep : xarray.Dataset
        data of a sweep, from `run_sweep` or from a file of ``results/data``, or a selection of
        its runs such as ``sweep.sel(gamma=0.3)``
    index : int
        number of the run in it, from 0

    Returns
    -------
    xarray.Dataset
        the run over x, with the fields that were recorded; its numbers are attributes

    Raises
    ------
    ValueError
        if ``sweep`` is not a sweep, has no such run, or blocks that are not those of its runs

    Examples
    --------
    >>> run = sp.point(xarray.open_dataset("results/data/arrest.nc"), 0)
    """
    listed = isinstance(sweep, xr.Dataset)
    listed = listed and ("point" in sweep.sizes or "run_flags" in sweep.variables)
    check_that(listed, "sweep", sweep, "a Dataset that run_sweep returned, or of results/data")
    sweep = over_points(sweep)
    check_number("index", index, integer=True, at_least=0, at_most=sweep.sizes["point"] - 1)
    return next(islice(runs_in(sweep), index, None)).dataset()
