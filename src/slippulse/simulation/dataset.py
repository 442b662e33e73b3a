"""A finished run as one Dataset, with flags for what its numbers are not."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from ..data.variables import VARIABLES
from ..data.versions import versions
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.run import LatticeRun

# A velocity this far below zero, as a fraction of the largest, means that a stick was stepped over. The textbook scheme
# steps over each, by what one step decelerates.
NEGATIVE_VELOCITY = {"localised": 1e-9, "fixed_step": 1e-2}
# An energy balance that misses this fraction of its largest part means that the step was too long for the damping.
ENERGY_RESIDUAL = 1e-2
# A front of the textbook scheme that takes each of these last blocks in equally many steps runs at a fraction of dx/dt;
# with fewer steps than this that is off by up to 1 per cent.
LAST_BLOCKS, FEW_STEPS = 30, 50
FIELDS = ("prestress", "release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration")


def dataset_of(scene: Scene, samples: Samples | None, run: LatticeRun) -> xr.Dataset:
    """The Dataset of a run, as `slippulse.simulate` describes it."""
    data: dict = {name: ("x", getattr(run, name)) for name in FIELDS}
    coordinates = {"x": ("x", run.x)}
    if samples is not None:
        coordinates["sample_time"] = ("sample_time", samples.times)
        coordinates["sample_position"] = ("sample_position", samples.positions)
        data["sample_slip"] = (("sample_time", "sample_position"), run.sample_slip)
        data["sample_velocity"] = (("sample_time", "sample_position"), run.sample_velocity)
    dataset = xr.Dataset(data, coords=coordinates)
    for name, variable in dataset.variables.items():
        variable.attrs = {"units": "1", "long_name": VARIABLES[str(name)][1]}
    dataset.attrs = scene.attributes() | run.numbers | judge(scene, run) | {"versions": versions()}
    return dataset


def judge(scene: Scene, run: LatticeRun) -> dict:
    """Flags of a finished run: what would make its numbers something else than the model's."""
    pulse_blocks = narrowest_pulse(scene, run)
    if run.numbers["releases"] == 0:
        return {"pulse_blocks": pulse_blocks, "run_flags": "nothing_released"}
    flags = ["nothing_sticks"] if nothing_sticks(scene, run) else []
    if scene.scheme == "continuum":
        flags += ["construction_ended"] if run.numbers["limit_reason"] else []
        return {"pulse_blocks": pulse_blocks, "run_flags": ",".join(flags)}
    if run.numbers["min_stuck_stress"] <= scene.reverse_threshold:
        flags.append("reverse_sliding")
    if 0 < pulse_blocks < scene.resolved_blocks:
        flags.append("unresolved_pulse")
    if died_out(run):
        flags.append("died_out")
    overshoot = -NEGATIVE_VELOCITY[scene.scheme] * max(1.0, float(np.max(run.slip_velocity)))
    if run.numbers["min_velocity"] < overshoot:
        flags.append("negative_velocity")
    # Not NaN either.
    if not run.numbers["energy_residual"] <= ENERGY_RESIDUAL:
        flags.append("energy")
    if scene.scheme == "fixed_step" and locked_front(run):
        flags.append("locked_front")
    return {"pulse_blocks": pulse_blocks, "run_flags": ",".join(flags)}


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
    """Blocks across the narrowest pulse at the end; under a stress boundary the nucleation peak sets the scale."""
    if scene.boundary == "stress":
        return int(nucleation_size(scene) / scene.dx)
    sliding = np.isfinite(run.release_time) & ~np.isfinite(run.stick_time)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], sliding, [False]]).astype(np.int8)))
    lengths = edges[1::2] - edges[0::2]
    # The pulses are the outermost segments; pieces left over behind them are not.
    return int(min(lengths[0], lengths[-1])) if lengths.size else 0


def nucleation_size(scene: Scene) -> float:
    """Width of the Gaussian, or the distance to where it falls to 0 on the way to a strongly negative level."""
    profile = scene.prestress
    sizes = [profile.width]
    for level in (profile.left, profile.right):
        if level < 0.0 < profile.peak:
            sizes.append(profile.width * math.sqrt(2.0 * math.log1p(-profile.peak / level)))
    return min(sizes)


def died_out(run: LatticeRun) -> bool:
    """Whether a front stands still on a side where the pre-stress ahead of it would drive it on for ever."""
    released = np.isfinite(run.release_time)
    sliding = released & ~np.isfinite(run.stick_time)
    for side in (-1.0, 1.0):
        half = side * run.x >= 0.0
        reach = side * run.x[half & released]
        if reach.size and not np.any(half & sliding):
            ahead = half & (side * run.x > reach.max())
            if ahead.any() and run.prestress[ahead][np.argmin(side * run.x[ahead])] > 0.0:
                return True
    return False


def describe_flags(scene: Scene, numbers: dict) -> str:
    """The figures behind the flags, in one line."""
    return (
        f"lowest stress of a stuck block {numbers['min_stuck_stress']:.4g}, reverse sliding at"
        f" {scene.reverse_threshold:.4g}; blocks in the narrowest pulse {numbers['pulse_blocks']}, needed"
        f" {scene.resolved_blocks}; smallest velocity {numbers['min_velocity']:.3g}; energy residual"
        f" {numbers['energy_residual']:.2g}, allowed {ENERGY_RESIDUAL:g}"
    )
