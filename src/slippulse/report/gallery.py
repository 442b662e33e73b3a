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
    """The figures that one report includes: those whose NAME.pdf and NAME.png are in a folder.

    They are numbered by the order in which the text names them; one that it does not name comes last, and one without a
    caption has its name.
    """

    def __init__(
        self, included: Sequence[str], text: str, captions: Mapping[str, Caption], folder: str | Path
    ) -> None:
        named = NAMED.findall(text)
        self.unnamed = [name for name in included if name not in named]
        self.order = [name for name in named if name in included] + self.unnamed
        self.captions = captions
        self.folder = Path(folder)

    def figure(self, name: str) -> str:
        """The figure with its number and caption, as Markdown; nothing if it is not included."""
        if name not in self.order:
            return ""
        title = name.replace("_", " ")
        caption = self.captions.get(name, Caption(title, title, "", ""))
        paper = OF_PAPER.match(name)
        head = f"Figure {self.order.index(name) + 1}" + (f" (paper, figure {int(paper[1])})" if paper else "")
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
        if name not in self.order:
            return ""
        start, word = re.fullmatch(r"(.*?)((?:figures? )?)", before).groups()  # type: ignore[union-attr]
        return f"{start}[{word}{self.order.index(name) + 1}](#{name}){after}"
