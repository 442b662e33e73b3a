"""Refusals of a configuration in words.

Each problem that pydantic reports becomes one line with the key, the value and the allowed values,
which are taken from the JSON Schema of the configuration.
"""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

from pydantic import BaseModel

from slippulse.model.checks import short_repr

from .problems import nearest
from .schema import LABEL_WORDS, NAME_WORDS, Configuration, Measure, Model, NamedScene, Simulation

# Users correct a few mistakes at a time.
MAX_LINES = 20
SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
Path = Sequence[str | int]
json_schema = cache(Configuration.model_json_schema)


def format_problems(problems: Sequence[str]) -> str:
    """Return the first problems, one on each line, and the number of further problems."""
    lines = [*problems[:MAX_LINES]]
    if len(problems) > MAX_LINES:
        lines.append(f"... and {len(problems) - MAX_LINES} more")
    return "\n".join(lines)


def dotted(path: Path) -> str:
    """Return the path of a key with dots, as refusals show it."""
    plain = re.compile(r"\w{1,80}", re.ASCII).fullmatch
    parts = [str(part) if plain(str(part)) else short_repr(part) for part in path]
    return ".".join(parts) or "the configuration"


def problem_line(problem: Mapping, config: Mapping) -> str:
    """Return one error of pydantic about a configuration as a line."""
    kind, path = problem["type"], problem["loc"]
    if kind == "value_error":
        reason = str(problem["ctx"]["error"])
        return f"{dotted(path)}.{reason}" if path else reason
    if kind == "missing" and isinstance(path[-1], str):
        return _missing_line(path, config)
    if path[-1] == "[key]":
        allowed = LABEL_WORDS if path[0] in ("presets", "published") else NAME_WORDS
        return f"{dotted(path[:-2])}: {short_repr(path[-2])}; allowed: {allowed}"
    entry = _last_known_entry(path, config)
    if kind == "extra_forbidden":
        known_keys = [*entry.schema["properties"]]
        allowed = ", ".join(known_keys)
        hint = nearest(path[-1], known_keys) or _elsewhere(path[-1])
        return f"{dotted(path)}: unknown key{hint}; allowed: {allowed}"
    allowed = "a finite number" if kind == "finite_number" else words(entry.schema)
    value = entry.value
    # Null, true and false are written as in YAML.
    given = json.dumps(value) if value is None or isinstance(value, bool) else short_repr(value)
    return f"{dotted(entry.path)}: {given}; allowed: {allowed}{_remedy(value)}"


def _elsewhere(key: str | int) -> str:
    """Return a hint at the blocks of the configuration that have a key, such as gamma."""
    blocks: dict[str, type[BaseModel]] = {"simulations.NAME": Simulation, "scenes.NAME": NamedScene}
    blocks |= {"model": Model, "measure": Measure}
    places = [f"{block}.{key}" for block, keys in blocks.items() if key in keys.model_fields]
    return f" (it is set by {' and '.join(places)})" if places else ""


def _missing_line(path: Path, config: Mapping) -> str:
    """Return the refusal of a mapping without a required key."""
    line = f"{dotted(path)}: missing; it is required (null removes a key)"
    if path == ("preset",) and config.get("presets"):
        line += f"; allowed: {', '.join(config['presets'])}"
    if len(path) > 2 and isinstance(path[-2], str):
        # An entry without a required key may be a shipped one with a misspelt name.
        siblings = _last_known_entry(path[:-2], config).value
        line += nearest(path[-2], {*siblings} - {path[-2]})
        if path[0] == "simulations" and path[-2].startswith("fig"):
            line += "; docs/figures.md lists the simulations of each figure"
    return line


class _Entry(NamedTuple):
    """An entry of the configuration: its path, the schema for it and its value."""

    path: Path
    schema: dict[str, Any]
    value: Any


def _last_known_entry(path: Path, config: Any) -> _Entry:
    """Return the last entry on a path that exists and has a single schema."""
    schema, value = resolved(json_schema()), config
    for depth, part in enumerate(path):
        if isinstance(part, int):
            # A row of numbers is refused with its list, whose schema describes the rows.
            items = schema.get("items")
            inner = None if "prefixItems" in resolved(items or {}) else items
        else:
            patterns = [*schema.get("patternProperties", {}).values()]
            any_name = patterns[0] if patterns else schema.get("additionalProperties")
            inner = schema.get("properties", {}).get(part, any_name)
        exists = isinstance(value, list) or (isinstance(value, Mapping) and part in value)
        if not isinstance(inner, dict) or not exists:
            return _Entry(path[:depth], schema, value)
        schema, value = resolved(inner), value[part]
    return _Entry(path, schema, value)


def resolved(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema behind a reference, or the only alternative to null.

    If the key has its own words for the allowed values, the result keeps them.
    """
    options = _not_null(schema)
    if "$ref" in schema:
        options = [json_schema()["$defs"][schema["$ref"].rpartition("/")[2]]]
    if len(options) != 1:
        return schema
    key_words = {"allowed": schema["allowed"]} if "allowed" in schema else {}
    return resolved(options[0]) | key_words


def words(schema: dict[str, Any]) -> str:
    """Return in words which values a schema allows."""
    schema = resolved(schema)
    kind = schema.get("type")
    if "allowed" in schema:
        return schema["allowed"]
    if "anyOf" in schema:
        return ", or ".join(map(words, _not_null(schema)))
    if "const" in schema or "enum" in schema:
        return ", ".join(map(str, schema.get("enum", [schema.get("const")])))
    if kind == "array" and "items" in schema:
        items = re.sub(r"^a (whole number|number|mapping)", r"\1s", words(schema["items"]))
        different = "different " if schema.get("uniqueItems") else ""
        least = ", at least one" if schema.get("minItems") else ""
        return f"a list of {different}{items}{least}"
    if kind in ("number", "integer"):
        noun = "a number" if kind == "number" else "a whole number"
        return f"{noun} {_range(schema)}".strip()
    return {"boolean": "true or false", "string": "text"}.get(str(kind), "a mapping")


def _not_null(schema: Mapping) -> list[dict[str, Any]]:
    """Return the alternatives of a schema other than null."""
    return [option for option in schema.get("anyOf", []) if option.get("type") != "null"]


def _range(schema: Mapping) -> str:
    """Return the limits of a number in words."""
    given = {key: f"{schema[key]:g}" for key in SIGNS if key in schema}
    # An exponent is written without leading zeros.
    limits = {key: re.sub(r"e\+?(-?)0", r"e\1", limit) for key, limit in given.items()}
    if {*limits} == {"minimum", "maximum"}:
        return f"from {limits['minimum']} to {limits['maximum']}"
    return " and ".join(f"{SIGNS[key]} {limit}" for key, limit in limits.items())


def _remedy(value: object) -> str:
    """Return advice if a value is text that was meant as a number."""
    text = value.strip() if isinstance(value, str) else ""
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text, re.ASCII):
        return " (text: write the number without quotes)"
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        return f" (write {text.replace(',', '.')}, with a point)"
    return ""
