"""Selection of the values of a configuration that a job depends on."""

from collections.abc import Iterable, Mapping
from copy import deepcopy


def selected(config: Mapping, keys: Iterable[str], additions: Mapping) -> dict:
    """Return the values of some dotted keys, nested as in the configuration, with additions."""
    values = deepcopy(dict(additions))
    for key in keys:
        target, source = values, config
        *parents, last = key.split(".")
        for parent in parents:
            target, source = target.setdefault(parent, {}), source[parent]
        target[last] = source[last]
    return values
