"""Evaluation of expressions in double braces in Markdown, as in jinja2 templates."""

import re
from collections.abc import Mapping
from numbers import Real
from traceback import extract_tb

from jinja2 import Environment, StrictUndefined, TemplateError

from .numerals import FILTERS, MISSING, number

MAX_QUOTED_LENGTH = 100
# Where a paragraph ends, where an item of a list begins, and where a sentence ends. An abbreviation
# may be taken for the end of a sentence.
PARAGRAPH_END = re.compile(r"(\n\s*\n)")
ITEM_START = re.compile(r"(?m)^(?=- )")
SENTENCE_END = re.compile(r"(?:(?<=[.!?])|(?<=[.!?][*)])|(?<=[.!?]\*\*))(?=\s+[A-Z$`*\[(])")
# A paragraph that begins like this is a table, code, or a formula.
NOT_PROSE = ("|", "`" * 3, "$$", "---")
# The words in bold type or italics with which a paragraph may begin.
LEAD = re.compile(r"\*{1,2}[^*]+\*{1,2}")


class Prose(Environment):
    """An environment of jinja2 in which an attribute or an entry of None is None."""

    def getattr(self, obj: object, attribute: str) -> object:
        """Return an attribute of an object, or None if the object is None."""
        return None if obj is None else super().getattr(obj, attribute)

    def getitem(self, obj: object, argument: object) -> object:
        """Return an entry of an object, or None if the object is None."""
        return None if obj is None else super().getitem(obj, argument)


def _default_text(value: object) -> object:
    """Return the text of a value to which no filter of the template was applied.

    A number gets three significant digits, None becomes "not measured", and a text stays as it is.
    """
    if isinstance(value, Real):
        return number(float(value))
    return number(None) if value is None else value


PROSE = Prose(undefined=StrictUndefined, finalize=_default_text)
PROSE.filters |= FILTERS


def fill(text: str, names: Mapping[str, object]) -> str:
    """Return a text in which each ``{{ expression }}`` is replaced by its value.

    ``names`` has the values that the expressions use. Raises ValueError with the line of a wrong
    expression.
    """
    try:
        return PROSE.from_string(text).render(names)
    except (TemplateError, ValueError, TypeError, ArithmeticError, LookupError) as error:
        line = text.splitlines()[_line_number(error) - 1]
        quoted = " ".join(line.split())[:MAX_QUOTED_LENGTH]
        raise ValueError(f"{quoted}: {type(error).__name__}: {error}") from None


def without_missing(text: str) -> str:
    """Return a text in Markdown without the sentences in which a number is missing.

    Tables, code and formulas are kept. A paragraph or an item of a list is left out if nothing else
    than the emphasised words at its beginning would remain.
    """
    if MISSING not in text:
        return text
    return "".join(map(_measured_part, PARAGRAPH_END.split(text)))


def _measured_part(paragraph: str) -> str:
    """Return a paragraph without the sentences in which a number is missing."""
    if MISSING not in paragraph or paragraph.startswith(NOT_PROSE):
        return paragraph
    items = []
    for item in ITEM_START.split(paragraph):
        bullet = "- " if item.startswith("- ") else ""
        sentences = SENTENCE_END.split(item.removeprefix(bullet))
        kept = "".join(sentence for sentence in sentences if MISSING not in sentence).lstrip()
        if kept and not LEAD.fullmatch(kept.strip()):
            items.append(bullet + kept.rstrip("\n"))
    return "\n".join(items)


def _line_number(error: Exception) -> int:
    """Return the number of the line, from 1, at which the evaluation of a text has failed."""
    frames = extract_tb(error.__traceback__)
    numbers = [frame.lineno for frame in frames if frame.filename == "<template>"]
    # An error of syntax has no frame in the template, but the number of the line as an attribute.
    line_number = numbers[-1] if numbers else getattr(error, "lineno", None)
    return line_number or 1
