"""What may be asked for on the command line, and where results may go."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from ..model.checks import ConfigError, nearest, short_repr


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
            raise ConfigError(
                f"target: {short_repr(target)}, a rule for many files; allowed: one of them, {patterns[target]}"
            )
        if target not in known:
            raise ConfigError(
                f"target: {short_repr(target)}{nearest(target, known)}; allowed: a rule, or a file that one makes"
            )


def check_places(results: Path, folders: Iterable[Path], files: Iterable[Path]) -> None:
    """Refuse a place for results in which nothing can be written.

    Parameters
    ----------
    results : where all results go
    folders, files : what is, or will be, a folder or a file

    Raises
    ------
    ConfigError
        Naming the place.
    """
    for path in (results, *folders):
        if os.path.lexists(path) and not path.is_dir():
            raise ConfigError(f"{path} is a file; remove or rename it: a folder of that name is needed")
    for path in files:
        if path.is_dir():
            raise ConfigError(f"{path} is a folder; remove or rename it: a file of that name is needed")
    if not os.access(results if results.exists() else results.absolute().parent, os.W_OK | os.X_OK):
        raise ConfigError(
            f"{results} may not be written by this user; change its permissions, or run elsewhere"
        )
