"""results/index.html, the page to open. Relative links only; nothing is loaded from outside."""

import json
from collections.abc import Mapping
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

from PIL import Image

from ..claims.claim_texts import read_text
from ..claims.ledger import Ledger
from ..text.prose import fill
from .claims_page import SIGNS
from .html import markup_of, page
from .texts import answer, judged_lines, parameters, read_captions, read_errata

# Pixels of the page for a pixel of a figure: a figure of one column is narrower than the page.
SCALE = 0.4


def index_page(results: Path, texts: Mapping, galleries: Mapping, scenes: Mapping[str, str]) -> str:
    """The page, by paths of texts, figures by heading and titles of scenes; links only to files."""
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
        texts=summary | {"answer": in_short, "exceptions": exceptions, "accuracy": accuracy},
        lines=lines,
        figures=figures,
        sizes=sizes,
        galleries=galleries,
        scenes=scenes,
        exists=lambda path: (results / path).exists(),
        facts=facts,
        html=markup_of(written),
        summary=ledger.summary(),
        signs=SIGNS,
    )


def _json(path: Path) -> Any:
    return json.loads(path.read_text(encoding="utf-8"))
