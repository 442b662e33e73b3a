"""What may be asked for on the command line, and where results may go."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from ..model.checks import ConfigError, nearest, short_repr


def check_targets(arguments: Sequence[str], made: Callable[[str], bool], known: Sequence[str]) -> None:
    """Refuse a target that no rule makes.

    Parameters
    ----------
    arguments : of the command line; all after ``--`` are targets, before it what starts with results/
    made : whether a rule has this name or makes this file
    known : rules and files to suggest

    Raises
    ------
    ConfigError
        Naming the target and the one that was probably meant.
    """
    start = arguments.index("--") + 1 if "--" in arguments else len(arguments)
    for argument in [*(a for a in arguments[:start] if a.startswith("results/")), *arguments[start:]]:
        if not made(argument):
            raise ConfigError(
                f"target: {short_repr(argument)}{nearest(argument, known)}; allowed: a rule, or a file that one makes"
            )


def check_folder(path: Path) -> None:
    """Refuse a place for results in which nothing can be written.

    Raises
    ------
    ConfigError
        Naming the folder.
    """
    if path.exists() and not path.is_dir():
        raise ConfigError(f"{path} is a file; remove or rename it: results go into a folder of that name")
    if not os.access(path if path.exists() else path.absolute().parent, os.W_OK | os.X_OK):
        raise ConfigError(f"{path} may not be written by this user; change its permissions, or run elsewhere")
