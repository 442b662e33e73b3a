"""The names that the cells and the prose of the report use."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from .. import theory
from ..configuration.parameters import parameters
from ..data.alterations import changes
from ..data.prose import FILTERS, fill
from ..model.prestress import Prestress
from .accuracy import attempt, edges, grid_studies, presets, speeds, sticking
from .alterations import alteration_note
from .captions import read_captions
from .errata import errata_table
from .figures import Gallery, placed_figures
from .inputs import Inputs
from .ledger import LedgerTables
from .markdown import CLOSE, FLUSH, SMALL, WIDE
from .statements import Statements

SOURCE = "replication.md"


def define(names: dict[str, object], inputs: Inputs, show: Callable[[str], None]) -> None:
    """Define what the report is written with.

    Parameters
    ----------
    names : where to; what the cells add later, the errata see too
    inputs : what the report is written from
    show : puts Markdown into the report
    """
    claim = LedgerTables(inputs.claims, inputs.config["claims"], inputs.findings)
    names |= FILTERS | {"claim": claim, "found": claim.found, "statements": Statements(inputs.statements)}
    names |= {"config": inputs.config, "inputs": inputs, "show": show}
    names["runs"] = partial(parameters, inputs.config)
    names |= {"CLOSE": CLOSE, "FLUSH": FLUSH, "SMALL": SMALL, "WIDE": WIDE, "np": np, "theory": theory}
    altered = changes(inputs.shipped, inputs.config)
    names["tolerances_altered"] = any(change["key"].startswith("claims.") for change in altered)
    for function in (Prestress, attempt, edges, grid_studies, presets, speeds, sticking):
        names[function.__name__] = function

    captions = read_captions(Path(inputs.manuscript) / "captions.yaml", lambda text: fill(text, names))
    placed = placed_figures(inputs.text(SOURCE))
    gallery = Gallery(inputs.figures, placed, captions, inputs.figures_folder)

    def further() -> None:
        for name in gallery.unplaced:
            show(gallery.figure(name))

    names |= {
        "alteration_note": lambda: alteration_note(
            inputs.config, inputs.shipped, inputs.claims, inputs.shipped_verdicts
        ),
        "errata": lambda: errata_table(inputs.errata, lambda text: fill(text, names)),
        "figure": lambda name: show(gallery.figure(name)),
        "further": further,
        "see": gallery.see,
    }


def define_by_hand(names: dict[str, object]) -> None:
    """The same for a notebook opened inside a project with finished results; what it shows stands below the cell."""
    from IPython.display import Markdown, display

    folder = Path.cwd()
    project = next(path for path in (folder, *folder.parents) if (path / "config/config.yaml").exists())
    define(names, Inputs.of_project(project), lambda markdown: display(Markdown(markdown)))
