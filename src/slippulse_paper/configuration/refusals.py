"""Messages that refuse a configuration, made from the errors of pydantic.

Each error becomes one line with the key, the value and the allowed values. The allowed values are
taken from the JSON Schema of the configuration.
"""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

from pydantic import BaseModel

from slippulse.model.checks import short_repr

from .problems import spelling_hint
from .schema import LABEL_WORDS, NAME_WORDS, Configuration, Measure, Model, NamedScene, Simulation

# Users correct a few mistakes at a time.
MAX_LINES = 20
LIMIT_SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
# Pydantic appends this to the path of an entry if the key itself is not allowed.
PYDANTIC_KEY_MARK = "[key]"
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
    return ".".join(map(_key_text, path)) or "the configuration"


def _key_text(part: str | int) -> str:
    """Return a key as it is, or shortened and in quotes if it is long or has special characters."""
    is_plain = re.fullmatch(r"\w{1,80}", str(part), re.ASCII)
    return str(part) if is_plain else short_repr(part)


def problem_line(problem: Mapping, config: Mapping) -> str:
    """Return the line of the refusal for one error of pydantic.

    ``problem`` is the error, and ``config`` the configuration that is refused.
    """
    kind, path = problem["type"], problem["loc"]
    if path and path[-1] == PYDANTIC_KEY_MARK:
        return _name_line(path)
    entry = _last_known_entry(path, config)
    # Find the mapping that may be in error. The path of an unknown or missing key ends with the
    # key. If the mapping is only one of several forms that a value may have, the known entry ends
    # before it. The value is then refused as a whole, without regard to its keys.
    mapping_path = path if kind == "value_error" else path[:-1]
    is_known_mapping = len(mapping_path) <= len(entry.path)
    if is_known_mapping:
        # The line is None for an error of a single value.
        line = _mapping_line(problem, config)
        if line is not None:
            return line
    allowed = "a finite number" if kind == "finite_number" else words_for(entry.schema)
    given = f"{dotted(entry.path)}: {_value_text(entry.value)}"
    return f"{given}; allowed: {allowed}{_hint_at_number_in_text(entry.value)}"


def _mapping_line(problem: Mapping, config: Mapping) -> str | None:
    """Return the refusal of a mapping that is not valid as a whole, or has a wrong or missing key.

    Returns None if the error is of another kind. The parameters are those of `problem_line`.
    """
    kind, path = problem["type"], problem["loc"]
    if kind == "value_error":
        # The reason begins with the key in the mapping.
        reason = str(problem["ctx"]["error"])
        return f"{dotted(path)}.{reason}" if path else reason
    # A missing key has a text at the end of the path. A missing number in a row has an int there,
    # and is not described here.
    if kind == "missing" and isinstance(path[-1], str):
        return _missing_line(path, config)
    return _unknown_key_line(path, config) if kind == "extra_forbidden" else None


def _name_line(path: Path) -> str:
    """Return the refusal of a name that has characters which are not allowed."""
    # The last part of the path is PYDANTIC_KEY_MARK.
    *parents, name, _ = path
    allowed = LABEL_WORDS if path[0] in ("presets", "published") else NAME_WORDS
    return f"{dotted(parents)}: {short_repr(name)}; allowed: {allowed}"


def _unknown_key_line(path: Path, config: Mapping) -> str:
    """Return the refusal of an unknown key, with a hint at the key that was probably meant."""
    known_keys = [*_last_known_entry(path, config).schema["properties"]]
    hint = spelling_hint(path[-1], known_keys) or _hint_at_other_blocks(path[-1])
    return f"{dotted(path)}: unknown key{hint}; allowed: {', '.join(known_keys)}"


def _value_text(value: Any) -> str:
    """Return a refused value as text. Null, true and false are written as in YAML."""
    is_yaml_word = value is None or isinstance(value, bool)
    return json.dumps(value) if is_yaml_word else short_repr(value)


def _hint_at_other_blocks(key: str | int) -> str:
    """Return a hint at the blocks of the configuration that have a key, or no text if none has."""
    blocks: dict[str, type[BaseModel]] = {
        "simulations.NAME": Simulation,
        "scenes.NAME": NamedScene,
        "model": Model,
        "measure": Measure,
    }
    places = [f"{name}.{key}" for name, block in blocks.items() if key in block.model_fields]
    return f" (this key is set by {' and '.join(places)})" if places else ""


def _missing_line(path: Path, config: Mapping) -> str:
    """Return the refusal of a mapping without a required key."""
    line = f"{dotted(path)}: missing; it is required (null removes a key)"
    if path == ("preset",) and config.get("presets"):
        line += f"; allowed: {', '.join(config['presets'])}"
    if len(path) > 2 and isinstance(path[-2], str):
        # In a path such as simulations.NAME.boundary, NAME may be the misspelt name of a shipped
        # entry, which has all keys.
        siblings = _last_known_entry(path[:-2], config).value
        line += spelling_hint(path[-2], {*siblings} - {path[-2]})
        if path[0] == "simulations" and path[-2].startswith("fig"):
            line += "; docs/figures.md lists the simulations of each figure"
    return line


