"""Put the data of a simulation's chunks into one file."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.join import join_datasets
from ..data.store import save_dataset


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: chunks. Outputs: data. Settings: record."""
    save_dataset(join_datasets(files["chunks"], settings["record"]), outputs["data"])
