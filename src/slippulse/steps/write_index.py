"""Write the page that leads to all results."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from ..data.files import write_text
from ..pages.index import captions_from, index_page


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: claims, provenance. Outputs: html. Settings: figures, studies (captions and settings), scenes."""
    claims, facts = (
        json.loads(Path(files[key]).read_text(encoding="utf-8")) for key in ("claims", "provenance")
    )
    text = index_page(
        Path(outputs["html"]).parent,
        captions_from(settings["figures"]),
        captions_from(settings["studies"]),
        claims,
        facts,
        settings["scenes"],
    )
    write_text(text, outputs["html"])
