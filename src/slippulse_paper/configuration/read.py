"""The configuration read: the shipped file, overlays and the command line, merged and checked.

Files are YAML 1.2 without tags, anchors, templates (Snakemake obeys them) or keys given twice.
"""

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer
from ruamel.yaml.constructor import DuplicateKeyError
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import ScalarEvent
from ruamel.yaml.nodes import MappingNode, ScalarNode

from slippulse.model.checks import short_repr

from ..text.markdown import is_readable
from .limits import simulation_problems
from .problems import ConfigError, nearest
from .profiles import with_points_of_files
from .refusals import dotted, format_problems, problem_line
from .renamed_keys import with_new_names
from .schema import Configuration

# The shipped configuration has some 20 kB. An overlay lists what differs, and is never larger.
LARGEST_FILE = 1_000_000
LIKE_SHIPPED = "allowed: keys and values as in config/config.yaml"


def read_config(
    shipped: Mapping,
    overlays: Sequence[Mapping] = (),
    command_line_values: Mapping | None = None,
    every_run: bool = True,
) -> Configuration:
    """Merge the shipped values, the overlays and the values of ``--config``, and check the result.

    Raises ConfigError with one line for each problem. The runs of all simulations are checked only
    if ``every_run`` is set, since that takes time.
    """
    merged = dict(shipped)
    for overlay in (*overlays, _typed(command_line_values or {})):
        # An overlay that was read from a file already has the points of the files that it names.
        with_points = with_points_of_files(with_new_names(overlay), Path())
        merged = _merge(merged, with_points)
    sweeps = merged.get("simulations")
    missing = {*shipped["simulations"]} - {*sweeps} if isinstance(sweeps, Mapping) else ()
    for name in sorted(missing):
        allowed = "what is shipped stays, since figures and verdicts need it"
        raise ConfigError(f"simulations.{name}: null; allowed: {allowed}")
    try:
        config = Configuration.model_validate(merged)
    except ValidationError as error:
        # Errors inside of an alternative, such as 'same' or a list, give the same line.
        lines = {problem_line(problem, merged) for problem in error.errors(include_url=False)}
        raise ConfigError(format_problems(sorted(lines))) from None
    problems = simulation_problems(config) if every_run else []
    problems += _text_problems(merged["published"], shipped["published"]) if every_run else []
    if problems:
        raise ConfigError(format_problems(problems))
    return config


def _text_problems(given: Mapping, shipped: Mapping) -> list[str]:
    """Lines on texts of the user that no page can show."""
    problems, allowed = [], "text with formulas that pandoc reads"
    for name, reading in given.items():
        known, text = shipped.get(name, {}).get("statement"), reading["statement"]
        if text != known and not is_readable(text):
            key = f"published.{name}.statement"
            problems.append(f"{key}: {short_repr(text)}; allowed: {allowed}")
    return problems


def _merge(base: Mapping, overlay: Mapping, path: tuple[str, ...] = ()) -> dict[str, Any]:
    """Merge mappings and replace all else; null removes a key, and a misspelt one is refused."""
    merged = dict(base)
    for key, value in overlay.items():
        if isinstance(value, Mapping):
            inner = merged.get(key)
            merged[key] = _merge(inner if isinstance(inner, Mapping) else {}, value, (*path, key))
        elif value is not None:
            merged[key] = value
        elif key not in merged and nearest(key, merged):
            problem = f"{dotted((*path, key))}: null{nearest(key, merged)}"
            raise ConfigError(f"{problem}; allowed: null for a key that there is")
        else:
            merged.pop(key, None)
    return merged


def _typed(value: Any, path: str = "") -> Any:
    """Values of the command line, where Snakemake leaves nested numbers text."""
    if isinstance(value, Mapping):
        return {key: _typed(entry, f"{path}.{key}".lstrip(".")) for key, entry in value.items()}
    if path == "preset" and isinstance(value, str) and value.isalnum():
        # A preset such as 01 has a name, not a number.
        return value
    if isinstance(value, list):
        return [_typed(entry, path) for entry in value]
    if not isinstance(value, str):
        return value
    try:
        scalar = _load(value)
    except (YAMLError, ConfigError):
        raise ConfigError(f"{path}: {short_repr(value)}; allowed: a plain value") from None
    return value if isinstance(scalar, Mapping | list) else scalar


