"""Overlay files, read as plain data: no tags, aliases, templates, duplicate keys, or scalars that YAML 1.1 misreads.

    python -m slippulse.configuration.overlay mine.yaml      says in one line what is wrong, before Snakemake reads it

Snakemake reads a --configfile itself, with a loader of YAML 1.1 that resolves aliases and can evaluate expressions; a
file that passes here holds none of it, and means the same in YAML 1.2.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from ..model.checks import ConfigError, short_repr

# The shipped configuration has some 20 kB; a larger file is not a list of what differs from it.
LARGEST_FILE = 1_000_000
DEEPEST = 12
# The parser written in C, where libyaml is there: ten times as fast.
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
# Plain scalars that are the same null, switch or number in YAML 1.1 and 1.2.
SAME_IN_BOTH = re.compile(
    r"~|null|Null|NULL|true|True|TRUE|false|False|FALSE"
    r"|[-+]?(0|[1-9]\d*)|0x[\da-fA-F]+|[-+]?(\.\d+|\d+\.\d*)([eE][-+]\d+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
    re.ASCII,
)
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
        if path.exists() and not path.is_file():
            raise ConfigError(f"{path}: not a regular file; allowed: a readable YAML file")
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
        # As Snakemake does, which reads JSON as such: 1e-3 is a number there.
        overlay = json.loads(text) if text.lstrip().startswith("{") and _is_json(text) else _load(text)
    except UnicodeDecodeError as error:
        raise ConfigError(f"{path}: not text (byte {error.start}); allowed: YAML in UTF-8") from None
    except yaml.YAMLError as error:
        raise ConfigError(
            f"{path}: not YAML ({_where(error)}); allowed: keys and values as in config/config.yaml"
        ) from None
    except (ValueError, RecursionError) as error:
        if isinstance(error, ConfigError):
            raise
        raise ConfigError(f"{path}: {short_repr(str(error))}; allowed: plain YAML") from None
    if not isinstance(overlay, dict):
        kind = "empty" if overlay is None else KINDS.get(type(overlay), type(overlay).__name__)
        raise ConfigError(f"{path}: {kind}; allowed: a mapping of keys, as in config/config.yaml")
    return overlay


def read_scalar(text: str, key: str) -> object:
    """What text of the command line stands for, as a plain scalar of a file.

    Parameters
    ----------
    text : as it was given
    key : of which it is the value

    Raises
    ------
    ConfigError
        Where YAML 1.1 and 1.2 differ.
    """
    if misread := _misread(text):
        raise ConfigError(f"{key}: {misread}")
    if text.lstrip().startswith(("&", "*", "!")):
        raise ConfigError(f"{key}: {short_repr(text)}, an anchor, alias or tag; allowed: a plain value")
    try:
        value = _load(text)
    except (yaml.YAMLError, ValueError):
        return text
    return text if isinstance(value, Mapping | list) else value


def _load(text: str) -> object:
    return yaml.load(text, Loader=LOADER)


def _is_json(text: str) -> bool:
    try:
        json.loads(text)
    except ValueError:
        return False
    return True


def _misread(text: str) -> str:
    """What is wrong with a plain scalar that YAML 1.1, which Snakemake reads, takes for something else than 1.2."""
    if text == "<<":
        return "'<<', which merges mappings in YAML 1.1; allowed: the keys themselves, written out"
    resolvers = LOADER.yaml_implicit_resolvers.get(text[:1], ())
    if SAME_IN_BOTH.fullmatch(text) or not any(pattern.match(text) for _, pattern in resolvers):
        return ""
    try:
        meant = f"reads as {short_repr(_load(text))}"
    except (yaml.YAMLError, ValueError):
        meant = "does not read as text"
    if re.fullmatch("[a-zA-Z]+", text):
        return f"{short_repr(text)}, which YAML 1.1 {meant}; allowed: true or false, or the word in quotes"
    return f"{short_repr(text)}, which YAML 1.1 {meant}; allowed: plain digits (90, 10.0), or text in quotes"


def _where(error: yaml.YAMLError) -> str:
    mark = getattr(error, "problem_mark", None)
    problem = " ".join(str(getattr(error, "problem", None) or error).split())
    return f"line {mark.line + 1}, column {mark.column + 1}: {problem}" if mark else problem


def _refuse_what_is_not_data(path: Path, text: str) -> None:
    """Walk the file's events, before anything is built from them."""
    # One entry an open collection: the keys met so far and whether a key comes next; None in a list.
    open_collections: list[list | None] = []
    documents = 0
    for event in yaml.parse(text, Loader=LOADER):
        place = f"{path}: line {event.start_mark.line + 1}"
        if isinstance(event, yaml.DocumentStartEvent):
            documents += 1
            if documents > 1:
                raise ConfigError(f"{place}: a second document; allowed: one")
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
            raise ConfigError(f"{place}: an anchor or alias; allowed: values written out")
        if getattr(event, "tag", None):
            raise ConfigError(f"{place}: tag {short_repr(event.tag)}; allowed: no tags")
        if isinstance(event, yaml.MappingEndEvent | yaml.SequenceEndEvent):
            open_collections.pop()
            continue
        if not isinstance(event, yaml.NodeEvent):
            continue
        if isinstance(event, yaml.ScalarEvent) and event.implicit[0]:
            if not event.value and open_collections:
                raise ConfigError(f"{place}: no value; allowed: a value, or null, which removes the key")
            if misread := _misread(event.value):
                raise ConfigError(f"{place}: {misread}")
        inside = open_collections[-1] if open_collections else None
        if inside is not None:
            keys, key_next = inside
            inside[1] = not key_next
            if key_next:
                if not isinstance(event, yaml.ScalarEvent):
                    raise ConfigError(f"{place}: a collection as a key; allowed: names as keys")
                if event.value == "__use_yte__" or event.value.startswith("?"):
                    raise ConfigError(
                        f"{place}: template key {short_repr(event.value)}; allowed: no templates"
                    )
                if event.value in keys:
                    raise ConfigError(
                        f"{place}: key {short_repr(event.value)} a second time; allowed: each key once"
                    )
                keys.add(event.value)
        if isinstance(event, yaml.CollectionStartEvent):
            open_collections.append([set(), True] if isinstance(event, yaml.MappingStartEvent) else None)
            if len(open_collections) > DEEPEST:
                raise ConfigError(f"{place}: more than {DEEPEST} levels; allowed: as in config/config.yaml")


def main(paths: Sequence[str]) -> int:
    """Check overlay files; returns the exit code."""
    if not paths:
        sys.stderr.write("usage: python -m slippulse.configuration.overlay FILE...\n")
        return 2
    for path in paths:
        try:
            read_overlay(path)
        except ConfigError as error:
            sys.stderr.write(f"The configuration is refused:\n{error}\n")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
