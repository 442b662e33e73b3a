"""Conversion of Markdown with the pandoc of the locked environment.

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
# Pandoc looks here for defaults, templates, filters and styles. There are none, so that those of
# the user have no effect.
DATA_FOLDER = Path(__file__).parent
# Extensions that are switched off for the texts of pages, so that a text cannot add HTML,
# attributes or code of its own.
DISABLED_EXTENSIONS = """
    raw_html raw_tex raw_attribute native_divs native_spans bracketed_spans fenced_divs
    link_attributes header_attributes fenced_code_attributes inline_code_attributes smart
    fancy_lists latex_macros inline_notes footnotes citations
"""
PAGE_TEXT = "-".join(["markdown", *DISABLED_EXTENSIONS.split()])
# A link has an address and a text, and a picture may have an alternative text.
LINK = re.compile(r'<a href="([^"]*)"[^>]*>(.*?)</a>', re.DOTALL)
IMAGE = re.compile(r'<img [^>]*?alt="([^"]*)"[^>]*>|<img [^>]*>')
# In a text of a user, formulas ($...$) and links to the web ([text](address)) are kept as they are.
# Elsewhere, special signs of Markdown are escaped.
FORMULA = re.compile(r"(?<!\\)\$(?=\S)((?:[^$\\]|\\.)*?)(?<=\S)\$(?!\d)")
KEPT = re.compile(rf"({FORMULA.pattern}|(?<!!)\[[\w ,.:;()-]+\]\(https?://[\w./?=&%:~-]+\))")
SPECIAL_SIGNS = re.compile(r"([\\`\[\]{}<>|@$^~#!])")


def pandoc(text: str, source: str, to: str, options: Sequence[str]) -> str:
    """Convert a text from one format of pandoc (``source``) to another one (``to``).

    Raises ValueError with the message of pandoc if pandoc fails or prints a warning.
    """
    command = [str(PANDOC), f"--data-dir={DATA_FOLDER}", f"--from={source}", f"--to={to}"]
    command += ["--fail-if-warnings", *options]
    # No variable of the user has an effect on the result.
    environment = {"LC_ALL": "C.UTF-8"}
    done = subprocess.run(
        command, input=text.encode(), capture_output=True, check=False, env=environment
    )
    if done.returncode:
        message = " ".join(done.stderr.decode(errors="replace").split())
        raise ValueError(f"pandoc: {message}")
    return done.stdout.decode()


def markup_of(texts: Iterable[str]) -> dict[str, Markup]:
    """Return a mapping from each text, one paragraph of Markdown, to its HTML with MathML.

    HTML in a text is shown as text. A link is kept only if it leads to the web. A picture is
    replaced by its alternative text. An empty text has empty HTML.
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
        raise ValueError(
            f"texts for a page: {texts}; allowed: each text is one paragraph of Markdown, without a"
            " horizontal rule"
        )
    paragraphs = {
        text: Markup(_paragraph_content(part, text))
        for text, part in zip(texts, parts, strict=True)
    }
    return {"": Markup(), **paragraphs}


def _paragraph_content(html: str, text: str) -> str:
    """Return the content of the HTML paragraph that was made from a text.

    Raises ValueError, with the text in the message, if the HTML is not a paragraph.
    """
    if not (html.startswith("<p>") and html.endswith("</p>")):
        raise ValueError(f"text for a page: {text!r}; allowed: one paragraph of Markdown")
    return html.removeprefix("<p>").removesuffix("</p>")


def _web_link(link: re.Match) -> str:
    """Return a link to the web without its attributes, or the text of any other link."""
    address, text = link.groups()
    is_web_link = address.lower().startswith(("http://", "https://"))
    return f'<a href="{address}">{text}</a>' if is_web_link else text


def _alternative_text(image: re.Match) -> str:
    """Return the alternative text of a picture, which may be empty."""
    return image[1] or ""


def harmless(text: str) -> str:
    """Return a user's text as Markdown in which only formulas, emphasis and web links have effect.

    The result is one line, and safe in a page, in the report and in a cell of a table.
    """
    parts, end_of_last = [], 0
    # KEPT finds formulas and web links, which stay as they are. Emphasis is marked by signs that
    # `_escaped` does not change.
    for kept in KEPT.finditer(text):
        parts += [_escaped(text[end_of_last : kept.start()]), kept[0]]
        end_of_last = kept.end()
    parts.append(_escaped(text[end_of_last:]))
    return " ".join("".join(parts).split())


def _escaped(text: str) -> str:
    """Return a text with a backslash before each special sign of Markdown."""
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
