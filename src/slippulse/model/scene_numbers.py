"""Definition of a number of `Scene` in one place: default, range, unit, symbol and meaning.

`number` makes the field of a number. The definitions are read by the checks of a scene, data files,
measured tables, the configuration, figures and docs/columns.md.
"""

from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any


@dataclass(frozen=True)
class NumberDefinition:
    """Definition of a number of a scene."""

    meaning: str  # as data files and docs/columns.md describe it
    symbol: str  # in TeX, for axes and captions
    unit: str  # "1" or "count"
    bounds: Mapping[str, Any]  # in the form that `check_number` takes
    extra_term: bool  # True if the paper's equation does not have the term of this number
    default: float | None  # None if every scene has to give the number


def number(
    meaning: str,
    symbol: str,
    default: float | None = None,
    *,
    unit: str = "1",
    extra_term: bool = False,
    **bounds: Any,
) -> Any:
    """Return the dataclass field of a number, with its definition in the field's metadata.

    meaning, symbol, unit : see `NumberDefinition`
    default : None for a number without a default value
    extra_term : True for the coefficient of a term that the paper's equation does not have. The
        default value leaves out the term.
    bounds : allowed range, as in `check_number`
    """
    definition = NumberDefinition(meaning, symbol, unit, bounds, extra_term, default)
    field_default: Any = MISSING if default is None else default
    return field(default=field_default, metadata={"definition": definition})


def definitions_of(scene: type) -> dict[str, NumberDefinition]:
    """Return the definitions of all fields of a dataclass that were made by `number`, by name."""
    definitions = {}
    for item in fields(scene):
        if "definition" in item.metadata:
            definitions[item.name] = item.metadata["definition"]
    return definitions
