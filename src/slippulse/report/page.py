"""The report as pandoc writes it, made a page: one title, tables that scroll by keyboard, figures that enlarge."""

from __future__ import annotations

import re
from itertools import count

FIGURE = re.compile(r'(<figure id="(\w+)">\s*)(<img [^>]*>)')
# Where the picture of a figure is, from the report.
PICTURE = "../figures/{}.png"


def as_page(html: str) -> str:
    """The document with its headings below the title, and each figure and table where everybody can use it.

    Parameters
    ----------
    html : by manuscript/template.html, its text inside ``main``
    """
    head, opening, text = html.partition('<main id="content">')
    text = re.sub(r"(</?h)([1-5])\b", lambda tag: f"{tag[1]}{int(tag[2]) + 1}", text)
    text = FIGURE.sub(_linked, text)
    # Where a phone has them scroll, the keyboard must reach them.
    text = re.sub('<math display="block"|<pre', lambda tag: f'{tag[0]} tabindex="0"', text)
    numbers = count(1)
    text = re.sub(
        "<table",
        lambda tag: (
            f'<div class="scroll" tabindex="0" role="region" aria-label="Table {next(numbers)}">{tag[0]}'
        ),
        text,
    )
    return head + opening + text.replace("</table>", "</table></div>")


def _linked(figure: re.Match) -> str:
    """A click on a figure opens its picture, at its own size."""
    return f'{figure[1]}<a href="{PICTURE.format(figure[2])}">{figure[3]}</a>'
