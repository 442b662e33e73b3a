"""results/index.html, the page to open. Relative links only; nothing is loaded from outside."""

import json
from collections.abc import Mapping
from functools import partial
from itertools import chain
from pathlib import Path

from PIL import Image

from ..claims.reading import Ledger, read_text
from ..data.prose import fill
from .claims_page import shown
from .html import page
from .texts import answer, judged_lines, parameters, read_captions

# Where a reader goes first, and what else there is.
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
# Pixels of a page for one of a figure: what is as wide as a column of the journal stays narrower than the page.
SCALE = 0.4
# What is wider has a row of the page for itself.
WIDE = 600


def index_page(
    results: str | Path, texts: Mapping, galleries: Mapping, scenes: Mapping[str, str]
) -> str:
    """The page, by files of texts, figures by heading and titles of scenes; what is not there gets no link."""
    results = Path(results)
    made = (results / f"{name}.json" for name in ("claims", "findings", "provenance"))
    claims, findings, facts = (json.loads(path.read_text(encoding="utf-8")) for path in made)
    ledger, config = Ledger(claims, findings), facts["config"]
    names = {
        "claim": ledger,
        "found": ledger.found,
        "config": config,
        "runs": partial(parameters, config),
    }
    filled = partial(fill, names=names)
    captions, summary = read_captions(texts["captions"], filled), read_text(texts["summary"])
    lines = judged_lines(summary, ledger, filled)
    found, accuracy = answer(lines), filled(summary["accuracy"])
    figures = {
        # A user-defined sweep has no caption but its name.
        name: captions.get(name)
        or captions["user_defined_sweep"]._replace(title=name.removeprefix("sweep_"))
        for name in chain.from_iterable(galleries.values())
    }
    written = [text for line in lines for text in (line.topic, line.text)]
    written += [text for caption in figures.values() for text in (caption.finding, caption.caption)]

    def there(files: Mapping[str, str]) -> dict[str, str]:
        return {path: name for path, name in files.items() if (results / path).exists()}

    def size(name: str) -> tuple[int, int]:
        """Width and height of a figure on the page, which does not jump while it loads."""
        with Image.open(results / f"figures/{name}.png") as picture:
            return round(SCALE * picture.width), round(SCALE * picture.height)

    return page(
        "index.html",
        altered=facts["overlay"],
        answer=found,
        lines=lines,
        accuracy=accuracy,
        figures=figures,
        sizes={name: size(name) for name in figures},
        wide=WIDE,
        picture=summary["picture"],
        first=there(FIRST),
        others=there(OTHERS),
        galleries=galleries,
        scenes={
            name: (title, (results / f"scenes/{name}.html").exists())
            for name, title in scenes.items()
        },
        facts=facts,
        **shown(ledger, [*written, found, accuracy]),
    )
