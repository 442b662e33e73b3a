"""The report as pandoc writes it, made a page: one title, tables that scroll by keyboard, figures that enlarge."""

from __future__ import annotations

import re
from base64 import b64decode, b64encode
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO
from itertools import count

from PIL import Image

FIGURE = re.compile(r'(<figure id="(\w+)">\s*)(<img [^>]*>)')
EMBEDDED = re.compile(r"data:image/png;base64,([A-Za-z0-9+/=]+)")
# Where the picture of a figure is, from the report.
PICTURE = "../figures/{}.png"


def as_page(html: str) -> str:
    """The document with its headings below the title, and each figure and table where everybody can use it.

    Parameters
    ----------
    html : by manuscript/template.html, its text inside ``main``, its pictures PNGs embedded in it
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
    with ThreadPoolExecutor() as pool:
        pictures = pool.map(_as_webp, EMBEDDED.findall(text))
        text = EMBEDDED.sub(lambda picture: next(pictures), text)
    return head + opening + text.replace("</table>", "</table></div>")


def _linked(figure: re.Match) -> str:
    """A click on a figure opens its picture, at its own size."""
    return f'{figure[1]}<a href="{PICTURE.format(figure[2])}">{figure[3]}</a>'


def _as_webp(png: str) -> str:
    """A picture with the same pixels in two thirds of the bytes."""
    content = BytesIO()
    with Image.open(BytesIO(b64decode(png))) as picture:
        # Higher settings take longer and gain nothing.
        picture.convert("RGB").save(content, format="WEBP", lossless=True, method=2, quality=75)
    return "data:image/webp;base64," + b64encode(content.getvalue()).decode("ascii")
