"""Templates to pages; every value is escaped unless it is HTML already."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ..data.origin import configuration
from ..data.prose import FILTERS
from .pandoc import html_of

# Of every page; what else a page is made with its step names.
FILES = ("report/templates/base.html", "report/templates/style.css")
PAGES = Environment(
    loader=FileSystemLoader(Path(__file__).with_name("templates")),
    autoescape=True,
    undefined=StrictUndefined,
    trim_blocks=True,
    lstrip_blocks=True,
)
PAGES.filters |= FILTERS


def page(template: str, **data: object) -> str:
    """A whole page.

    Parameters
    ----------
    template : file beside this module, in templates
    data : what it shows
    """
    return PAGES.get_template(template).render(data, configuration=configuration()) + "\n"


def markup_of(texts: Iterable[str]) -> dict[str, Markup]:
    """Each text of Markdown as HTML with MathML, converted together."""
    return {text: Markup(html) for text, html in html_of(texts).items()}


def picture_size(path: str | Path) -> tuple[int, int] | None:
    """Width and height of a PNG, so that a page does not jump while it loads; None without the file."""
    path = Path(path)
    if not path.exists():
        return None
    header = path.read_bytes()[16:24]
    return int.from_bytes(header[:4], "big"), int.from_bytes(header[4:], "big")
