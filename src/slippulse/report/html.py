"""Templates and Markdown to HTML; every value is escaped unless it is HTML already."""

import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path

import pypandoc
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from ..data.files import configuration
from ..data.numerals import FILTERS

# Files that every page is made with; the step of a page names the others.
FILES = ("report/templates/base.html", "report/templates/style.css")
TEMPLATES = Path(__file__).with_name("templates")
PAGES = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined)
PAGES.trim_blocks = PAGES.lstrip_blocks = True
PAGES.filters |= FILTERS


def page(template: str, **data: object) -> str:
    """A whole page: a file in `TEMPLATES`, filled with what it shows."""
    return PAGES.get_template(template).render(data, configuration=configuration()) + "\n"


def pandoc(text: str, options: Sequence[str]) -> str:
    """The text as pandoc converts it; ValueError has its message if it refuses or warns."""
    command = [pypandoc.get_pandoc_path(), "--fail-if-warnings", *options]
    done = subprocess.run(
        command, input=text, capture_output=True, text=True, encoding="utf-8", check=False
    )
    if done.returncode != 0:
        raise ValueError(f"pandoc: {done.stderr.strip()}")
    return done.stdout


def markup_of(texts: Iterable[str]) -> dict[str, Markup]:
    """HTML with MathML of each text, one paragraph of Markdown with formulas; raw HTML is shown."""
    texts = sorted({text for text in texts if text.strip()})
    if not texts:
        return {"": Markup()}
    # One call of pandoc converts all texts.
    joined = "\n\n* * *\n\n".join(" ".join(text.split()) for text in texts)
    options = ["--from=markdown-raw_html-smart-fancy_lists", "--to=html5", "--mathml"]
    html = pandoc(joined, [*options, "--wrap=none"])
    parts = [part.strip() for part in html.split("<hr />")]
    paragraphs = [part[3:-4] for part in parts if part.startswith("<p>") and part.endswith("</p>")]
    if not len(texts) == len(parts) == len(paragraphs):
        raise ValueError("a text for a page is not one paragraph of Markdown")
    return {"": Markup(), **dict(zip(texts, map(Markup, paragraphs), strict=True))}
