"""Write the table of one figure, then draw the figure from that table alone."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path

from ..data.store import load_dataset, load_table, save_table
from ..figures.style import save_figure


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: data, measured, coarser. Outputs: csv, png, pdf. Settings: figure (its module), values."""
    module = import_module(f"slippulse.figures.{settings['figure']}")
    table = module.table(
        {Path(path).stem: load_dataset(path) for path in files["data"]},
        {Path(path).stem: load_table(path) for path in files["measured"]}
        | {f"coarser/{Path(path).stem}": load_table(path) for path in files["coarser"]},
        settings["values"],
    )
    save_table(table, outputs["csv"])
    save_figure(module.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])
