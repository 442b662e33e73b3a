"""Write the provenance of the results, their checksums and their manifest."""

from pathlib import Path

from ..data.files import write_json, write_text
from ..data.provenance import checksums, manifest, provenance
from ..report.texts import read_captions


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: results, captions. Outputs: provenance, checksums, manifest."""
    base = Path(outputs["provenance"]).parent
    captions = read_captions(files["captions"])
    comments = {name: caption.title for name, caption in captions.items()}
    write_text(checksums(files["results"], base), outputs["checksums"])
    write_text(manifest(files["results"], base, comments), outputs["manifest"])
    facts = provenance(".", settings["config"], settings["shipped"], base)
    write_json(facts, outputs["provenance"])
