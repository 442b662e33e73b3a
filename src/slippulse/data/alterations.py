"""Values that an overlay changed."""

from collections.abc import Mapping


def changes(shipped: object, config: object, key: str = "") -> list[dict]:
    """List the values that differ below a key, as shipped and as here; an absent one is None."""
    if not (isinstance(shipped, Mapping) and isinstance(config, Mapping)):
        return [] if shipped == config else [{"key": key, "shipped": shipped, "here": config}]
    changed = []
    for name in dict.fromkeys([*shipped, *config]):
        dotted = f"{key}.{name}" if key else str(name)
        changed += changes(shipped.get(name), config.get(name), dotted)
    return changed
