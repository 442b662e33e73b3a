"""Run one study of the solver and write its table."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module

from ..data.store import save_table


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Outputs: table. Settings: module (of the study), values (what it takes from the configuration)."""
    study = import_module(f"slippulse.{settings['module']}")
    save_table(study.table(settings["values"]), outputs["table"])
