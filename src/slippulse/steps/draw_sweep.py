"""Write the table of a sweep of one's own and draw it."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.store import load_table, save_table
from ..figures import own_sweep
from ..figures.style import save_figure


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: measured. Outputs: csv, png, pdf. Settings: share."""
    save_table(own_sweep.table(load_table(files["measured"]), settings["share"]), outputs["csv"])
    save_figure(own_sweep.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])
