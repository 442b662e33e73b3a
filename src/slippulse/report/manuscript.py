"""The manuscript executed: its code run, its prose filled, its figures numbered by where they stand."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import jupytext
import pandas as pd
from PIL import Image

from ..claims.reading import Ledger, coverage, read_text
from ..data.alterations import changes
from ..data.numerals import FILTERS, percent
from ..data.prose import fill
from .tables import alteration_note, errata, verdicts
from .texts import Caption, answer, judged_lines, parameters, read_captions, read_errata

# The report and what it refers to for more; each is NAME.md.
DOCUMENTS = ("replication", "supplement")
# A cell for the notebook opened by hand: here its names are there already.
BY_HAND = "by-hand"
# The number that a figure has in the paper, in its name.
OF_PAPER = re.compile(r"fig(\d+)_")
# How the text includes a figure.
NAMED = re.compile(r"""\bfigure\(\s*["'](\w+)["']\s*\)""")
# Inches across the pages of the journal, and of the report.
PAGE = 7.0


@dataclass(frozen=True)
class Inputs:
    """What one report is written from: files read, tables as `steps.inputs.given` has them, names of figures."""

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
    """The figures of a report of several documents: those whose NAME.pdf and NAME.png are in a folder.

    Each document numbers its own by the order in which its text names them, the first from 1 on, the others from S1 on.
    One that no text names comes last, and one without a caption has its name.
    """

    def __init__(
        self, included: Sequence[str], texts: Mapping, captions: Mapping, folder: Path, here: str
    ) -> None:
        self.captions, self.folder, self.here = captions, folder, here
        named = {document: NAMED.findall(text) for document, text in texts.items()}
        self.unnamed = [
            name for name in included if not any(name in names for names in named.values())
        ]
        named[[*texts][-1]] += self.unnamed
        # Of each figure the document and the number.
        self.places: dict[str, tuple[str, str]] = {}
        for letter, (document, names) in zip(["", *"S" * len(named)], named.items(), strict=False):
            there = [name for name in names if name in included]
            self.places |= {
                name: (document, f"{letter}{i}") for i, name in enumerate(there, start=1)
            }

    def figure(self, name: str) -> str:
        """The figure with its number and caption, as Markdown; nothing if it is not included."""
        if name not in self.places:
            return ""
        title = name.replace("_", " ")
        caption = self.captions.get(name, Caption(title, title, "", ""))
        head, paper = f"Figure {self.places[name][1]}", OF_PAPER.match(name)
        if paper and head != f"Figure {int(paper[1])}":
            head += f" (paper, figure {int(paper[1])})"
        text = f"**{head}. {caption.title}.** {caption.finding} {caption.caption}".strip()
        alt = caption.alt.replace("'", "\N{RIGHT SINGLE QUOTATION MARK}")
        with Image.open(self.folder / f"{name}.png") as picture:
            inches = picture.width / picture.info["dpi"][0]
        # A column of the journal stays one.
        width = min(100.0, 100.0 * inches / PAGE)
        # No extension: the vector file for print, the picture for the browser.
        return f"![{text}]({self.folder / name}){{#{name} width={width:.0f}% alt='{alt}'}}"

    def further(self) -> str:
        """The figures that the text does not name."""
        return "\n\n".join(self.figure(name) for name in self.unnamed)

    def see(self, name: str, before: str = "figure ", after: str = "") -> str:
        """A link to a figure between two texts, with the word before its number; nothing if it is not included."""
        if name not in self.places:
            return ""
        start, word = re.fullmatch(r"(.*?)((?:figures? )?)", before).groups()  # type: ignore[union-attr]
        document, number = self.places[name]
        file = "" if document == self.here else f"{document}.html"
        return f"{start}[{word}{number}]({file}#{name}){after}"


def names_for(inputs: Inputs, show: Callable[[str], None], document: str) -> dict[str, object]:
    """The names that cells and prose of a document use, with ``show``, which puts Markdown into it."""
    config, folder = inputs.config, inputs.manuscript
    ledger = Ledger(inputs.claims, inputs.findings)
    statements = read_text(folder / "statements.yaml")["statements"]
    altered = changes(inputs.shipped, config)
    # A number as a link to its claim or finding, where the tables behind it are.
    cite = "[{1}](../claims.html#{0})".format
    names: dict[str, object] = {
        **FILTERS,
        "config": config,
        "citation": inputs.citation,
        "tables": inputs.tables,
        "show": show,
        "claim": ledger,
        "found": ledger.found,
        "cite": cite,
        "off": lambda id: cite(id, percent(ledger(id).deviation)),
        "measured": lambda id: cite(id, ledger.measured(id)),
        "runs": partial(parameters, config),
        "entries": read_text(folder / "claims.yaml"),
        "statements": statements,
        "sentences": coverage(statements),
        "tolerances_altered": any(change["key"].startswith("claims.") for change in altered),
    }
    # The errata see what the cells add later.
    filled = partial(fill, names=names)
    texts = {name: (folder / f"{name}.md").read_text(encoding="utf-8") for name in DOCUMENTS}
    captions = read_captions(folder / "captions.yaml", filled)
    gallery = Gallery(inputs.figures, texts, captions, inputs.figures_folder, document)
    lines = judged_lines(read_text(folder / "summary.yaml"), ledger, filled)
    shipped = read_text(folder / "shipped_verdicts.yaml") or {}
    names |= {
        "figure": lambda name: show(gallery.figure(name)),
        "further": lambda: show(gallery.further()),
        "see": gallery.see,
        "alteration_note": lambda: alteration_note(altered, ledger, shipped),
        "answer": answer(lines),
        "verdicts": lambda: verdicts(lines),
        "errata": lambda: errata(read_errata(folder / "errata.yaml"), filled),
    }
    return names


def execute(source: str | Path, inputs: Inputs) -> str:
    """The prose of a file with its expressions replaced, and what its code shows; a ValueError tells which fails."""
    source = Path(source)
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
            raise ValueError(
                f"{source.name}: {type(error).__name__}: {reason} (cell {start!r})"
            ) from error
    # No line ends between a number and its per cent sign.
    return re.sub(r"(?<=\d) %", "\N{NO-BREAK SPACE}%", "\n\n".join(filter(None, shown))) + "\n"
