"""Write what the results were made from, their checksums and their manifest."""

from pathlib import Path

from ..data.files import write_json, write_text
from ..data.provenance import checksums, manifest, provenance, source_files
from ..report.texts import read_captions
from .reach import digest_of_files


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: results, captions. Outputs: provenance, checksums, manifest. Settings: config, shipped."""
    base = Path(outputs["provenance"]).parent
    comments = {name: caption.title for name, caption in read_captions(files["captions"]).items()}
    write_text(checksums(files["results"], base), outputs["checksums"])
    write_text(manifest(files["results"], base, comments), outputs["manifest"])
    sources = digest_of_files(source_files("."))
    write_json(
        provenance(".", sources, settings["config"], settings["shipped"], base),
        outputs["provenance"],
    )
