"""What a step of the workflow gets of the configuration."""

from __future__ import annotations

import copy
from collections.abc import Iterable


def selected(config: dict, keys: Iterable[str], own: dict) -> dict:
    """What a step gets: the declared keys of the configuration alone, nested as there, beside its own values."""
    found = copy.deepcopy(own)
    for key in keys:
        *parents, last = key.split(".")
        inside, value = found, config
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = value[last]
    return found
