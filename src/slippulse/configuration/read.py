"""The configuration as Snakemake merged it, brought into its plain form and checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from .overlay import read_scalar
from .validate import validate

# What make and the command line may say for a switch.
SWITCHES = dict.fromkeys(("1", "true", "yes", "on"), True) | dict.fromkeys(("0", "false", "no", "off"), False)


def read_config(
    config: dict, shipped: Mapping, command_line: Mapping | None = None, every_run: bool = True
) -> None:
    """Bring a merged configuration into its plain form, in place, and refuse what is wrong with it.

    Parameters
    ----------
    config : config/config.yaml with the overlays and the command line merged into it; where an overlay says null, the
        key is removed
    shipped : the configuration without overlays
    command_line : what was given by --config, in which Snakemake leaves nested numbers text
    every_run : see `validate`

    Raises
    ------
    ConfigError
        One line a problem: the key, the value, what is allowed.
    """
    merged = merge(_plain(config), _typed(_plain(command_line or {})))
    removed = list(_nulls(merged))
    merged = _without_nulls(merged)
    validate(merged, _plain(shipped), every_run, removed)
    config.clear()
    config.update(merged)


def merge(base: Mapping, overlay: Mapping) -> dict:
    """Mappings merged, all else replaced, as Snakemake merges configurations."""
    merged = dict(base)
    for key, value in overlay.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
        merged[key] = merge(merged[key], value) if both else value
    return merged


def _plain(value):
    """Dicts with text as keys, and lists."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    return [_plain(entry) for entry in value] if isinstance(value, list | tuple) else value


def _typed(values: Mapping) -> dict:
    """Values of the command line, with what is text there read as in a file."""

    def typed(value, place):
        if isinstance(value, Mapping):
            return {key: typed(entry, f"{place}.{key}") for key, entry in value.items()}
        if isinstance(value, list):
            return [typed(entry, place) for entry in value]
        return read_scalar(value, place) if isinstance(value, str) else value

    switches = {
        key: SWITCHES.get(str(value).lower(), value) for key, value in values.items() if key == "allow_large"
    }
    return {key: typed(value, key) for key, value in values.items() if key not in switches} | switches


def _nulls(value: Mapping, place: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for key, entry in value.items():
        if entry is None:
            yield (*place, key)
        elif isinstance(entry, Mapping):
            yield from _nulls(entry, (*place, key))


def _without_nulls(value: Mapping) -> dict:
    return {
        key: _without_nulls(entry) if isinstance(entry, Mapping) else entry
        for key, entry in value.items()
        if entry is not None
    }
