"""Join one file of each chunk of a simulation: data, or a table of any kind."""

from ..data.join import join_datasets, join_grid_studies, join_tables
from ..data.saving import save_dataset
from ..data.tables import load_table
from ..measurement.table import LABELS, PARAMETERS
from ..measurement.uncertainty import quantities


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: chunks, finest (joined measurements). Outputs: joined. Settings: kind, record."""
    kind = settings["kind"]
    chunks, joined = files["chunks"], outputs["joined"]
    if kind == "data":
        save_dataset(join_datasets(chunks, settings["record"]), joined)
    elif kind == "uncertainties":
        finest = files["finest"][0]
        keys = [*PARAMETERS, *(name for name in LABELS if name in load_table(finest))]
        join_grid_studies(chunks, finest, keys, quantities, joined)
    else:
        join_tables(chunks, joined)
