"""Writes what follows from the definition of the keys: the JSON Schema, and the tables of config/README.md.

python docs/describe.py      in the folder of the project, or with its path
"""

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from slippulse.configuration.read import read_overlay
from slippulse.configuration.refusals import json_schema, resolved, words

README, SCHEMA, SHIPPED = (
    "config/README.md",
    "workflow/schemas/config.schema.yaml",
    "config/config.yaml",
)
# A table stands between these two lines; the first names the model, and where its values stand in config/config.yaml.
TABLE = re.compile(r"(<!-- keys: (\w+)(?: at (\w+))? -->\n).*?(<!-- end of keys -->)", re.DOTALL)
HEAD = "| key | meaning | allowed | default |\n|---|---|---|---|\n"
LONGEST_DEFAULT = 40


def schema_text() -> str:
    """The JSON Schema of the whole configuration, as YAML."""
    text = yaml.safe_dump(
        json_schema(), sort_keys=False, allow_unicode=True, default_flow_style=None, width=110
    )
    return (
        "# Written by `make describe` from src/slippulse/configuration/schema.py, for editors and catalogues.\n"
        f"$schema: https://json-schema.org/draft/2020-12/schema\n{text}"
    )


def rows(node: dict[str, Any], values: Mapping | None = None, prefix: str = "") -> Iterator[str]:
    """One line for each key of a mapping and of what is nested in it, by its schema and its shipped values if any."""
    for name, key in node["properties"].items():
        inside = resolved(key)
        mapping = inside.get("type") == "object"
        if name in node.get("required", ()):
            default = "required" if mapping or values is None else _short(values[name])
        else:
            default = (
                "none" if mapping or key.get("default") in (None, []) else _short(key["default"])
            )
        cells = (f"`{prefix}{name}`", key["description"], words(key), default)
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
        if "properties" in inside and node is not json_schema():
            yield from rows(inside, values and values[name], f"{prefix}{name}.")


def _short(value: Any) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, width=1000).replace("\n...\n", "").strip()
    if len(text) > LONGEST_DEFAULT and isinstance(value, list):
        text = f"{value[0]} to {value[-1]}, {len(value)} values"
    return text


def readme(text: str, shipped: Mapping) -> str:
    """The text of config/README.md with its tables made anew, by the values in config/config.yaml."""

    def table(found: re.Match) -> str:
        start, name, place, end = found.groups()
        values = shipped if place == "top" else shipped.get(place)
        node = json_schema() if name == "Configuration" else json_schema()["$defs"][name]
        return f"{start}{HEAD}" + "\n".join(rows(node, values)) + f"\n{end}"

    return TABLE.sub(table, text)


def main(root: str = ".") -> None:
    """Write both files of a project."""
    folder = Path(root)
    (folder / SCHEMA).write_text(schema_text(), encoding="utf-8")
    manual = (folder / README).read_text(encoding="utf-8")
    (folder / README).write_text(readme(manual, read_overlay(folder / SHIPPED)), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
