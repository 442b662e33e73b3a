"""Write what theory predicts of every run of one simulation, or of one chunk of it."""

from ..configuration.expand import expand
from ..data.store import save_table
from ..predict.table import predictions

# Formulas are compared beyond what is kept of measured numbers.
DIGITS = 15


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: predicted. Settings: sweep (resolved), share and still, as in `measure` of the configuration."""
    scenes, _ = expand(settings["sweep"])
    save_table(predictions(scenes, settings["share"], settings["still"]), outputs["predicted"], DIGITS)
