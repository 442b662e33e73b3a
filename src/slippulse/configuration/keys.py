"""What the definition of the configuration is written in: types of values, each with the words of its refusal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    TypeAdapter,
    ValidationError,
)
from pydantic_core import PydanticCustomError

# Units of the tables in config/README.md, which says what they stand for.
LENGTH, TIME, STRESS = "H", "H/c", "S"


@dataclass(frozen=True)
class Allowed:
    """What a value may be, as a refusal and the tables say it."""

    text: str


class Block(BaseModel):
    """A mapping of the configuration: no keys but its own, no conversions."""

    # Built once, with the whole configuration around it.
    model_config = ConfigDict(extra="forbid", strict=True, defer_build=True)


def key(
    meaning: str, unit: str = "", origin: str = "ours", otherwise: str | None = None, alias: str | None = None
) -> Any:
    """One key.

    Parameters
    ----------
    meaning : for the table of config/README.md
    unit : of its numbers; empty where they have none
    origin : "paper", "figure" (read off a published one) or "ours"
    otherwise : what holds where the key is left out; None for a key that is required
    alias : the key, where Python has another use for the word
    """
    about = {"unit": unit, "origin": origin, "otherwise": otherwise}
    return Field(
        ... if otherwise is None else None, alias=alias, description=meaning, json_schema_extra=about
    )


def number(
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    below: float | None = None,
    whole: bool = False,
) -> Any:
    """The type of a finite number within bounds, or of a whole one."""
    bounds = {"gt": above, "ge": at_least, "le": at_most, "lt": below}
    if at_least is not None and at_most is not None:
        words = f" from {_plain(at_least)} to {_plain(at_most)}"
    elif above is not None and below is not None:
        words = f" between {above:g} and {below:g}"
    else:
        signs = {">": above, ">=": at_least, "<=": at_most, "<": below}
        words = " and ".join(f" {sign} {_plain(bound)}" for sign, bound in signs.items() if bound is not None)
        words = words.replace("and  ", "and ")
    bounds = {name: bound for name, bound in bounds.items() if bound is not None}
    if whole:
        return Annotated[int, Field(strict=True, **bounds), Allowed(f"a whole number{words}")]
    return Annotated[float, Field(strict=True, allow_inf_nan=False, **bounds), Allowed(f"a number{words}")]


def _plain(bound: float) -> str:
    """A bound as it is written in YAML."""
    if 0.01 <= abs(bound) < 1e6 or bound == 0.0:
        return f"{bound:g}"
    return f"{bound:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def allowed_text(kind: Any) -> str:
    """What a type made here allows."""
    return next(mark.text for mark in kind.__metadata__ if isinstance(mark, Allowed))


def choice(options: tuple[str, ...]) -> Any:
    """The type of one of several words."""
    return Annotated[Literal[options], Allowed(", ".join(options))]


def different(item: Any, words: str = "", least: int = 1, most: int | None = None) -> Any:
    """The type of a list of different values."""
    if not words:
        text = allowed_text(item)
        plural = text.replace("a whole number", "whole numbers").replace("a number", "numbers")
        words = f"a list of different {plural}, at least {('one', 'two', 'three', 'four')[least - 1]}"
    return Annotated[
        list[item],
        Field(min_length=least, max_length=most, json_schema_extra={"uniqueItems": True}),
        AfterValidator(_all_different),
        Allowed(words),
    ]


def _all_different(values: list) -> list:
    plain = [value.model_dump_json() if isinstance(value, BaseModel) else value for value in values]
    if len(set(plain)) < len(plain):
        raise PydanticCustomError("different", "an entry twice")
    return values


Number = number()


def row(*names: str, **kinds: Any) -> Any:
    """The type of a list of so many numbers, by name: any, or of a type of their own."""
    types = dict.fromkeys(names, Number) | kinds
    adapter = TypeAdapter(tuple[tuple(types.values())])
    bounds = "".join(f", {name} {allowed_text(kind)}" for name, kind in kinds.items())

    def within(values: list[float]) -> list[float]:
        try:
            return list(adapter.validate_python(values))
        except ValidationError:
            raise PydanticCustomError("bounds", "out of bounds") from None

    count = Field(min_length=len(types), max_length=len(types))
    return Annotated[list[Number], count, AfterValidator(within), Allowed(f"[{', '.join(types)}]{bounds}")]


def rows(*names: str, least: int = 0, **kinds: Any) -> Any:
    """The type of a list of such lists."""
    kind = row(*names, **kinds)
    return Annotated[list[kind], Field(min_length=least), Allowed(f"a list of {allowed_text(kind)}")]


Positive = number(above=0.0)
NonNegative = number(at_least=0.0)
Share = number(above=0.0, below=1.0)
Spacing = number(above=0.0, at_most=1.0)
Order = number(at_least=3, at_most=8, whole=True)
Count = number(at_least=1, whole=True)
Numbers, Positives, NonNegatives = different(Number), different(Positive), different(NonNegative)
Switch = Annotated[bool, Allowed("true or false")]
Sentence = Annotated[str, StringConstraints(min_length=1), Allowed("a sentence")]
Name = Annotated[
    str,
    StringConstraints(pattern=r"^[a-z][a-z0-9_]{0,60}$"),
    Allowed("a name of lower-case letters, digits and underscores that begins with a letter"),
]
