"""Pre-stress profiles of a configuration.

A profile may name a file, whose points are read into the configuration, or a rough background with
several seeds, which is expanded into one profile for each seed. Each expanded profile is then a
`Prestress`.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from slippulse.model.prestress import Prestress
from slippulse.model.rough_prestress import rough
from slippulse.model.si_stress_file import read_in_si
from slippulse.model.stress_file import read_dimensionless

from .problems import ConfigError

# Keys of a profile that give it a table of pre-stress instead of levels.
TABLES = frozenset({"points", "file", "rough"})


def with_points_of_files(overlay: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return an overlay in which each profile that names a file also has the points of the file.

    The path of a file may be relative to ``folder``. Raises ConfigError with the profile, the file
    and the row if a file cannot be used.
    """

    def add_points(profile: Any, key: str) -> Any:
        """Return a profile, whose dotted key is ``key``, with the points of its file."""
        names_file = isinstance(profile, Mapping) and isinstance(profile.get("file"), str)
        # A profile has both if this function has been called before.
        if not names_file or "points" in profile:
            return profile
        try:
            columns = _columns_of_file(folder / profile["file"], in_si="layer" in profile)
        except ValueError as error:
            raise ConfigError(f"{key}.file: {error}") from None
        return {**profile, "points": [list(row) for row in zip(*columns, strict=True)]}

    return _with_changed_profiles(overlay, add_points)


def _columns_of_file(path: Path, in_si: bool) -> tuple[list[float], list[float]]:
    """Return the positions and stresses in a file, in m and Pa or in non-dimensional units."""
    if in_si:
        x, stress = read_in_si(path)
        return x.tolist(), stress.tolist()
    table = read_dimensionless(path, None, None)
    return table.x, table.prestress


def _with_changed_profiles(
    overlay: Mapping[str, Any], change: Callable[[Any, str], Any]
) -> dict[str, Any]:
    """Return an overlay in which each scene and each profile of a simulation is changed.

    ``change`` gets a scene or a profile, and its dotted key.
    """
    changed = dict(overlay)
    scenes, simulations = overlay.get("scenes"), overlay.get("simulations")
    # An overlay has not been checked yet, and so any value may have any type.
    if isinstance(scenes, Mapping):
        changed["scenes"] = {
            name: change(scene, f"scenes.{name}") for name, scene in scenes.items()
        }
    if isinstance(simulations, Mapping):
        changed["simulations"] = {
            name: _with_changed_list(simulation, f"simulations.{name}", change)
            for name, simulation in simulations.items()
        }
    return changed


def _with_changed_list(simulation: Any, key: str, change: Callable[[Any, str], Any]) -> Any:
    """Return a simulation in which each entry of its list of profiles is changed."""
    if not isinstance(simulation, Mapping) or not isinstance(simulation.get("profiles"), list):
        return simulation
    profiles = [
        change(profile, f"{key}.profiles.{number}")
        for number, profile in enumerate(simulation["profiles"])
    ]
    return {**simulation, "profiles": profiles}


def expanded(profiles: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Return the profiles of runs: one for each seed, with points and without the file name."""
    return [*chain.from_iterable(map(_profiles_of_seeds, profiles))]


def _profiles_of_seeds(profile: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield one profile for each seed, or the profile itself if it has no seeds."""
    plain = {key: value for key, value in profile.items() if key != "file"}
    if "rough" not in plain:
        yield plain
        return
    seeds = plain["rough"]["seed"]
    for seed in seeds if isinstance(seeds, list) else [seeds]:
        yield {**plain, "rough": {**plain["rough"], "seed": seed}}


def prestress_of(profile: Mapping[str, Any]) -> Prestress:
    """Return the pre-stress of one expanded profile."""
    if not any(key in profile for key in TABLES):
        return Prestress(**profile)
    return _prestress_of_table(json.dumps(profile, sort_keys=True))


# The profile of each run is needed several times while the workflow is planned.
@lru_cache(maxsize=256)
def _prestress_of_table(text: str) -> Prestress:
    """Return the pre-stress of a profile with a table, given as JSON, which can be cached."""
    profile = json.loads(text)
    x, tau = rough(**profile["rough"]) if "rough" in profile else np.array(profile["points"]).T
    gaussians = {key: profile[key] for key in ("width", "peak", "bumps") if key in profile}
    return Prestress.through(x, tau, **gaussians)


def labels_of(profiles: Sequence[Mapping[str, Any]]) -> list[dict[str, float]]:
    """Return the number of each expanded profile, from 1, and its seed (NaN if it has none).

    Rough profiles that differ only in the seed have the same number.
    """
    labels: list[dict[str, float]] = []
    number, previous_shape = 0, None
    for profile in profiles:
        background = dict(profile.get("rough", {}))
        seed = background.pop("seed", math.nan)
        shape = {**profile, "rough": background}
        if "rough" not in profile or shape != previous_shape:
            number += 1
        previous_shape = shape
        labels.append({"profile": number, "seed": float(seed)})
    return labels


def ends_of_ensembles(profiles: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Return the expanded profiles without the seeds between the first and the last of an ensemble.

    A profile without seeds is kept.
    """
    numbers = [label["profile"] for label in labels_of(profiles)]
    ends = []
    for index, number in enumerate(numbers):
        is_first = index == 0 or numbers[index - 1] != number
        is_last = index == len(numbers) - 1 or numbers[index + 1] != number
        if is_first or is_last:
            ends.append(profiles[index])
    return ends
