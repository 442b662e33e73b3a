"""results/index.html, the page to open. Relative links only; nothing is loaded from outside."""

import json
from collections.abc import Mapping
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

from PIL import Image

from ..claims.ledger import Ledger
from ..claims.reading import read_text
from ..data.prose import fill
from .claims_page import shown
from .html import page
from .texts import answer, judged_lines, parameters, read_captions, read_errata

# A reader goes to the first files; the others follow below.
FIRST = {
    "manuscript/replication.html": "Report",
    "explorer.html": "Explore a rupture with sliders",
    "claims.html": "Every claim, with the tables behind it",
}
OTHERS = {
    "manuscript/replication.pdf": "report (PDF)",
    "manuscript/supplement.html": "supplement",
    "manuscript/supplement.pdf": "supplement (PDF)",
    "claims.json": "claims (JSON)",
    "findings.json": "further findings (JSON)",
    "provenance.json": "provenance (JSON)",
    "codecheck.yml": "manifest of every output (CODECHECK)",
    "checksums.txt": "checksums",
    "scenes/index.html": "scenes",
}
# Pixels of the page for a pixel of a figure: a figure of one column is narrower than the page.
SCALE = 0.4
# A wider figure has a row of the page for itself.
WIDE = 600


def index_page(
    results: str | Path, texts: Mapping, galleries: Mapping, scenes: Mapping[str, str]
) -> str:
    """The page, by paths of texts, figures by heading and titles of scenes; links only to files."""
    results = Path(results)
    facts = _json(results / "provenance.json")
    ledger = Ledger(_json(results / "claims.json"), _json(results / "findings.json"))
    config = facts["config"]
    names = {"claim": ledger, "found": ledger.found, "config": config}
    names["misprints"] = read_errata(texts["errata"])
    filled = partial(fill, names=names | {"runs": partial(parameters, config)})
    captions, summary = read_captions(texts["captions"], filled), read_text(texts["summary"])
    lines = judged_lines(summary, ledger, filled)
    in_short, accuracy = answer(lines[:1]), filled(summary["accuracy"])
    exceptions = answer(lines).removeprefix(in_short).strip()
    figures = {
        # A user-defined sweep has no caption but its name.
        name: captions.get(name)
        or captions["user_defined_sweep"]._replace(title=name.removeprefix("sweep_"))
        for name in chain.from_iterable(galleries.values())
    }
    written = [summary["question"], in_short, exceptions, summary["symbols"], accuracy]
    for line in lines:
        written += [line.topic, line.text]
    for caption in figures.values():
        written += [caption.finding, caption.caption]
    # The page does not jump while it loads.
    sizes = {}
    for name in figures:
        with Image.open(results / f"figures/{name}.png") as picture:
            sizes[name] = round(SCALE * picture.width), round(SCALE * picture.height)
    return page(
        "index.html",
        altered=facts["overlay"],
        texts=summary,
        answer=in_short,
        exceptions=exceptions,
        lines=lines,
        accuracy=accuracy,
        figures=figures,
        sizes=sizes,
        wide=WIDE,
        first=_existing(results, FIRST),
        others=_existing(results, OTHERS),
        galleries=galleries,
        scenes={
            name: (title, (results / f"scenes/{name}.html").exists())
            for name, title in scenes.items()
        },
        facts=facts,
        **shown(ledger, written),
    )


def _json(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))


def _existing(folder: Path, files: Mapping[str, str]) -> dict[str, str]:
    return {path: name for path, name in files.items() if (folder / path).exists()}
