"""What a step takes of the configuration, what may be asked for on the command line, and where results may go."""

import os
from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from types import MappingProxyType

from ..model.checks import ConfigError, nearest, short_repr


def selected(config: Mapping, keys: Iterable[str], own: Mapping = MappingProxyType({})) -> dict:
    """The values of some dotted keys of the configuration, nested as there, beside what is a result's own."""
    found = deepcopy(dict(own))
    for key in keys:
        inside, value = found, config
        *parents, last = key.split(".")
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = value[last]
    return found


def check_targets(targets: Iterable[str], known: Sequence[str], patterns: Mapping[str, str]) -> None:
    """Refuse a target that no rule makes.

    Parameters
    ----------
    targets : what is asked for
    known : rules and files that there are
    patterns : rules that make a file for each of many names, with how it is called

    Raises
    ------
    ConfigError
        Naming the target and the one that was probably meant.
    """
    for target in targets:
        if target in patterns:
            allowed = f", a rule for many files; allowed: one of them, {patterns[target]}"
            raise ConfigError(f"target: {short_repr(target)}{allowed}")
        if target not in known:
            hint = nearest(target, known)
            raise ConfigError(
                f"target: {short_repr(target)}{hint}; allowed: a rule, or a file that one makes"
            )


def check_places(folders: Iterable[Path], files: Iterable[Path]) -> None:
    """Refuse a place for a folder, or for a file, in which there is something else.

    Raises
    ------
    ConfigError
        Naming the place.
    """
    taken = [(path, "file", "folder") for path in folders if os.path.lexists(path) and not path.is_dir()]
    taken += [(path, "folder", "file") for path in files if path.is_dir()]
    for path, found, needed in taken:
        raise ConfigError(f"{path} is a {found}; remove or rename it: a {needed} of that name is needed")
