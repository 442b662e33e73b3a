"""Execute the manuscript: run its code cells, fill in its prose, and number its figures.

The prose has expressions in double braces. `names_for` returns the values and functions that code
cells and expressions may use. `execute` returns the finished Markdown, which the module `document`
converts to HTML and PDF.
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import jupytext
import pandas as pd
from PIL import Image

from ..claims.claim_texts import coverage, read_text
from ..claims.ledger import Ledger
from ..records.provenance import changes
from ..text.numerals import percent
from ..text.prose import fill
from .report_tables import alteration_note, errata, verdicts
from .texts import Caption, answer, judged_lines, parameters, read_captions, read_errata

# The report and its supplement, each from manuscript/NAME.md.
DOCUMENTS = ("replication", "supplement")
# The letters before the numbers of figures: none in the report, and S in the supplement.
NUMBER_LETTERS = ("", "S")
# Tag of a cell that defines these names if the manuscript is opened as a notebook. Such a cell is
# not run here.
BY_HAND = "by-hand"
# The name of a figure of the paper, with its number.
PAPER_FIGURE = re.compile(r"fig(\d+)_")
# The call in a code cell that shows a figure.
FIGURE_CALL = re.compile(r"""\bfigure\(\s*["'](\w+)["']\s*\)""")
# Width of the text on a page of the journal and of the report, in inches.
PAGE_WIDTH = 7.0


@dataclass(frozen=True)
class Inputs:
    """Everything from which the report and its supplement are written."""

    config: Mapping
    shipped: Mapping  # the shipped configuration, without overlay
    claims: Sequence[Mapping]  # content of claims.json
    findings: Sequence[Mapping]  # content of findings.json
    tables: Mapping[str, pd.DataFrame]
    figures: Sequence[str]  # names of the figures that were drawn
    figures_folder: Path
    manuscript: Path  # folder with the texts
    citation: Mapping


class FigureNumber(NamedTuple):
    """The document that shows a figure, and the number of the figure there, such as S3."""

    document: str
    number: str


class Gallery:
    """The figures of all documents, numbered in the order in which the texts show them.

    Figures that no text shows are appended to the last document.
    """

    def __init__(self, inputs: Inputs, texts: Mapping, captions: Mapping, current: str) -> None:
        """Number the figures.

        texts : the text of each document, by its name
        captions : the caption of each figure, by its name
        current : name of the document that is being written
        """
        self.captions, self.current = captions, current
        self.folder = inputs.figures_folder
        names_by_document = {name: FIGURE_CALL.findall(text) for name, text in texts.items()}
        # Figures that no text shows come at the end of the last document.
        shown = {*chain.from_iterable(names_by_document.values())}
        self.further_names = [name for name in inputs.figures if name not in shown]
        last_document = [*texts][-1]
        names_by_document[last_document] += self.further_names
        # Each document has its own letter in front of the numbers of its figures.
        self.numbers: dict[str, FigureNumber] = {}
        for letter, (document, names) in zip(
            NUMBER_LETTERS, names_by_document.items(), strict=True
        ):
            # A text may show figures that were not drawn in this run. They get no number.
            drawn = [name for name in names if name in inputs.figures]
            for i, name in enumerate(drawn, start=1):
                self.numbers[name] = FigureNumber(document, f"{letter}{i}")

    def figure(self, name: str) -> str:
        """Return a figure with number and caption as Markdown, or no text if it was not drawn."""
        if name not in self.numbers:
            return ""
        title = name.replace("_", " ")
        without_texts = Caption(title=title, alt=title, finding="", caption="")
        caption = self.captions.get(name, without_texts)
        label = self._label(name)
        text = f"**{label}. {caption.title}.** {caption.finding} {caption.caption}".strip()
        alt = caption.alt.replace("'", "\N{RIGHT SINGLE QUOTATION MARK}")
        # Without an extension the PDF takes the vector file, and the page the picture.
        path = self.folder / name
        return f"![{text}]({path}){{#{name} width={self._width(name):.0f}% alt='{alt}'}}"

    def _label(self, name: str) -> str:
        """Return the number of a figure as text, such as "Figure 3 (paper, figure 2)".

        The number in the paper is left out if the paper has no such figure, or if it is the same.
        """
        label = f"Figure {self.numbers[name].number}"
        in_paper = PAPER_FIGURE.match(name)
        if in_paper is None:
            return label
        number = int(in_paper[1])
        return label if label == f"Figure {number}" else f"{label} (paper, figure {number})"

    def _width(self, name: str) -> float:
        """Return the width of a figure in per cent of the page.

        A figure that is one column wide in the journal is equally wide here.
        """
        with Image.open(self.folder / f"{name}.png") as picture:
            dots_per_inch = picture.info["dpi"][0]
            inches = picture.width / dots_per_inch
        return min(100.0, 100.0 * inches / PAGE_WIDTH)

    def further(self) -> str:
        """Return the figures that no text shows, with their captions, as Markdown."""
        return "\n\n".join(self.figure(name) for name in self.further_names)

    def see(self, name: str, before: str = "figure ", after: str = "") -> str:
        """Return a reference to a figure in Markdown, such as "[figure 3](#NAME)".

        The result is empty if the figure was not drawn.

        before, after : texts around the number; the word "figure" or "figures" at the end of
            ``before`` becomes a part of the link
        """
        if name not in self.numbers:
            return ""
        start, word = before, ""
        for possible_word in ("figure ", "figures "):
            if before.endswith(possible_word):
                start, word = before.removesuffix(possible_word), possible_word
        document, number = self.numbers[name]
        # A link within the current document has no file name.
        file = "" if document == self.current else f"{document}.html"
        return f"{start}[{word}{number}]({file}#{name}){after}"


def names_for(inputs: Inputs, show: Callable[[str], None], document: str) -> dict[str, object]:
    """Return the values and functions that cells and prose of a document may use, by name.

    show : function that puts Markdown into the document
    document : name of the document
    """
    folder = inputs.manuscript
    ledger = Ledger(inputs.claims, inputs.findings)
    altered = changes(inputs.shipped, inputs.config)
    misprints = read_errata(folder / "errata.yaml")
    names = _names_of_data(inputs, ledger, altered) | {"show": show, "misprints": misprints}
    # Cells add the names that they define to this dictionary. The errata may use these names,
    # because their expressions are evaluated after the cells.
    evaluated = partial(fill, names=names)
    texts = {name: (folder / f"{name}.md").read_text(encoding="utf-8") for name in DOCUMENTS}
    captions = read_captions(folder / "captions.yaml", evaluated)
    gallery = Gallery(inputs, texts, captions, document)
    summary = read_text(folder / "summary.yaml")
    lines = judged_lines(summary, ledger, evaluated)
    shipped_verdicts = read_text(folder / "shipped_verdicts.yaml") or {}
    # "further" shows the figures that no text shows, and "see" returns a reference to a figure.
    names |= {
        "figure": lambda name: show(gallery.figure(name)),
        "further": lambda: show(gallery.further()),
        "see": gallery.see,
        "alteration_note": lambda: alteration_note(altered, ledger, shipped_verdicts),
        "question": summary["question"],
        "answer": answer(lines),
        "symbols": summary["symbols"],
        "accuracy": evaluated(summary["accuracy"]),
        "verdicts": lambda: verdicts(lines),
        "errata": lambda: errata(misprints, evaluated),
    }
    return names


def _names_of_data(inputs: Inputs, ledger: Ledger, altered: Sequence[Mapping]) -> dict[str, object]:
    """Return the values and functions for configuration, tables, claims and statements, by name.

    altered : values of the configuration that differ from the shipped ones
    """
    folder = inputs.manuscript
    statements = read_text(folder / "statements.yaml")["statements"]

    def cite(id: str, text: str) -> str:
        """Return a text with a link to a claim or a finding on the page of claims."""
        return f"[{text}](../claims.html#{id})"

    def deviation_of(id: str) -> str:
        """Return the deviation of a claim as a percentage, with a link to the claim."""
        return cite(id, percent(ledger(id).deviation))

    def measured_of(id: str) -> str:
        """Return the measured number of a claim, with a link to the claim."""
        return cite(id, ledger(id).measured_text())

    return {
        "config": inputs.config,
        "citation": inputs.citation,
        "tables": inputs.tables,
        "claim": ledger,
        "found": ledger.found,
        "cite": cite,
        "off": deviation_of,
        "measured": measured_of,
        "runs": partial(parameters, inputs.config),
        "entries": read_text(folder / "claims.yaml"),
        "statements": statements,
        "sentences": coverage(statements),
        "tolerances_altered": any(change["key"].startswith("claims.") for change in altered),
    }


def execute(source: Path, inputs: Inputs) -> str:
    """Run the code cells of a document, fill in its prose, and return the finished Markdown.

    A code cell adds Markdown by calling functions such as `figure`. Raises ValueError, which quotes
    the cell, if a cell fails.

    source : path of the document
    """
    shown: list[str] = []
    names = names_for(inputs, shown.append, source.stem)
    for cell in jupytext.read(source).cells:
        # A cell with this tag is run only if the document is opened as a notebook.
        if BY_HAND in cell.metadata.get("tags", []):
            continue
        try:
            if cell.cell_type == "code":
                exec(compile(cell.source, str(source), "exec"), names)
            else:
                shown.append(fill(cell.source, names))
        except Exception as error:
            first_line = cell.source.strip().splitlines()[0][:70]
            reason = " ".join(str(error).split())
            problem = f"{type(error).__name__}: {reason} (cell {first_line!r})"
            raise ValueError(f"{source.name}: {problem}") from error
    text = "\n\n".join(filter(None, shown))
    # A no-break space keeps a number and its per cent sign on one line.
    return re.sub(r"(?<=\d) %", "\N{NO-BREAK SPACE}%", text) + "\n"
