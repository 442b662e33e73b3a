"""Make the table of one study."""

from importlib import import_module

from slippulse.data.tables import save_table

from .inputs import load_inputs


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the ``table`` of a study from files of the kinds of `load_inputs`.

    The settings have the study (the name of its module) and the values of the configuration that
    it reads.
    """
    study = import_module(f"slippulse_paper.studies.{settings['study']}")
    inputs = load_inputs(files)
    table = study.table(inputs.data, inputs.tables, settings["values"])
    save_table(table, outputs["table"])
