"""Reading of the configuration.

The shipped file, the overlays and the values of the command line are merged and checked. The files
must be YAML 1.2 without tags, anchors and repeated keys. Templates are refused too, because
Snakemake would execute them.
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
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import Event, ScalarEvent
from ruamel.yaml.nodes import MappingNode, ScalarNode

from slippulse.model.checks import short_repr

from ..text.markdown import is_readable
from .limits import simulation_problems
from .problems import ConfigError, spelling_hint
from .profiles import with_points_of_files
from .refusals import dotted, format_problems, problem_line
from .renamed_keys import with_new_names
from .schema import Configuration

# The shipped configuration has about 20 kB, and an overlay lists only what differs from it.
MAX_FILE_BYTES = 1_000_000
LIKE_SHIPPED = "allowed: keys and values as in config/config.yaml"
VALUE_ALLOWED = "allowed: a value, or null, which removes the key"
MAPPING_ALLOWED = "allowed: a mapping of keys, as in config/config.yaml"
# Snakemake executes the expressions of a file that has this key.
TEMPLATE_KEY = "__use_yte__"


def read_config(
    shipped: Mapping,
    overlays: Sequence[Mapping] = (),
    command_line_values: Mapping | None = None,
    every_run: bool = True,
) -> Configuration:
    """Merge the shipped values, the overlays and the values of ``--config``, and check the result.

    Later overlays take precedence over earlier ones, and the command line over all of them. The
    runs of all simulations are checked only if ``every_run`` is set, since this check takes time.
    Raises ConfigError with one line for each problem.
    """
    merged = dict(shipped)
    for overlay in (*overlays, _parse_texts(command_line_values or {})):
        # An overlay from `read_overlay` has the points of its files already.
        with_points = with_points_of_files(with_new_names(overlay), Path())
        merged = _merge(merged, with_points)
    _refuse_removed_simulations(merged, shipped)
    config = _validated(merged)
    if every_run:
        problems = simulation_problems(config)
        # Only statements that an overlay has changed are checked.
        problems += _unreadable_statements(merged["published"], shipped["published"])
        if problems:
            raise ConfigError(format_problems(problems))
    return config


def _refuse_removed_simulations(merged: Mapping, shipped: Mapping) -> None:
    """Raise ConfigError if a shipped simulation was removed."""
    sweeps = merged.get("simulations")
    if not isinstance(sweeps, Mapping):
        # The later validation refuses this.
        return
    removed = sorted({*shipped["simulations"]} - {*sweeps})
    if removed:
        allowed = (
            "other values, but not null, since figures and verdicts need each shipped simulation"
        )
        raise ConfigError(f"simulations.{removed[0]}: null; allowed: {allowed}")


def _validated(merged: Mapping) -> Configuration:
    """Return the configuration, or raise ConfigError with a line for each value not allowed.

    ``merged`` has the shipped values with those of all overlays.
    """
    try:
        return Configuration.model_validate(merged)
    except ValidationError as error:
        # A value that may have several forms, such as 'same' or a list, has an error for each form.
        # All of them give the same line.
        lines = {problem_line(problem, merged) for problem in error.errors(include_url=False)}
        raise ConfigError(format_problems(sorted(lines))) from None


def _unreadable_statements(given: Mapping, shipped: Mapping) -> list[str]:
    """Return a line for each statement in ``published`` that cannot be shown on a page.

    Only statements that differ from the shipped ones are checked, since this takes time.

    given, shipped : the block ``published`` of the configuration, and the shipped one
    """
    problems = []
    for name, reading in given.items():
        text = reading["statement"]
        is_shipped = text == shipped.get(name, {}).get("statement")
        if not is_shipped and not is_readable(text):
            problem = f"published.{name}.statement: {short_repr(text)}"
            problems.append(f"{problem}; allowed: text with LaTeX formulas that pandoc can convert")
    return problems


def _merge(base: Mapping, overlay: Mapping, path: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return a mapping into which an overlay was merged.

    Mappings are merged, and other values are replaced. The value null removes a key. It is refused
    for a key that does not exist but is similar to one, since this is a spelling mistake.

    path : keys that lead to the mapping, for messages
    """
    merged = dict(base)
    for key, value in overlay.items():
        if isinstance(value, Mapping):
            base_value = merged.get(key)
            inner_base = base_value if isinstance(base_value, Mapping) else {}
            merged[key] = _merge(inner_base, value, (*path, key))
        elif value is not None:
            merged[key] = value
        elif key not in merged and spelling_hint(key, merged):
            problem = f"{dotted((*path, key))}: null{spelling_hint(key, merged)}"
            raise ConfigError(f"{problem}; allowed: null for a key that exists")
        else:
            merged.pop(key, None)
    return merged


