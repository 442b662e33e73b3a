"""Convert Markdown with the pandoc of the locked environment.

`markup_of` turns the texts of a page into HTML, and `harmless` escapes the texts of a user.
"""

import re
import subprocess
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from pathlib import Path

from markupsafe import Markup

# The program inside the package pypandoc_binary, not another one on the user's path.
PANDOC = Path(str(getattr(find_spec("pypandoc"), "origin", ""))).with_name("files") / "pandoc"
# A folder without pandoc defaults, templates, filters or styles, so that none of the user's apply.
DATA_FOLDER = Path(__file__).parent
# Extensions that are switched off for the texts of pages, so that a text cannot add HTML,
# attributes or code of its own.
DISABLED_EXTENSIONS = """
    raw_html raw_tex raw_attribute native_divs native_spans bracketed_spans fenced_divs
    link_attributes header_attributes fenced_code_attributes inline_code_attributes smart
    fancy_lists latex_macros inline_notes footnotes citations
"""
PAGE_TEXT = "-".join(["markdown", *DISABLED_EXTENSIONS.split()])
NOT_ONE_PARAGRAPH = "a text for a page is not one paragraph of Markdown"
LINK = re.compile(r'<a href="([^"]*)"[^>]*>(.*?)</a>', re.DOTALL)
IMAGE = re.compile(r'<img [^>]*?alt="([^"]*)"[^>]*>|<img [^>]*>')
# Formulas and links to the web are kept in a user's text. Elsewhere special signs are escaped.
FORMULA = re.compile(r"(?<!\\)\$(?=\S)((?:[^$\\]|\\.)*?)(?<=\S)\$(?!\d)")
KEPT = re.compile(rf"({FORMULA.pattern}|(?<!!)\[[\w ,.:;()-]+\]\(https?://[\w./?=&%:~-]+\))")
SPECIAL_SIGNS = re.compile(r"([\\`\[\]{}<>|@$^~#!])")


def pandoc(text: str, source: str, to: str, options: Sequence[str]) -> str:
    """Convert a text from the format ``source`` to the format ``to``.

    Raises ValueError with the message of pandoc if it fails or warns.
    """
    command = [str(PANDOC), f"--data-dir={DATA_FOLDER}", f"--from={source}", f"--to={to}"]
    command += ["--fail-if-warnings", *options]
    environment = {"LC_ALL": "C.UTF-8"}
    done = subprocess.run(
        command, input=text.encode(), capture_output=True, check=False, env=environment
    )
    if done.returncode:
        message = " ".join(done.stderr.decode(errors="replace").split())
        raise ValueError(f"pandoc: {message}")
    return done.stdout.decode()


def markup_of(texts: Iterable[str]) -> dict[str, Markup]:
    """Return HTML with MathML for each text, which is one paragraph of Markdown.

    HTML in a text is shown as text, a link is kept only if it leads to the web, and a picture
    becomes its alternative text.
    """
    texts = sorted({text for text in texts if text.strip()})
    if not texts:
        return {"": Markup()}
    # One call of pandoc converts all texts, with a horizontal rule between them.
    joined = "\n\n* * *\n\n".join(" ".join(text.split()) for text in texts)
    html = pandoc(joined, PAGE_TEXT, "html5", ["--sandbox", "--mathml", "--wrap=none"])
    html = LINK.sub(_web_link, html)
    html = IMAGE.sub(_alternative_text, html)
    parts = [part.strip() for part in html.split("<hr />")]
    if len(parts) != len(texts):
        raise ValueError(NOT_ONE_PARAGRAPH)
    paragraphs = [Markup(_paragraph_content(part)) for part in parts]
    return {"": Markup(), **dict(zip(texts, paragraphs, strict=True))}


def _paragraph_content(html: str) -> str:
    """Return the content of a paragraph, or raise ValueError if the HTML is something else."""
    if not (html.startswith("<p>") and html.endswith("</p>")):
        raise ValueError(NOT_ONE_PARAGRAPH)
    return html.removeprefix("<p>").removesuffix("</p>")


def _web_link(link: re.Match) -> str:
    """Return a link to the web without its attributes, and of any other link only the text."""
    address, text = link.groups()
    is_web_link = address.lower().startswith(("http://", "https://"))
    return f'<a href="{address}">{text}</a>' if is_web_link else text


def _alternative_text(image: re.Match) -> str:
    """Return the alternative text of a picture, which may be empty."""
    return image[1] or ""


def harmless(text: str) -> str:
    """Return a user's text as Markdown in which only formulas, emphasis and web links have effect.

    The result is safe in a page, in the report and in a cell of a table.
    """
    parts, end = [], 0
    for kept in KEPT.finditer(text):
        parts += [_escaped(text[end : kept.start()]), kept[0]]
        end = kept.end()
    parts.append(_escaped(text[end:]))
    return " ".join("".join(parts).split())


def _escaped(text: str) -> str:
    """Return a text in which special signs of Markdown have no effect."""
    return SPECIAL_SIGNS.sub(r"\\\1", text)


def is_readable(text: str) -> bool:
    """Return True if pandoc can read all formulas of a user's text."""
    if "$" not in text:
        return True
    try:
        markup_of([harmless(text)])
    except ValueError:
        return False
    return True
