"""Solutions as Datasets: of one scene, or of many scenes that are solved in threads and joined."""

from collections.abc import Callable, Iterator, Sequence
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


class SweepStopped(Exception):
    """Raised in a scene if another scene of the sweep failed, or if the user stopped the sweep."""


def solve_sweep(
    solve: Solver,
    scenes: Sequence[Scene],
    samples: Sequence[Samples | None],
    record: Sequence[str],
    threads: int = 1,
    progress: Callable[[float, int], None] | None = None,
) -> xr.Dataset:
    """Solve scenes by a solver and join their solutions, as `run_sweep` returns them.

    Long scenes on fine lattices are solved first, so that no thread is left with one at the end.
    """
    results: dict[int, Recorded] = {}
    order = sorted(range(len(scenes)), key=lambda i: -scenes[i].duration / scenes[i].dx)
    stopped = Event()
    report = progress if progress is not None else _ignore_progress

    def check(fraction_done: float) -> None:
        """Raise SweepStopped if the sweep was stopped; report the progress of a single scene."""
        if stopped.is_set():
            raise SweepStopped
        if len(scenes) == 1:
            report(fraction_done, 1)

    def solve_one(i: int) -> None:
        """Solve the scene of this number and keep its solution."""
        results[i] = recorded(scenes[i], samples[i], solve(scenes[i], samples[i], check))

    # Exact solutions are computed in Python, which runs only one thread at a time. The main thread
    # solves them itself, because only the main thread can be interrupted at once.
    is_exact = any(scene.scheme == "continuum" for scene in scenes)
    with ThreadPoolExecutor(max_workers=threads) as pool:
        try:
            finished = _solve_all(solve_one, order, None if is_exact or threads == 1 else pool)
            for count, _ in enumerate(finished, start=1):
                report(count, len(scenes))
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise
    return combine([results[i] for i in range(len(scenes))], record)


def _solve_all(
    solve_one: Callable[[int], None], order: Sequence[int], pool: ThreadPoolExecutor | None
) -> Iterator[None]:
    """Solve scenes by their numbers, in a pool or in this thread, and yield after each of them."""
    if pool is None:
        yield from map(solve_one, order)
        return
    futures = [pool.submit(solve_one, i) for i in order]
    for future in as_completed(futures):
        # This raises the error of a scene, if there was one.
        yield future.result()


def _ignore_progress(done: float, total: int) -> None:
    """Do nothing; it takes the place of a function that reports progress."""


def simulate_on_lattice(scene: Scene, samples: Samples | None = None) -> xr.Dataset:
    """Return the Dataset of one scene, solved by the localised scheme."""
    return recorded(scene, samples, solve_on_lattice(scene, samples)).dataset()


def recorded(scene: Scene, samples: Samples | None, solution: Solution) -> Recorded:
    """Return the arrays of a solution, with the parameters of its scene, its numbers and flags."""
    arrays = solution.arrays()
    if samples is not None:
        arrays |= {"sample_time": samples.times, "sample_position": samples.positions}
    numbers = scene.attributes() | solution.numbers | flags_of(scene, solution)
    return Recorded(arrays, numbers | {"versions": versions()})
