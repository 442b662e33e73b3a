"""The manuscript executed: its code run, its prose filled, without a kernel."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import jupytext
import pandas as pd

from ..claims.reading import Ledger, coverage
from ..data.alterations import changes
from ..data.numerals import FILTERS, percent
from ..data.prose import fill
from .answer import answer, judged_lines
from .gallery import Gallery
from .parameters import parameters
from .tables import alteration_note, errata, verdicts
from .texts import read_captions, read_errata, read_text

# The report and what it refers to for more; each is NAME.md.
DOCUMENTS = ("replication", "supplement")
# A cell for the notebook opened by hand: here its names are there already.
BY_HAND = "by-hand"


@dataclass(frozen=True)
class Inputs:
    """What one report is written from.

    Attributes
    ----------
    config, shipped : the configuration of the run and the shipped one, builtins
    claims, findings : as in claims.json and findings.json
    tables : by simulation measured and predicted numbers, one row a run, by study its table; uncertainties/NAME the
        grid study of a simulation
    figures : names of the figures to include, in any order
    figures_folder : where their files are
    manuscript : folder of the texts
    citation : as in CITATION.cff: version, date-released
    """

    config: Mapping
    shipped: Mapping
    claims: Sequence[Mapping]
    findings: Sequence[Mapping]
    tables: Mapping[str, pd.DataFrame]
    figures: Sequence[str]
    figures_folder: Path
    manuscript: Path
    citation: Mapping


def names_for(inputs: Inputs, show: Callable[[str], None], document: str) -> dict[str, object]:
    """The names that cells and prose of a document use, with ``show``, which puts Markdown into it."""
    config, folder = inputs.config, inputs.manuscript
    ledger = Ledger(inputs.claims, inputs.findings)
    statements = read_text(folder / "statements.yaml")["statements"]
    altered = changes(inputs.shipped, config)
    names: dict[str, object] = {
        **FILTERS,
        "config": config,
        "shipped": inputs.shipped,
        "citation": inputs.citation,
        "tables": inputs.tables,
        "show": show,
        "claim": ledger,
        "found": ledger.found,
        "cite": cite,
        "off": lambda id: cite(id, percent(ledger.deviation(id))),
        "measured": lambda id: cite(id, ledger.measured(id)),
        "runs": partial(parameters, config),
        "entries": read_text(folder / "claims.yaml"),
        "statements": statements,
        "sentences": coverage(statements),
        "tolerances_altered": any(change["key"].startswith("claims.") for change in altered),
    }

    def filled(text: str) -> str:
        # The errata see what the cells add later.
        return fill(text, names)

    texts = {name: (folder / f"{name}.md").read_text(encoding="utf-8") for name in DOCUMENTS}
    captions = read_captions(folder / "captions.yaml", filled)
    gallery = Gallery(inputs.figures, texts, captions, inputs.figures_folder, document)
    lines = judged_lines(read_text(folder / "summary.yaml"), ledger, filled)
    names |= {
        "figure": lambda name: show(gallery.figure(name)),
        "further": lambda: show(gallery.further()),
        "see": gallery.see,
        "alteration_note": lambda: alteration_note(
            altered, ledger, read_text(folder / "shipped_verdicts.yaml") or {}
        ),
        "answer": answer(lines),
        "verdicts": lambda: verdicts(lines),
        "errata": lambda: errata(read_errata(folder / "errata.yaml"), filled),
    }
    return names


def cite(id: str, text: str) -> str:
    """A number as a link to its claim or finding, where the tables behind it are."""
    return f"[{text}](../claims.html#{id})"


def execute(source: str | Path, inputs: Inputs) -> str:
    """Its prose with every expression replaced, and the Markdown that its code shows, in order.

    Parameters
    ----------
    source : file in any format of jupytext; cells tagged `BY_HAND` are left out
    inputs : what it is written from

    Raises
    ------
    ValueError
        If a cell fails: the error and the first line of the cell.
    """
    shown: list[str] = []
    document = Path(source).stem
    names = names_for(inputs, lambda markdown: shown.append(markdown) if markdown else None, document)
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