def _parse_texts(value: Any, path: tuple[str, ...] = ()) -> Any:
    """Return values of the command line, with each text read as YAML.

    Snakemake leaves some numbers as texts, such as "0.3". ``path`` has the keys that lead to
    ``value``.
    """
    if isinstance(value, Mapping):
        return {key: _parse_texts(entry, (*path, key)) for key, entry in value.items()}
    if isinstance(value, list):
        return [_parse_texts(entry, path) for entry in value]
    if not isinstance(value, str):
        return value
    if path == ("preset",) and value.isalnum():
        # The name of a preset, such as 01, stays text.
        return value
    try:
        parsed = _load(value)
    except (YAMLError, ConfigError):
        problem = f"{dotted(path)}: {short_repr(value)}"
        raise ConfigError(f"{problem}; allowed: a plain value") from None
    # Snakemake has read lists and mappings already. A text that looks like one stays text.
    return value if isinstance(parsed, Mapping | list) else parsed


def read_overlay(path: str | Path) -> dict[str, Any]:
    """Read an overlay: a YAML or JSON file with a mapping. Raises ConfigError with its path.

    If a profile of the pre-stress names a file with points, the points are read as well. The path
    of such a file may be relative to the folder of the overlay.
    """
    path = Path(path)
    try:
        overlay = _load(_read_text(path))
        if overlay is None:
            raise ConfigError(f"empty; {MAPPING_ALLOWED}")
        if not isinstance(overlay, dict):
            raise ConfigError(f"{short_repr(overlay)}; {MAPPING_ALLOWED}")
        if TEMPLATE_KEY in overlay:
            raise ConfigError(f"a template; {MAPPING_ALLOWED}")
        # A round trip through JSON turns keys and dates into text.
        plain = json.loads(json.dumps(overlay, default=str))
        return with_points_of_files(plain, path.parent)
    except (OSError, ValueError, RecursionError, YAMLError) as error:
        raise ConfigError(f"{path}: {_reason(error)}") from None


def _read_text(path: Path) -> str:
    """Return the text of an overlay. Raises ConfigError if it is no regular file, or too large."""
    if path.exists() and not path.is_file():
        raise ConfigError("not a regular file; allowed: a readable YAML file")
    with path.open("rb") as file:
        data = file.read(MAX_FILE_BYTES + 1)
    if len(data) > MAX_FILE_BYTES:
        allowed = "only the differences from config/config.yaml"
        raise ConfigError(f"more than {MAX_FILE_BYTES} bytes; allowed: {allowed}")
    return data.decode("utf-8-sig")


def _reason(error: Exception) -> str:
    """Return the reason why a file is refused, and what is allowed instead."""
    if isinstance(error, ConfigError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.strerror or error}; allowed: a readable YAML file"
    if isinstance(error, UnicodeDecodeError):
        return f"not text (byte {error.start}); allowed: YAML in UTF-8"
    if isinstance(error, RecursionError):
        return f"nested too deeply; {LIKE_SHIPPED}"
    if isinstance(error, MarkedYAMLError):
        return _reason_of_parser(error)
    return f"not YAML ({' '.join(str(error).split())[:120]}); {LIKE_SHIPPED}"


