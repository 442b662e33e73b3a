"""Convert the executed manuscript to one HTML file and to a PDF.

Pandoc writes the HTML, and the Typst source of the PDF. Neither needs a network connection.
"""

import json
import re
import tempfile
from base64 import b64encode
from collections.abc import Sequence
from functools import partial
from itertools import count
from pathlib import Path

import matplotlib
import typst
from PIL import Image

from slippulse.data.files import configuration, write_text, write_whole

from ..text.markdown import pandoc
from .html import TEMPLATES, page

# The fonts of the figures, which Matplotlib brings along.
FONT_FOLDER = Path(matplotlib.get_data_path()) / "fonts/ttf"
# The creation date of every PDF. With a fixed date, equal inputs give equal bytes.
TIMESTAMP = 0
HTML_FIGURE = re.compile(r'(<figure id="(\w+)">\s*)<img\s+src="([^"]+)"([^>]*>)')
# Name and alternative text of a figure in Markdown. Pandoc does not pass the latter on to Typst.
ALTERNATIVE = re.compile(r"\{#(\w+) [^{}]*\balt='([^']*)'\}")


def write_html(text: str, manuscript: Path, output: str | Path) -> None:
    """Write Markdown as one HTML file; ``manuscript`` is the folder with the bibliography."""
    with tempfile.TemporaryDirectory(prefix="slippulse-report-") as folder:
        template = Path(folder) / "report.html"
        template.write_text(page("report.html"), encoding="utf-8")
        options = ["--mathml", "--default-image-extension=png", "--toc", "--toc-depth=2"]
        html = _pandoc(text, manuscript, template, "html5", options)
    head, opening, body = html.partition('<main id="content">')
    # The title is the only heading of level 1.
    body = re.sub(r"(</?h)([1-5])\b", lambda tag: f"{tag[1]}{int(tag[2]) + 1}", body)
    # Formulas, code and tables scroll sideways on a phone, so the keyboard must reach them.
    body = re.sub('<math display="block"|<pre', lambda tag: f'{tag[0]} tabindex="0"', body)
    numbers = count(1)
    region = '<div class="scroll" tabindex="0" role="region" aria-label="Table {}"><table'
    body = re.sub("<table", lambda _: region.format(next(numbers)), body)
    body = body.replace("</table>", "</table></div>")
    # A click on a figure opens its picture, at its own size.
    write_text(head + opening + HTML_FIGURE.sub(_enlarging, body), output)


def _enlarging(figure: re.Match) -> str:
    """Return the figure with its picture embedded, its size given, and a link to the file."""
    start, name, path, rest = figure.groups()
    content = b64encode(Path(path).read_bytes()).decode()
    with Image.open(path) as picture:
        size = 'width="{}" height="{}"'.format(*picture.size)
    image = f'<img src="data:image/png;base64,{content}" {size}'
    return f'{start}<a href="../figures/{name}.png">{image}{rest}</a>'


def write_pdf(text: str, manuscript: Path, output: str | Path) -> None:
    """Write Markdown as a PDF with vector figures; a ValueError has the message of Typst."""
    # In a PDF, a link to another document leads to the PDF of that document.
    text = re.sub(r"\((\w+)\.html(?:#[\w-]*)?\)", r"(\1.pdf)", text)
    options = ["--default-image-extension=pdf"]
    source = _pandoc(text, manuscript, TEMPLATES / "report.typ", "typst", options)
    alternatives = dict(ALTERNATIVE.findall(text))

    def with_alternative(image: re.Match) -> str:
        alternative = alternatives[Path(image[1]).stem]
        # JSON and Typst write a string in the same way.
        return f"{image[0]}, alt: {json.dumps(alternative, ensure_ascii=False)}"

    source = re.sub(r'image\("([^"]+)"', with_alternative, source)
    compiled = partial(
        typst.compile, ignore_system_fonts=True, font_paths=[FONT_FOLDER], timestamp=TIMESTAMP
    )
    try:
        pdf: bytes | None = compiled(source.encode(), root=Path("/"), format="pdf")
    except typst.TypstError as error:
        raise ValueError(f"Typst: {error}") from None
    write_whole(output, lambda part: part.write_bytes(pdf or b""))


def _pandoc(text: str, manuscript: Path, template: Path, to: str, options: Sequence[str]) -> str:
    """Convert the report with pandoc, with the template, the metadata and the bibliography."""
    common = ["--standalone", "--number-sections", "--citeproc"]
    common += [
        f"--template={template}",
        f"--csl={TEMPLATES / 'report.csl'}",
        f"--metadata-file={manuscript / 'metadata.yaml'}",
        f"--bibliography={manuscript / 'references.bib'}",
        f"--variable=configuration:{configuration()}",
    ]
    return pandoc(text, "markdown", to, [*common, *options])
