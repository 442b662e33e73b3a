"""The error for a configuration that is not allowed, and hints at misspelt names."""

import difflib
from collections.abc import Iterable


class ConfigError(ValueError):
    """Refusal of a configuration: a line for each problem, with key, value and what is allowed."""


def spelling_hint(name: object, known: Iterable[str]) -> str:
    """Return a hint such as " (did you mean 'gamma'?)"; empty if no known name is similar."""
    similar = difflib.get_close_matches(str(name)[:80], list(known), n=1)
    return f" (did you mean {similar[0]!r}?)" if similar else ""
