"""Write what theory predicts of every run of one simulation, or of one chunk of it."""

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module

import pandas as pd

from ..configuration.expand import expand
from ..data.tables import save_table
from ..model.scene import Scene

# Modules of `predict`.
TOPICS = ("final_regime", "front", "pulse", "transition")
# Formulas are compared beyond what is kept of measured numbers.
DIGITS = 15


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: predicted. Settings: sweep (resolved), topics, share and still, as in `measure` of the configuration."""
    scenes, _ = expand(settings["sweep"])
    save_table(predictions(settings["topics"], scenes, settings), outputs["predicted"], DIGITS)


def predictions(topics: Iterable[str], scenes: Sequence[Scene], settings: Mapping) -> pd.DataFrame:
    """What the paper and the exact theory say of each run by some modules of `predict`; NaN where they say nothing."""
    found = [
        import_module(f"slippulse.predict.{topic}").predictions(scenes, settings)
        for topic in topics
    ]
    return pd.concat(found, axis=1)
