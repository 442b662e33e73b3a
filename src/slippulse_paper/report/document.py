"""Convert the executed manuscript to one HTML file and to a PDF.

Pandoc converts the Markdown to HTML, and to Typst source, from which Typst makes the PDF. Neither
program needs a network connection.
"""

import json
import re
import tempfile
from base64 import b64encode
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import matplotlib
import typst
from PIL import Image

from slippulse.data.files import configuration_digest, write_text, write_whole

from ..text.markdown import pandoc
from .html import TEMPLATES, page

# The fonts of the figures, which Matplotlib brings along.
FONT_FOLDER = Path(matplotlib.get_data_path()) / "fonts/ttf"
# The creation date of every PDF. With a fixed date, equal inputs give equal bytes.
TIMESTAMP = 0
HTML_FIGURE = re.compile(
    r'(?P<start><figure id="(?P<name>\w+)">\s*)<img\s+src="(?P<path>[^"]+)"(?P<attributes>[^>]*>)'
)
# Name and alternative text of a figure in Markdown. Pandoc does not write the alternative text into
# the Typst source.
ALTERNATIVE_TEXT = re.compile(r"\{#(\w+) [^{}]*\balt='([^']*)'\}")


def write_html(text: str, manuscript: Path, output: str | Path) -> None:
    """Write Markdown as one HTML file that contains all pictures.

    manuscript : the folder with the metadata and the bibliography
    """
    with tempfile.TemporaryDirectory(prefix="slippulse-report-") as folder:
        template = Path(folder) / "report.html"
        template.write_text(page("report.html"), encoding="utf-8")
        options = ["--mathml", "--default-image-extension=png", "--toc", "--toc-depth=2"]
        html = _pandoc(text, manuscript, template, "html5", options)
    # The title and the contents before the main part stay as they are.
    head, opening_tag, body = html.partition('<main id="content">')
    body = _make_scrollable(_lower_headings(body))
    body = HTML_FIGURE.sub(_figure_with_picture, body)
    write_text(head + opening_tag + body, output)


def _lower_headings(html: str) -> str:
    """Return HTML in which each heading is one level lower, since only the title has level 1."""
    return re.sub(r"(</?h)([1-5])\b", lambda tag: f"{tag[1]}{int(tag[2]) + 1}", html)


def _make_scrollable(html: str) -> str:
    """Return HTML in which wide formulas, code and tables can be scrolled sideways.

    These elements get a tab index, so that the keyboard can scroll them, too.
    """
    html = re.sub('<math display="block"|<pre', lambda tag: f'{tag[0]} tabindex="0"', html)
    # Put each table into a region that scrolls, with a number as its label.
    before_tables, *tables = html.split("<table")
    html = before_tables
    for number, table in enumerate(tables, start=1):
        label = f"Table {number}"
        html += f'<div class="scroll" tabindex="0" role="region" aria-label="{label}"><table{table}'
    return html.replace("</table>", "</table></div>")


def _figure_with_picture(figure: re.Match) -> str:
    """Return the HTML of a figure that contains its picture and the size of the picture.

    A click on it opens the picture file.

    figure : match of `HTML_FIGURE`, the HTML of a figure with a link to the picture file
    """
    content = b64encode(Path(figure["path"]).read_bytes()).decode()
    with Image.open(figure["path"]) as picture:
        size = f'width="{picture.width}" height="{picture.height}"'
    image = f'<img src="data:image/png;base64,{content}" {size}{figure["attributes"]}'
    return f'{figure["start"]}<a href="../figures/{figure["name"]}.png">{image}</a>'


def write_pdf(text: str, manuscript: Path, output: str | Path) -> None:
    """Write Markdown as a PDF with vector figures.

    Raises ValueError with the message of Typst if Typst cannot make the PDF.

    manuscript : the folder with the metadata and the bibliography
    """
    # In a PDF, a link to another document leads to the PDF of that document.
    text = re.sub(r"\((\w+)\.html(?:#[\w-]*)?\)", r"(\1.pdf)", text)
    options = ["--default-image-extension=pdf"]
    source = _pandoc(text, manuscript, TEMPLATES / "report.typ", "typst", options)
    # The alternative text of each figure, by the name of the figure.
    alternatives = dict(ALTERNATIVE_TEXT.findall(text))

    def add_alternative_text(image: re.Match) -> str:
        """Add the alternative text to image("PATH", the beginning of a call in Typst."""
        alternative = alternatives[Path(image[1]).stem]
        # JSON and Typst write a string in the same way.
        return f"{image[0]}, alt: {json.dumps(alternative, ensure_ascii=False)}"

    source = re.sub(r'image\("([^"]+)"', add_alternative_text, source)
    # `partial` is used because the declared types of `typst.compile` do not allow these options
    # together with a source in bytes.
    compiled = partial(
        typst.compile, ignore_system_fonts=True, font_paths=[FONT_FOLDER], timestamp=TIMESTAMP
    )
    try:
        pdf: bytes | None = compiled(source.encode(), root=Path("/"), format="pdf")
    except typst.TypstError as error:
        raise ValueError(f"Typst: {error}") from None
    write_whole(output, lambda path: path.write_bytes(pdf or b""))


def _pandoc(text: str, manuscript: Path, template: Path, to: str, options: Sequence[str]) -> str:
    """Convert the Markdown of the report with pandoc.

    manuscript : the folder with the metadata and the bibliography
    to : the format of the result, "html5" or "typst"
    options : further options of pandoc
    """
    common = ["--standalone", "--number-sections", "--citeproc"]
    common += [
        f"--template={template}",
        f"--csl={TEMPLATES / 'report.csl'}",
        f"--metadata-file={manuscript / 'metadata.yaml'}",
        f"--bibliography={manuscript / 'references.bib'}",
        f"--variable=configuration:{configuration_digest()}",
    ]
    return pandoc(text, "markdown", to, [*common, *options])
