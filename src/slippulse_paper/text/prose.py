"""Evaluate expressions in double braces in Markdown, with the rules of jinja2 templates."""

from collections.abc import Mapping
from numbers import Real
from traceback import extract_tb

from jinja2 import Environment, StrictUndefined, TemplateError

from .numerals import FILTERS, number


class Prose(Environment):
    """Rules of the expressions: an unknown name is an error, and an attribute of None is None."""

    def getattr(self, obj: object, attribute: str) -> object:
        return None if obj is None else super().getattr(obj, attribute)

    def getitem(self, obj: object, argument: object) -> object:
        return None if obj is None else super().getitem(obj, argument)


def _text(value: object) -> object:
    """Write a number that has no filter with three significant digits, and leave texts alone."""
    if isinstance(value, Real):
        return number(float(value))
    return number(None) if value is None else value


PROSE = Prose(undefined=StrictUndefined, finalize=_text)
PROSE.filters |= FILTERS


def fill(text: str, names: Mapping[str, object]) -> str:
    """Evaluate each ``{{ expression }}`` of a text; a ValueError quotes the line that fails."""
    try:
        return PROSE.from_string(text).render(names)
    except (TemplateError, ValueError, TypeError, ArithmeticError, LookupError) as error:
        frames = extract_tb(error.__traceback__)
        numbers = [frame.lineno for frame in frames if frame.filename == "<template>"]
        last = (numbers[-1] if numbers else getattr(error, "lineno", None)) or 1
        line = " ".join(text.splitlines()[last - 1].split())[:100]
        raise ValueError(f"{line}: {type(error).__name__}: {error}") from None
