"""Many scenes in, one Dataset with a ``point`` dimension out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

import numpy as np
import xarray as xr

from ..data.points import combine
from ..model.samples import Samples
from ..model.scene import Scene
from .simulate import simulate

RECORDS = ("fronts", "fields", "samples")


def run_sweep(
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None] | None = None,
    record: Sequence[str] = ("fronts",),
    threads: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Run scenes in a pool of threads, the most expensive first.

    Parameters
    ----------
    scenes : the scenes, one point each
    samples : per scene, where and when to record; all of one shape
    record : what is kept per block: "fronts" (release and stick times), "fields" (slip, velocity, acceleration at
        the end); "samples" (the recorded samples)
    threads : how many run at once; the result does not depend on it
    progress : called with (done, all) after each scene

    Returns
    -------
    Dataset with every parameter and number of the runs over ``point``; per-block variables as contiguous ragged
    arrays over ``block``, ``row_size`` blocks a point; samples over (point, time, position).
    """
    samples = list(samples) if samples is not None else [None] * len(scenes)
    results: list[xr.Dataset | None] = [None] * len(scenes)
    order = sorted(range(len(scenes)), key=lambda i: -expected_cost(scenes[i]))
    with ThreadPoolExecutor(max_workers=max(1, threads)) as pool:
        futures = {pool.submit(simulate, scenes[i], samples[i]): i for i in order}
        try:
            for done, future in enumerate(as_completed(futures), start=1):
                results[futures[future]] = future.result()
                if progress is not None:
                    progress(done, len(scenes))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return combine([result for result in results if result is not None], record)


def expected_cost(scene: Scene) -> float:
    """Block updates a scene may need, up to a factor: fronts at the wave speed and a crack between them."""
    width = scene.duration
    if scene.boundary == "displacement":
        width = min(width, np.pi / np.sqrt(scene.gamma))
    return scene.duration / scene.dx * (width / scene.dx)
