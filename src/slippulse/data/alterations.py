"""What an overlay changed."""

from collections.abc import Mapping


def changes(shipped: object, config: object, key: str = "") -> list[dict]:
    """What an overlay changed: one entry a value, with key, shipped and here; None where one side has nothing.

    Parameters
    ----------
    shipped, config : the configuration without and with overlays
    key : where in the configuration both stand
    """
    if isinstance(shipped, Mapping) and isinstance(config, Mapping):
        return [
            change
            for name in dict.fromkeys([*shipped, *config])
            for change in changes(shipped.get(name), config.get(name), f"{key}.{name}".lstrip("."))
        ]
    return [] if shipped == config else [{"key": key, "shipped": shipped, "here": config}]
