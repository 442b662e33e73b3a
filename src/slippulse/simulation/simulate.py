"""Simulation of one scene (`simulate`), or of a sweep of many (`run_sweep`).

Each scene names the scheme that solves it. Both functions check their arguments, solve, and return
a Dataset with the flags of each run.
"""

import os
from collections.abc import Callable, Sequence

import xarray as xr

from ..data.sweep_views import with_parameters
from ..data.variables import with_descriptions
from ..model.checks import check_kind, check_number, check_that
from ..model.cost import bound_cost
from ..model.samples import RECORD_GROUPS, Samples
from ..model.scene import Scene
from ..solver.compile_notice import announced_compilation
from ..solver.fixed_step import solve_by_scheme
from ..solver.solution import Solution
from .continuum import solve_exactly
from .flags import MAX_ENERGY_RESIDUAL
from .progress_bar import make_bar
from .sweep import recorded, solve_sweep


class UnresolvedRun(RuntimeError):
    """Raised by `simulate` if it is strict and the numbers of a run are not those of the model."""


def simulate(
    scene: Scene,
    samples: Samples | None = None,
    progress: Callable[[float], None] | bool | None = None,
    strict: bool = False,
) -> xr.Dataset:
    """Simulate one scene.

    Parameters
    ----------
    scene : Scene
    samples : Samples, optional
    progress : callable or bool, optional
        A function that is called with the fraction of the duration done. True draws a bar with the
        time that is left.
    strict : bool
        Raise UnresolvedRun instead of returning a flagged run.

    Returns
    -------
    xarray.Dataset
        The variables have the dimension x: prestress, release_time, stick_time, and slip,
        slip_velocity and slip_acceleration at the end. The attributes are every parameter of the
        scene, counters, the energy balance, run_flags ("" or names separated by commas) and
        versions.

    Raises
    ------
    ValueError
        If an argument has another type, or if a sample is later than the end. Also if the run may
        take days, or more memory than a small machine has; `run_sweep` accepts any cost.
    UnstableRun
        If slip velocity is not finite, or is larger than the pre-stress can drive.
    UnresolvedRun
        If the run is flagged and ``strict`` is true.

    Examples
    --------
    >>> slip = sp.simulate(sp.Scene("stress", sp.Prestress(0.6, 0.6), 5.0, dx=0.05)).slip
    """
    check_kind("scene", scene, Scene)
    is_valid = isinstance(progress, bool | None) or callable(progress)
    check_that(is_valid, "progress", progress, "a function of the fraction done, True, or None")
    check_kind("strict", strict, bool)
    _check_sample_times(samples, scene.duration)
    # The message is empty if the run is not too long and does not need too much memory.
    message = bound_cost(scene, samples).exceeded(
        remedy="use run_sweep, which has no limit of cost"
    )
    # The exact solution itself refuses scenes that are too large, and names the key.
    if message and scene.scheme != "continuum":
        raise ValueError(message)
    if isinstance(progress, bool):
        progress = make_bar() if progress else None
    with announced_compilation():
        solution = _solve(scene, samples, progress)
    # The Dataset also contains the flags of the run, and the units and names of its variables.
    run = with_descriptions(recorded(scene, samples, solution).dataset())
    if strict and run.attrs["run_flags"]:
        details = _flag_details(scene, run.attrs)
        raise UnresolvedRun(f"the run is flagged: {run.attrs['run_flags']}{details}")
    return run


def _flag_details(scene: Scene, numbers: dict) -> str:
    """Return the numbers on which the flags of a run depend, as text in parentheses.

    numbers : the attributes of the run
    """
    if scene.scheme == "continuum":
        return f" ({numbers['limit_reason']})" if numbers["limit_reason"] else ""
    return (
        f" (lowest stress of a block at rest: {numbers['min_stuck_stress']:.4g}, needed: above"
        f" {scene.reverse_threshold:.4g}; blocks in the narrowest pulse:"
        f" {numbers['pulse_blocks']}, needed: {scene.resolved_blocks}; smallest slip velocity:"
        f" {numbers['min_velocity']:.3g}; relative energy error:"
        f" {numbers['energy_residual']:.2g}, allowed: {MAX_ENERGY_RESIDUAL:g})"
    )


