"""From Markdown to one self-contained HTML file and a PDF, with pandoc and Typst; no network, no LaTeX, no clock."""

from __future__ import annotations

import json
import re
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

import matplotlib
import typst

from ..data.files import write_whole
from ..data.origin import configuration
from .page import as_page
from .pandoc import pandoc

# Those of the figures, which Matplotlib brings along.
FONTS = str(Path(matplotlib.get_data_path()) / "fonts/ttf")
# Any fixed instant will do: equal inputs then give equal bytes.
TIMESTAMP = 0
# Names and alternative texts of the figures of a text, which pandoc does not pass on to Typst.
ALTERNATIVE = re.compile(r"\{#(\w+) [^{}]*\balt='([^']*)'\}")


def render_html(text: str, manuscript: str | Path, output: str | Path) -> None:
    """Write the report as one HTML file that loads nothing.

    Parameters
    ----------
    text : Markdown
    manuscript : folder with metadata.yaml, references.bib, style.css, template.html
    output : HTML file
    """
    manuscript = Path(manuscript)
    options = [
        "--to=html5",
        f"--template={manuscript / 'template.html'}",
        "--mathml",
        "--embed-resources",
        "--default-image-extension=png",
        f"--css={manuscript / 'style.css'}",
        "--toc",
        "--toc-depth=2",
    ]
    html = as_page(_pandoc(text, manuscript, options))
    write_whole(output, lambda part: part.write_text(html, encoding="utf-8"))


def render_pdf(text: str, manuscript: str | Path, output: str | Path) -> None:
    """Write the report as PDF, its figures as vectors.

    Parameters
    ----------
    text : Markdown
    manuscript : folder with metadata.yaml, references.bib, template.typ
    output : PDF file

    Raises
    ------
    ValueError
        If Typst refuses the text, with its message.
    """
    manuscript = Path(manuscript)
    options = [
        "--to=typst",
        "--default-image-extension=pdf",
        f"--template={manuscript / 'template.typ'}",
    ]
    source = _pandoc(text, manuscript, options)
    with tempfile.TemporaryDirectory(prefix="slippulse-report-") as folder:
        root = Path(folder)
        (root / "report.typ").write_text(
            _gather(source, root, dict(ALTERNATIVE.findall(text))), encoding="utf-8"
        )
        try:
            pdf = typst.compile(
                str(root / "report.typ"),
                root=str(root),
                format="pdf",
                ignore_system_fonts=True,
                font_paths=[FONTS],
                timestamp=TIMESTAMP,
            )
        except typst.TypstError as error:
            raise ValueError(f"Typst: {error}") from None
    write_whole(output, lambda part: part.write_bytes(pdf))


def _pandoc(text: str, manuscript: Path, options: list[str]) -> str:
    common = [
        "--from=markdown",
        "--standalone",
        "--number-sections",
        "--citeproc",
        f"--metadata-file={manuscript / 'metadata.yaml'}",
        f"--bibliography={manuscript / 'references.bib'}",
        f"--variable=configuration:{configuration()}",
    ]
    return pandoc(text, common + options)


def _gather(source: str, root: Path, alternatives: Mapping[str, str]) -> str:
    """Copy the pictures beside the source, since Typst reads nothing above its root, and say what they show."""

    def local(match: re.Match) -> str:
        picture = Path(match[1])
        shutil.copyfile(picture, root / picture.name)
        # A string of Typst is written as one of JSON.
        shows = json.dumps(alternatives.get(picture.stem, picture.stem), ensure_ascii=False)
        return f'image("{picture.name}", alt: {shows}'

    return re.sub(r'image\("([^"]+)"', local, source)
