"""From the jupytext source of the report to Markdown: its code run, its prose filled, without a kernel."""

from __future__ import annotations

import re
from pathlib import Path

import jupytext

from ..data.prose import fill
from .inputs import Inputs
from .notebook import define

# A cell for the notebook opened by hand: here its names are there already.
BY_HAND = "by-hand"


def execute(source: str | Path, inputs: Inputs) -> str:
    """Execute the report.

    Parameters
    ----------
    source : file in any format of jupytext; cells tagged `BY_HAND` are left out
    inputs : what it is written from

    Returns
    -------
    its prose with every expression replaced, and the Markdown that its code showed, in order

    Raises
    ------
    ValueError
        If a cell fails: the error and the first line of the cell.
    """
    shown: list[str] = []
    names: dict[str, object] = {}
    define(names, inputs, lambda markdown: shown.append(markdown) if markdown else None)
    for cell in jupytext.read(source).cells:
        if BY_HAND in cell.metadata.get("tags", []):
            continue
        try:
            if cell.cell_type == "code":
                exec(compile(cell.source, str(source), "exec"), names)
            else:
                shown.append(fill(cell.source, names))
        except Exception as error:
            start = cell.source.strip().splitlines()[0][:70]
            reason = " ".join(str(error).split())
            raise ValueError(
                f"{Path(source).name}: {type(error).__name__}: {reason} (cell {start!r})"
            ) from error
    # No line ends between a number and its per cent sign.
    return re.sub(r"(?<=\d) %", "\N{NO-BREAK SPACE}%", "\n\n".join(shown)) + "\n"
