"""The configuration: what is shipped, the overlays and the command line, merged and checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from ..model.checks import ConfigError, nearest
from .check import simulation_problems
from .overlay import read_scalar
from .problems import dotted, format_problems, refused
from .schema import Configuration

# What make and the command line may say for a switch.
SWITCHES = dict.fromkeys(("1", "true", "yes", "on"), True) | dict.fromkeys(("0", "false", "no", "off"), False)


def read_config(
    shipped: Mapping,
    overlays: Sequence[Mapping] = (),
    command_line: Mapping | None = None,
    every_run: bool = True,
) -> Configuration:
    """The configuration, checked.

    Parameters
    ----------
    shipped : config/config.yaml
    overlays : what differs, one after the other; null removes a key
    command_line : what was given by --config, in which Snakemake leaves nested numbers text
    every_run : whether the scenes of all simulations are checked too

    Raises
    ------
    ConfigError
        One line a problem: the key, the value, what is allowed.
    """
    merged = dict(shipped)
    for overlay in (*overlays, _typed(command_line or {})):
        merged = merge(merged, overlay)
    sweeps = merged.get("simulations")
    for name in shipped["simulations"]:
        if isinstance(sweeps, Mapping) and name not in sweeps:
            raise ConfigError(
                f"simulations.{name}: null; allowed: what is shipped stays, since figures and verdicts need it"
            )
    try:
        config = Configuration.model_validate(merged)
    except ValidationError as error:
        raise ConfigError(format_problems(refused(error, merged))) from None
    if every_run and (problems := simulation_problems(config)):
        raise ConfigError(format_problems(problems))
    return config


def merge(base: Mapping, overlay: Mapping, place: tuple[str, ...] = ()) -> dict[str, Any]:
    """Mappings merged, all else replaced; null removes a key.

    Raises
    ------
    ConfigError
        Where null is said of a misspelt key.
    """
    merged = dict(base)
    for key, value in overlay.items():
        if value is None:
            if key not in merged and (hint := nearest(key, merged)):
                raise ConfigError(
                    f"{dotted((*place, key))}: null{hint}; allowed: null for a key that there is"
                )
            merged.pop(key, None)
        elif isinstance(value, Mapping):
            inside = merged.get(key)
            merged[key] = merge(inside if isinstance(inside, Mapping) else {}, value, (*place, key))
        else:
            merged[key] = value
    return merged


def _typed(value: Any, place: str = "") -> Any:
    """Values of the command line, with what is text there read as in a file."""
    if isinstance(value, Mapping):
        return {key: _typed(entry, f"{place}.{key}".lstrip(".")) for key, entry in value.items()}
    if isinstance(value, list):
        return [_typed(entry, place) for entry in value]
    if place == "allow_large":
        return SWITCHES.get(str(value).lower(), value)
    return read_scalar(value, place) if isinstance(value, str) else value
