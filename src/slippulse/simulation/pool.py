"""Runs of many scenes in threads, put together as one Dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from threading import Event

import xarray as xr

from ..data.variables import combine
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.run import LatticeRun
from .dataset import dataset_of


class Stopped(Exception):
    """Another scene of the sweep failed, or the user stopped it."""


def run_all(
    solve: Callable[[Scene, Samples | None, Callable[[float], None]], LatticeRun],
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None],
    record: Sequence[str],
    threads: int = 1,
    progress: Callable[[float, int], None] | None = None,
) -> xr.Dataset:
    """Run scenes by a solver, long ones on fine lattices first; the rest is as `run_sweep` has it."""
    results: list[xr.Dataset | None] = [None] * len(scenes)
    order = sorted(range(len(scenes)), key=lambda i: -scenes[i].duration / scenes[i].dx)
    stopped = Event()

    def run(i: int) -> tuple[int, xr.Dataset]:
        def check(done: float) -> None:
            if stopped.is_set():
                raise Stopped
            if progress is not None and len(scenes) == 1:
                progress(done, 1)

        return i, dataset_of(scenes[i], samples[i], solve(scenes[i], samples[i], check))

    # What exact solutions take is Python's, one at a time, and stops at once in the main thread alone.
    alone = threads == 1 or any(scene.scheme == "continuum" for scene in scenes)
    with ThreadPoolExecutor(max_workers=threads) as pool:

        def finished() -> Iterator[tuple[int, xr.Dataset]]:
            futures = [pool.submit(run, i) for i in order]
            yield from (future.result() for future in as_completed(futures))

        try:
            for done, (i, data) in enumerate(map(run, order) if alone else finished(), start=1):
                results[i] = data
                if progress is not None:
                    progress(done, len(scenes))
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise
    return combine([result for result in results if result is not None], record)
