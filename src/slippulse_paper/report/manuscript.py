"""Execute the manuscript: run its code cells, fill in its prose, and number its figures.

`names_for` defines what cells and prose may use, and `execute` returns the finished Markdown, which
`document` converts to HTML and PDF.
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
# Tag of a cell that defines the names in a notebook opened by hand. It is skipped here.
BY_HAND = "by-hand"
# The name of a figure of the paper, with its number.
PAPER_FIGURE = re.compile(r"fig(\d+)_")
# The call that includes a figure in the text.
FIGURE_CALL = re.compile(r"""\bfigure\(\s*["'](\w+)["']\s*\)""")
# Width of a page of the journal and of the report, in inches.
PAGE_WIDTH = 7.0


@dataclass(frozen=True)
class Inputs:
    """Everything that a report is written from: contents of files, tables by name, figures."""

    config: Mapping
    shipped: Mapping
    claims: Sequence[Mapping]
    findings: Sequence[Mapping]
    tables: Mapping[str, pd.DataFrame]
    figures: Sequence[str]
    figures_folder: Path
    manuscript: Path
    citation: Mapping


class FigureNumber(NamedTuple):
    """The document that shows a figure, and the number of the figure there, such as S3."""

    document: str
    number: str


class Gallery:
    """The figures with their numbers, which follow the order in which the texts show them.

    Figures that no text shows are appended to the last document. ``current`` is the document that
    is being written.
    """

    def __init__(self, inputs: Inputs, texts: Mapping, captions: Mapping, current: str) -> None:
        self.captions, self.current = captions, current
        self.folder = inputs.figures_folder
        names_by_document = {
            document: FIGURE_CALL.findall(text) for document, text in texts.items()
        }
        shown = {*chain.from_iterable(names_by_document.values())}
        self.further_names = [name for name in inputs.figures if name not in shown]
        last_document = [*texts][-1]
        names_by_document[last_document] += self.further_names
        self.numbers: dict[str, FigureNumber] = {}
        for letter, document in zip(NUMBER_LETTERS, texts, strict=True):
            names = names_by_document[document]
            drawn = [name for name in names if name in inputs.figures]
            for i, name in enumerate(drawn, start=1):
                self.numbers[name] = FigureNumber(document, f"{letter}{i}")

    def figure(self, name: str) -> str:
        """Return a figure with number and caption as Markdown, or no text if it was not drawn."""
        if name not in self.numbers:
            return ""
        title = name.replace("_", " ")
        caption = self.captions.get(name, Caption(title, title, "", ""))
        label = self._label(name)
        text = f"**{label}. {caption.title}.** {caption.finding} {caption.caption}".strip()
        alt = caption.alt.replace("'", "\N{RIGHT SINGLE QUOTATION MARK}")
        # Without an extension the PDF takes the vector file, and the page the picture.
        path = self.folder / name
        return f"![{text}]({path}){{#{name} width={self._width(name):.0f}% alt='{alt}'}}"

    def _label(self, name: str) -> str:
        """Return "Figure" and the number, with the number in the paper if that is another one."""
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
        """Return all figures that no text shows, as Markdown."""
        return "\n\n".join(self.figure(name) for name in self.further_names)

    def see(self, name: str, before: str = "figure ", after: str = "") -> str:
        """Return a link to a figure between two texts, or no text if the figure was not drawn.

        The word "figure" or "figures" at the end of ``before`` becomes a part of the link.
        """
        if name not in self.numbers:
            return ""
        start, word = before, ""
        for ending in ("figure ", "figures "):
            if before.endswith(ending):
                start, word = before.removesuffix(ending), ending
        document, number = self.numbers[name]
        file = "" if document == self.current else f"{document}.html"
        return f"{start}[{word}{number}]({file}#{name}){after}"


def names_for(inputs: Inputs, show: Callable[[str], None], document: str) -> dict[str, object]:
    """Return the values and functions that cells and prose of a document may use, by name.

    ``show`` puts Markdown into the document.
    """
    config, folder = inputs.config, inputs.manuscript
    ledger = Ledger(inputs.claims, inputs.findings)
    statements = read_text(folder / "statements.yaml")["statements"]
    altered = changes(inputs.shipped, config)
    misprints = read_errata(folder / "errata.yaml")

    def cite(id: str, text: str) -> str:
        """Return a text that links to a claim or a finding, where its tables are."""
        return f"[{text}](../claims.html#{id})"

    def deviation_of(id: str) -> str:
        """Return the deviation of a claim as a percentage, with a link to the claim."""
        return cite(id, percent(ledger(id).deviation))

    def measured_of(id: str) -> str:
        """Return the measured number of a claim, with a link to the claim."""
        return cite(id, ledger(id).measured_text())

    names: dict[str, object] = {
        "config": config,
        "citation": inputs.citation,
        "tables": inputs.tables,
        "show": show,
        "claim": ledger,
        "found": ledger.found,
        "cite": cite,
        "off": deviation_of,
        "measured": measured_of,
        "runs": partial(parameters, config),
        "entries": read_text(folder / "claims.yaml"),
        "statements": statements,
        "sentences": coverage(statements),
        "misprints": misprints,
        "tolerances_altered": any(change["key"].startswith("claims.") for change in altered),
    }
    # This dictionary grows while cells run, so that errata can use names that cells define.
    filled = partial(fill, names=names)
    texts = {name: (folder / f"{name}.md").read_text(encoding="utf-8") for name in DOCUMENTS}
    captions = read_captions(folder / "captions.yaml", filled)
    gallery = Gallery(inputs, texts, captions, document)
    summary = read_text(folder / "summary.yaml")
    lines = judged_lines(summary, ledger, filled)
    shipped = read_text(folder / "shipped_verdicts.yaml") or {}
    names |= {
        "figure": lambda name: show(gallery.figure(name)),
        "further": lambda: show(gallery.further()),
        "see": gallery.see,
        "alteration_note": lambda: alteration_note(altered, ledger, shipped),
        "question": summary["question"],
        "answer": answer(lines),
        "symbols": summary["symbols"],
        "accuracy": filled(summary["accuracy"]),
        "verdicts": lambda: verdicts(lines),
        "errata": lambda: errata(misprints, filled),
    }
    return names


def execute(source: Path, inputs: Inputs) -> str:
    """Return the Markdown of a file with its code run and its prose filled.

    A ValueError quotes the cell that fails.
    """
    shown: list[str] = []
    names = names_for(inputs, shown.append, source.stem)
    for cell in jupytext.read(source).cells:
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