def run_sweep(
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None] | None = None,
    record: Sequence[str] = ("fronts",),
    threads: int | None = None,
    progress: Callable[[float, int], None] | bool | None = None,
) -> xr.Dataset:
    """Simulate scenes in a pool of threads.

    Parameters
    ----------
    scenes : sequence of Scene
        One for each point of the sweep. Either all or none have the scheme "continuum".
    samples : sequence of Samples, optional
        One for each scene, all with the same numbers of times and positions.
    record : sequence of {"fronts", "fields", "samples"}
        Groups of results to keep. "fronts" are release and stick times. "fields" are slip, slip
        velocity and acceleration at the end. "samples" are the recorded samples.
    threads : int, optional
        Number of scenes that are solved at a time, from 1 to 1024. The default is the number of
        cores that this process may use. The result does not depend on it.
    progress : callable or bool, optional
        A function that is called with (number done, number of scenes) after each scene. For a
        single scene, it is called with the fraction done and 1 during the run. True draws a bar
        with the time that is left.

    Returns
    -------
    xarray.Dataset
        Numbers have the dimension ``point``, with one value for each run. The parameters are
        coordinates: ``sel`` selects runs by any of them, and `as_grid` turns them into axes if
        there is a run for each combination. Fields have the dimension ``block``, along which the
        runs follow one another: the ``row_size`` blocks of a run begin at ``row_start``. Samples
        have the dimensions (point, time, position).

    Raises
    ------
    ValueError
        If an argument is invalid. The message names the argument and what is allowed.

    Examples
    --------
    >>> profile = sp.Prestress(0.6, 0.6)
    >>> sweep = sp.run_sweep([sp.Scene("stress", profile, 5.0, dx) for dx in (0.1, 0.05)])
    >>> sweep.sel(dx=0.05)["releases"].sizes["point"]
    1
    """
    _check_scenes(scenes)
    samples = [None] * len(scenes) if samples is None else samples
    is_valid = isinstance(samples, Sequence) and len(samples) == len(scenes)
    allowed = f"a list of {len(scenes)} Samples, one for each scene, or None"
    check_that(is_valid, "samples", samples, allowed)
    for scene, samples_of_scene in zip(scenes, samples, strict=True):
        _check_sample_times(samples_of_scene, scene.duration)
    _check_record(record, samples)
    threads = _usable_cores() if threads is None else threads
    check_number("threads", threads, integer=True, at_least=1, at_most=1024)
    is_valid = isinstance(progress, bool | None) or callable(progress)
    check_that(is_valid, "progress", progress, "a function of (runs done, all runs), True, or None")
    if isinstance(progress, bool):
        progress = make_bar(len(scenes)) if progress else None
    with announced_compilation():
        data = solve_sweep(_solve, scenes, samples, record, int(threads), progress)
    return with_parameters(with_descriptions(data))


def _check_scenes(scenes: Sequence[Scene]) -> None:
    """Raise ValueError unless the argument is a list of Scenes that can be solved together."""
    is_list = isinstance(scenes, Sequence) and len(scenes) > 0
    is_valid = is_list and all(isinstance(scene, Scene) for scene in scenes)
    check_that(is_valid, "scenes", scenes, "a list of Scenes, at least one")
    # Exact solutions are computed one after another, but lattices in several threads.
    schemes = sorted({scene.scheme for scene in scenes})
    is_compatible = "continuum" not in schemes or len(schemes) == 1
    check_that(is_compatible, "scheme", schemes, "'continuum' for all scenes, or for no scene")


def _usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _check_sample_times(samples: Samples | None, duration: float) -> None:
    """Raise ValueError if a sample is later than the end of the scene."""
    if samples is not None:
        check_kind("samples", samples, Samples)
        last_time = float(samples.times.max(initial=0.0))
        allowed = f"up to the duration of the scene, {duration:g}"
        check_that(last_time <= duration, "samples.times", last_time, allowed)


def _check_record(record: Sequence[str], samples: Sequence[Samples | None]) -> None:
    """Raise ValueError if the groups to record are unknown, or if their samples are missing.

    record : the groups, of RECORD_GROUPS
    samples : the samples of each scene
    """
    is_list = isinstance(record, Sequence) and not isinstance(record, str) and len(record) > 0
    is_valid = is_list and all(isinstance(word, str) and word in RECORD_GROUPS for word in record)
    check_that(is_valid, "record", record, f"a list of {', '.join(RECORD_GROUPS)}")
    if "samples" not in record:
        return
    given_samples = [item for item in samples if item is not None]
    if len(given_samples) < len(samples):
        allowed = "Samples for each scene, as the second argument"
        raise ValueError(f"record: 'samples' without samples; allowed: {allowed}")
    shapes = {(item.times.shape, item.positions.shape) for item in given_samples}
    allowed = "equal numbers of times and positions for all scenes"
    check_that(len(shapes) == 1, "samples", samples, allowed)


def _solve(
    scene: Scene, samples: Samples | None, progress: Callable[[float], None] | None
) -> Solution:
    """Solve a scene by the scheme that it names."""
    solve = solve_exactly if scene.scheme == "continuum" else solve_by_scheme
    return solve(scene, samples, progress)
