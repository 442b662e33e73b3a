"""Writes what follows from the definition of the keys: the JSON Schema, and the tables of config/README.md.

python -m slippulse.configuration.describe      in the folder of the project, or with its path
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, get_origin

import yaml

from . import schema, schema_simulations, schema_studies
from .keys import Allowed, Block
from .overlay import read_overlay
from .refusals import words_of

README, SCHEMA, SHIPPED = "config/README.md", "workflow/schemas/config.schema.yaml", "config/config.yaml"
# A table stands between these two lines; the first names the model, and where its values stand in config/config.yaml.
TABLE = re.compile(r"(<!-- keys: (\w+)(?: at ([\w.]+))? -->\n).*?(<!-- end of keys -->)", re.DOTALL)
HEAD = "| key | meaning | unit | allowed | default | origin |\n|---|---|---|---|---|---|\n"
LONGEST_DEFAULT = 40


def json_schema() -> str:
    """The JSON Schema of the whole configuration, as YAML."""
    plain = _without_titles(schema.Configuration.model_json_schema())
    text = yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, default_flow_style=None, width=110)
    return (
        "# Written by `make describe` from src/slippulse/configuration/schema.py, for editors and catalogues.\n"
        f"$schema: https://json-schema.org/draft/2020-12/schema\n{text}"
    )


def _without_titles(value: Any, of_properties: bool = False) -> Any:
    """A schema without what pydantic adds; what it says of a key is a sentence with the unit."""
    if isinstance(value, list):
        return [_without_titles(entry) for entry in value]
    if not isinstance(value, dict):
        return value
    if of_properties:
        return {name: _without_titles(entry) for name, entry in value.items()}
    kept = {
        name: _without_titles(entry, name in ("properties", "$defs"))
        for name, entry in value.items()
        if name not in ("title", "unit", "origin", "otherwise") and not (name == "default" and entry is None)
    }
    if value.get("unit"):
        kept["description"] += f" (unit: {value['unit']})"
    return kept


def rows(model: type[Block], values: Mapping | None = None, prefix: str = "") -> Iterator[str]:
    """One line of a table for each key of a model and of what is nested in it.

    Parameters
    ----------
    model : part of the definition
    values : its values in config/config.yaml, where it has a place there
    prefix : of its keys
    """
    for name, field in model.model_fields.items():
        name = field.alias or name
        about = field.json_schema_extra
        annotation, marks = field.annotation, field.metadata
        texts = [mark.text for mark in marks if isinstance(mark, Allowed)]
        nested = annotation if isinstance(annotation, type) and issubclass(annotation, Block) else None
        if about["otherwise"] is not None:
            default = about["otherwise"]
        elif values is None or nested or get_origin(annotation) is dict:
            default = "required"
        else:
            default = _short(values[name])
        allowed = texts[-1] if texts else words_of(annotation)
        cells = (f"`{prefix}{name}`", field.description, about["unit"], allowed, default, about["origin"])
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
        if nested and model is not schema.Configuration:
            yield from rows(nested, values and values[name], f"{prefix}{name}.")


def _short(value: Any) -> str:
    text = yaml.safe_dump(value, default_flow_style=True, width=1000).replace("\n...\n", "").strip()
    if len(text) > LONGEST_DEFAULT and isinstance(value, list):
        ends = "" if isinstance(value[0], list) else f"{value[0]} to {value[-1]}, "
        text = f"{ends}{len(value)} values"
    return text


def readme(text: str, shipped: Mapping) -> str:
    """The manual with its tables made anew.

    Parameters
    ----------
    text : of config/README.md
    shipped : config/config.yaml
    """
    homes = vars(schema_simulations) | vars(schema_studies) | vars(schema)

    def table(found: re.Match) -> str:
        start, name, place, end = found.groups()
        values: Any = shipped if place else None
        for part in (place or "").split(".") if place not in (None, "top") else ():
            values = values[part]
        return f"{start}{HEAD}" + "\n".join(rows(homes[name], values)) + f"\n{end}"

    return TABLE.sub(table, text)


def main(root: str = ".") -> None:
    """Write both files of a project."""
    folder = Path(root)
    (folder / SCHEMA).write_text(json_schema(), encoding="utf-8")
    manual = (folder / README).read_text(encoding="utf-8")
    (folder / README).write_text(readme(manual, read_overlay(folder / SHIPPED)), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
