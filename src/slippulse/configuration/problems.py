"""What the definition of the keys refuses, in lines that a reader can act on: key, value, what is allowed."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from pydantic import ValidationError
from pydantic.json_schema import GenerateJsonSchema

from ..model.checks import nearest, short_repr
from .schema import NAME_WORDS, Configuration

# Lines of a refusal; a reader mends a few at a time.
LINES = 20
SIGNS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}


def format_problems(problems: Sequence[str]) -> str:
    """The first problems, one a line, and how many more there are."""
    rest = [f"... and {len(problems) - LINES} more"] if len(problems) > LINES else []
    return "\n".join([*problems[:LINES], *rest])


class _Untitled(GenerateJsonSchema):
    def field_title_should_be_set(self, schema: Any) -> bool:
        """Of no key, since a title would be its name again."""
        return False


@cache
def json_schema() -> dict[str, Any]:
    """The JSON Schema of the configuration."""
    return Configuration.model_json_schema(schema_generator=_Untitled)


def refused(error: ValidationError, config: Mapping) -> list[str]:
    """One line for each key that is refused.

    Parameters
    ----------
    error : of the validation of a configuration
    config : that configuration, builtins
    """
    # Errors inside of an alternative, as 'same' or a list, are one line about the key.
    return sorted({_line(problem, config) for problem in error.errors(include_url=False)})


def _line(problem: Mapping, config: Mapping) -> str:
    kind, place = problem["type"], problem["loc"]
    if kind == "value_error":
        return ".".join(filter(None, [dotted(place) if place else "", str(problem["ctx"]["error"])]))
    depth, node, value = _walk(place, config)
    if kind == "missing":
        # An incomplete new entry may be a misspelt one.
        others = _walk(place[:-2], config)[2] if len(place) > 2 else {}
        hint = nearest(place[-2], {*others} - {place[-2]}) if others else ""
        presets = config.get("presets", ()) if place == ("preset",) else ()
        names = f"; allowed: {', '.join(presets)}" if presets else ""
        return f"{dotted(place)}: missing; it is required (null removes a key){hint}{names}"
    if kind == "extra_forbidden":
        known = [*node["properties"]]
        return f"{dotted(place)}: unknown key{nearest(place[-1], known)}; allowed: {', '.join(known)}"
    if place[-1] == "[key]":
        return f"{dotted(place[:-2])}: {short_repr(place[-2])}; allowed: {NAME_WORDS}"
    allowed = "a finite number" if kind == "finite_number" else words(node)
    return f"{dotted(place[:depth])}: {short_repr(value)}; allowed: {allowed}{_remedy(value)}"


def _walk(place: Sequence[str | int], config: Any) -> tuple[int, dict[str, Any], Any]:
    """Depth, schema and value at a place, as far as there is one schema for it."""
    node, value = resolved(json_schema()), config
    for depth, part in enumerate(place):
        named = [*node.get("patternProperties", {}).values(), node.get("additionalProperties")]
        inside = (
            node.get("items") if isinstance(part, int) else node.get("properties", {}).get(part, named[0])
        )
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
    return resolved(inside) | {key: node[key] for key in ("allowed",) if key in node} if inside else node


def words(node: dict[str, Any]) -> str:
    """What a schema allows, in words."""
    node = resolved(node)
    if "allowed" in node:
        return node["allowed"]
    if "anyOf" in node:
        return ", or ".join(words(option) for option in node["anyOf"] if option.get("type") != "null")
    if "const" in node or "enum" in node:
        return ", ".join(map(repr, node.get("enum", [node.get("const")]))).replace("'", "")
    kind = node.get("type")
    if kind == "array":
        item = words(node["items"]).replace("a whole number", "whole numbers").replace("a number", "numbers")
        different = "different " if node.get("uniqueItems") else ""
        return f"a list of {different}{item}" + (", at least one" if node.get("minItems") else "")
    if kind in ("number", "integer"):
        text = " and ".join(f"{sign} {_plain(node[key])}" for key, sign in SIGNS.items() if key in node)
        if "minimum" in node and "maximum" in node:
            text = f"from {_plain(node['minimum'])} to {_plain(node['maximum'])}"
        return f"{'a number' if kind == 'number' else 'a whole number'} {text}".strip()
    return {"boolean": "true or false", "string": "text"}.get(str(kind), "a mapping")


def _plain(bound: float) -> str:
    """A bound as it is written."""
    return f"{bound:g}".replace("e-0", "e-").replace("e+0", "e")


def dotted(place: Sequence[str | int]) -> str:
    """A key as a refusal names it."""
    parts = (
        str(part) if re.fullmatch(r"\w{1,80}", str(part), re.ASCII) else short_repr(part) for part in place
    )
    return ".".join(parts) or "the configuration"


def _remedy(value: object) -> str:
    """What to write instead of text that was meant as a number."""
    text = value.strip() if isinstance(value, str) else ""
    if re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", text, re.ASCII):
        return " (text: write the number without quotes)"
    return f" (write {text.replace(',', '.')}, with a point)" if re.fullmatch(r"[-+]?\d+,\d+", text) else ""
