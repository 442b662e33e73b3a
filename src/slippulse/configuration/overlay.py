"""Overlay files, read as plain data: YAML 1.2, without tags, anchors, templates or keys given twice.

    python -m slippulse.configuration.overlay mine.yaml      says in one line what is wrong, before Snakemake reads it

Snakemake reads a --configfile itself, and can evaluate expressions in it; a file that passes here holds none.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer
from ruamel.yaml.constructor import DuplicateKeyError
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import AliasEvent, ScalarEvent

from ..model.checks import ConfigError, short_repr

# The shipped configuration has some 20 kB; a larger file is not a list of what differs from it.
LARGEST_FILE = 1_000_000


class _PlainComposer(Composer):
    """Refuses what is not plain data before anything is built from it."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.parser.peek_event()
        found = ""
        if isinstance(event, AliasEvent) or event.anchor:
            found = "an anchor or alias; allowed: values written out"
        elif event.tag:
            found = f"tag {short_repr(str(event.tag))}; allowed: no tags"
        elif isinstance(event, ScalarEvent) and event.implicit[0] and not event.value and parent is not None:
            found = "no value; allowed: a value, or null, which removes the key"
        if found:
            raise ConfigError(f"line {event.start_mark.line + 1}: {found}")
        return super().compose_node(parent, index)


def read_overlay(path: str | Path) -> dict[str, Any]:
    """Read an overlay of the configuration.

    Parameters
    ----------
    path : a YAML or JSON file with a mapping at the top level

    Raises
    ------
    ConfigError
        One line that names the file, what was found and what is allowed.
    """
    path = Path(path)
    try:
        if path.exists() and not path.is_file():
            raise ConfigError("not a regular file; allowed: a readable YAML file")
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
        if len(data) > LARGEST_FILE:
            raise ConfigError(
                f"more than {LARGEST_FILE} bytes; allowed: what differs from config/config.yaml"
            )
        overlay = _load(data.decode("utf-8-sig"))
        if not isinstance(overlay, dict) or "__use_yte__" in overlay:
            found = "a template" if isinstance(overlay, dict) else short_repr(overlay)
            raise ConfigError(f"{found}; allowed: a mapping of keys, as in config/config.yaml")
        return _with_names(overlay)
    except (OSError, ValueError, YAMLError, TypeError, RecursionError) as error:
        raise ConfigError(f"{path}: {_reason(error)}") from None


def read_scalar(text: str, key: str) -> object:
    """What the text of a key on the command line stands for, as a scalar of a file; ConfigError where it is none."""
    try:
        value = _load(text)
    except (YAMLError, ConfigError):
        raise ConfigError(f"{key}: {short_repr(text)}; allowed: a plain value") from None
    return text if isinstance(value, Mapping | list) else value


def _load(text: str) -> Any:
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _PlainComposer
    return yaml.load(text)


def _with_names(value: Any) -> Any:
    """The same with text as keys."""
    if isinstance(value, Mapping):
        return {str(key): _with_names(entry) for key, entry in value.items()}
    return [_with_names(entry) for entry in value] if isinstance(value, list) else value


def _reason(error: Exception) -> str:
    """One line: what was found and what is allowed."""
    if isinstance(error, ConfigError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.strerror or error}; allowed: a readable YAML file"
    if isinstance(error, UnicodeDecodeError):
        return f"not text (byte {error.start}); allowed: YAML in UTF-8"
    if isinstance(error, RecursionError):
        return "nested too deeply; allowed: keys and values as in config/config.yaml"
    problem = " ".join(str(getattr(error, "problem", None) or error).split())
    mark = getattr(error, "problem_mark", None)
    where = f"line {mark.line + 1}: " if mark else ""
    if isinstance(error, DuplicateKeyError):
        return f"{where}{problem.partition(' with value')[0]}; allowed: each key once"
    return f"not YAML ({where}{problem[:120]}); allowed: keys and values as in config/config.yaml"


def main(paths: Sequence[str]) -> int:
    """Check overlay files; returns the exit code."""
    if not paths:
        sys.stderr.write("usage: python -m slippulse.configuration.overlay FILE...\n")
        return 2
    try:
        for path in paths:
            read_overlay(path)
    except ConfigError as error:
        sys.stderr.write(f"The configuration is refused:\n{error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
