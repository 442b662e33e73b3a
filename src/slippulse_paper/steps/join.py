"""Join the files of the chunks of a simulation, which are data or tables of one kind."""

from slippulse.data.saving import save_dataset

from .joined_files import join_datasets, join_grid_studies, join_tables


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the file ``joined`` from the files ``chunks``.

    The settings have the ``kind`` of these files, and the kinds of data that the runs ``record``.
    If the kind is "uncertainties", the file ``finest`` has the joined table of measured numbers.
    """
    kind = settings["kind"]
    chunks, joined = files["chunks"], outputs["joined"]
    if kind == "data":
        save_dataset(join_datasets(chunks, settings["record"]), joined)
    elif kind == "uncertainties":
        join_grid_studies(chunks, files["finest"][0], joined)
    else:
        join_tables(chunks, joined)
