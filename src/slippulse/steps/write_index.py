"""Write the page that leads to all results."""

from pathlib import Path

from ..data.files import write_text
from ..report.index_page import index_page

FILES = ("report/templates/index.html", "report/templates/parts.html")


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: captions, summary, claims, provenance. Outputs: html. Settings: galleries (names by heading), scenes."""
    texts = {key: files[key] for key in ("captions", "summary")}
    page = index_page(Path(outputs["html"]).parent, texts, settings["galleries"], settings["scenes"])
    write_text(page, outputs["html"])
