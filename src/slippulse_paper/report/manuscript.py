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


class Gallery:
    """The figures with their numbers, which follow the order of the texts.

    Numbers of the supplement begin with S. Figures that no text includes come last. ``current`` is
    the document that is being written.
    """

    def __init__(self, inputs: Inputs, texts: Mapping, captions: Mapping, current: str) -> None:
        self.captions, self.current = captions, current
        self.folder = inputs.figures_folder
        named = {document: FIGURE_CALL.findall(text) for document, text in texts.items()}
        everywhere = {*chain.from_iterable(named.values())}
        self.unnamed = [name for name in inputs.figures if name not in everywhere]
        named[[*texts][-1]] += self.unnamed
        # Document and number of each figure.
        self.numbers: dict[str, tuple[str, str]] = {}
        for letter, (document, names) in zip(("", "S"), named.items(), strict=True):
            drawn = [name for name in names if name in inputs.figures]
            for i, name in enumerate(drawn, start=1):
                self.numbers[name] = document, f"{letter}{i}"

    def figure(self, name: str) -> str:
        """Return a figure with number and caption as Markdown; empty if it was not drawn."""
        if name not in self.numbers:
            return ""
        title = name.replace("_", " ")
        caption = self.captions.get(name, Caption(title, title, "", ""))
        head, paper = f"Figure {self.numbers[name][1]}", PAPER_FIGURE.match(name)
        if paper and head != f"Figure {int(paper[1])}":
            head += f" (paper, figure {int(paper[1])})"
        text = f"**{head}. {caption.title}.** {caption.finding} {caption.caption}".strip()
        alt = caption.alt.replace("'", "\N{RIGHT SINGLE QUOTATION MARK}")
        with Image.open(self.folder / f"{name}.png") as picture:
            inches = picture.width / picture.info["dpi"][0]
        # A figure that is one column wide in the journal is equally wide here.
        width = min(100.0, 100.0 * inches / PAGE_WIDTH)
        # Without an extension the PDF takes the vector file, and the page the picture.
        return f"![{text}]({self.folder / name}){{#{name} width={width:.0f}% alt='{alt}'}}"

    def further(self) -> str:
        """Return all figures that no text includes, as Markdown."""
        return "\n\n".join(self.figure(name) for name in self.unnamed)

    def see(self, name: str, before: str = "figure ", after: str = "") -> str:
        """Return a link to a figure between two texts; empty if the figure was not drawn."""
        if name not in self.numbers:
            return ""
        word = next((word for word in ("figure ", "figures ") if before.endswith(word)), "")
        start = before.removesuffix(word)
        document, number = self.numbers[name]
        file = "" if document == self.current else f"{document}.html"
        return f"{start}[{word}{number}]({file}#{name}){after}"


def names_for(inputs: Inputs, show: Callable[[str], None], document: str) -> dict[str, object]:
    """Return the names that cells and prose of a document may use.

    ``show`` puts Markdown into the document.
    """
    config, folder = inputs.config, inputs.manuscript
    ledger = Ledger(inputs.claims, inputs.findings)
    statements = read_text(folder / "statements.yaml")["statements"]
    altered, misprints = changes(inputs.shipped, config), read_errata(folder / "errata.yaml")
    # A number links to its claim or finding, where its tables are.
    cite = "[{1}](../claims.html#{0})".format
    names: dict[str, object] = {
        "config": config,
        "citation": inputs.citation,
        "tables": inputs.tables,
        "show": show,
        "claim": ledger,
        "found": ledger.found,
        "cite": cite,
        "off": lambda id: cite(id, percent(ledger(id).deviation)),
        "measured": lambda id: cite(id, ledger(id).measured_text()),
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
            start, reason = cell.source.strip().splitlines()[0][:70], " ".join(str(error).split())
            problem = f"{type(error).__name__}: {reason} (cell {start!r})"
            raise ValueError(f"{source.name}: {problem}") from error
    # A no-break space keeps a number and its per cent sign on one line.
    return re.sub(r"(?<=\d) %", "\N{NO-BREAK SPACE}%", "\n\n".join(filter(None, shown))) + "\n"
