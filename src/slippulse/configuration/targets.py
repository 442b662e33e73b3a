"""What may be asked for on the command line, and where results may go."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from ..model.checks import ConfigError, nearest, short_repr


def check_targets(arguments: Sequence[str], made: Callable[[str], bool], known: Sequence[str]) -> None:
    """Refuse a file under results/ that no rule makes.

    Parameters
    ----------
    arguments : of the command line; what does not start with results/ is not looked at
    made : whether a rule makes a file
    known : files to suggest

    Raises
    ------
    ConfigError
        Naming the target and the one that was probably meant.
    """
    for argument in arguments:
        if argument.startswith("results/") and not made(argument):
            raise ConfigError(
                f"target: {short_repr(argument)}{nearest(argument, known)}; allowed: a file that a rule makes"
                " (snakemake --summary lists them)"
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
