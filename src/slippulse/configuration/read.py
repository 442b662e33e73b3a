"""The configuration: what is shipped, overlays and the command line, read as plain data, merged and checked.

    python -m slippulse.configuration.read mine.yaml      says in one line what is wrong, before Snakemake reads it

Files are YAML 1.2 without tags, anchors, templates (which Snakemake would obey) or keys given twice.
"""

import json
import re
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.composer import Composer
from ruamel.yaml.constructor import DuplicateKeyError
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import AliasEvent, ScalarEvent
from ruamel.yaml.nodes import MappingNode

from ..model.checks import short_repr
from .problems import ConfigError, nearest
from .resolve import simulation_problems
from .schema import NAME_WORDS, Configuration

# The shipped configuration has some 20 kB; a larger file is not a list of what differs from it.
LARGEST_FILE = 1_000_000
LIKE_SHIPPED = "allowed: keys and values as in config/config.yaml"
# Lines of a refusal; a reader mends a few at a time.
LINES = 20
json_schema = cache(Configuration.model_json_schema)
SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}


def read_config(
    shipped: Mapping,
    overlays: Sequence[Mapping] = (),
    said: Mapping | None = None,
    every_run: bool = True,
) -> Configuration:
    """The configuration, checked; ConfigError has one line a problem, with the key, the value, what is allowed.

    shipped : config/config.yaml
    overlays : what differs, one after the other; null removes a key
    said : what was given by --config, in which Snakemake leaves nested numbers text
    every_run : whether the scenes of all simulations are checked too
    """
    merged = dict(shipped)
    for overlay in (*overlays, _typed(said or {})):
        merged = _merge(merged, overlay)
    sweeps = merged.get("simulations")
    if isinstance(sweeps, Mapping) and (
        gone := [name for name in shipped["simulations"] if name not in sweeps]
    ):
        allowed = "what is shipped stays, since figures and verdicts need it"
        raise ConfigError(f"simulations.{gone[0]}: null; allowed: {allowed}")
    try:
        config = Configuration.model_validate(merged)
    except ValidationError as error:
        # Errors inside of an alternative, as 'same' or a list, are one line about the key.
        lines = sorted({_line(problem, merged) for problem in error.errors(include_url=False)})
        raise ConfigError(format_problems(lines)) from None
    if every_run and (problems := simulation_problems(config)):
        raise ConfigError(format_problems(problems))
    return config


def _merge(base: Mapping, overlay: Mapping, place: tuple[str, ...] = ()) -> dict[str, Any]:
    """Mappings merged, all else replaced; null removes a key, and is refused of a misspelt one."""
    merged = dict(base)
    for key, value in overlay.items():
        if isinstance(value, Mapping):
            inside = merged.get(key)
            merged[key] = _merge(
                inside if isinstance(inside, Mapping) else {}, value, (*place, key)
            )
        elif value is not None:
            merged[key] = value
        elif key not in merged and (hint := nearest(key, merged)):
            raise ConfigError(
                f"{_dotted((*place, key))}: null{hint}; allowed: null for a key that there is"
            )
        else:
            merged.pop(key, None)
    return merged


def _typed(value: Any, place: str = "") -> Any:
    """Values of the command line, with what is text there read as a scalar of a file."""
    if isinstance(value, Mapping):
        return {key: _typed(entry, f"{place}.{key}".lstrip(".")) for key, entry in value.items()}
    if isinstance(value, list):
        return [_typed(entry, place) for entry in value]
    try:
        read = _load(value) if isinstance(value, str) else value
    except (YAMLError, ConfigError):
        raise ConfigError(f"{place}: {short_repr(value)}; allowed: a plain value") from None
    return value if isinstance(read, Mapping | list) else read


def read_overlay(path: str | Path) -> dict[str, Any]:
    """Read an overlay, a YAML or JSON file with a mapping; a ConfigError names the file and what is allowed."""
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
            found = "a template" if isinstance(overlay, dict) else short_repr(overlay)
            raise ConfigError(f"{found}; allowed: a mapping of keys, as in config/config.yaml")
        # Names are text, and so are dates.
        return json.loads(json.dumps(overlay, default=str))
    except ConfigError as error:
        reason = str(error)
    except OSError as error:
        reason = f"{error.strerror or error}; allowed: a readable YAML file"
    except UnicodeDecodeError as error:
        reason = f"not text (byte {error.start}); allowed: YAML in UTF-8"
    except RecursionError:
        reason = f"nested too deeply; {LIKE_SHIPPED}"
    except (YAMLError, ValueError) as error:
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        mark = getattr(error, "problem_mark", None)
        where = f"line {mark.line + 1}: " if mark else ""
        reason = f"not YAML ({where}{problem[:120]}); {LIKE_SHIPPED}"
        if isinstance(error, DuplicateKeyError):
            reason = f"{where}{problem.partition(' with value')[0]}; allowed: each key once"
    raise ConfigError(f"{path}: {reason}")


class _PlainComposer(Composer):
    """Refuses what is not plain data before anything is built from it."""

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.parser.peek_event()
        found = ""
        if isinstance(event, AliasEvent) or event.anchor:
            found = "an anchor or alias; allowed: values written out"
        elif event.tag:
            found = f"tag {short_repr(str(event.tag))}; allowed: no tags"
        elif not isinstance(event, ScalarEvent):
            if isinstance(parent, MappingNode) and index is None:
                found = "a collection as a key; allowed: text"
        elif event.implicit[0] and not event.value and parent is not None:
            found = "no value; allowed: a value, or null, which removes the key"
        if found:
            raise ConfigError(f"line {event.start_mark.line + 1}: {found}")
        return super().compose_node(parent, index)


