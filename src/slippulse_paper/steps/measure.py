"""Measure every run of one simulation and write the table."""

from slippulse.data.store import load_dataset
from slippulse.data.tables import save_table
from slippulse.prediction.comparison import measured_table


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the table ``measured`` from ``data``.

    The settings have the settings of the measurements (``measure``).
    """
    table = measured_table(load_dataset(files["data"]), settings["measure"])
    save_table(table, outputs["measured"])
