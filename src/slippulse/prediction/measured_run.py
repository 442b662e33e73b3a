"""The public way from a run to its numbers."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import over_points, runs_in
from ..data.sweep_views import is_sweep
from ..measurement.transition import first_stick
from ..model.checks import check_that
from ..model.layer_units import layer_of
from ..model.prestress import prestress_from
from ..model.scene import check_run_attributes
from ..theory.prestress_pieces import nucleations
from .comparison import measured_row

# The settings of `measure` in the shipped configuration, which is not part of the package.
SETTINGS: dict[str, Any] = {
    "share": 0.95,
    "front_window": 0.3,
    "steady_tolerance": 0.02,
    "trailing_times": [5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
    "still": 0.05,
}


# Numbers that are distances between the two fronts of one rupture.
LENGTHS = ("transition_length", "slip_length_background", "slip_length_nucleation")


def measure(run: xr.Dataset) -> Any:
    """Measure a run, or every run of a sweep: T_trans, L_trans, speeds, the pulse and flags.

    The numbers are those of `results/measurements`, by the settings of the shipped configuration.
    In addition they have T_trans and L_trans of displacement boundaries with different levels.

    Parameters
    ----------
    run : xarray.Dataset
        A run of a lattice or of the exact solution, which `simulate` returned or `point` took out
        of a sweep, or which `Layer.to_si` converted; or a sweep, a selection of its runs or a grid
        of them, with "fronts" recorded. With `Samples` at two positions or more the regime is
        classified as well.

    Returns
    -------
    dict of str to float or str, or pandas.DataFrame
        Of a sweep, a table with one row for each run. Numbers by the names in docs/columns.md, in
        units of H and of H over the wave speed, or in SI units if the run is (then without
        ``trailing_edge_*``, whose names have times), among them ``transition_time`` and
        ``transition_length`` (T_trans and L_trans; if one is NaN, ``transition_reason`` says why),
        ``front_speed_left`` and ``front_speed_right``,
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
    T_trans is the first stick, and L_trans the distance between both fronts then; under a stress
    boundary the left front has then covered 95 % of ``|x_minus|``.

    Examples
    --------
    >>> layer = sp.Prestress(left=0.5, right=0.5)
    >>> scene = sp.Scene("displacement", layer, duration=8.0, dx=0.05, gamma=0.65)
    >>> numbers = sp.measure(sp.simulate(scene))
    >>> round(numbers["transition_time"], 1), numbers["run_flags"]
    (3.8, '')
    >>> sweep = sp.sweep(boundary="displacement", gamma=[0.5, 1.0], left=0.5, dx=0.05, duration=8.0)
    >>> sp.measure(sweep)[["gamma", "transition_time"]].round(1).to_numpy().tolist()
    [[0.5, 4.4], [1.0, 3.1]]
    """
    check_that(isinstance(run, xr.Dataset), "run", run, "a Dataset that simulate returned")
    if "point" in run.dims or "run_flags" in run.variables:
        run = over_points(run)
        check_that(is_sweep(run), "run", run, "a run, or a sweep with its parameters")
        known = {"release_time", "stick_time"} <= set(run)
        check_that(known, "run", run, "a sweep that was recorded with 'fronts'")
        rows = [_measured(one.dataset()) for one in runs_in(run)]
        numbers = run["point"].values if "point" in run.variables else None
        return pd.DataFrame(rows, index=numbers).rename_axis("point")
    return _measured(run)


def _measured(run: xr.Dataset) -> dict[str, Any]:
    known = {"release_time", "stick_time"} <= set(run) and "point" not in run.dims
    check_that(known, "run", run, "a Dataset that simulate returned")
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
    row = unknown | measured_row(run, SETTINGS | settings)
    profile = prestress_from(run.attrs)
    held = run.attrs["boundary"] == "displacement"
    if held and max(profile.left, profile.right) > 0.0 and profile.left != profile.right:
        row |= first_stick(run)
    if several := len(nucleations(profile)) > 1:
        row |= {name: math.nan for name in LENGTHS if name in row}
    return row | {"transition_reason": _reason(row, several)}


def _reason(row: Mapping[str, Any], several: bool) -> str:
    """Return why T_trans or L_trans is NaN; empty if both are numbers."""
    time, length = row["transition_time"], row["transition_length"]
    if math.isfinite(time) and math.isfinite(length):
        return ""
    if row["boundary"] == "stress":
        if "transition_state" not in row:
            return "under a stress boundary the paper defines it for left < 0 and right = 0 alone"
        if math.isnan(time):
            return f"the left front did not cover {SETTINGS['share']:.0%} of |x_minus|"
    elif max(row["left"], row["right"]) <= 0.0:
        return "both levels are 0 or negative, where no pulse runs on"
    elif math.isnan(time):
        return "no block stuck before the end"
    if several:
        return "several nucleations: no two fronts bound one rupture"
    return "the fronts are not known at that time"


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
