"""Figures of the report: numbered by where they stand in the text, drawn elsewhere."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from PIL import Image

from .texts import Caption

# The number that a figure has in the paper, in its name.
OF_PAPER = re.compile(r"fig(\d+)_")
# How the text includes a figure.
NAMED = re.compile(r"""\bfigure\(\s*["'](\w+)["']\s*\)""")
# Inches across the pages of the journal, and of the report.
PAGE = 7.0


class Gallery:
    """The figures of a report of several documents: those whose NAME.pdf and NAME.png are in a folder.

    Each document numbers its own by the order in which its text names them, the first from 1 on, the others from S1 on.
    One that no text names comes last, and one without a caption has its name.
    """

    def __init__(
        self,
        included: Sequence[str],
        texts: Mapping[str, str],
        captions: Mapping[str, Caption],
        folder: str | Path,
        here: str,
    ) -> None:
        named = {document: NAMED.findall(text) for document, text in texts.items()}
        self.unnamed = [name for name in included if not any(name in names for names in named.values())]
        named[[*texts][-1]] += self.unnamed
        # Of each figure the document and the number.
        self.places: dict[str, tuple[str, str]] = {}
        for document, names in named.items():
            letter = "" if document == next(iter(texts)) else "S"
            there = [name for name in names if name in included]
            self.places |= {name: (document, f"{letter}{i}") for i, name in enumerate(there, start=1)}
        self.captions = captions
        self.folder = Path(folder)
        self.here = here

    def figure(self, name: str) -> str:
        """The figure with its number and caption, as Markdown; nothing if it is not included."""
        if name not in self.places:
            return ""
        title = name.replace("_", " ")
        caption = self.captions.get(name, Caption(title, title, "", ""))
        paper = OF_PAPER.match(name)
        head = f"Figure {self.places[name][1]}"
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
