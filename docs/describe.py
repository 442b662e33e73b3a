"""Write the JSON Schema, the tables of config/README.md and rows of docs/columns.md.

The schema and the tables follow from the definition of the keys of the configuration, and the rows
from the definition of the numbers of a scene.

python docs/describe.py      in the folder of the project, or with its path
"""

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from slippulse.model.scene import SCENE_NUMBERS
from slippulse_paper.configuration.read import read_overlay
from slippulse_paper.configuration.refusals import dereferenced, json_schema, words_for

README = "config/README.md"
SCHEMA = "workflow/schemas/config.schema.yaml"
SHIPPED = "config/config.yaml"
COLUMNS = "docs/columns.md"
# A table of keys is between two comments. The first one names the class of the keys, and the key of
# config/config.yaml that has their shipped values.
TABLE = re.compile(
    r"(?P<start><!-- keys: (?P<class>\w+)(?: at (?P<key>\w+))? -->\n)"
    r".*?(?P<end><!-- end of keys -->)",
    re.DOTALL,
)
HEAD = "| key | meaning | allowed | default |\n|---|---|---|---|\n"
LONGEST_DEFAULT = 40


def schema_text() -> str:
    """Return the JSON Schema of the whole configuration as YAML."""
    text = yaml.safe_dump(
        json_schema(), sort_keys=False, allow_unicode=True, default_flow_style=None, width=110
    )
    source = "src/slippulse_paper/configuration/schema.py, for editors and catalogues"
    standard = "https://json-schema.org/draft/2020-12/schema"
    return f"# Written by `make describe` from {source}.\n$schema: {standard}\n{text}"


def rows(schema: dict[str, Any], values: Mapping | None = None, prefix: str = "") -> Iterator[str]:
    """Yield one line for each key of a mapping, and for each key nested in it.

    values : shipped values of the mapping, if there are any
    prefix : the keys above the mapping, with dots
    """
    for name, key in schema["properties"].items():
        inner = dereferenced(key)
        if name not in schema.get("required", ()):
            default = _default(key)
        elif values is None or inner.get("type") == "object":
            default = "required"
        else:
            default = _short(values[name])
        cells = (f"`{prefix}{name}`", key["description"], words_for(key), default)
        yield f"| {' | '.join(map(_escaped, cells))} |"
        if "properties" in inner and schema is not json_schema():
            yield from rows(inner, values and values[name], f"{prefix}{name}.")


def _default(key: Mapping) -> str:
    """Return the default of an optional key as text."""
    default = key.get("default")
    has_default = dereferenced(dict(key)).get("type") != "object" and default not in (None, [])
    return _short(default) if has_default else "none"


def _escaped(cell: str) -> str:
    """Return the text of a cell, in which a bar does not end the cell."""
    return cell.replace("|", r"\|")


def _short(value: Any) -> str:
    """Return a value as YAML, or the ends of a list if it is long."""
    text = yaml.safe_dump(value, default_flow_style=True, width=1000).replace("\n...\n", "").strip()
    if len(text) > LONGEST_DEFAULT and isinstance(value, list):
        text = f"{value[0]} to {value[-1]}, {len(value)} values"
    return text


def readme(text: str, shipped: Mapping) -> str:
    """Return the text of config/README.md with new tables; ``shipped`` is config/config.yaml."""

    def table(match: re.Match) -> str:
        name, key = match["class"], match["key"]
        values = shipped if key == "top" else shipped.get(key)
        schema = json_schema() if name == "Configuration" else json_schema()["$defs"][name]
        lines = "\n".join(rows(schema, values))
        return f"{match['start']}{HEAD}{lines}\n{match['end']}"

    return TABLE.sub(table, text)


def columns(text: str) -> str:
    """Return the text of docs/columns.md with the rows of all numbers of a scene."""
    head, rule, table = text.partition("|---|---|---|\n")
    # Each row begins with the name of its column in backquotes.
    rows_by_name = {row.split("`")[1]: row for row in table.splitlines()}
    for name, number in SCENE_NUMBERS.items():
        rows_by_name[name] = f"| `{name}` | {number.unit} | {_escaped(number.meaning)} |"
    sorted_rows = [rows_by_name[name] for name in sorted(rows_by_name)]
    return head + rule + "\n".join(sorted_rows) + "\n"


def main(root: str = ".") -> None:
    """Write the three files of a project."""
    folder = Path(root)
    (folder / SCHEMA).write_text(schema_text(), encoding="utf-8")
    manual = (folder / README).read_text(encoding="utf-8")
    (folder / README).write_text(readme(manual, read_overlay(folder / SHIPPED)), encoding="utf-8")
    table = (folder / COLUMNS).read_text(encoding="utf-8")
    (folder / COLUMNS).write_text(columns(table), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
