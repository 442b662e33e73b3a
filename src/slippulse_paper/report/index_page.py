"""Write results/index.html, the page to open first.

The page begins with a table of the paper's statements and their verdicts, followed by the figures,
the scenes and the provenance. All links are relative, and the page loads nothing from outside.
"""

import json
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

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


class _Texts(NamedTuple):
    """The texts of the page in Markdown, with numbers in place of their expressions.

    paragraphs : the question of the page, its answer, and a text about accuracy
    glossary : pairs of a term and its meaning
    rows : statements of the paper with their verdicts
    captions : the caption of each figure, by the name of the figure
    """

    paragraphs: Mapping[str, str]
    glossary: Sequence[tuple[str, str]]
    rows: Sequence[StatementRow]
    captions: Mapping[str, Caption]


def index_page(
    results: Path, text_files: Mapping, galleries: Mapping, scenes: Mapping[str, str]
) -> str:
    """Return the page as HTML, with links only to files that exist.

    text_files : paths of the captions, the summary and the errata
    galleries : names of figures by heading
    scenes : title of each scene by name
    """
    provenance = _read_json(results / "provenance.json")
    ledger = Ledger(_read_json(results / "claims.json"), _read_json(results / "findings.json"))
    figures = [*chain.from_iterable(galleries.values())]
    texts = _read_texts(text_files, figures, provenance["config"], ledger)
    return page(
        "index.html",
        altered=provenance["overlay"],
        texts=texts.paragraphs,
        rows=texts.rows,
        words=texts.glossary,
        figures=texts.captions,
        sizes={name: _shown_size(results / f"figures/{name}.png") for name in figures},
        labels=_figure_labels(galleries),
        galleries=galleries,
        scenes=scenes,
        exists=lambda path: (results / path).exists(),
        facts=provenance,
        html=_texts_as_html(texts),
        summary=ledger.summary(),
        signs=SIGNS,
    )


def _read_texts(paths: Mapping, figures: Iterable[str], config: Mapping, ledger: Ledger) -> _Texts:
    """Read the texts of the page, and put numbers in place of their expressions.

    paths : paths of the captions, the summary and the errata
    figures : names of the figures on the page
    """
    # The values and functions that the expressions may use.
    names = {
        "claim": ledger,
        "found": ledger.found,
        "config": config,
        "misprints": read_errata(paths["errata"]),
        "runs": partial(parameters, config),
    }
    evaluated = partial(fill, names=names)
    summary = read_text(paths["summary"])
    captions = read_captions(paths["captions"], evaluated)
    # The first line of the summary is enough to answer the question.
    first_line = judged_lines(summary, ledger, evaluated)[0]
    return _Texts(
        paragraphs={
            "question": evaluated(summary["question"]),
            "accuracy": evaluated(summary["accuracy"]),
            "answer": answer([first_line]),
        },
        glossary=[
            (evaluated(word["term"]), evaluated(word["meaning"])) for word in summary["words"]
        ],
        rows=statement_rows(summary, ledger, evaluated),
        captions={name: _caption_of(name, captions) for name in figures},
    )


def _texts_as_html(texts: _Texts) -> Mapping[str, str]:
    """Return the HTML of each text of the page, by the text in Markdown.

    All texts are collected first, because one call converts all of them.
    """
    markdown = [*texts.paragraphs.values(), *chain.from_iterable(texts.glossary)]
    for row in texts.rows:
        markdown += [row.statement, row.number]
    for caption in texts.captions.values():
        markdown += [caption.finding, caption.caption]
    return markup_of(markdown)


def _caption_of(figure: str, captions: Mapping[str, Caption]) -> Caption:
    """Return the caption of a figure.

    A user-defined sweep has no caption of its own. It gets a general one, with its name as title.
    """
    if figure in captions:
        return captions[figure]
    return captions["user_defined_sweep"]._replace(title=figure.removeprefix("sweep_"))


def _figure_labels(galleries: Mapping[str, Sequence[str]]) -> dict[str, str]:
    """Return a short label for each figure, such as "Figure 5", "Study 3" or "Sweep 1".

    Figures of the paper have the numbers of the paper. The others are numbered in their order on
    the page.

    galleries : names of figures by heading
    """
    labels = {}
    for names in galleries.values():
        for number, name in enumerate(names, start=1):
            if name.startswith("fig"):
                labels[name] = f"Figure {int(name[3:5])}"
            else:
                labels[name] = f"{name.partition('_')[0].capitalize()} {number}"
    return labels


def _shown_size(path: Path) -> tuple[int, int]:
    """Return the width and height of a figure on the page, in pixels of the page.

    The page contains these sizes, so that nothing moves while the figures load.
    """
    with Image.open(path) as picture:
        return round(FIGURE_SCALE * picture.width), round(FIGURE_SCALE * picture.height)


def _read_json(path: Path) -> Any:
    """Return the content of a JSON file."""
    return json.loads(path.read_text(encoding="utf-8"))
