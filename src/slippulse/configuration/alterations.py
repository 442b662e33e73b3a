"""What differs between two configurations."""

from __future__ import annotations

from collections.abc import Mapping


def alterations(config: object, shipped: object, key: str = "") -> list[dict]:
    """Values at which a configuration differs from the shipped one, in the order of the shipped one.

    Parameters
    ----------
    config, shipped : with and without overlays, nested mappings of builtins
    key : where in the configuration both stand

    Returns
    -------
    list of dicts with key (dotted), shipped and here; None where one side has nothing
    """
    if isinstance(shipped, Mapping) and isinstance(config, Mapping):
        return [
            found
            for name in {**shipped, **config}
            for found in alterations(config.get(name), shipped.get(name), f"{key}.{name}".lstrip("."))
        ]
    return [] if config == shipped else [{"key": key, "shipped": shipped, "here": config}]
