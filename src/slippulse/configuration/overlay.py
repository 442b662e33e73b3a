"""Overlay files, read as plain data: no tags, no aliases, no templates, no duplicate keys, nothing large.

    python -m slippulse.overlay mine.yaml      says in one line what is wrong, before Snakemake reads the file

Snakemake reads a --configfile itself, with a loader that resolves aliases and can evaluate expressions; a file that
passes here holds neither.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import yaml

from ..model.checks import ConfigError, shown

# The shipped configuration has some 20 kB; a larger file is not a list of what differs from it.
LARGEST_FILE = 1_000_000
DEEPEST = 12
# The parser written in C, where libyaml is there: ten times as fast, and the whole schema is read at every start.
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
KINDS = {list: "a list", str: "text", int: "a number", float: "a number", bool: "true or false"}


def read_overlay(path: str | Path) -> dict:
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
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise ConfigError(f"{path}: {error.strerror or error}; allowed: a readable YAML file") from None
    if len(data) > LARGEST_FILE:
        raise ConfigError(
            f"{path}: more than {LARGEST_FILE} bytes; allowed: what differs from config/config.yaml"
        )
    try:
        text = data.decode("utf-8-sig")
        _refuse_what_is_not_data(path, text)
        overlay = yaml.load(text, Loader=LOADER)
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not text (byte {error.start}); allowed: YAML in UTF-8") from None
    except yaml.YAMLError as error:
        raise ConfigError(
            f"{path}: not YAML ({_where(error)}); allowed: keys and values as in config/config.yaml"
        ) from None
    except (ValueError, RecursionError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"{path}: {shown(str(error))}; allowed: plain YAML") from None
    if not isinstance(overlay, dict):
        kind = "empty" if overlay is None else KINDS.get(type(overlay), type(overlay).__name__)
        raise ConfigError(f"{path}: {kind}; allowed: a mapping of keys, as in config/config.yaml")
    return overlay


def _where(error: yaml.YAMLError) -> str:
    mark = getattr(error, "problem_mark", None)
    problem = " ".join(str(getattr(error, "problem", None) or error).split())
    return f"line {mark.line + 1}, column {mark.column + 1}: {problem}" if mark else problem


def _refuse_what_is_not_data(path: Path, text: str) -> None:
    """Walk the file's events, before anything is built from them."""
    # One entry an open collection: the keys met so far and whether a key comes next; None in a list.
    open_collections: list[list | None] = []
    documents = 0
    for event in yaml.parse(text, Loader=yaml.SafeLoader):
        place = f"{path}: line {event.start_mark.line + 1}"
        if isinstance(event, yaml.DocumentStartEvent):
            documents += 1
            if documents > 1:
                raise ConfigError(f"{place}: a second document; allowed: one")
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            raise ConfigError(f"{place}: an anchor or alias; allowed: values written out")
        if getattr(event, "tag", None):
            raise ConfigError(f"{place}: tag {shown(event.tag)}; allowed: no tags")
        if isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
            open_collections.pop()
            continue
        if not isinstance(event, yaml.NodeEvent):
            continue
        inside = open_collections[-1] if open_collections else None
        if inside is not None:
            keys, key_next = inside
            inside[1] = not key_next
            if key_next:
                if not isinstance(event, yaml.ScalarEvent):
                    raise ConfigError(f"{place}: a collection as a key; allowed: names as keys")
                if event.value == "__use_yte__" or event.value.startswith("?"):
                    raise ConfigError(f"{place}: template key {shown(event.value)}; allowed: no templates")
                if event.value in keys:
                    raise ConfigError(
                        f"{place}: key {shown(event.value)} a second time; allowed: each key once"
                    )
                keys.add(event.value)
        if isinstance(event, yaml.CollectionStartEvent):
            open_collections.append([set(), True] if isinstance(event, yaml.MappingStartEvent) else None)
            if len(open_collections) > DEEPEST:
                raise ConfigError(f"{place}: more than {DEEPEST} levels; allowed: as in config/config.yaml")


def main(paths: Sequence[str]) -> int:
    """Check overlay files; returns the exit code."""
    for path in paths:
        try:
            read_overlay(path)
        except ConfigError as error:
            sys.stderr.write(f"The configuration is refused:\n{error}\n")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
