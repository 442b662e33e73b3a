"""Write the predictions of theory for every run of one simulation, or of one chunk of it."""

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module

import numpy as np
import pandas as pd

from ..configuration.runs import runs
from ..data.tables import save_table
from ..model.run import Run

TOPICS = ("final_regime", "front", "pulse", "transition")
# Formulas are compared to more digits than measured numbers have.
DIGITS = 15
# Theory knows these laws of friction, which are those that the exact continuum has.
KNOWN_LAWS = ("coulomb", "linear_rate")


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: predicted. Settings: sweep (resolved), topics; share, still (of `measure`)."""
    table = predictions(settings["topics"], [*runs(settings["sweep"])], settings)
    save_table(table, outputs["predicted"], DIGITS)


def predictions(topics: Iterable[str], swept: Sequence[Run], settings: Mapping) -> pd.DataFrame:
    """Join the predictions of some modules of `predict`, one row a run; NaN where there is none."""
    modules = [import_module(f"slippulse.predict.{topic}") for topic in topics]
    table = pd.concat([module.predictions(swept, settings) for module in modules], axis=1)
    unknown = [one.friction["law"] not in KNOWN_LAWS for one in swept]
    return table.mask(np.array(unknown)) if any(unknown) else table
