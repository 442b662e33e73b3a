"""Templates and Markdown to HTML; every value is escaped unless it is HTML already."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import pypandoc
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from slippulse.data.files import configuration

from ..text.numerals import FILTERS

TEMPLATES = Path(__file__).with_name("templates")
PAGES = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined)
PAGES.trim_blocks = PAGES.lstrip_blocks = True
PAGES.filters |= FILTERS


def page(template: str, **data: object) -> str:
    """A whole page: a file in `TEMPLATES`, filled with what it shows."""
    return PAGES.get_template(template).render(data, configuration=configuration()) + "\n"


def pandoc(text: str, source: str, to: str, options: Sequence[str]) -> str:
    """The text as pandoc converts it; ValueError has its message if it refuses or warns."""
    options = ["--fail-if-warnings", *options]
    try:
        return pypandoc.convert_text(text, to, source, options, verify_format=False)
    except RuntimeError as error:
        raise ValueError(error) from None


def markup_of(texts: Iterable[str]) -> dict[str, Markup]:
    """HTML with MathML of each text, one paragraph of Markdown with formulas; raw HTML is shown."""
    texts = sorted({text for text in texts if text.strip()})
    if not texts:
        return {"": Markup()}
    # One call of pandoc converts all texts.
    joined = "\n\n* * *\n\n".join(" ".join(text.split()) for text in texts)
    markdown = "markdown-raw_html-smart-fancy_lists"
    html = pandoc(joined, markdown, "html5", ["--mathml", "--wrap=none"])
    parts = [part.strip() for part in html.split("<hr />")]
    paragraphs = [part[3:-4] for part in parts if part.startswith("<p>") and part.endswith("</p>")]
    if not len(texts) == len(parts) == len(paragraphs):
        raise ValueError("a text for a page is not one paragraph of Markdown")
    return {"": Markup(), **dict(zip(texts, map(Markup, paragraphs), strict=True))}
