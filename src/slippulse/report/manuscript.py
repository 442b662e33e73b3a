"""The manuscript executed: its code run, its prose filled, without a kernel."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import jupytext
import pandas as pd

from ..claims.entries import coverage, positions
from ..claims.reading import Ledger
from ..data.alterations import changes
from ..data.numerals import FILTERS, short
from ..data.prose import fill
from . import tables
from .gallery import Gallery
from .parameters import parameters
from .texts import read_captions, read_errata, read_text

SOURCE = "replication.md"
# A cell for the notebook opened by hand: here its names are there already.
BY_HAND = "by-hand"


def _between(typst: str) -> str:
    return f'`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{typst}[\n`````'


# A long table stands between WIDE or SMALL and CLOSE: on pages on their side, or in small type over several pages.
# All figures so far stand before FLUSH.
LAYOUT = {
    "WIDE": _between("sideways"),
    "SMALL": _between("small"),
    "CLOSE": "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````",
    "FLUSH": "`````{=typst}\n#place.flush()\n`````",
}


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
    """

    config: Mapping
    shipped: Mapping
    claims: Sequence[Mapping]
    findings: Sequence[Mapping]
    tables: Mapping[str, pd.DataFrame]
    figures: Sequence[str]
    figures_folder: Path
    manuscript: Path


def names_for(inputs: Inputs, show: Callable[[str], None]) -> dict[str, object]:
    """The names that cells and prose use; the errata see what the cells add later.

    Parameters
    ----------
    inputs : what the report is written from
    show : puts Markdown into the report
    """
    config, folder = inputs.config, inputs.manuscript
    ledger = Ledger(inputs.claims, inputs.findings)
    sentences = read_text(folder / "statements.yaml")["statements"]
    entries = read_text(folder / "claims.yaml")
    algebra = entries["algebra"]
    verdicts = read_text(folder / "shipped_verdicts.yaml") or {}
    names: dict[str, object] = {
        **FILTERS,
        **LAYOUT,
        "config": config,
        "shipped": inputs.shipped,
        "show": show,
    }
    names |= {"claim": ledger, "found": ledger.found, "runs": partial(parameters, config)}

    def filled(text: str) -> str:
        return fill(text, names)

    text = (folder / SOURCE).read_text(encoding="utf-8")
    captions = read_captions(folder / "captions.yaml", filled)
    gallery = Gallery(inputs.figures, text, captions, inputs.figures_folder)
    altered = changes(inputs.shipped, config)
    names |= {
        "tables": inputs.tables,
        "tolerances_altered": any(change["key"].startswith("claims.") for change in altered),
        "sentences": coverage(sentences),
        "algebra": algebra,
        "figure": lambda name: show(gallery.figure(name)),
        "further": lambda: show(gallery.further()),
        "see": gallery.see,
        "alteration_note": lambda: alteration_note(altered, inputs.claims, verdicts),
        "judged": lambda id: f"{ledger.measured(id)}, {ledger.verdict(id)}",
        "counts": partial(tables.counts, ledger),
        "failures": partial(tables.failures, ledger),
        "whole_ledger": partial(tables.whole_ledger, ledger),
        "tolerances": partial(tables.tolerances, ledger),
        "published": partial(tables.published, ledger, config["published"]),
        "found_list": partial(tables.found_list, ledger),
        "algebra_checked": partial(tables.algebra_checked, algebra, positions(algebra, sentences)),
        "sentence_counts": partial(tables.sentence_counts, coverage(sentences)),
        "tested_sentences": partial(tables.tested_sentences, sentences, entries["claims"] | algebra),
        "errata": lambda: tables.errata(read_errata(folder / "errata.yaml"), filled),
        "grid_studies": partial(tables.grid_studies, inputs.tables),
        "presets": partial(tables.presets, config["presets"], config["preset"]),
        "speeds": tables.speeds,
        "sticking": tables.sticking,
        "edges": tables.edges,
    }
    return names


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
    names = names_for(inputs, lambda markdown: shown.append(markdown) if markdown else None)
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


def alteration_note(
    altered: Iterable[Mapping], claims: Iterable[Mapping], verdicts: Mapping[str, str]
) -> str:
    """What differs from the shipped run, as Markdown; empty if nothing does.

    Parameters
    ----------
    altered : what differs from the shipped configuration (`slippulse.data.alterations.changes`)
    claims : the run's ledger
    verdicts : shipped verdict of each claim
    """

    def code(value: object) -> str:
        return "absent" if value is None else "`" + short(value).replace("`", "'") + "`"

    keys = [
        f"`{change['key']}`: {code(change['here'])} (shipped: {code(change['shipped'])})"
        for change in altered
    ]
    judged = [
        f"`{claim['id']}`: {claim['verdict']} (shipped: {verdicts.get(claim['id'], 'absent')})"
        for claim in claims
        if claim["verdict"] != verdicts.get(claim["id"])
    ]
    lines = []
    if keys:
        lines.append(
            f"**Altered configuration.** This run differs from the shipped configuration in {'; '.join(keys)}."
        )
    if judged:
        lines.append(f"**Verdicts that differ from the shipped report:** {'; '.join(judged)}.")
    elif keys:
        lines.append("No verdict differs from the shipped report.")
    return "\n>\n".join(f"> {line}" for line in lines)
