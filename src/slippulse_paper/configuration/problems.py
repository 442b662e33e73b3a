"""Errors of a configuration, and hints at what was probably meant."""

import difflib
from collections.abc import Iterable


class ConfigError(ValueError):
    """Refusal of a configuration: one line a problem, with key, value and what is allowed."""


def nearest(name: object, known: Iterable[str]) -> str:
    """A hint at the known name that was probably meant; empty where none is near."""
    near = difflib.get_close_matches(str(name)[:80], list(known), n=1)
    return f" (did you mean {near[0]!r}?)" if near else ""
