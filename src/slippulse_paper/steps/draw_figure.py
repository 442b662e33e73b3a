"""Write the table of one figure, then draw the figure from that table alone."""

from importlib import import_module

from slippulse.data.tables import load_table, save_table
from slippulse.plotting.style import house_style, save_figure

from .inputs import given


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: as of `given`. Outputs: csv, png, pdf. Settings: figure, values, altered."""
    module, note = (
        import_module(f"slippulse_paper.figures.{settings['figure']}"),
        settings["altered"],
    )
    table = module.table(*given(files), settings["values"])
    save_table(table.assign(altered=note) if note else table, outputs["csv"])
    drawn = load_table(outputs["csv"]).drop(columns="altered", errors="ignore")
    with house_style():
        save_figure(module.draw(drawn), outputs["png"], outputs["pdf"], note)