class _Entry(NamedTuple):
    """An entry of the configuration: its path, the schema for it and its value."""

    path: Path
    schema: dict[str, Any]
    value: Any


def _last_known_entry(path: Path, config: Any) -> _Entry:
    """Return the last entry on a path of pydantic that has a value and a single schema.

    The path may lead on to a missing key, or to one of several allowed forms of a value.
    """
    schema, value = dereferenced(json_schema()), config
    for depth, part in enumerate(path):
        # A part of the path is the key of a mapping or the number of an entry of a list.
        if isinstance(part, int):
            inner_schema = _schema_of_list_entry(schema)
        else:
            inner_schema = _schema_of_key(schema, part)
        exists = isinstance(value, list) or (isinstance(value, Mapping) and part in value)
        if not isinstance(inner_schema, dict) or not exists:
            return _Entry(path[:depth], schema, value)
        schema, value = dereferenced(inner_schema), value[part]
    return _Entry(path, schema, value)


def _schema_of_list_entry(schema: Mapping) -> Any:
    """Return the schema for the entries of a list, or None if there is none.

    The result is also None if the entries are rows of numbers. A wrong row is refused with the
    whole list, whose schema describes the rows.
    """
    items = schema.get("items")
    # In JSON Schema, only a row of a fixed length has this key.
    has_rows = items is not None and "prefixItems" in dereferenced(items)
    return None if has_rows else items


def _schema_of_key(schema: Mapping, key: str) -> Any:
    """Return the schema for the value of a key in a mapping, or None if there is none.

    The keys of a mapping are either fixed, or names that match a pattern. In the second case, all
    values have the same schema.
    """
    properties = schema.get("properties", {})
    if key in properties:
        return properties[key]
    patterns = [*schema.get("patternProperties", {}).values()]
    return patterns[0] if patterns else schema.get("additionalProperties")


def dereferenced(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the schema that a reference leads to, or the only alternative to null.

    Other schemas are returned as they are. The entry ``allowed`` of the given schema, which
    describes the allowed values in words, is kept.
    """
    alternatives = _not_null(schema)
    if "$ref" in schema:
        # A reference has the form #/$defs/NAME.
        name = schema["$ref"].rpartition("/")[2]
        target = json_schema()["$defs"][name]
    elif len(alternatives) == 1:
        target = alternatives[0]
    else:
        return schema
    result = dereferenced(target)
    return {**result, "allowed": schema["allowed"]} if "allowed" in schema else result


def words_for(schema: dict[str, Any]) -> str:
    """Return in words which values a schema allows.

    The definition of a key may have these words (``allowed``). Otherwise they follow from the type.
    """
    schema = dereferenced(schema)
    json_type = schema.get("type")
    if "allowed" in schema:
        return schema["allowed"]
    if "anyOf" in schema:
        return ", or ".join(map(words_for, _not_null(schema)))
    if "const" in schema:
        return str(schema["const"])
    if "enum" in schema:
        return ", ".join(map(str, schema["enum"]))
    if json_type == "array" and "items" in schema:
        return _list_words(schema)
    if json_type == "number":
        return f"a number {_range(schema)}".strip()
    if json_type == "integer":
        return f"a whole number {_range(schema)}".strip()
    return {"boolean": "true or false", "string": "text"}.get(str(json_type), "a mapping")


def _list_words(schema: Mapping) -> str:
    """Return in words which lists a schema allows, such as "a list of numbers > 0"."""
    # The plural of the words for one entry, such as "numbers > 0" for "a number > 0".
    items = re.sub(r"^a (whole number|number|mapping)", r"\1s", words_for(schema["items"]))
    different = "different " if schema.get("uniqueItems") else ""
    at_least = ", at least one" if schema.get("minItems") else ""
    return f"a list of {different}{items}{at_least}"


def _not_null(schema: Mapping) -> list[dict[str, Any]]:
    """Return the alternatives that a schema allows, without null."""
    return [option for option in schema.get("anyOf", []) if option.get("type") != "null"]


def _range(schema: Mapping) -> str:
    """Return the limits of a number in words, such as "> 0 and <= 1"."""
    limits: dict[str, str] = {}
    # The keys are those of JSON Schema, such as exclusiveMinimum.
    for key in LIMIT_SIGNS:
        if key in schema:
            # Exponents are written without plus signs and leading zeros.
            limits[key] = re.sub(r"e\+?(-?)0?", r"e\1", f"{schema[key]:g}")
    if {*limits} == {"minimum", "maximum"}:
        return f"from {limits['minimum']} to {limits['maximum']}"
    return " and ".join(f"{LIMIT_SIGNS[key]} {limit}" for key, limit in limits.items())


def _hint_at_number_in_text(value: object) -> str:
    """Return advice if a value is text that was meant as a number, and no text otherwise."""
    text = value.strip() if isinstance(value, str) else ""
    # A number, such as -1.5e3.
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text, re.ASCII):
        return " (text: write the number without quotes)"
    # A number with a decimal comma.
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        return f" (write {text.replace(',', '.')}, with a point)"
    return ""
