"""Scenes in, Datasets out: one scene on the lattice or exactly, by its scheme, or a sweep of many."""

import sys
from collections.abc import Callable, Sequence

import xarray as xr

from ..data.variables import described
from ..model.checks import check_number, short_repr
from ..model.samples import RECORDS, Samples
from ..model.scene import Scene
from ..solver.fixed_step import run_by_scheme
from ..solver.lattice import UnstableRun
from ..solver.run import LatticeRun
from .continuum import solve_scene
from .runs import ENERGY_RESIDUAL, recorded, run_all


class UnresolvedRun(RuntimeError):
    """A run finished, but its numbers are not those of the model; raised on request, otherwise flagged."""


def simulate(
    scene: Scene,
    samples: Samples | None = None,
    progress: Callable[[float], None] | bool | None = None,
    strict: bool = False,
) -> xr.Dataset:
    """Simulate one scene.

    Parameters
    ----------
    scene : the scene
    samples : where and when to record slip and slip velocity during the run; nothing when left out
    progress : called with the fraction of the duration done; True draws a bar with the time that is left
    strict : raise UnresolvedRun where a run would be flagged

    Returns a Dataset over x with prestress, release_time, stick_time, slip, slip_velocity and slip_acceleration at the
    end. Attributes: every scene parameter, steps, block_updates, event_updates (blocks that events changed), energy
    balance and energy_residual, min_velocity, re_releases, run_flags ("" or a comma-separated list), versions.

    Raises TypeError: if an argument is of another type; ValueError: if a sample is after the end; UnstableRun: if slip
    velocity is not finite or beyond anything the pre-stress can drive.
    """
    _require(isinstance(scene, Scene), "scene", scene, "a Scene", TypeError)
    _require(isinstance(samples, Samples | None), "samples", samples, "Samples, or None", TypeError)
    known = isinstance(progress, bool | None) or callable(progress)
    _require(
        known, "progress", progress, "a function of the fraction done, True, or None", TypeError
    )
    _require(isinstance(strict, bool), "strict", strict, "true or false", TypeError)
    if samples is not None:
        samples.check_within(scene.duration)
    if isinstance(progress, bool):
        progress = bar() if progress else None
    data = described(recorded(scene, samples, _run(scene, samples, progress)).dataset())
    numbers = data.attrs
    if strict and numbers["run_flags"]:
        raise UnresolvedRun(
            f"the run is flagged: {numbers['run_flags']} (lowest stress of a stuck block"
            f" {numbers['min_stuck_stress']:.4g}, reverse sliding at {scene.reverse_threshold:.4g}; blocks in the"
            f" narrowest pulse {numbers['pulse_blocks']}, needed {scene.resolved_blocks}; smallest velocity"
            f" {numbers['min_velocity']:.3g}; energy residual {numbers['energy_residual']:.2g}, allowed"
            f" {ENERGY_RESIDUAL:g})"
        )
    return data


def run_sweep(
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None] | None = None,
    record: Sequence[str] = ("fronts",),
    threads: int = 1,
    progress: Callable[[float, int], None] | None = None,
) -> xr.Dataset:
    """Run scenes in a pool of threads.

    Parameters
    ----------
    scenes : the scenes, one point each
    samples : per scene, where and when to record; all of one shape
    record : what is kept per block: "fronts" (release and stick times), "fields" (slip, velocity, acceleration at
        the end); "samples" (the recorded samples)
    threads : how many run at once; the result does not depend on it
    progress : called with (done, all) after each scene; of a single one, with the fraction done as it goes

    Returns a Dataset with every parameter and number of the runs over ``point``; per-block variables as contiguous
    ragged arrays over ``block``, ``row_size`` blocks a point; samples over (point, time, position).

    Raises ValueError: naming the argument and what is allowed.
    """
    listed = (
        isinstance(scenes, Sequence)
        and scenes
        and all(isinstance(scene, Scene) for scene in scenes)
    )
    _require(bool(listed), "scenes", scenes, "a list of Scenes, at least one")
    schemes = sorted({scene.scheme for scene in scenes})
    alike = schemes[0] != "continuum" or len(schemes) == 1
    _require(alike, "scheme", schemes, "'continuum' for all, or for none")
    samples = [None] * len(scenes) if samples is None else samples
    listed = isinstance(samples, Sequence) and all(
        isinstance(each, Samples | None) for each in samples
    )
    one_each = listed and len(samples) == len(scenes)
    _require(
        one_each,
        "samples",
        samples,
        f"a list of Samples, {len(scenes)} for as many scenes, or None",
    )
    for scene, of_scene in zip(scenes, samples, strict=True):
        if of_scene is not None:
            of_scene.check_within(scene.duration)
    words = record if isinstance(record, Sequence) and not isinstance(record, str) else ()
    known = bool(words) and all(isinstance(word, str) and word in RECORDS for word in words)
    _require(known, "record", record, f"a list of {', '.join(RECORDS)}")
    if "samples" in words:
        shapes = {
            of_scene and (of_scene.times.shape, of_scene.positions.shape) for of_scene in samples
        }
        if None in shapes:
            raise ValueError(
                "record: 'samples' without samples; allowed: Samples for each scene, the second argument"
            )
        _require(len(shapes) == 1, "samples", samples, "as many times and positions for each scene")
    check_number("threads", threads, whole=True, at_least=1, at_most=1024)
    known = progress is None or callable(progress)
    _require(known, "progress", progress, "a function of (done, all), or None")
    return described(run_all(_run, scenes, samples, record, int(threads), progress))


def bar(stream=None) -> Callable[[float], None]:
    """A function of the fraction done that draws a bar with the time left on a stream, standard error if left out."""
    from tqdm import tqdm

    shown = tqdm(
        total=1.0, delay=0.2, mininterval=0.2, file=stream or sys.stderr,
        bar_format="[{bar:30}] {percentage:3.0f}%  {elapsed}, {remaining} left",
    )  # fmt: skip

    def draw(done: float) -> None:
        shown.update(done - shown.n)
        if done >= 1.0:
            shown.close()

    return draw


def _run(
    scene: Scene, samples: Samples | None, progress: Callable[[float], None] | None
) -> LatticeRun:
    solve = solve_scene if scene.scheme == "continuum" else run_by_scheme
    return solve(scene, samples, progress)


def _require(holds: bool, name: str, value: object, allowed: str, error: type = ValueError) -> None:
    """Refuse an argument in one line."""
    if not holds:
        raise error(f"{name}: {short_repr(value)}; allowed: {allowed}")


__all__ = ["Samples", "UnresolvedRun", "UnstableRun", "run_sweep", "simulate"]
