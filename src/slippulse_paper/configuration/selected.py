"""Selection of the values of a configuration that a job depends on."""

from collections.abc import Iterable, Mapping
from copy import deepcopy


def selected(config: Mapping, keys: Iterable[str], additions: Mapping) -> dict:
    """Return the part of a configuration that consists of some dotted keys, and ``additions``.

    Values are nested as in the configuration.
    """
    values = deepcopy(dict(additions))
    for key in keys:
        *parents, last = key.split(".")
        selected_block, block = values, config
        for parent in parents:
            selected_block = selected_block.setdefault(parent, {})
            block = block[parent]
        selected_block[last] = block[last]
    return values
