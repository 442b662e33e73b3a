"""Put the measured tables of a simulation's chunks into one."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.join import count_rows, joined_table, save_rows


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: chunks. Outputs: measured."""
    save_rows(joined_table(files["chunks"], count_rows(files["chunks"])), outputs["measured"])
