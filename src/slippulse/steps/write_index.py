"""Write the page that leads to all results."""

from pathlib import Path

from ..data.files import write_text
from ..report.index_page import index_page

FILES = ("report/templates/index.html", "report/templates/parts.html")
# Headings of figures, by how the names of these begin.
HEADINGS = {
    "fig": "The figures of the paper",
    "study_": "Beyond the paper",
    "sweep_": "User-defined sweeps",
}


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: captions, summary, provenance. Outputs: html. Settings: figures, scenes (titles)."""
    galleries = {}
    for start, heading in HEADINGS.items():
        names = [name for name in settings["figures"] if name.startswith(start)]
        if names:
            galleries[heading] = names
    page = index_page(Path(outputs["html"]).parent, files, galleries, settings["scenes"])
    write_text(page, outputs["html"])
