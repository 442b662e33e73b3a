"""Simulation of one scene, or of a sweep of many, each by the scheme that it names."""

import os
from collections.abc import Callable, Sequence

import xarray as xr

from ..data.sweep_views import with_parameters
from ..data.variables import described
from ..model.checks import check_kind, check_number, check_that
from ..model.cost import bound_cost
from ..model.samples import RECORD_GROUPS, Samples
from ..model.scene import Scene
from ..solver.compile_notice import announced_compilation
from ..solver.fixed_step import solve_by_scheme
from ..solver.solution import Solution
from .continuum import solve_exactly
from .flags import ENERGY_RESIDUAL
from .progress_bar import bar
from .sweep import recorded, solve_sweep


class UnresolvedRun(RuntimeError):
    """A run whose numbers are not those of the model; raised by `simulate` if it is strict."""


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
        Called with the fraction of the duration done; True draws a bar with the time that is left.
    strict : bool
        Raise UnresolvedRun where a run would be flagged.

    Returns
    -------
    xarray.Dataset
        Over x: prestress, release_time, stick_time, and at the end slip, slip_velocity and
        slip_acceleration. Attributes: every parameter of the scene, counters, the energy balance,
        run_flags ("" or names separated by commas), versions.

    Raises
    ------
    ValueError
        If an argument is of another type, a sample is after the end, or the run may cost more than
        days or a small machine has; `run_sweep` takes any.
    UnstableRun
        If slip velocity is not finite or beyond anything the pre-stress can drive.
    UnresolvedRun
        If the run is flagged and ``strict`` is true.

    Examples
    --------
    >>> slip = sp.simulate(sp.Scene("stress", sp.Prestress(0.6, 0.6), 5.0, dx=0.05)).slip
    """
    check_kind("scene", scene, Scene)
    known = isinstance(progress, bool | None) or callable(progress)
    check_that(known, "progress", progress, "a function of the fraction done, True, or None")
    check_kind("strict", strict, bool)
    _check_within(samples, scene.duration)
    exceeded = bound_cost(scene, samples).exceeded(remedy="or run_sweep, which takes any scene")
    # The exact solution refuses what it cannot solve, by the key that is too large.
    if exceeded and scene.scheme != "continuum":
        raise ValueError(exceeded)
    if isinstance(progress, bool):
        progress = bar() if progress else None
    with announced_compilation():
        data = described(recorded(scene, samples, _solve(scene, samples, progress)).dataset())
    numbers = data.attrs
    if strict and numbers["run_flags"]:
        facts = (
            f" (lowest stress of a stuck block {numbers['min_stuck_stress']:.4g}, reverse sliding"
            f" at {scene.reverse_threshold:.4g}; blocks in the narrowest pulse"
            f" {numbers['pulse_blocks']}, needed {scene.resolved_blocks}; smallest velocity"
            f" {numbers['min_velocity']:.3g}; energy residual {numbers['energy_residual']:.2g},"
            f" allowed {ENERGY_RESIDUAL:g})"
        )
        if scene.scheme == "continuum":
            # These are numbers of a lattice.
            facts = f" ({numbers['limit_reason']})" if numbers["limit_reason"] else ""
        raise UnresolvedRun(f"the run is flagged: {numbers['run_flags']}{facts}")
    return data


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
        One for each point of the sweep; by the scheme "continuum" all or none.
    samples : sequence of Samples, optional
        One for each scene, all of one shape.
    record : sequence of {"fronts", "fields", "samples"}
        What is kept: release and stick times; slip, slip velocity and acceleration at the end;
        the recorded samples.
    threads : int, optional
        Number of scenes at a time, 1 to 1024, by default the number of cores that this process may
        use; the result does not depend on it.
    progress : callable or bool, optional
        Called with (done, all) after each scene; for a single scene, with the fraction done. True
        draws a bar with the time that is left.

    Returns
    -------
    xarray.Dataset
        Every number over ``point``, with the parameters as coordinates: ``sel`` selects runs by
        any of them, and `as_grid` makes those of a full product axes. Contiguous ragged arrays over
        ``block``: the ``row_size`` blocks of a run begin at ``row_start``. Samples over
        (point, time, position).

    Raises
    ------
    ValueError
        In one line that names the argument and what is allowed.

    Examples
    --------
    >>> profile = sp.Prestress(0.6, 0.6)
    >>> sweep = sp.run_sweep([sp.Scene("stress", profile, 5.0, dx) for dx in (0.1, 0.05)])
    >>> sweep.sel(dx=0.05)["releases"].sizes["point"]
    1
    """
    _check_scenes(scenes)
    samples = [None] * len(scenes) if samples is None else samples
    listed = isinstance(samples, Sequence) and len(samples) == len(scenes)
    allowed = f"a list of Samples, {len(scenes)} for as many scenes, or None"
    check_that(listed, "samples", samples, allowed)
    for scene, samples_of_scene in zip(scenes, samples, strict=True):
        _check_within(samples_of_scene, scene.duration)
    _check_record(record, samples)
    threads = _usable_cores() if threads is None else threads
    check_number("threads", threads, integer=True, at_least=1, at_most=1024)
    known = isinstance(progress, bool | None) or callable(progress)
    check_that(known, "progress", progress, "a function of (done, all), True, or None")
    if isinstance(progress, bool):
        progress = bar(len(scenes)) if progress else None
    with announced_compilation():
        data = solve_sweep(_solve, scenes, samples, record, int(threads), progress)
    return with_parameters(described(data))


def _check_scenes(scenes: Sequence[Scene]) -> None:
    listed = isinstance(scenes, Sequence) and len(scenes) > 0
    known = listed and all(isinstance(scene, Scene) for scene in scenes)
    check_that(known, "scenes", scenes, "a list of Scenes, at least one")
    schemes = sorted({scene.scheme for scene in scenes})
    alike = "continuum" not in schemes or len(schemes) == 1
    check_that(alike, "scheme", schemes, "'continuum' for all, or for none")


def _usable_cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _check_within(samples: Samples | None, duration: float) -> None:
    if samples is not None:
        check_kind("samples", samples, Samples)
        last = float(samples.times.max(initial=0.0))
        allowed = f"up to the duration of the scene, {duration:g}"
        check_that(last <= duration, "samples.times", last, allowed)


def _check_record(record: Sequence[str], samples: Sequence[Samples | None]) -> None:
    listed = isinstance(record, Sequence) and not isinstance(record, str) and len(record) > 0
    known = listed and all(isinstance(word, str) and word in RECORD_GROUPS for word in record)
    check_that(known, "record", record, f"a list of {', '.join(RECORD_GROUPS)}")
    if "samples" not in record:
        return
    given = [item for item in samples if item is not None]
    if len(given) < len(samples):
        allowed = "Samples for each scene, the second argument"
        raise ValueError(f"record: 'samples' without samples; allowed: {allowed}")
    shapes = {(item.times.shape, item.positions.shape) for item in given}
    check_that(len(shapes) == 1, "samples", samples, "as many times and positions for each scene")


def _solve(
    scene: Scene, samples: Samples | None, progress: Callable[[float], None] | None
) -> Solution:
    solve = solve_exactly if scene.scheme == "continuum" else solve_by_scheme
    return solve(scene, samples, progress)
