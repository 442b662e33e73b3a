"""Write the table of a user-defined sweep and draw it."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.store import load_table, save_table
from ..figures import own_sweep
from ..figures.style import save_figure


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: measured, predicted. Outputs: csv, png, pdf."""
    runs = load_table(files["measured"]).join(load_table(files["predicted"]))
    save_table(own_sweep.table(runs), outputs["csv"])
    save_figure(own_sweep.plot(load_table(outputs["csv"])), outputs["png"], outputs["pdf"])
