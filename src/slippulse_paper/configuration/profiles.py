"""Pre-stress profiles of a configuration.

Instead of levels, a profile may have a table, which gives the pre-stress at many positions: points,
a file with points, or a rough background. The points of a file are read into the configuration. A
rough background may have lists of parameters. Such a profile is expanded into one profile for each
combination of the parameters. Each expanded profile is converted to a `Prestress`.
"""

import json
import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from slippulse.model.prestress import Prestress
from slippulse.model.rough_prestress import rough
from slippulse.model.si_stress_file import read_in_si
from slippulse.model.stress_file import read_dimensionless

from .problems import ConfigError

# Each of these keys gives a profile a table of the pre-stress instead of levels.
TABLE_KEYS = frozenset({"points", "file", "rough"})
# Keys of a rough background that may be lists. The seed may also be a range.
ROUGH_LISTS = ("level", "deviation", "correlation_length", "hurst", "seed")


def with_points_of_files(overlay: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return an overlay in which each profile that names a file also has the points of the file.

    The path of a file may be relative to ``folder``. Raises ConfigError with the profile, the file
    and the row if a file cannot be used.
    """
    changed = dict(overlay)
    scenes, simulations = overlay.get("scenes"), overlay.get("simulations")
    # An overlay has not been checked yet, and so any value may have any type.
    if isinstance(scenes, Mapping):
        changed["scenes"] = {
            name: _with_points(scene, f"scenes.{name}", folder) for name, scene in scenes.items()
        }
    if isinstance(simulations, Mapping):
        changed["simulations"] = {
            name: _with_points_in_profiles(simulation, f"simulations.{name}", folder)
            for name, simulation in simulations.items()
        }
    return changed


def _with_points_in_profiles(simulation: Any, key: str, folder: Path) -> Any:
    """Return a simulation, whose dotted key is ``key``, with the points in its list of profiles.

    The paths of files may be relative to ``folder``.
    """
    if not isinstance(simulation, Mapping) or not isinstance(simulation.get("profiles"), list):
        return simulation
    profiles = [
        _with_points(profile, f"{key}.profiles.{number}", folder)
        for number, profile in enumerate(simulation["profiles"])
    ]
    return {**simulation, "profiles": profiles}


def _with_points(profile: Any, key: str, folder: Path) -> Any:
    """Return a scene or profile, whose dotted key is ``key``, with the points of its file.

    The scene or profile is returned as it is if it names no file, or if it already has the points.
    The path of the file may be relative to ``folder``.
    """
    names_file = isinstance(profile, Mapping) and isinstance(profile.get("file"), str)
    if not names_file or "points" in profile:
        return profile
    try:
        columns = _columns_of_file(folder / profile["file"], in_si="layer" in profile)
    except ValueError as error:
        raise ConfigError(f"{key}.file: {error}") from None
    return {**profile, "points": [list(row) for row in zip(*columns, strict=True)]}


def _columns_of_file(path: Path, in_si: bool) -> tuple[list[float], list[float]]:
    """Return the positions and stresses in a file, in m and Pa or in non-dimensional units."""
    if in_si:
        x, stress = read_in_si(path)
        return x.tolist(), stress.tolist()
    # The columns have their usual names.
    table = read_dimensionless(path, x=None, prestress=None)
    return table.x, table.prestress


def without_files(profiles: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return profiles without the names of the files from which their points were read.

    Results depend only on the points.
    """
    copies = [dict(profile) for profile in profiles]
    for profile in copies:
        profile.pop("file", None)
    return copies


def rough_lists(background: Mapping[str, Any]) -> dict[str, Sequence]:
    """Return a list of values for each key of a rough background that may be a list."""
    return {name: _values_of(background[name]) for name in ROUGH_LISTS}


def _values_of(given: Any) -> Sequence:
    """Return the values of a key, which is a range of whole numbers, a list or a single value."""
    if isinstance(given, Mapping):
        return range(given["from"], given["to"] + 1)
    return given if isinstance(given, list) else [given]


class ExpandedProfiles(Collection[dict[str, Any]]):
    """The profiles of runs: one for each combination of the lists of a rough background.

    Neighbouring profiles differ in the seed, which is the last list. The profiles are made when
    they are needed, because there may be many.
    """

    def __init__(self, profiles: Sequence[Mapping[str, Any]]) -> None:
        self._profiles = profiles

    def __len__(self) -> int:
        return sum(math.prod(map(len, _lists_of(profile))) for profile in self._profiles)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """Yield the profile of each run, with one value in place of each list."""
        for profile in self._profiles:
            if "rough" not in profile:
                yield dict(profile)
                continue
            for values in product(*_lists_of(profile)):
                values_by_name = dict(zip(ROUGH_LISTS, values, strict=True))
                yield {**profile, "rough": {**profile["rough"], **values_by_name}}

    def __contains__(self, profile: object) -> bool:
        return any(profile == run_profile for run_profile in self)


def _lists_of(profile: Mapping[str, Any]) -> list[Sequence]:
    """Return the lists of the rough background of a profile, or no lists if it has none."""
    return [*rough_lists(profile["rough"]).values()] if "rough" in profile else []


def prestress_of(profile: Mapping[str, Any]) -> Prestress:
    """Return the pre-stress of one expanded profile, with levels or with a table (TABLE_KEYS).

    A table takes longer to read or to compute, so the results are cached.
    """
    has_table = any(key in profile for key in TABLE_KEYS)
    if not has_table:
        return Prestress(**profile)
    return _prestress_of_table(json.dumps(profile, sort_keys=True))


# The profile of each run is needed several times while the workflow is planned.
@lru_cache(maxsize=512)
def _prestress_of_table(text: str) -> Prestress:
    """Return the pre-stress of a profile with points or a rough background, given as JSON.

    The cache needs a hashable argument, which a dictionary is not.
    """
    profile = json.loads(text)
    x, tau = rough(**profile["rough"]) if "rough" in profile else np.array(profile["points"]).T
    gaussians = {key: profile[key] for key in ("width", "peak", "bumps") if key in profile}
    return Prestress.through(x, tau, **gaussians)


def labels_of(profiles: Iterable[Mapping[str, Any]]) -> list[dict[str, float]]:
    """Return the number of each expanded profile, from 1, and its seed (NaN if it has none).

    Neighbouring rough profiles that differ only in the seed have the same number.
    """
    labels: list[dict[str, float]] = []
    number, previous_without_seed = 0, None
    for profile in profiles:
        background = dict(profile.get("rough", {}))
        seed = background.pop("seed", math.nan)
        without_seed = {**profile, "rough": background}
        if "rough" not in profile or without_seed != previous_without_seed:
            number += 1
        previous_without_seed = without_seed
        labels.append({"profile": number, "seed": float(seed)})
    return labels


def ends_of_ensembles(profiles: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return profiles in which each list or range of seeds has only its first and last seed."""
    ends = []
    for profile in profiles:
        background = profile.get("rough")
        if background is not None:
            seeds = rough_lists(background)["seed"]
            end_seeds = [*dict.fromkeys([seeds[0], seeds[-1]])]
            profile = {**profile, "rough": {**background, "seed": end_seeds}}
        ends.append(profile)
    return ends
