"""Types of values in the configuration."""

from typing import Annotated, Any, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError

T = TypeVar("T")


class Block(BaseModel):
    """A mapping of the configuration: no keys but its own, no conversions, finite numbers."""

    model_config = ConfigDict(
        extra="forbid", strict=True, allow_inf_nan=False, defer_build=True, serialize_by_alias=True
    )

    def given(self) -> dict[str, Any]:
        """What was given, as builtins."""
        return self.model_dump(mode="json", exclude_unset=True)

    def plain(self) -> dict[str, Any]:
        """The same with its defaults, without what has none."""
        return self.model_dump(mode="json", exclude_none=True)


def allowed(words: str) -> dict[str, Any]:
    """What a key allows, where its type does not say it in words."""
    return {"allowed": words}


def require(condition: bool, problem: str) -> None:
    """Raise with a problem, as "key: value; allowed: ...", unless a condition holds."""
    if not condition:
        raise ValueError(problem)


def _all_different(values: list[T]) -> list[T]:
    if len({repr(value) for value in values}) < len(values):
        raise PydanticCustomError("different", "an entry twice")
    return values


# A list of different entries, at least one.
Distinct = Annotated[
    list[T], Field(min_length=1, json_schema_extra={"uniqueItems": True}), AfterValidator(_all_different)
]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Spacing = Annotated[float, Field(gt=0.0, le=1.0)]
Count = Annotated[int, Field(ge=1)]
Boundary = Literal["displacement", "stress"]
Release = Literal["total", "elastic"]
Scheme = Literal["localised", "fixed_step", "continuum"]
Record = Literal["fronts", "fields", "samples"]
# Rows of numbers, which YAML has as lists.
Step = Annotated[tuple[float, float], Field(strict=False)]
Bump = Annotated[tuple[float, float, float], Field(strict=False)]
NAME_WORDS = "a name of lower-case letters, digits and underscores that begins with a letter"
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
Title = Annotated[
    str,
    Field(
        max_length=120,
        pattern=r"^[^\x00-\x1f\x7f-\x9f]*[^\s\x00-\x1f\x7f-\x9f][^\x00-\x1f\x7f-\x9f]*$",
        json_schema_extra=allowed("one line of at most 120 printable characters, not blank"),
    ),
]
