"""Markdown tables whose columns have stated widths."""

from __future__ import annotations

import re
from collections.abc import Sequence

# Wide enough that pandoc takes the dashes as relative widths.
FULL = 200


def _between(typst: str) -> str:
    return f'`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{typst}[\n`````'


# A long table stands between WIDE or SMALL and CLOSE: on pages on their side, or in small type over several pages.
WIDE, SMALL = _between("sideways"), _between("small")
# All figures so far stand before what follows.
FLUSH = "`````{=typst}\n#place.flush()\n`````"
CLOSE = "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````"


def table(head: Sequence[str], rows: Sequence[Sequence[str]], widths: Sequence[int], align: str) -> str:
    """A pipe table.

    Parameters
    ----------
    head : titles of the columns
    rows : cells, Markdown without line breaks or bare bars
    widths : relative widths of the columns
    align : one letter a column: l, r or c
    """
    marks = []
    for width, side in zip(widths, align, strict=True):
        dashes = "-" * max(3, round(FULL * width / sum(widths)))
        marks.append({"l": f":{dashes}", "r": f"{dashes}:", "c": f":{dashes}:"}[side])
    lines = [head, marks, *rows]
    return "\n".join("| " + " | ".join(" ".join(str(cell).split()) for cell in line) + " |" for line in lines)


def plain(text: str) -> str:
    """Text that Markdown and its tables leave alone."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~^])", r"\\\1", text)