def _load(text: str) -> Any:
    yaml = YAML(typ="safe", pure=True)
    yaml.Composer = _PlainComposer
    return yaml.load(text)


def format_problems(problems: Sequence[str]) -> str:
    """The first problems, one a line, and how many more there are."""
    rest = [f"... and {len(problems) - LINES} more"] if len(problems) > LINES else []
    return "\n".join([*problems[:LINES], *rest])


def _line(problem: Mapping, config: Mapping) -> str:
    kind, place = problem["type"], problem["loc"]
    if kind == "value_error":
        return ".".join(
            filter(None, [_dotted(place) if place else "", str(problem["ctx"]["error"])])
        )
    depth, node, value = _walk(place, config)
    if kind == "missing":
        # An incomplete new entry may be a misspelt one.
        others = _walk(place[:-2], config)[2] if len(place) > 2 else {}
        hint = nearest(place[-2], {*others} - {place[-2]}) if others else ""
        presets = config.get("presets", ()) if place == ("preset",) else ()
        names = f"; allowed: {', '.join(presets)}" if presets else ""
        return f"{_dotted(place)}: missing; it is required (null removes a key){hint}{names}"
    if kind == "extra_forbidden":
        known = [*node["properties"]]
        return (
            f"{_dotted(place)}: unknown key{nearest(place[-1], known)}; allowed: {', '.join(known)}"
        )
    if place[-1] == "[key]":
        return f"{_dotted(place[:-2])}: {short_repr(place[-2])}; allowed: {NAME_WORDS}"
    allowed = "a finite number" if kind == "finite_number" else words(node)
    return f"{_dotted(place[:depth])}: {short_repr(value)}; allowed: {allowed}{_remedy(value)}"


def _walk(place: Sequence[str | int], config: Any) -> tuple[int, dict[str, Any], Any]:
    """Depth, schema and value at a place, as far as there is one schema for it."""
    node, value = resolved(json_schema()), config
    for depth, part in enumerate(place):
        named = [*node.get("patternProperties", {}).values(), node.get("additionalProperties")]
        fields = node.get("properties", {})
        inside = node.get("items") if isinstance(part, int) else fields.get(part, named[0])
        there = isinstance(value, list) or (isinstance(value, Mapping) and part in value)
        if not isinstance(inside, dict) or not there or part == "[key]":
            return depth, node, value
        node, value = resolved(inside), value[part]
    return len(place), node, value


def resolved(node: dict[str, Any]) -> dict[str, Any]:
    """A schema behind a reference or an alternative of null; what is said of the key itself stays."""
    options = [option for option in node.get("anyOf", []) if option.get("type") != "null"]
    inside = options[0] if len(options) == 1 else {}
    if "$ref" in node:
        inside = json_schema()["$defs"][node["$ref"].rpartition("/")[2]]
    return (
        resolved(inside) | {key: node[key] for key in ("allowed",) if key in node}
        if inside
        else node
    )


def words(node: dict[str, Any]) -> str:
    """What a schema allows, in words."""
    node = resolved(node)
    if "allowed" in node:
        return node["allowed"]
    if "anyOf" in node:
        return ", or ".join(
            words(option) for option in node["anyOf"] if option.get("type") != "null"
        )
    if "const" in node or "enum" in node:
        return ", ".join(map(repr, node.get("enum", [node.get("const")]))).replace("'", "")
    kind = node.get("type")
    if kind == "array":
        item = re.sub(r"^a (whole number|number|mapping)", r"\1s", words(node["items"]))
        different = "different " if node.get("uniqueItems") else ""
        return f"a list of {different}{item}" + (", at least one" if node.get("minItems") else "")
    if kind in ("number", "integer"):
        limits = {
            key: re.sub(r"e\+?(-?)0", r"e\1", f"{node[key]:g}") for key in SIGNS if key in node
        }
        text = " and ".join(f"{SIGNS[key]} {limit}" for key, limit in limits.items())
        if {*limits} == {"minimum", "maximum"}:
            text = f"from {limits['minimum']} to {limits['maximum']}"
        return f"{'a number' if kind == 'number' else 'a whole number'} {text}".strip()
    return {"boolean": "true or false", "string": "text"}.get(str(kind), "a mapping")


def _dotted(place: Sequence[str | int]) -> str:
    """A key as a refusal names it."""
    plain = re.compile(r"\w{1,80}", re.ASCII).fullmatch
    parts = [str(part) if plain(str(part)) else short_repr(part) for part in place]
    return ".".join(parts) or "the configuration"


def _remedy(value: object) -> str:
    """What to write instead of text that was meant as a number."""
    text = value.strip() if isinstance(value, str) else ""
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text, re.ASCII):
        return " (text: write the number without quotes)"
    return (
        f" (write {text.replace(',', '.')}, with a point)"
        if re.fullmatch(r"[-+]?\d+,\d+", text)
        else ""
    )


def main(paths: Sequence[str]) -> int:
    """Check overlay files; returns the exit code."""
    if not paths:
        sys.stderr.write("usage: python -m slippulse.configuration.read FILE...\n")
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
