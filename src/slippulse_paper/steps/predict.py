"""Write the predictions of theory for every run of one simulation, or of one chunk of it."""

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module

import pandas as pd

from slippulse.data.tables import save_table
from slippulse.model.run import Run

from ..configuration.runs import runs

TOPICS = ("final_regime", "front", "pulse", "transition")
MODULES = {
    "final_regime": "predicted_regime",
    "front": "predicted_front",
    "pulse": "predicted_pulse",
    "transition": "predicted_transition",
}
# Formulas are compared to more digits than measured numbers have.
DIGITS = 15


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: predicted. Settings: sweep (resolved), topics, fraction and still (of `measure`)."""
    table = predictions(settings["topics"], [*runs(settings["sweep"])], settings)
    save_table(table, outputs["predicted"], DIGITS)


def predictions(topics: Iterable[str], swept: Sequence[Run], settings: Mapping) -> pd.DataFrame:
    """Join the predictions of some modules of `predict`, one row a run; NaN where there is none."""
    tables = []
    for topic in topics:
        module = import_module(f"slippulse.prediction.{MODULES[topic]}")
        table = module.predictions(swept, settings)
        # A number that ignores the friction of a run is worse than none.
        known = [one.friction["law"] in module.LAWS for one in swept]
        tables.append(table[known].reindex(table.index))
    return pd.concat(tables, axis=1)
