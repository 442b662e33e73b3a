"""Sweeps over every combination of parameters.

`sweep` makes a scene of each combination and simulates all of them with `run_sweep`.
"""

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

# Parameters of the pre-stress that may be lists of values, and others that are the same in each
# run.
LISTED_PROFILE_NAMES = ("left", "right", "width", "peak")
SINGLE_PROFILE_NAMES = ("steps", "bumps")
SCENE_NAMES = (*(field.name for field in fields(Scene)), "damping_ratio")
PROFILE_NAMES = (*LISTED_PROFILE_NAMES, *SINGLE_PROFILE_NAMES)
ALLOWED_NAMES = (*SCENE_NAMES, *PROFILE_NAMES)


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
        Times and positions that are sampled in each run, if ``record`` contains "samples".
    record, threads, progress
        As in `run_sweep`.
    **parameters
        Parameters of `Scene`, each a value or a list of values. Instead of ``prestress``, the
        parameters of `Prestress` can be given. ``left``, ``right``, ``width`` and ``peak`` are
        values or lists, and ``right`` is equal to ``left`` by default. ``steps`` and ``bumps`` are
        the same in each run.

    Returns
    -------
    xarray.Dataset
        A sweep as `run_sweep` returns it. From run to run, the last list varies fastest. ``sel``
        selects runs by their parameters, and `as_grid` turns the lists into axes.

    Raises
    ------
    ValueError
        If a parameter is invalid. The message names the parameter and what is allowed.

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
        check_that(name in ALLOWED_NAMES, "parameter", name, ", ".join(ALLOWED_NAMES))
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
    # A list of pre-stresses is not a coordinate, although their levels and widths are.
    is_grid = bool(axes) and all(name in data.coords for name in axes)
    return data.assign_attrs({AXES_ATTRIBUTE: " ".join(axes)}) if is_grid else data


def _values(name: str, value: Any) -> list:
    """Return the values of a parameter as a list, with one value if the parameter is no list.

    The steps and bumps of the pre-stress are a list themselves, which is one value.
    """
    is_sequence = isinstance(value, list | tuple | range | np.ndarray)
    if not is_sequence or name in SINGLE_PROFILE_NAMES:
        return [value]
    # Elements of an array are converted to Python numbers. An array may be a single number.
    values = np.atleast_1d(value).tolist() if isinstance(value, np.ndarray) else list(value)
    check_that(len(values) > 0, name, value, "a value, or a list of at least one")
    return values


def _scenes(lists: dict[str, list]) -> Iterator[Scene]:
    """Yield a scene for each combination of values.

    lists : the values of each parameter by its name
    """
    profile_names = [name for name in lists if name in PROFILE_NAMES]
    if "prestress" in lists and profile_names:
        allowed = "prestress, or left, right, width and peak, but not both"
        raise ValueError(f"prestress: given with {', '.join(profile_names)}; allowed: {allowed}")
    for combination in product(*lists.values()):
        values = dict(zip(lists, combination, strict=True))
        if profile_names:
            profile = {name: values.pop(name) for name in profile_names}
            check_that("left" in profile, "left", None, "a level, or a list of levels")
            profile.setdefault("right", profile["left"])
            values["prestress"] = Prestress(**profile)
        for name in ("boundary", "prestress", "duration", "dx"):
            check_that(name in values, name, None, "a value, which every scene needs")
        yield Scene(**values)
