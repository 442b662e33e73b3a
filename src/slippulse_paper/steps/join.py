"""Join the files of the chunks of a simulation, which are data or tables of one kind."""

from slippulse.data.saving import save_dataset
from slippulse.data.tables import load_table
from slippulse.measurement.table import LABELS, PARAMETERS
from slippulse.measurement.uncertainty import studied_columns

from .joined_files import join_datasets, join_grid_studies, join_tables


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the file ``joined`` from the files ``chunks``.

    The settings have the ``kind`` of these files, and the kinds of data that the runs ``record``.
    If the kind is uncertainties, the file ``finest`` has the joined measurements.
    """
    kind = settings["kind"]
    chunks, joined = files["chunks"], outputs["joined"]
    if kind == "data":
        save_dataset(join_datasets(chunks, settings["record"]), joined)
    elif kind == "uncertainties":
        finest = files["finest"][0]
        # Columns that identify a run.
        keys = [*PARAMETERS, *(name for name in LABELS if name in load_table(finest))]
        join_grid_studies(chunks, finest, keys, studied_columns, joined)
    else:
        join_tables(chunks, joined)
