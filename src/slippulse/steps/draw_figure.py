"""Write the table of one figure, then draw the figure from that table alone."""

from importlib import import_module

from ..data.tables import load_table, save_table
from ..figures.style import save_figure
from .inputs import given


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: as of `given`. Outputs: csv, png, pdf. Settings: figure (its module), values."""
    module = import_module(f"slippulse.figures.{settings['figure']}")
    save_table(module.table(*given(files), settings["values"]), outputs["csv"])
    save_figure(module.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])
