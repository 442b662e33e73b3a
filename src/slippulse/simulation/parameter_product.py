"""A sweep over every combination of lists of parameters."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields
from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from ..data.sweep_views import AXES_ATTRIBUTE
from ..model.checks import check_that
from ..model.prestress import Prestress
from ..model.samples import Samples
from ..model.scene import Scene
from .simulate import run_sweep

PROFILE = ("left", "right", "width", "peak")
OTHER_PARTS = ("steps", "bumps")
SCENE = (*(field.name for field in fields(Scene)), "damping_ratio")


def sweep(
    samples: Samples | None = None,
    record: Sequence[str] = ("fronts",),
    threads: int | None = None,
    progress: Callable[[float, int], None] | bool | None = None,
    **parameters: Any,
) -> xr.Dataset:
    """Simulate every combination of lists of parameters.

    Parameters
    ----------
    samples : Samples, optional
        What is sampled in each run, if ``record`` has "samples".
    record, threads, progress
        As in `run_sweep`.
    **parameters
        Parameters of `Scene`, each a value or a list of values. In place of ``prestress`` stand
        those of `Prestress`: ``left``, ``right`` (as ``left`` if it is left out), ``width`` and
        ``peak``, each a value or a list, and ``steps`` and ``bumps``, the same in each run.

    Returns
    -------
    xarray.Dataset
        As `run_sweep` returns it, the last list varying fastest: ``sel`` selects runs by their
        parameters, and `as_grid` makes the lists axes.

    Raises
    ------
    ValueError
        In one line that names the parameter and what is allowed.

    Examples
    --------
    >>> runs = sp.sweep(boundary="displacement", gamma=[0.3, 0.6], left=[0.4, 0.5],
    ...                 damping_ratio=0.1, dx=0.1, duration=8.0)
    >>> runs.sel(gamma=0.3, left=0.5)["first_stick_time"].round(1).item()
    5.7
    >>> sp.as_grid(runs)["first_stick_time"].sizes
    Frozen({'gamma': 2, 'left': 2})
    """
    for name in parameters:
        check_that(name in (*SCENE, *PROFILE, *OTHER_PARTS), "parameter", name, ", ".join(_NAMES))
    lists = {name: _values(name, value) for name, value in parameters.items()}
    scenes = [*_scenes(lists)]
    data = run_sweep(
        scenes,
        None if samples is None else [samples] * len(scenes),
        record=record,
        threads=threads,
        progress=progress,
    )
    axes = [name for name, values in lists.items() if len(values) > 1]
    # A listed pre-stress is no coordinate, but its levels and width are.
    known = bool(axes) and all(name in data.coords for name in axes)
    return data.assign_attrs({AXES_ATTRIBUTE: " ".join(axes)}) if known else data


_NAMES = (*SCENE, *PROFILE, *OTHER_PARTS)


def _values(name: str, value: Any) -> list:
    """Return the values of a parameter; one if it is no list."""
    listed = isinstance(value, list | tuple | range | np.ndarray) and name not in OTHER_PARTS
    values = np.asarray(value).tolist() if isinstance(value, np.ndarray) else value
    values = list(values) if listed else [value]
    check_that(len(values) > 0, name, value, "a value, or a list of at least one")
    return values


def _scenes(lists: dict[str, list]) -> Iterator[Scene]:
    profile = [name for name in lists if name in (*PROFILE, *OTHER_PARTS)]
    together = "prestress" in lists and bool(profile)
    check_that(not together, "prestress", profile, "prestress, or left, right, width and peak")
    for combination in product(*lists.values()):
        values = dict(zip(lists, combination, strict=True))
        parts = {name: values.pop(name) for name in profile}
        if profile:
            check_that("left" in parts, "left", None, "a level, or a list of levels")
            values["prestress"] = Prestress(**{"right": parts["left"]} | parts)
        for name in ("boundary", "prestress", "duration", "dx"):
            check_that(name in values, name, None, "a value, which every scene needs")
        yield Scene(**values)
