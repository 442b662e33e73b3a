"""Write results/index.html, the page to open first.

It begins with a table of the paper's statements and their verdicts, followed by the figures, the
scenes and the provenance. All links are relative, and the page loads nothing from outside.
"""

import json
from collections.abc import Iterable, Mapping
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
from .texts import (
    Caption,
    StatementRow,
    answer,
    judged_lines,
    parameters,
    read_captions,
    read_errata,
    statement_rows,
)

# Width of a figure on the page divided by the width of its file, both in pixels.
FIGURE_SCALE = 0.4


def index_page(results: Path, texts: Mapping, galleries: Mapping, scenes: Mapping[str, str]) -> str:
    """Return the page as HTML, with links only to files that exist.

    texts : paths of the captions, the summary and the errata
    galleries : names of figures by heading
    scenes : title of each scene by name
    """
    provenance = _read_json(results / "provenance.json")
    ledger = Ledger(_read_json(results / "claims.json"), _read_json(results / "findings.json"))
    names = _names_in_texts(provenance["config"], ledger, read_errata(texts["errata"]))
    # This function returns a text with the values of the expressions in it.
    evaluated = partial(fill, names=names)
    summary = read_text(texts["summary"])
    # The first line of the summary is enough to answer the question.
    first_line = judged_lines(summary, ledger, evaluated)[0]
    paragraphs = {
        "question": evaluated(summary["question"]),
        "accuracy": evaluated(summary["accuracy"]),
        "answer": answer([first_line]),
    }
    # Rows of the table of the paper's statements and their verdicts.
    rows = statement_rows(summary, ledger, evaluated)
    glossary = [(evaluated(word["term"]), evaluated(word["meaning"])) for word in summary["words"]]
    captions = read_captions(texts["captions"], evaluated)
    figure_names = chain.from_iterable(galleries.values())
    caption_by_figure = {name: _caption_of(name, captions) for name in figure_names}
    return page(
        "index.html",
        altered=provenance["overlay"],
        texts=paragraphs,
        rows=rows,
        words=glossary,
        figures=caption_by_figure,
        sizes={name: _shown_size(results / f"figures/{name}.png") for name in caption_by_figure},
        galleries=galleries,
        scenes=scenes,
        exists=lambda path: (results / path).exists(),
        facts=provenance,
        html=_texts_as_html(paragraphs, glossary, rows, caption_by_figure.values()),
        summary=ledger.summary(),
        signs=SIGNS,
    )


def _texts_as_html(
    paragraphs: Mapping[str, str],
    glossary: Iterable[tuple[str, str]],
    rows: Iterable[StatementRow],
    captions: Iterable[Caption],
) -> Mapping[str, str]:
    """Return the HTML of each text of the page, by the text in Markdown.

    All texts are collected first, because one call converts all of them.

    glossary : pairs of a term and its meaning
    """
    markdown = [*paragraphs.values(), *chain.from_iterable(glossary)]
    for row in rows:
        markdown += [row.statement, row.number]
    for caption in captions:
        markdown += [caption.finding, caption.caption]
    return markup_of(markdown)


def _names_in_texts(config: Mapping, ledger: Ledger, misprints: list) -> dict[str, object]:
    """Return the values and functions that the expressions in the texts may use, by name."""
    return {
        "claim": ledger,
        "found": ledger.found,
        "config": config,
        "misprints": misprints,
        "runs": partial(parameters, config),
    }


def _caption_of(figure: str, captions: Mapping[str, Caption]) -> Caption:
    """Return the caption of a figure.

    A user-defined sweep has no caption of its own. It gets a general one, with its name as title.
    """
    if figure in captions:
        return captions[figure]
    return captions["user_defined_sweep"]._replace(title=figure.removeprefix("sweep_"))


def _shown_size(path: Path) -> tuple[int, int]:
    """Return the width and height of a figure on the page, in pixels of the page.

    The page contains these sizes, so that nothing moves while the figures load.
    """
    with Image.open(path) as picture:
        return round(FIGURE_SCALE * picture.width), round(FIGURE_SCALE * picture.height)


def _read_json(path: Path) -> Any:
    """Return the content of a JSON file."""
    return json.loads(path.read_text(encoding="utf-8"))
