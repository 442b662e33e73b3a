"""Write the table of one figure, then draw the figure from that table alone."""

from importlib import import_module

from slippulse.data.tables import load_table, save_table
from slippulse.plotting.style import house_style, save_figure

from .inputs import load_inputs


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write ``csv``, ``png`` and ``pdf`` of a figure from files of the kinds of `load_inputs`.

    The settings have the figure (the name of its module), the values of the configuration that it
    reads, and the note ``altered``.
    """
    module = import_module(f"slippulse_paper.figures.{settings['figure']}")
    note = settings["altered"]
    inputs = load_inputs(files)
    table = module.table(inputs.data, inputs.tables, settings["values"])
    save_table(table.assign(altered=note) if note else table, outputs["csv"])
    drawn = load_table(outputs["csv"]).drop(columns="altered", errors="ignore")
    with house_style():
        save_figure(module.draw(drawn), outputs["png"], outputs["pdf"], note)
