"""Write the page with links to all results, and the provenance, checksums and manifest."""

from pathlib import Path

from slippulse.data.files import write_text

from ..records.job_records import write_json
from ..records.provenance import checksums, manifest, provenance
from ..records.sources import PROJECT
from ..report.index_page import index_page
from ..report.texts import read_captions

# Headings of groups of figures, by the first part of the names of the figures.
HEADINGS = {
    "fig": "The figures of the paper",
    "study_": "Studies beyond the paper",
    "sweep_": "User-defined sweeps",
}


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the page ``html``, and the files ``provenance``, ``checksums`` and ``manifest``.

    The files are all results, and texts of the manuscript. The settings have the configuration
    (``config``), the shipped configuration (``shipped``), the names of the figures, and the titles
    of the scenes by name.
    """
    base = Path(outputs["html"]).parent
    titles = {name: caption.title for name, caption in read_captions(files["captions"]).items()}
    write_text(checksums(files["results"], base), outputs["checksums"])
    write_text(manifest(files["results"], base, titles), outputs["manifest"])
    facts = provenance(PROJECT, settings["config"], settings["shipped"], base)
    write_json(facts, outputs["provenance"])
    # The names of the figures by heading. The beginning of a name determines its heading.
    galleries = {}
    for prefix, heading in HEADINGS.items():
        names = [name for name in settings["figures"] if name.startswith(prefix)]
        if names:
            galleries[heading] = names
    write_text(index_page(base, files, galleries, settings["scenes"]), outputs["html"])
