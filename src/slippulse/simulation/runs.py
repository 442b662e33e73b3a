"""Finished runs as Datasets, with flags for what their numbers are not: one, or many in threads put together."""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from threading import Event

import numpy as np
import xarray as xr

from ..data.points import Recorded
from ..data.sweeps import combine
from ..data.versions import versions
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.run import LatticeRun, run_scene

# A velocity this far below zero, as a fraction of the largest, means that a stick was stepped over. The textbook scheme
# steps over each, by what one step decelerates.
NEGATIVE_VELOCITY = {"localised": 1e-9, "fixed_step": 1e-2}
# An energy balance that misses this fraction of its largest part means that the step was too long for the damping.
ENERGY_RESIDUAL = 1e-2
# A front of the textbook scheme that takes each of these last blocks in equally many steps runs at a fraction of dx/dt;
# with fewer steps than this that is off by up to 1 per cent.
LAST_BLOCKS, FEW_STEPS = 30, 50


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
    results: dict[int, Recorded] = {}
    order = sorted(range(len(scenes)), key=lambda i: -scenes[i].duration / scenes[i].dx)
    stopped = Event()

    def run(i: int) -> None:
        def check(done: float) -> None:
            if stopped.is_set():
                raise Stopped
            if progress is not None and len(scenes) == 1:
                progress(done, 1)

        results[i] = recorded(scenes[i], samples[i], solve(scenes[i], samples[i], check))

    # What exact solutions take is Python's, one at a time, and stops at once in the main thread alone.
    alone = threads == 1 or any(scene.scheme == "continuum" for scene in scenes)
    with ThreadPoolExecutor(max_workers=threads) as pool:
        try:
            futures = [] if alone else [pool.submit(run, i) for i in order]
            finished = (
                map(run, order) if alone else (future.result() for future in as_completed(futures))
            )
            for done, _ in enumerate(finished, start=1):
                if progress is not None:
                    progress(done, len(scenes))
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise
    return combine([results[i] for i in range(len(scenes))], record)


def simulate_on_lattice(scene: Scene, samples: Samples | None = None) -> xr.Dataset:
    """The Dataset of one scene by the localised scheme."""
    return recorded(scene, samples, run_scene(scene, samples)).dataset()


def recorded(scene: Scene, samples: Samples | None, run: LatticeRun) -> Recorded:
    """A run with its scene, and flags for what its numbers are not."""
    arrays = {name: values for name, values in vars(run).items() if isinstance(values, np.ndarray)}
    if samples is not None:
        arrays |= {"sample_time": samples.times, "sample_position": samples.positions}
    return Recorded(
        arrays, scene.attributes() | run.numbers | judge(scene, run) | {"versions": versions()}
    )


def judge(scene: Scene, run: LatticeRun) -> dict:
    """Flags of a finished run: what would make its numbers something else than the model's."""
    blocks, numbers = narrowest_pulse(scene, run), run.numbers
    if numbers["releases"] == 0:
        return {"pulse_blocks": blocks, "run_flags": "nothing_released"}
    found = {"nothing_sticks": nothing_sticks(scene, run)}
    if scene.scheme == "continuum":
        found["construction_ended"] = numbers["limit_reason"] != ""
    else:
        overshoot = -NEGATIVE_VELOCITY[scene.scheme] * max(1.0, float(np.max(run.slip_velocity)))
        found |= {
            "reverse_sliding": numbers["min_stuck_stress"] <= scene.reverse_threshold,
            "unresolved_pulse": 0 < blocks < scene.resolved_blocks,
            "died_out": died_out(run),
            "negative_velocity": numbers["min_velocity"] < overshoot,
            # Not NaN either.
            "energy": not numbers["energy_residual"] <= ENERGY_RESIDUAL,
            "locked_front": scene.scheme == "fixed_step" and locked_front(run),
        }
    return {"pulse_blocks": blocks, "run_flags": ",".join(flag for flag in found if found[flag])}


def nothing_sticks(scene: Scene, run: LatticeRun) -> bool:
    """Whether friction that depends on slip rate has let nothing stick for two of the paper's pi/sqrt(gamma)."""
    if scene.rate_strengthening == 0.0 or scene.gamma == 0.0 or not np.any(run.slip_velocity > 0.0):
        return False
    last = np.max(run.stick_time, initial=0.0, where=np.isfinite(run.stick_time))
    return scene.duration - last > 2.0 * math.pi / math.sqrt(scene.gamma)


def locked_front(run: LatticeRun) -> bool:
    """Whether a front of a fixed step has locked onto a fraction of dx/dt: frequency locking."""
    step = run.numbers["end_time"] / run.numbers["steps"]
    for side in (-1.0, 1.0):
        times = np.sort(run.release_time[(side * run.x >= 0.0) & np.isfinite(run.release_time)])
        counts = np.rint(np.diff(times[-LAST_BLOCKS:]) / step)
        if counts.size == LAST_BLOCKS - 1 and counts.min() == counts.max() < FEW_STEPS:
            return True
    return False


def narrowest_pulse(scene: Scene, run: LatticeRun) -> int:
    """Blocks across the narrowest pulse at the end.

    Under a stress boundary nucleation sets the scale: the width of the Gaussian, or the distance to where it falls to 0
    on the way to a strongly negative level.
    """
    if scene.boundary == "stress":
        profile, sizes = scene.prestress, [scene.prestress.width]
        for level in (profile.left, profile.right):
            if level < 0.0 < profile.peak:
                sizes.append(profile.width * math.sqrt(2.0 * math.log1p(-profile.peak / level)))
        return int(min(sizes) / scene.dx)
    sliding = np.isfinite(run.release_time) & ~np.isfinite(run.stick_time)
    edges = np.flatnonzero(np.diff(sliding, prepend=False, append=False))
    lengths = edges[1::2] - edges[0::2]
    # The pulses are the outermost segments; pieces left over behind them are not.
    return int(min(lengths[0], lengths[-1])) if lengths.size else 0


def died_out(run: LatticeRun) -> bool:
    """Whether a front stands still on a side where the pre-stress ahead of it would drive it on for ever."""
    released = np.isfinite(run.release_time)
    sliding = released & ~np.isfinite(run.stick_time)
    for side in (1, -1):
        # From x = 0 outwards.
        start = np.searchsorted(side * run.x[::side], 0.0)
        reached = np.flatnonzero(released[::side][start:])
        if reached.size and not np.any(sliding[::side][start:]):
            ahead = run.prestress[::side][start + reached[-1] + 1 :]
            if ahead.size and ahead[0] > 0.0:
                return True
    return False
