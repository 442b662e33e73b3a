"""Write the predictions of theory for every run of one simulation, or of one chunk of it."""

from collections.abc import Container, Iterable, Mapping, Sequence
from importlib import import_module

import pandas as pd

from slippulse.data.tables import save_table
from slippulse.model.run import Run
from slippulse.model.scene import used_extra_terms

from ..configuration.runs import runs

TOPICS = ("final_regime", "front", "pulse", "transition")
# The module in slippulse.prediction for each topic.
MODULES = {
    "final_regime": "predicted_regime",
    "front": "predicted_front",
    "pulse": "predicted_pulse",
    "transition": "predicted_transition",
}
# Formulas are compared with more digits than measured numbers have.
DIGITS = 15


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the table ``predicted`` for the resolved simulation ``sweep`` in the settings.

    The settings also have the topics of the predictions (``topics``), and two fractions. Under a
    stress boundary, the left front has covered the part ``fraction`` of its path at the transition.
    A point counts as at rest below the part ``still`` of the largest slip velocity.
    """
    swept_runs = [*runs(settings["sweep"])]
    table = predictions(settings["topics"], swept_runs, settings)
    save_table(table, outputs["predicted"], DIGITS)


def predictions(
    topics: Iterable[str], swept_runs: Sequence[Run], settings: Mapping
) -> pd.DataFrame:
    """Return a table of the predictions on some topics, with one row for each run.

    A number is NaN if the theory does not cover the friction law or an extra term of the run. The
    settings are those of `run`.
    """
    tables = []
    for topic in topics:
        module = import_module(f"slippulse.prediction.{MODULES[topic]}")
        table = module.predictions(swept_runs, settings)
        is_covered = [_is_covered(swept_run, module.LAWS) for swept_run in swept_runs]
        # The rows of all other runs are removed, and added again with NaN.
        tables.append(table[is_covered].reindex(table.index))
    return pd.concat(tables, axis=1)


def _is_covered(swept_run: Run, laws: Container[str]) -> bool:
    """Return True if a run has one of some friction laws, and no extra term of the equation.

    Otherwise a prediction would ignore the friction law or the extra term, and be misleading.
    """
    return swept_run.friction["law"] in laws and not used_extra_terms(swept_run.extra_terms)
