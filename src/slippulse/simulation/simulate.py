"""One scene in, one Dataset out."""

from __future__ import annotations

from collections.abc import Callable

import xarray as xr

from ..model.checks import short_repr
from ..model.samples import Samples
from ..model.scene import Scene
from ..solver.lattice import UnstableRun
from ..solver.run import LatticeRun, run_scene
from .continuum import solve_scene
from .dataset import dataset_of, describe_flags
from .progress import bar


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
    strict : raise instead of flagging a run that meets the reverse-sliding threshold or does not resolve its pulse

    Returns
    -------
    Dataset over x with prestress, release_time, stick_time, slip, slip_velocity and slip_acceleration at the end.
    Attributes: every scene parameter, steps, block_updates, event_updates (blocks that events changed), energy
    balance and energy_residual, min_velocity, re_releases, flags ("" or a comma-separated list), versions.

    Raises
    ------
    TypeError
        When an argument is of another type, in one line.
    ValueError
        When a sample is after the end, in one line.
    UnstableRun
        When slip velocity is not finite or beyond anything the pre-stress can drive.
    UnresolvedRun
        With ``strict``, when a flag is set.
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: {short_repr(scene)}; allowed: a Scene")
    if samples is not None and not isinstance(samples, Samples):
        raise TypeError(f"samples: {short_repr(samples)}; allowed: Samples, or None")
    if samples is not None:
        samples.check_within(scene.duration)
    if not isinstance(progress, bool) and progress is not None and not callable(progress):
        raise TypeError(
            f"progress: {short_repr(progress)}; allowed: a function of the fraction done, True, or None"
        )
    if not isinstance(strict, bool):
        raise TypeError(f"strict: {short_repr(strict)}; allowed: true or false")
    if isinstance(progress, bool):
        progress = bar() if progress else None
    data = dataset_of(scene, samples, run_or_solve(scene, samples, progress))
    if strict and data.attrs["run_flags"]:
        flags = data.attrs["run_flags"]
        raise UnresolvedRun(f"the run is flagged: {flags} ({describe_flags(scene, data.attrs)})")
    return data


def run_or_solve(
    scene: Scene, samples: Samples | None, progress: Callable[[float], None] | None
) -> LatticeRun:
    """Run a scene by its scheme: on a lattice, or exactly."""
    solve = solve_scene if scene.scheme == "continuum" else run_scene
    return solve(scene, samples, progress)


__all__ = ["Samples", "UnresolvedRun", "UnstableRun", "simulate"]
