"""Compute the table of one study."""

from importlib import import_module

from slippulse.data.tables import save_table

from .inputs import load_inputs


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the ``table`` of a study.

    The files are those that `load_inputs` reads. The settings have the name of the module of the
    study (``study``), and the ``values`` of the configuration that the study reads.
    """
    study = import_module(f"slippulse_paper.studies.{settings['study']}")
    inputs = load_inputs(files)
    table = study.table(inputs.data, inputs.tables, settings["values"])
    save_table(table, outputs["table"])
