"""Keys of the configuration that have a new name, whose old name is read for one more version."""

from collections.abc import Iterable, Mapping
from typing import Any

from slippulse.model.checks import short_repr

from .problems import ConfigError

# Old and new name, for each block of the configuration that has renamed keys.
RENAMED_KEYS = {"measure": {"share": "fraction"}}


def with_new_names(overlay: Mapping[str, Any]) -> dict[str, Any]:
    """Return an overlay in which every renamed key has its new name.

    Raises ConfigError if the overlay sets a key by its old and by its new name.
    """
    renamed = dict(overlay)
    for block, names in RENAMED_KEYS.items():
        if not isinstance(overlay.get(block), Mapping):
            continue
        renamed[block] = {}
        for key, value in overlay[block].items():
            new_name = names.get(key, key)
            if new_name != key and new_name in overlay[block]:
                problem = f"{block}.{key}: {short_repr(value)}, in addition to {block}.{new_name}"
                raise ConfigError(f"{problem}; allowed: one of them, {block}.{new_name}")
            renamed[block][new_name] = value
    return renamed


def rename_warnings(overlays: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return one line for each old name that an overlay uses."""
    lines: dict[str, None] = {}
    for overlay in overlays:
        for block, names in RENAMED_KEYS.items():
            keys = overlay.get(block)
            for old_name in names.keys() & keys if isinstance(keys, Mapping) else ():
                line = f"{block}.{old_name} is now {block}.{names[old_name]}"
                lines[f"{line}; the old name is read for one more version"] = None
    return [*lines]