def _reason_of_parser(error: MarkedYAMLError) -> str:
    """Return the reason why the parser of YAML refuses a file, with the number of the line.

    A mark of the error is a position in the file.
    """
    problem = " ".join((error.problem or str(error)).split())
    mark = error.problem_mark
    if error.context_mark and re.search("flow|quoted|simple key", error.context or ""):
        # The parser notices an unfinished value only on a later line. Report where it begins.
        mark = error.context_mark
    line = f"line {mark.line + 1}: " if mark else ""
    if isinstance(error, DuplicateKeyError):
        # The message continues with the values of the key.
        return f"{line}{problem.partition(' with value')[0]}; allowed: each key once"
    return f"not YAML ({line}{problem[:120]}); {LIKE_SHIPPED}"


class _PlainComposer(Composer):
    """A composer of YAML that refuses everything except plain data while it parses."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        """Compose the next node of ``parent``, or raise ConfigError if it is not plain data.

        The library calls this method for each node. The node is a key (``index`` is None), a value
        (``index`` is its key) or an entry of a list (``index`` is its number).
        """
        # The next event of the parser describes the node.
        event = self.parser.peek_event()
        is_key = isinstance(parent, MappingNode) and index is None
        line, refusal = event.start_mark.line, ""
        if event.anchor:
            refusal = "an anchor or alias; allowed: values written out"
        elif event.tag:
            refusal = f"tag {short_repr(str(event.tag))}; allowed: no tags"
        elif is_key and not isinstance(event, ScalarEvent):
            refusal = "a collection as a key; allowed: text"
        # Without a parent the file is empty, which `read_overlay` refuses.
        elif _is_missing(event) and parent is not None:
            refusal = _refusal_of_missing_value(parent, index)
            if isinstance(index, ScalarNode):
                # The parser reports a missing value at the line of the next key.
                line = index.start_mark.line
        if refusal:
            raise ConfigError(f"line {line + 1}: {refusal}")
        return super().compose_node(parent, index)


def _is_missing(event: Event) -> bool:
    """Return True if nothing stands where the parser expects a value."""
    return isinstance(event, ScalarEvent) and event.implicit[0] and not event.value


def _refusal_of_missing_value(parent: Any, key: Any) -> str:
    """Return the refusal of a missing value in a mapping or list, which is ``parent``.

    ``key`` is the node of its key in the mapping, or its number in the list.
    """
    if not isinstance(key, ScalarNode):
        return f"no value; {VALUE_ALLOWED}"
    refusal_of_comma = _refusal_of_decimal_comma(parent, key)
    return refusal_of_comma or f"{key.value}: no value; {VALUE_ALLOWED}"


def _refusal_of_decimal_comma(mapping: MappingNode, key: ScalarNode) -> str:
    """Return the refusal of a number with a decimal comma; empty if ``key`` is not part of one.

    In a mapping in braces, such as {gamma: 0,3}, the parser takes the 3 for a key without a value.
    So this key follows an entry whose value is an integer.
    """
    if not mapping.flow_style or not mapping.value or not re.match(r"\d", key.value, re.ASCII):
        return ""
    previous_key, previous_value = mapping.value[-1]
    if not _is_integer(previous_value.value):
        return ""
    given = f"{previous_key.value}: {previous_value.value},{key.value}"
    suggestion = f"{previous_value.value}.{key.value}"
    return f"{given}; allowed: numbers with a point (write {suggestion})"


def _is_integer(value: Any) -> bool:
    """Return True for the text of an integer, such as -2."""
    return isinstance(value, str) and bool(re.fullmatch(r"[-+]?\d+", value, re.ASCII))


def _load(text: str) -> Any:
    """Read YAML 1.2 that contains only plain data."""
    # A directive could select YAML 1.1, in which yes means true and 1:30 means 90.
    if directive := re.match(r"(?:\s*(?:#.*)?\n)*(%.*)", text):
        raise ConfigError(f"{short_repr(directive[1])}; allowed: YAML 1.2, without directives")
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _PlainComposer
    return yaml.load(text)
