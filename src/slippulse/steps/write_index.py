"""Write the page that leads to all results."""

from pathlib import Path

from ..data.files import write_text
from ..report.index_page import index_page

FILES = ("report/templates/index.html", "report/templates/parts.html")
# Of figures, by how their names begin.
HEADINGS = {
    "fig": "The figures of the paper",
    "study_": "Beyond the paper",
    "sweep_": "User-defined sweeps",
}


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: captions, summary, provenance. Outputs: html. Settings: figures (names), scenes (titles)."""
    figures = settings["figures"]
    named = {
        text: [name for name in figures if name.startswith(key)] for key, text in HEADINGS.items()
    }
    galleries = {heading: names for heading, names in named.items() if names}
    page = index_page(Path(outputs["html"]).parent, files, galleries, settings["scenes"])
    write_text(page, outputs["html"])
