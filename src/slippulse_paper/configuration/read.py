"""Reading of the configuration.

The shipped file, the overlays and the values of the command line are merged and checked. The files
are YAML 1.2 without tags, anchors and repeated keys. Templates are refused too, because Snakemake
would execute them.
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

# The shipped configuration has about 20 kB, and an overlay lists only what differs from it.
MAX_FILE_BYTES = 1_000_000
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
    """Return a line for each text of the user that cannot be shown on a page."""
    problems, allowed = [], "text with formulas that pandoc reads"
    for name, reading in given.items():
        shipped_text, text = shipped.get(name, {}).get("statement"), reading["statement"]
        if text != shipped_text and not is_readable(text):
            key = f"published.{name}.statement"
            problems.append(f"{key}: {short_repr(text)}; allowed: {allowed}")
    return problems


def _merge(base: Mapping, overlay: Mapping, path: tuple[str, ...] = ()) -> dict[str, Any]:
    """Merge an overlay into a mapping.

    Mappings are merged, and other values are replaced. The value null removes a key, but is refused
    for a misspelt key.
    """
    merged = dict(base)
    for key, value in overlay.items():
        if isinstance(value, Mapping):
            inner = merged.get(key)
            merged[key] = _merge(inner if isinstance(inner, Mapping) else {}, value, (*path, key))
        elif value is not None:
            merged[key] = value
        elif key not in merged and nearest(key, merged):
            problem = f"{dotted((*path, key))}: null{nearest(key, merged)}"
            raise ConfigError(f"{problem}; allowed: null for a key that exists")
        else:
            merged.pop(key, None)
    return merged


def _typed(value: Any, path: str = "") -> Any:
    """Return values of the command line with numbers instead of the texts that Snakemake leaves."""
    if isinstance(value, Mapping):
        return {key: _typed(entry, f"{path}.{key}".lstrip(".")) for key, entry in value.items()}
    if path == "preset" and isinstance(value, str) and value.isalnum():
        # The name of a preset, such as 01, stays text.
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
    """Read an overlay: a YAML or JSON file with a mapping. Raises ConfigError with its path."""
    path = Path(path)
    try:
        if path.exists() and not path.is_file():
            raise ConfigError("not a regular file; allowed: a readable YAML file")
        with path.open("rb") as file:
            data = file.read(MAX_FILE_BYTES + 1)
        if len(data) > MAX_FILE_BYTES:
            allowed = "only the differences from config/config.yaml"
            raise ConfigError(f"more than {MAX_FILE_BYTES} bytes; allowed: {allowed}")
        overlay = _load(data.decode("utf-8-sig"))
        if not isinstance(overlay, dict) or "__use_yte__" in overlay:
            given = "a template" if isinstance(overlay, dict) else short_repr(overlay)
            given = "empty" if overlay is None else given
            raise ConfigError(f"{given}; allowed: a mapping of keys, as in config/config.yaml")
        # A round trip through JSON turns keys and dates into text.
        plain = json.loads(json.dumps(overlay, default=str))
        return with_points_of_files(plain, path.parent)
    except (OSError, ValueError, RecursionError, YAMLError) as error:
        raise ConfigError(f"{path}: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """Return the reason why a file is refused, and what is allowed."""
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
        # The parser notices an unfinished value below the line where the value begins.
        mark = getattr(error, "context_mark", None) or mark
    line = f"line {mark.line + 1}: " if mark else ""
    if isinstance(error, DuplicateKeyError):
        return f"{line}{problem.partition(' with value')[0]}; allowed: each key once"
    return f"not YAML ({line}{problem[:120]}); {LIKE_SHIPPED}"


class _PlainComposer(Composer):
    """A composer of YAML that refuses everything except plain data while it parses."""

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
                # The parser reports a missing value at the line of the next key.
                line, refusal = index.start_mark.line, _missing_value(parent, index)
        if refusal:
            raise ConfigError(f"line {line + 1}: {refusal}")
        return super().compose_node(parent, index)


def _missing_value(mapping: MappingNode, key: ScalarNode) -> str:
    """Return the refusal of a key without a value.

    In a mapping in braces this key may be the second half of a number with a decimal comma.
    """
    previous_entry = mapping.value[-1] if mapping.value else (None, None)
    name, value = (getattr(node, "value", None) for node in previous_entry)
    is_number = isinstance(value, str) and re.fullmatch(r"[-+]?\d+", value, re.ASCII)
    if mapping.flow_style and is_number and re.match(r"\d", key.value, re.ASCII):
        given = f"{name}: {value},{key.value}"
        return f"{given}; allowed: numbers with a point (write {value}.{key.value})"
    return f"{key.value}: no value; allowed: a value, or null, which removes the key"


def _load(text: str) -> Any:
    """Read YAML 1.2 with plain data."""
    # A directive could select an older version of YAML, in which yes is a switch and 1:30 is 90.
    if directive := re.match(r"(?:\s*(?:#.*)?\n)*(%.*)", text):
        raise ConfigError(f"{short_repr(directive[1])}; allowed: YAML 1.2, without directives")
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _PlainComposer
    return yaml.load(text)
