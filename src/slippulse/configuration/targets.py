"""What may be asked for on the command line, and where results may go."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from ..model.checks import ConfigError, nearest, short_repr


def check_targets(
    arguments: Sequence[str],
    made: Callable[[str], bool],
    known: Sequence[str],
    patterns: Mapping[str, str],
) -> None:
    """Refuse a target that no rule makes.

    Parameters
    ----------
    arguments : of the command line; all after ``--`` are targets, before it what starts with results/
    made : whether a rule has this name or makes this file
    known : rules and files to suggest
    patterns : rules that make a file for each of many names, with how it is called

    Raises
    ------
    ConfigError
        Naming the target and the one that was probably meant.
    """
    start = arguments.index("--") + 1 if "--" in arguments else len(arguments)
    for argument in [*(a for a in arguments[:start] if a.startswith("results/")), *arguments[start:]]:
        if argument in patterns:
            raise ConfigError(
                f"target: {short_repr(argument)}, a rule for many files; allowed: one of them, {patterns[argument]}"
            )
        if not made(argument):
            raise ConfigError(
                f"target: {short_repr(argument)}{nearest(argument, known)}; allowed: a rule, or a file that one makes"
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
