"""Measure a run, or all runs of a sweep: the public function `measure`."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..data.points import over_points, runs_in
from ..data.sweep_views import is_sweep
from ..measurement.nucleation import positions_from_zero, seen_from_nucleation
from ..measurement.transition import first_stick
from ..model.checks import check_that
from ..model.layer_units import layer_of
from ..model.prestress import prestress_from
from ..model.scene import check_run_attributes
from ..theory.prestress_pieces import nucleation_intervals
from .comparison import measured_row

# The settings under ``measure`` in config/config.yaml. They are repeated here, because that file is
# not part of the library.
MEASURE_SETTINGS: dict[str, Any] = {
    "fraction": 0.95,
    "front_window": 0.3,
    "steady_tolerance": 0.02,
    "trailing_times": [5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
    "still": 0.05,
}


# Measured numbers that are distances between the two fronts of a rupture.
RUPTURE_LENGTHS = ("transition_length", "slip_length_background", "slip_length_nucleation")


def measure(run: xr.Dataset) -> Any:
    """Measure a run, or every run of a sweep: T_trans, L_trans, front speeds, pulse and flags.

    The numbers are the same as in `results/measurements`, with the settings of the shipped
    configuration. In addition, under a displacement boundary T_trans and L_trans are also measured
    if the pre-stress levels on the two sides differ.

    Parameters
    ----------
    run : xarray.Dataset
        A run from `simulate` (of a lattice or of the exact solution), `point` or `Layer.to_si`. Or
        a sweep that was recorded with "fronts", a selection of its runs, or a grid from `as_grid`.
        The regime is classified if the run has `Samples` at two or more positions.

    Returns
    -------
    dict of str to float or str, or pandas.DataFrame
        The numbers of a run by name, or for a sweep a table with one row for each run.
        docs/columns.md explains all names. Units are H and H divided by the wave speed, or SI units
        if the run is in SI units (then without ``trailing_edge_*``, whose names contain times).
        A number whose data were not recorded is left out. The main numbers are

        - ``transition_time`` and ``transition_length``: T_trans and L_trans; if one is NaN,
          ``transition_reason`` says why;
        - ``front_speed_left`` and ``front_speed_right``;
        - ``pulse_width``, ``pulse_slip`` and ``pulse_peak_velocity`` of the leading pulse on the
          right at the end, and its ``pulse_state`` (steady, unsteady, several, stopped, ...);
        - ``run_flags``: empty text, or a comma-separated list;
        - the parameters of the scene.

    Raises
    ------
    ValueError
        If `run` is not such a Dataset, or if some of its blocks are missing.

    Notes
    -----
    Source: sections III B and III C of the paper for the transition. Under a displacement boundary
    T_trans is the time of the first stick. Under a stress boundary it is the time at which the left
    front has covered 95 % of ``|x_minus|``. L_trans is the distance between both fronts at T_trans.
    If the rupture starts at one place that is not x = 0, "left" and "right" are the sides of this
    place, and ``|x_minus|`` is the distance from it.

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
        check_that(is_sweep(run), "run", run, "a run, or a sweep that contains its parameters")
        has_fronts = {"release_time", "stick_time"} <= set(run)
        check_that(has_fronts, "run", run, "a sweep that was recorded with 'fronts'")
        rows = [_measure_run(recorded.dataset()) for recorded in runs_in(run)]
        run_numbers = run["point"].values if "point" in run.variables else None
        return pd.DataFrame(rows, index=run_numbers).rename_axis("point")
    return _measure_run(run)


def _measure_run(run: xr.Dataset) -> dict[str, Any]:
    """Return the measured numbers of one run, in SI units if the run is in SI units."""
    is_run = {"release_time", "stick_time"} <= set(run) and "point" not in run.dims
    check_that(is_run, "run", run, "a Dataset that simulate returned")
    layer = layer_of(run.attrs)
    if layer is None:
        return _measure_in_model_units(run)
    # The names of the numbers ``trailing_edge_*`` contain times, which would be those of the model.
    # So these numbers are left out.
    numbers = _measure_in_model_units(layer.from_si(run), trailing_times=[])
    return layer.numbers_to_si(numbers)


def _measure_in_model_units(run: xr.Dataset, **settings: Any) -> dict[str, Any]:
    """Return the measured numbers of a run that is in the units of the model.

    settings : settings that differ from MEASURE_SETTINGS
    """
    check_run_attributes(run.attrs)
    allowed = "a run from which no block was removed along x"
    check_that(_has_all_blocks(run), "run", run, allowed)
    no_transition = dict.fromkeys(("transition_time", "transition_length"), math.nan)
    numbers = no_transition | measured_row(run, MEASURE_SETTINGS | settings)
    profile = prestress_from(run.attrs)
    is_held = run.attrs["boundary"] == "displacement"
    if is_held and max(profile.left, profile.right) > 0.0 and profile.left != profile.right:
        # The paper defines no transition if the two levels differ. `measure` takes the first stick,
        # which is the transition at equal levels.
        moved_run = seen_from_nucleation(run)
        numbers |= positions_from_zero(first_stick(moved_run), moved_run)
    has_several_nucleations = len(nucleation_intervals(profile)) > 1
    if has_several_nucleations:
        # The two outermost fronts then belong to different ruptures.
        numbers |= {name: math.nan for name in RUPTURE_LENGTHS if name in numbers}
    reason = _explain_missing_transition(numbers, has_several_nucleations)
    return numbers | {"transition_reason": reason}


def _explain_missing_transition(numbers: Mapping[str, Any], has_several_nucleations: bool) -> str:
    """Return the reason why T_trans or L_trans is NaN; empty text if neither is.

    numbers are the measured numbers of a run.
    """
    time, length = numbers["transition_time"], numbers["transition_length"]
    if math.isfinite(time) and math.isfinite(length):
        return ""
    if numbers["boundary"] == "stress":
        if "transition_state" not in numbers:
            return (
                "under a stress boundary the paper defines the transition only for left < 0 and"
                " right = 0, without steps, and with a balance position"
            )
        if math.isnan(time):
            fraction = MEASURE_SETTINGS["fraction"]
            return f"the left front did not cover {fraction:.0%} of the way to the balance position"
    elif max(numbers["left"], numbers["right"]) <= 0.0:
        return "both levels of the pre-stress are 0 or negative, so that no pulse keeps running"
    elif math.isnan(time):
        return "no block stuck before the end of the run"
    if has_several_nucleations:
        return "several nucleations: the two outermost fronts do not belong to one rupture"
    return "the positions of the fronts at the transition time are not known"


def _has_all_blocks(run: xr.Dataset) -> bool:
    """Return True if no block of a run is missing.

    The blocks must have equal distances. The first and the last one must never have been released,
    since a lattice is longer than its rupture. The number of released blocks must be the number
    that the simulation has recorded.
    """
    x, is_released = run["x"].values, np.isfinite(run["release_time"].values)
    if x.size < 2 or is_released[0] or is_released[-1]:
        return False
    # If half of the lattice was simulated, the recorded numbers of releases are those of that half.
    is_counted = x >= 0.0 if run.attrs["half_lattice_used"] else True
    # A block may be released again, but release_time has only its first release.
    first_releases = run.attrs["releases"] - run.attrs["re_releases"]
    has_equal_spacing = np.allclose(np.diff(x), run.attrs["dx"], rtol=1e-6, atol=0.0)
    return has_equal_spacing and np.count_nonzero(is_released & is_counted) == first_releases
