"""Pre-stress profiles of a configuration: their files, their seeds, and the `Prestress` of each."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from slippulse.model.prestress import Prestress
from slippulse.model.rough_prestress import rough
from slippulse.model.stress_file import read_dimensionless

from .problems import ConfigError

# Keys of a profile that give it a table of pre-stress instead of levels.
TABLES = ("points", "file", "rough")


def with_points_of_files(overlay: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """An overlay in which each profile with a file also has the points that are in it.

    A relative path starts from ``folder``. ConfigError names the profile, the file and the row.
    """

    def read(profile: Any, key: str) -> Any:
        if not isinstance(profile, Mapping) or not isinstance(profile.get("file"), str):
            return profile
        if "points" in profile:
            # An overlay that was read before has both.
            return profile
        try:
            table = read_dimensionless(folder / profile["file"], None, None)
        except ValueError as error:
            raise ConfigError(f"{key}.file: {error}") from None
        return {
            **profile,
            "points": [list(row) for row in zip(table.x, table.prestress, strict=True)],
        }

    return _changed(overlay, read)


def _changed(overlay: Mapping[str, Any], change: Callable[[Any, str], Any]) -> dict[str, Any]:
    """An overlay with a change of each scene and of each profile of a simulation."""
    out = dict(overlay)
    if isinstance(scenes := overlay.get("scenes"), Mapping):
        out["scenes"] = {name: change(one, f"scenes.{name}") for name, one in scenes.items()}
    if isinstance(sweeps := overlay.get("simulations"), Mapping):
        out["simulations"] = {name: _sweep(one, name, change) for name, one in sweeps.items()}
    return out


def _sweep(sweep: Any, name: str, change: Callable[[Any, str], Any]) -> Any:
    if not isinstance(sweep, Mapping) or not isinstance(sweep.get("profiles"), list):
        return sweep
    key = f"simulations.{name}.profiles"
    changed = [change(one, f"{key}.{number}") for number, one in enumerate(sweep["profiles"])]
    return {**sweep, "profiles": changed}


def expanded(profiles: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The profiles as runs have them: one for each seed, and points without their file."""
    return [one for profile in profiles for one in _of_each_seed(profile)]


def _of_each_seed(profile: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    plain = {key: value for key, value in profile.items() if key != "file"}
    if "rough" not in plain:
        yield plain
        return
    seeds = plain["rough"]["seed"]
    for seed in seeds if isinstance(seeds, list) else [seeds]:
        yield {**plain, "rough": {**plain["rough"], "seed": seed}}


def prestress_of(profile: Mapping[str, Any]) -> Prestress:
    """The pre-stress of one expanded profile."""
    if not any(key in profile for key in TABLES):
        return Prestress(**profile)
    return _table(json.dumps(profile, sort_keys=True))


# Each run of a sweep asks for its profile, several times while the workflow is planned.
@lru_cache(maxsize=256)
def _table(text: str) -> Prestress:
    profile = json.loads(text)
    columns = rough(**profile["rough"]) if "rough" in profile else np.array(profile["points"]).T
    rest = {key: profile[key] for key in ("width", "peak", "bumps") if key in profile}
    return Prestress.through(*columns, **rest)


def label_of(profile: Mapping[str, Any], number: int) -> dict[str, float]:
    """Number of an expanded profile, from 1, and its seed, NaN if it has none."""
    return {"profile": number, "seed": float(profile.get("rough", {}).get("seed", "nan"))}
