"""Renamed keys of the configuration. Their old names can be used for one more version."""

from collections.abc import Mapping, Sequence
from typing import Any

from slippulse.model.checks import short_repr

from .problems import ConfigError

# For each block of the configuration that has renamed keys: their new names, by their old names.
RENAMED_KEYS = {"measure": {"share": "fraction"}}


def with_new_names(overlay: Mapping[str, Any]) -> dict[str, Any]:
    """Return an overlay in which every renamed key has its new name.

    Raises ConfigError if the overlay contains both the old and the new name of a key.
    """
    renamed = dict(overlay)
    for block, new_names in RENAMED_KEYS.items():
        if not isinstance(overlay.get(block), Mapping):
            continue
        renamed[block] = {}
        for key, value in overlay[block].items():
            new_name = new_names.get(key, key)
            if new_name != key and new_name in overlay[block]:
                problem = f"{block}.{key}: {short_repr(value)}, in addition to {block}.{new_name}"
                raise ConfigError(
                    f"{problem}; allowed: only one of the two keys, {block}.{new_name}"
                )
            renamed[block][new_name] = value
    return renamed


def rename_warnings(overlays: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return one line for each old name that some overlay uses."""
    lines = []
    for block, new_names in RENAMED_KEYS.items():
        blocks = [overlay.get(block) for overlay in overlays]
        mappings = [keys for keys in blocks if isinstance(keys, Mapping)]
        for old_name, new_name in new_names.items():
            if any(old_name in keys for keys in mappings):
                line = f"{block}.{old_name} is now {block}.{new_name}"
                lines.append(f"{line}; the old name is valid for one more version")
    return lines
