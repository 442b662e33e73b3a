"""Make the table of one study."""

from importlib import import_module

from slippulse.data.tables import save_table

from .inputs import given


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: as of `given`. Outputs: table. Settings: study (its module), values."""
    study = import_module(f"slippulse_paper.studies.{settings['study']}")
    save_table(study.table(*given(files), settings["values"]), outputs["table"])
