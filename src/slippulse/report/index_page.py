"""results/index.html, the page to open. Relative links only; nothing is loaded from outside."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from PIL import Image

from ..claims.reading import FAILURES_FIRST, Ledger
from ..data.prose import fill
from .claims_page import shown
from .html import page
from .parameters import parameters
from .texts import read_captions, read_text

FILES_OF_RESULTS = {
    "explorer.html": "Explorer (a rupture with sliders)",
    "manuscript/replication.html": "Replication report (HTML)",
    "manuscript/replication.pdf": "Replication report (PDF)",
    "claims.html": "Ledger of claims (a table)",
    "claims.json": "Ledger of claims (JSON)",
    "findings.json": "Further findings (JSON)",
    "provenance.json": "Provenance (JSON)",
    "codecheck.yml": "Manifest of every output (CODECHECK)",
    "checksums.txt": "Checksums (make verify)",
    "scenes/index.html": "Scenes",
}


def index_page(
    results: str | Path,
    texts: Mapping[str, str | Path],
    galleries: Mapping[str, Sequence[str]],
    scenes: Mapping[str, str],
) -> str:
    """The page.

    Parameters
    ----------
    results : folder that the page stands in, with claims.json, findings.json and provenance.json; files that are not
        there get no link
    texts : files of the `captions` and of the `summary`
    galleries : names of figures by the heading that they stand under
    scenes : titles by name
    """
    results = Path(results)
    claims, findings, facts = (
        json.loads((results / f"{name}.json").read_text(encoding="utf-8"))
        for name in ("claims", "findings", "provenance")
    )
    ledger = Ledger(claims, findings)
    config = facts["config"]
    names = {"claim": ledger, "found": ledger.found, "config": config, "facts": facts}
    names["runs"] = partial(parameters, config)
    captions = read_captions(texts["captions"], lambda text: fill(text, names))
    summary = read_text(texts["summary"])
    accuracy = fill(summary["accuracy"], names)
    for line in summary["verdict"]:
        line["text"] = fill(line["text"], names)
        # Its sign is the worst of its claims.
        line["claim"] = min(
            map(ledger, line["claims"]), key=lambda claim: FAILURES_FIRST.index(claim.verdict)
        )
    figures = {
        # A user-defined sweep has no caption but its name.
        name: captions.get(name) or captions["own_sweep"]._replace(title=name.removeprefix("sweep_"))
        for listed in galleries.values()
        for name in listed
    }
    written = [text for caption in figures.values() for text in (caption.finding, caption.caption)]
    return page(
        "index.html",
        altered=facts["overlay"],
        lines=summary["verdict"],
        accuracy=accuracy,
        figures=figures,
        sizes={name: _size(results / f"figures/{name}.png") for name in figures},
        picture=summary["picture"],
        files={path: title for path, title in FILES_OF_RESULTS.items() if (results / path).exists()},
        galleries=galleries,
        scenes={name: (title, (results / f"scenes/{name}.html").exists()) for name, title in scenes.items()},
        facts=facts,
        **shown(ledger, [*written, *(line["text"] for line in summary["verdict"]), accuracy]),
    )


def _size(path: Path) -> tuple[int, int]:
    """Width and height of a picture, so that the page does not jump while it loads."""
    with Image.open(path) as picture:
        return picture.size
