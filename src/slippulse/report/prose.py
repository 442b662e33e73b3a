"""Prose with expressions in double braces, evaluated where the cells ran."""

from __future__ import annotations

import re
from collections.abc import Mapping

from .numerals import number

EXPRESSION = re.compile(r"\{\{(.+?)\}\}", re.S)


def fill(text: str, names: Mapping[str, object]) -> str:
    """Replace each ``{{ expression }}`` by its value.

    Parameters
    ----------
    text : Markdown
    names : what the expressions may use

    Raises
    ------
    ValueError
        If an expression fails, with the expression and the reason.

    A number is written with three significant digits; text goes in as it is.
    """

    def value(match: re.Match) -> str:
        expression = " ".join(match[1].split())
        try:
            found = eval(expression, dict(names))
        except Exception as error:
            raise ValueError(f"{{{{ {expression} }}}}: {type(error).__name__}: {error}") from None
        return found if isinstance(found, str) else number(found)

    return EXPRESSION.sub(value, text)
