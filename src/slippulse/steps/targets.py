"""What a step takes of the configuration, what may be asked for on the command line, and where results may go."""

import os
from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path

from ..model.checks import ConfigError, nearest, short_repr


def selected(config: Mapping, keys: Iterable[str], own: Mapping) -> dict:
    """The values of some dotted keys of the configuration, nested as there, beside what is a result's own."""
    found = deepcopy(dict(own))
    for key in keys:
        inside, value = found, config
        *parents, last = key.split(".")
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = value[last]
    return found


def check_targets(targets: Iterable[str], known: Sequence[str]) -> None:
    """Refuse a target that is none of the rules and files that there are.

    Raises ConfigError: naming the target and the one that was probably meant.
    """
    for target in targets:
        if target not in known:
            allowed = (
                f"{nearest(target, known)}; allowed: a rule of a single job, or a file that a rule makes"
            )
            raise ConfigError(f"target: {short_repr(target)}{allowed}")


def check_places(folders: Iterable[Path], files: Iterable[Path]) -> None:
    """Refuse a place for a folder, or for a file, in which there is something else.

    Raises ConfigError: naming the place.
    """
    taken = [(path, "file", "folder") for path in folders if os.path.lexists(path) and not path.is_dir()]
    taken += [(path, "folder", "file") for path in files if path.is_dir()]
    for path, found, needed in taken:
        raise ConfigError(f"{path} is a {found}; remove or rename it: a {needed} of that name is needed")
