"""What an overlay changed."""

from collections.abc import Mapping


def changes(shipped: object, config: object, key: str = "") -> list[dict]:
    """What an overlay changed below a key: one entry a value, shipped and here; None where one has nothing."""
    if isinstance(shipped, Mapping) and isinstance(config, Mapping):
        return [
            change
            for name in dict.fromkeys([*shipped, *config])
            for change in changes(shipped.get(name), config.get(name), f"{key}.{name}".lstrip("."))
        ]
    return [] if shipped == config else [{"key": key, "shipped": shipped, "here": config}]
