"""Measure every run of one simulation and write the table."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.store import load_dataset, save_table
from ..predict.measured import measured_table


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: data. Outputs: measured. Settings: measure (how to measure)."""
    save_table(measured_table(load_dataset(files["data"]), settings["measure"]), outputs["measured"])
