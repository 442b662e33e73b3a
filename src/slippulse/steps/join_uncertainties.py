"""Put the grid studies of a simulation's chunks into one, and their tables on the coarser lattices."""

from __future__ import annotations

from collections.abc import Mapping

from ..data.join import joined_grid_study, joined_table, save_rows
from ..data.store import load_table
from ..measure.table import PARAMETERS
from ..measure.uncertainty import quantities


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: finest, uncertainties, coarser. Outputs: uncertainties, coarser."""
    measured = load_table(files["finest"])
    studied = quantities(measured, PARAMETERS)
    study = joined_grid_study(files["uncertainties"], measured, PARAMETERS, studied)
    save_rows(study, outputs["uncertainties"])
    save_rows(joined_table(files["coarser"], len(measured), last=("factor",)), outputs["coarser"])
