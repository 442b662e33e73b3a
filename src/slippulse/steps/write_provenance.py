"""Write what the results were made from, their checksums and their manifest."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from ..data.files import write_text
from ..data.provenance import checksums, manifest, provenance, source_files
from ..report.texts import read_captions
from .reach import digest_of_files


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: results, captions. Outputs: provenance, checksums, manifest. Settings: config, shipped."""
    base = Path(outputs["provenance"]).parent
    facts = provenance(".", digest_of_files(source_files(".")), settings["config"], settings["shipped"], base)
    comments = {name: caption.title for name, caption in read_captions(files["captions"]).items()}
    write_text(checksums(files["results"], base), outputs["checksums"])
    write_text(manifest(files["results"], base, comments), outputs["manifest"])
    write_text(json.dumps(facts, indent=1, ensure_ascii=False) + "\n", outputs["provenance"])