def read_overlay(path: str | Path) -> dict[str, Any]:
    """Read an overlay, a YAML or JSON file with a mapping; ConfigError names the file."""
    path = Path(path)
    try:
        if path.exists() and not path.is_file():
            raise ConfigError("not a regular file; allowed: a readable YAML file")
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
        if len(data) > LARGEST_FILE:
            allowed = "what differs from config/config.yaml"
            raise ConfigError(f"more than {LARGEST_FILE} bytes; allowed: {allowed}")
        overlay = _load(data.decode("utf-8-sig"))
        if not isinstance(overlay, dict) or "__use_yte__" in overlay:
            given = "a template" if isinstance(overlay, dict) else short_repr(overlay)
            given = "empty" if overlay is None else given
            raise ConfigError(f"{given}; allowed: a mapping of keys, as in config/config.yaml")
        # JSON turns names and dates into text.
        plain = json.loads(json.dumps(overlay, default=str))
        return with_points_of_files(plain, path.parent)
    except (OSError, ValueError, RecursionError, YAMLError) as error:
        raise ConfigError(f"{path}: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """Why a file is refused, and what is allowed instead."""
    if isinstance(error, ConfigError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.strerror or error}; allowed: a readable YAML file"
    if isinstance(error, UnicodeDecodeError):
        return f"not text (byte {error.start}); allowed: YAML in UTF-8"
    if isinstance(error, RecursionError):
        return f"nested too deeply; {LIKE_SHIPPED}"
    problem = " ".join(str(getattr(error, "problem", None) or error).split())
    mark = getattr(error, "problem_mark", None)
    if re.search("flow|quoted|simple key", str(getattr(error, "context", ""))):
        # What is not finished is noticed somewhere below the line where it begins.
        mark = getattr(error, "context_mark", None) or mark
    line = f"line {mark.line + 1}: " if mark else ""
    if isinstance(error, DuplicateKeyError):
        return f"{line}{problem.partition(' with value')[0]}; allowed: each key once"
    return f"not YAML ({line}{problem[:120]}); {LIKE_SHIPPED}"


class _PlainComposer(Composer):
    """Composer that refuses what is not plain data before anything is built from it."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event, refusal = self.parser.peek_event(), ""
        line = event.start_mark.line
        if event.anchor:
            refusal = "an anchor or alias; allowed: values written out"
        elif event.tag:
            refusal = f"tag {short_repr(str(event.tag))}; allowed: no tags"
        elif not isinstance(event, ScalarEvent):
            # The key of a mapping has no index.
            if isinstance(parent, MappingNode) and index is None:
                refusal = "a collection as a key; allowed: text"
        elif event.implicit[0] and not event.value and parent is not None:
            refusal = "no value; allowed: a value, or null, which removes the key"
            if isinstance(index, ScalarNode):
                # The event of a value that is missing stands where the next key begins.
                line, refusal = index.start_mark.line, _missing_value(parent, index)
        if refusal:
            raise ConfigError(f"line {line + 1}: {refusal}")
        return super().compose_node(parent, index)


def _missing_value(mapping: MappingNode, key: ScalarNode) -> str:
    """Refusal of a key without a value, which may be the end of a number with a decimal comma."""
    before = mapping.value[-1] if mapping.value else (None, None)
    name, value = (getattr(node, "value", None) for node in before)
    is_number = isinstance(value, str) and re.fullmatch(r"[-+]?\d+", value, re.ASCII)
    if mapping.flow_style and is_number and re.match(r"\d", key.value, re.ASCII):
        given = f"{name}: {value},{key.value}"
        return f"{given}; allowed: numbers with a point (write {value}.{key.value})"
    return f"{key.value}: no value; allowed: a value, or null, which removes the key"


def _load(text: str) -> Any:
    # An older version reads other values: yes is a switch, and 1:30 is 90.
    if directive := re.match(r"(?:\s*(?:#.*)?\n)*(%.*)", text):
        raise ConfigError(f"{short_repr(directive[1])}; allowed: YAML 1.2, without directives")
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _PlainComposer
    return yaml.load(text)
