"""Solutions as Datasets: one, or those of many scenes, solved in threads and joined."""

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from threading import Event

import xarray as xr

from ..data.points import Recorded
from ..data.sweeps import combine, versions
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.solution import Solution, solve_on_lattice
from .flags import flags_of

Solver = Callable[[Scene, Samples | None, Callable[[float], None]], Solution]


class Stopped(Exception):
    """Another scene of the sweep failed, or the user stopped it."""


def solve_sweep(
    solve: Solver,
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None],
    record: Sequence[str],
    threads: int = 1,
    progress: Callable[[float, int], None] | None = None,
) -> xr.Dataset:
    """Solve scenes by a solver, long ones on fine lattices first; otherwise as `run_sweep` does."""
    results: dict[int, Recorded] = {}
    order = sorted(range(len(scenes)), key=lambda i: -scenes[i].duration / scenes[i].dx)
    stopped = Event()

    def check(done: float) -> None:
        if stopped.is_set():
            raise Stopped
        if progress is not None and len(scenes) == 1:
            progress(done, 1)

    def solve_one(i: int) -> None:
        results[i] = recorded(scenes[i], samples[i], solve(scenes[i], samples[i], check))

    # Exact solutions are computed by Python, one at a time, and only the main thread stops at once.
    alone = threads == 1 or any(scene.scheme == "continuum" for scene in scenes)
    with ThreadPoolExecutor(max_workers=threads) as pool:
        try:
            # Calls of this thread, or futures of those of the pool, as they are done.
            finished: Iterable = map(solve_one, order)
            if not alone:
                finished = as_completed([pool.submit(solve_one, i) for i in order])
            for count, future in enumerate(finished, start=1):
                if future is not None:
                    future.result()
                if progress is not None:
                    progress(count, len(scenes))
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise
    return combine([results[i] for i in range(len(scenes))], record)


def simulate_on_lattice(scene: Scene, samples: Samples | None = None) -> xr.Dataset:
    """The Dataset of one scene by the localised scheme."""
    return recorded(scene, samples, solve_on_lattice(scene, samples)).dataset()


def recorded(scene: Scene, samples: Samples | None, solution: Solution) -> Recorded:
    """The arrays of a solution, with the parameters of its scene, its numbers and its flags."""
    arrays = solution.arrays()
    if samples is not None:
        arrays |= {"sample_time": samples.times, "sample_position": samples.positions}
    numbers = scene.attributes() | solution.numbers | flags_of(scene, solution)
    return Recorded(arrays, numbers | {"versions": versions()})
