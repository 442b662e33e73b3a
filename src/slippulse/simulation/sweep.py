"""Many scenes in, one Dataset with a ``point`` dimension out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import xarray as xr

from ..model.checks import check_number, short_repr
from ..model.samples import RECORDS, Samples
from ..model.scene import Scene
from .pool import run_all
from .simulate import run_or_solve


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

    Returns
    -------
    Dataset with every parameter and number of the runs over ``point``; per-block variables as contiguous ragged
    arrays over ``block``, ``row_size`` blocks a point; samples over (point, time, position).

    Raises
    ------
    ValueError
        One line naming the argument and what is allowed.
    """
    samples = [None] * len(scenes) if samples is None and isinstance(scenes, Sequence) else samples
    _check_arguments(scenes, samples, record, threads, progress)
    return run_all(run_or_solve, scenes, samples, record, int(threads), progress)


def _check_arguments(
    scenes: object, samples: object, record: object, threads: object, progress: object
) -> None:
    """Refuse what is not a list of scenes with what each records, naming the argument and what is allowed."""
    if (
        not isinstance(scenes, Sequence)
        or not scenes
        or not all(isinstance(scene, Scene) for scene in scenes)
    ):
        raise ValueError(f"scenes: {short_repr(scenes)}; allowed: a list of Scenes, at least one")
    kinds = (Samples, type(None))
    if not isinstance(samples, Sequence) or not all(isinstance(of_scene, kinds) for of_scene in samples):
        raise ValueError(f"samples: {short_repr(samples)}; allowed: a list of Samples, or None")
    if len(samples) != len(scenes):
        raise ValueError(f"samples: {len(samples)} for {len(scenes)} scenes; allowed: one a scene, or None")
    for scene, of_scene in zip(scenes, samples, strict=True):
        if of_scene is not None:
            of_scene.check_within(scene.duration)
    words = record if isinstance(record, Sequence) and not isinstance(record, str) else ()
    if not words or not all(isinstance(word, str) and word in RECORDS for word in words):
        raise ValueError(f"record: {short_repr(record)}; allowed: a list of {', '.join(RECORDS)}")
    if "samples" in words:
        shapes = {of_scene and (of_scene.times.shape, of_scene.positions.shape) for of_scene in samples}
        if None in shapes:
            raise ValueError(
                "record: 'samples' without samples; allowed: Samples for each scene, the second argument"
            )
        if len(shapes) > 1:
            raise ValueError(
                f"samples: {len(shapes)} shapes; allowed: as many times and positions for each scene"
            )
    check_number("threads", threads, whole=True, at_least=1, at_most=1024)
    if progress is not None and not callable(progress):
        raise ValueError(f"progress: {short_repr(progress)}; allowed: a function of (done, all), or None")
