"""Write the page that leads to all results."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..data.files import write_text
from ..pages.index import index_page

FILES = (
    "pages/templates/base.html",
    "pages/templates/index.html",
    "pages/templates/parts.html",
    "pages/templates/style.css",
)


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: captions, summary, claims, provenance. Outputs: html. Settings: galleries (names by heading), scenes."""
    texts = {key: files[key] for key in ("captions", "summary")}
    page = index_page(Path(outputs["html"]).parent, texts, settings["galleries"], settings["scenes"])
    write_text(page, outputs["html"])
