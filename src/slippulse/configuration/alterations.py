"""What a run's configuration has that the shipped one has not."""

from __future__ import annotations

from collections.abc import Mapping


def changes(shipped: object, config: object, key: str = "") -> list[dict]:
    """What an overlay changed: one entry a value, with the shipped one beside it.

    Parameters
    ----------
    shipped, config : the configuration without and with overlays
    key : where in the configuration both stand

    Returns
    -------
    list of dicts with key, shipped, here; None where one side has nothing
    """
    if isinstance(shipped, Mapping) and isinstance(config, Mapping):
        names = [*shipped, *(name for name in config if name not in shipped)]
        return [
            change
            for name in names
            for change in changes(shipped.get(name), config.get(name), f"{key}.{name}".lstrip("."))
        ]
    return [] if shipped == config else [{"key": key, "shipped": shipped, "here": config}]
