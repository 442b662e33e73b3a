"""Selection of the values of a configuration that a job depends on."""

from collections.abc import Iterable, Mapping
from copy import deepcopy


def selected(config: Mapping, keys: Iterable[str], additions: Mapping) -> dict:
    """Return the values of some dotted keys, nested as in the configuration, and ``additions``.

    For example, the keys ["model.release"] give {"model": {"release": "total"}}.
    """
    values = deepcopy(dict(additions))
    for key in keys:
        *parents, last = key.split(".")
        # Go down to the block with the key in both, and make this block where it is missing.
        selected_block, block = values, config
        for parent in parents:
            selected_block = selected_block.setdefault(parent, {})
            block = block[parent]
        selected_block[last] = block[last]
    return values
