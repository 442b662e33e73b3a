"""Write the table of one figure, then draw the figure from that table alone."""

from importlib import import_module

from slippulse.data.tables import load_table, save_table
from slippulse.plotting.style import house_style, save_figure

from .inputs import load_inputs


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the table of a figure as ``csv``, and the figure as ``png`` and ``pdf``.

    The files are those that `load_inputs` reads. The settings have the name of the module of the
    figure (``figure``), the ``values`` of the configuration that the figure reads, and a note on
    altered parameters (``altered``), which may be empty.
    """
    module = import_module(f"slippulse_paper.figures.{settings['figure']}")
    note = settings["altered"]
    inputs = load_inputs(files)
    table = module.table(inputs.data, inputs.tables, settings["values"])
    save_table(table.assign(altered=note) if note else table, outputs["csv"])
    # Read the table again, so that the figure shows nothing that the file does not contain.
    table = load_table(outputs["csv"]).drop(columns="altered", errors="ignore")
    with house_style():
        save_figure(module.draw(table), outputs["png"], outputs["pdf"], note)
