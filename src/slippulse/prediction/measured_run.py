"""The public way from a run to its numbers."""

import math
from typing import Any

import numpy as np
import xarray as xr

from ..model.checks import check_that
from ..model.layer_units import layer_of
from ..model.scene import check_run_attributes
from .comparison import measured_row

# The settings of `measure` in the shipped configuration, which is not part of the package.
SETTINGS: dict[str, Any] = {
    "share": 0.95,
    "front_window": 0.3,
    "steady_tolerance": 0.02,
    "trailing_times": [5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
    "still": 0.05,
}


def measure(run: xr.Dataset) -> dict[str, Any]:
    """Measure one run: T_trans, L_trans, front speeds, the leading pulse and flags.

    The numbers are those of `results/measurements`, by the settings of the shipped configuration.

    Parameters
    ----------
    run : xarray.Dataset
        A run of a lattice or of the exact solution, which `simulate` returned or `point` took out
        of a sweep, or which `Layer.to_si` converted. With `Samples` at two positions or more its
        regime is classified as well.

    Returns
    -------
    dict of str to float or str
        Numbers by the names in docs/columns.md, in units of H and of H over the wave speed, or in
        SI units if the run is (then without ``trailing_edge_*``, whose names have times), among
        them ``transition_time`` and ``transition_length`` (T_trans and L_trans; NaN where the paper
        defines none, or before they are reached), ``front_speed_left`` and ``front_speed_right``,
        ``pulse_width``, ``pulse_slip`` and ``pulse_peak_velocity`` of the leading pulse on the
        right at the end, ``pulse_state`` (steady, or several, stopped, ... : what was measured),
        ``run_flags`` ("" or a comma-separated list), and the parameters of the scene. A number
        whose data were not recorded is not in it.

    Raises
    ------
    ValueError
        If `run` is not such a Dataset, or has not all of its blocks.

    Notes
    -----
    Source: sections III B and III C of the paper for the transition. Under a displacement boundary
    T_trans is the first stick; under a stress boundary the left front has then covered 95 % of
    ``|x_minus|``.

    Examples
    --------
    >>> layer = sp.Prestress(left=0.5, right=0.5)
    >>> scene = sp.Scene("displacement", layer, duration=8.0, dx=0.05, gamma=0.65)
    >>> numbers = sp.measure(sp.simulate(scene))
    >>> round(numbers["transition_time"], 1), numbers["run_flags"]
    (4.2, '')
    """
    known = isinstance(run, xr.Dataset) and {"release_time", "stick_time"} <= set(run)
    check_that(known, "run", run, "a Dataset that simulate returned")
    allowed = "one run; point(sweep, index) takes it out of a sweep"
    check_that("point" not in run.dims, "run", run, allowed)
    layer = layer_of(run.attrs)
    if layer is not None:
        return layer.numbers_to_si(_numbers(layer.from_si(run), {"trailing_times": []}))
    return _numbers(run, {})


def _numbers(run: xr.Dataset, settings: dict[str, Any]) -> dict[str, Any]:
    """Return the measured numbers of a run in the units of the model."""
    check_run_attributes(run.attrs)
    allowed = "a whole run, without blocks cut off or left out along x"
    check_that(_whole(run), "run", run, allowed)
    unknown = dict.fromkeys(("transition_time", "transition_length"), math.nan)
    return unknown | measured_row(run, SETTINGS | settings)


def _whole(run: xr.Dataset) -> bool:
    """True if the blocks stand at equal spacing, all released ones between two at rest."""
    x, released = run["x"].values, np.isfinite(run["release_time"].values)
    if x.size < 2 or released[0] or released[-1]:
        return False
    # A mirrored lattice counts releases on one side.
    side = x >= 0.0 if run.attrs["half_lattice_used"] else True
    first_releases = run.attrs["releases"] - run.attrs["re_releases"]
    equal = np.allclose(np.diff(x), run.attrs["dx"], rtol=1e-6, atol=0.0)
    return equal and np.count_nonzero(released & side) == first_releases
