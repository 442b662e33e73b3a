"""Solution of one scene, or of many scenes in threads, returned in the form of a Dataset."""

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

# A function that solves a scene with its samples, and calls its last argument with the fraction
# done.
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
    """Solve scenes by a solver and join their solutions, in the form that `run_sweep` returns.

    Long scenes on fine lattices are solved first. Otherwise one thread could begin such a scene
    last, and the others would wait for it.

    samples, record, threads, progress : as in `run_sweep`
    """
    # The solved scenes, by their position in ``scenes``.
    runs: dict[int, Recorded] = {}
    order = sorted(range(len(scenes)), key=lambda i: -scenes[i].duration / scenes[i].dx)
    is_stopped = Event()
    report = progress if progress is not None else _ignore_progress

    def report_or_stop(fraction_done: float) -> None:
        """Raise SweepStopped if the sweep was stopped; report the progress of a single scene."""
        if is_stopped.is_set():
            raise SweepStopped
        # A sweep of several scenes reports the number of solved scenes instead.
        if len(scenes) == 1:
            report(fraction_done, len(scenes))

    def solve_one(i: int) -> None:
        """Solve scene number i and keep its solution."""
        solution = solve(scenes[i], samples[i], report_or_stop)
        runs[i] = recorded(scenes[i], samples[i], solution)

    # Exact solutions are computed in Python, which runs only one thread at a time. The main thread
    # solves them itself, because only the main thread can be interrupted at once.
    is_exact = any(scene.scheme == "continuum" for scene in scenes)
    in_main_thread = is_exact or threads == 1
    with ThreadPoolExecutor(max_workers=threads) as pool:
        try:
            solved_scenes = _solve_all(solve_one, order, None if in_main_thread else pool)
            for count, _ in enumerate(solved_scenes, start=1):
                report(count, len(scenes))
        except BaseException:
            # An error of a scene, or the user, ends all scenes.
            is_stopped.set()
            pool.shutdown(cancel_futures=True)
            raise
    return combine([runs[i] for i in range(len(scenes))], record)


def _solve_all(
    solve_one: Callable[[int], None], order: Sequence[int], pool: ThreadPoolExecutor | None
) -> Iterator[None]:
    """Solve scenes, and yield after each of them.

    order : the numbers of the scenes in the order in which they begin
    pool : threads that solve them; None if this thread does
    """
    if pool is None:
        yield from map(solve_one, order)
        return
    futures = [pool.submit(solve_one, i) for i in order]
    for future in as_completed(futures):
        # This raises the error of a scene, if there was one.
        yield future.result()


def _ignore_progress(done: float, total: int) -> None:
    """Do nothing, in place of a function that reports progress."""


def simulate_on_lattice(scene: Scene, samples: Samples | None = None) -> xr.Dataset:
    """Return the Dataset of one scene, solved by the localised scheme."""
    return recorded(scene, samples, solve_on_lattice(scene, samples)).dataset()


def recorded(scene: Scene, samples: Samples | None, solution: Solution) -> Recorded:
    """Return a solved scene as a run: its arrays, its parameters, its numbers and its flags."""
    arrays = solution.arrays()
    if samples is not None:
        arrays |= {"sample_time": samples.times, "sample_position": samples.positions}
    numbers = scene.attributes() | solution.numbers | flags_of(scene, solution)
    return Recorded(arrays, numbers | {"versions": versions()})
