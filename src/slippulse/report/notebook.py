"""What the cells of the report use. `from slippulse.report.notebook import *` in its first cell opens the inputs."""

from __future__ import annotations

import inspect
from pathlib import Path

import numpy as np
from IPython.display import Markdown, display

from .. import theory
from ..model.prestress import Prestress
from .accuracy import grid_studies, presets, speeds
from .alterations import alteration_note
from .attempt import attempt
from .errata import errata_table
from .figures import Gallery, placed_figures
from .inputs import Inputs
from .ledger import Ledger
from .markdown import CLOSE, SMALL, WIDE
from .numerals import number, percent, setting
from .prose import fill

__all__ = [
    "CLOSE",
    "SMALL",
    "WIDE",
    "Prestress",
    "alteration_note",
    "attempt",
    "claim",
    "config",
    "errata",
    "figure",
    "further",
    "gallery",
    "grid_studies",
    "inputs",
    "np",
    "number",
    "percent",
    "presets",
    "prose",
    "see",
    "setting",
    "show",
    "speeds",
    "theory",
]

inputs = Inputs.current()
config = inputs.config
claim = Ledger(inputs.claims, config["claims"])
gallery = Gallery(
    inputs.figures,
    placed_figures((Path(inputs.manuscript) / "replication.md").read_text(encoding="utf-8")),
    inputs.captions,
    inputs.figures_folder,
)
see = gallery.see


def show(markdown: str) -> None:
    """Put Markdown into the report."""
    if markdown:
        display(Markdown(markdown))


def prose(text: str) -> None:
    """Put Markdown into the report, its expressions evaluated with the names of the cells."""
    show(fill(text, _names()))


def figure(name: str) -> None:
    """Put a figure into the report, if this run has it."""
    show(gallery.figure(name))


def further() -> None:
    """Put the included figures that the text does not place into the report."""
    for name in gallery.unplaced:
        figure(name)


def errata() -> str:
    """The errata as a table."""
    names = _names()
    return errata_table(inputs.errata, lambda text: fill(text, names))


def _names() -> dict:
    """What the cells have defined so far, seen from the caller outside this module."""
    frame = inspect.currentframe()
    while frame is not None and frame.f_globals.get("__name__") == __name__:
        frame = frame.f_back
    return dict(frame.f_globals) if frame is not None else {}
