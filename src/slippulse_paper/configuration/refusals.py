"""Refusals in words: each problem that pydantic reports, as one line about its key."""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from pydantic import BaseModel

from slippulse.model.checks import short_repr

from .problems import nearest
from .schema import LABEL_WORDS, NAME_WORDS, Configuration, Measure, Model, NamedScene, Simulation

# A refusal has this number of lines at most: a reader mends a few mistakes at a time.
LINES = 20
SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
Path = Sequence[str | int]
json_schema = cache(Configuration.model_json_schema)


def format_problems(problems: Sequence[str]) -> str:
    """The first problems, one a line, and how many more there are."""
    lines = [*problems[:LINES]]
    if len(problems) > LINES:
        lines.append(f"... and {len(problems) - LINES} more")
    return "\n".join(lines)


def dotted(path: Path) -> str:
    """A key as a refusal names it: its path with dots."""
    plain = re.compile(r"\w{1,80}", re.ASCII).fullmatch
    parts = [str(part) if plain(str(part)) else short_repr(part) for part in path]
    return ".".join(parts) or "the configuration"


def problem_line(problem: Mapping, config: Mapping) -> str:
    """One error of pydantic about a configuration, as a line."""
    kind, path = problem["type"], problem["loc"]
    if kind == "value_error":
        reason = str(problem["ctx"]["error"])
        return f"{dotted(path)}.{reason}" if path else reason
    if kind == "missing" and isinstance(path[-1], str):
        return _missing_line(path, config)
    if path[-1] == "[key]":
        allowed = LABEL_WORDS if path[0] in ("presets", "published") else NAME_WORDS
        return f"{dotted(path[:-2])}: {short_repr(path[-2])}; allowed: {allowed}"
    known_path, schema, value = _deepest(path, config)
    if kind == "extra_forbidden":
        known = [*schema["properties"]]
        allowed = ", ".join(known)
        hint = nearest(path[-1], known) or _elsewhere(path[-1])
        return f"{dotted(path)}: unknown key{hint}; allowed: {allowed}"
    allowed = "a finite number" if kind == "finite_number" else words(schema)
    # Words of YAML, not of Python.
    given = json.dumps(value) if value is None or isinstance(value, bool) else short_repr(value)
    return f"{dotted(known_path)}: {given}; allowed: {allowed}{_remedy(value)}"


def _elsewhere(key: str | int) -> str:
    """Hint at the blocks of named entries that have a key, such as gamma."""
    blocks: dict[str, type[BaseModel]] = {"simulations.NAME": Simulation, "scenes.NAME": NamedScene}
    blocks |= {"model": Model, "measure": Measure}
    places = [f"{block}.{key}" for block, keys in blocks.items() if key in keys.model_fields]
    return f" (it is set by {' and '.join(places)})" if places else ""


def _missing_line(path: Path, config: Mapping) -> str:
    line = f"{dotted(path)}: missing; it is required (null removes a key)"
    if path == ("preset",) and config.get("presets"):
        line += f"; allowed: {', '.join(config['presets'])}"
    if len(path) > 2 and isinstance(path[-2], str):
        # An incomplete new entry may be a misspelt one.
        _, _, siblings = _deepest(path[:-2], config)
        line += nearest(path[-2], {*siblings} - {path[-2]})
    return line


def _deepest(path: Path, config: Any) -> tuple[Path, dict[str, Any], Any]:
    """Path, schema and value of the last entry on a path for which there is one schema."""
    schema, value = resolved(json_schema()), config
    for depth, part in enumerate(path):
        if isinstance(part, int):
            # A row of numbers is named with the list that it is in, which says what a row is.
            items = schema.get("items")
            inner = None if "prefixItems" in resolved(items or {}) else items
        else:
            patterns = [*schema.get("patternProperties", {}).values()]
            any_name = patterns[0] if patterns else schema.get("additionalProperties")
            inner = schema.get("properties", {}).get(part, any_name)
        exists = isinstance(value, list) or (isinstance(value, Mapping) and part in value)
        if not isinstance(inner, dict) or not exists:
            return path[:depth], schema, value
        schema, value = resolved(inner), value[part]
    return path, schema, value


def resolved(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema behind a reference or an alternative to null; words of the key itself stay."""
    options = _not_null(schema)
    if "$ref" in schema:
        options = [json_schema()["$defs"][schema["$ref"].rpartition("/")[2]]]
    if len(options) != 1:
        return schema
    key_words = {"allowed": schema["allowed"]} if "allowed" in schema else {}
    return resolved(options[0]) | key_words


def words(schema: dict[str, Any]) -> str:
    """Values that a schema allows, in words."""
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
    """The alternatives of a schema other than null."""
    return [option for option in schema.get("anyOf", []) if option.get("type") != "null"]


def _range(schema: Mapping) -> str:
    """The limits of a number in words."""
    given = {key: f"{schema[key]:g}" for key in SIGNS if key in schema}
    # An exponent is written without zeros in front.
    limits = {key: re.sub(r"e\+?(-?)0", r"e\1", limit) for key, limit in given.items()}
    if {*limits} == {"minimum", "maximum"}:
        return f"from {limits['minimum']} to {limits['maximum']}"
    return " and ".join(f"{SIGNS[key]} {limit}" for key, limit in limits.items())


def _remedy(value: object) -> str:
    """Advice on text that was meant as a number."""
    text = value.strip() if isinstance(value, str) else ""
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text, re.ASCII):
        return " (text: write the number without quotes)"
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        return f" (write {text.replace(',', '.')}, with a point)"
    return ""
