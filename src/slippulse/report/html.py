"""Templates and Markdown to HTML; every value is escaped unless it is HTML already."""

import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path

import pypandoc
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ..data.files import configuration
from ..data.numerals import FILTERS

# Of every page; what else a page is made with its step names.
FILES = ("report/templates/base.html", "report/templates/style.css")
TEMPLATES = Path(__file__).with_name("templates")
PAGES = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined)
PAGES.trim_blocks = PAGES.lstrip_blocks = True
PAGES.filters |= FILTERS


def page(template: str, **data: object) -> str:
    """A whole page: a file in `TEMPLATES`, filled with what it shows."""
    return PAGES.get_template(template).render(data, configuration=configuration()) + "\n"


def pandoc(text: str, options: Sequence[str]) -> str:
    """The text as pandoc converts it; a ValueError has its message if it refuses the text or warns of it."""
    command = [pypandoc.get_pandoc_path(), "--fail-if-warnings", *options]
    done = subprocess.run(
        command, input=text, capture_output=True, text=True, encoding="utf-8", check=False
    )
    if done.returncode != 0:
        raise ValueError(f"pandoc: {done.stderr.strip()}")
    return done.stdout


def markup_of(texts: Iterable[str]) -> dict[str, Markup]:
    """Each text, one paragraph of Markdown with formulas, as HTML with MathML; raw HTML in it is shown, not obeyed."""
    texts = sorted({text for text in texts if text.strip()})
    if not texts:
        return {"": Markup()}
    # All by one call of pandoc.
    whole = "\n\n* * *\n\n".join(" ".join(text.split()) for text in texts)
    options = [
        "--from=markdown-raw_html-smart-fancy_lists",
        "--to=html5",
        "--mathml",
        "--wrap=none",
    ]
    parts = [part.strip() for part in pandoc(whole, options).split("<hr />")]
    paragraphs = [part[3:-4] for part in parts if part.startswith("<p>") and part.endswith("</p>")]
    if not len(texts) == len(parts) == len(paragraphs):
        raise ValueError("a text for a page is not one paragraph of Markdown")
    return {"": Markup(), **dict(zip(texts, map(Markup, paragraphs), strict=True))}
