"""Write results/compare.html, a page that shows old and new results side by side.

The page contains the pictures of all figures. All compared numbers are in a CSV file beside it.
"""

import base64
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
from PIL import Image

from slippulse.data.files import UnreadableFile, write_text
from slippulse.data.tables import save_table

from ..claims.claim_texts import read_text
from .claims_page import SIGNS, figure_title
from .compare import Comparison, TableRuns
from .compared_numbers import ALTERED, DIFFERS, UNKNOWN
from .html import markup_of, page

# The page shows this many numbers of one table. All of them are in the CSV file.
SHOWN_NUMBERS = 40
# Largest width of a picture in pixels. The page contains each figure twice.
MAX_PICTURE_WIDTH = 1000
PICTURE_COLOURS = 128


@dataclass(frozen=True)
class ChangedVerdict:
    """A claim whose verdict changed, with its entries in the old and the new claims.json.

    An entry is None if the folder does not have the claim.
    """

    id: str
    statement: str
    old: dict[str, Any] | None
    new: dict[str, Any] | None


@dataclass(frozen=True)
class ShownTable:
    """The part of the page about one table.

    runs : how many runs are in both folders, and descriptions of the others
    counts : how many numbers have each outcome
    differing_count : how many numbers differ
    rows : the numbers that differ most
    """

    runs: TableRuns
    counts: dict[str, int]
    differing_count: int
    rows: pd.DataFrame


@dataclass(frozen=True)
class Picture:
    """A picture as a data URI, which a page can contain, with its size in pixels."""

    uri: str
    width: int
    height: int


@dataclass(frozen=True)
class FigurePair:
    """The old and the new picture of a figure, or None if a folder does not have it.

    is_equal : True if both pictures show the same numbers
    """

    name: str
    is_equal: bool
    old: Picture | None
    new: Picture | None


def write_comparison(result: Comparison, new: Path, old: Path, path: Path) -> None:
    """Write the page to ``path``, and beside it a CSV file with all compared numbers."""
    if not path.parent.is_dir():
        raise ValueError(f"{path.parent}: no such folder; allowed: a folder of results")
    numbers_path = path.with_suffix(".csv")
    save_table(result.numbers, numbers_path)
    write_text(comparison_page(result, new, old, numbers_path.name), path)


def comparison_page(result: Comparison, new: Path, old: Path, numbers: str) -> str:
    """Return the page as HTML. ``numbers`` is the name of the CSV file that it links to."""
    verdicts = changed_verdicts(result, new, old)
    pairs = [figure_pair(name, new, old) for name in figure_names(new, old)]
    return page(
        "compare.html",
        old=old,
        new=new,
        result=result,
        settings=result.changes.get("provenance.json", []),
        verdicts=verdicts,
        html=markup_of(verdict.statement for verdict in verdicts),
        tables=[shown_table(runs, result.numbers) for runs in result.runs],
        # Figures whose numbers differ come first.
        figures=sorted(pairs, key=lambda pair: pair.is_equal),
        numbers=numbers,
        signs=SIGNS,
        figure_title=figure_title,
    )


def changed_verdicts(result: Comparison, new: Path, old: Path) -> list[ChangedVerdict]:
    """Return the claims whose verdicts differ, with everything that both folders record of them."""
    changes = result.changes.get("claims.json", [])
    if not changes:
        return []
    new_claims = {claim["id"]: claim for claim in read_text(new / "claims.json")}
    old_claims = {claim["id"]: claim for claim in read_text(old / "claims.json")}
    changed = []
    for change in changes:
        id = change["key"]
        new_claim, old_claim = new_claims.get(id), old_claims.get(id)
        # Only one of the two folders may have the claim.
        claim = new_claim or old_claim or {}
        statement = claim.get("statement", id)
        changed.append(ChangedVerdict(id, statement, old=old_claim, new=new_claim))
    return changed


def shown_table(runs: TableRuns, numbers: pd.DataFrame) -> ShownTable:
    """Return the part of the page about one table.

    numbers : the compared numbers of all tables
    """
    table_numbers = numbers[numbers["table"] == runs.table]
    differing = differing_numbers(table_numbers)
    counts = table_numbers["outcome"].value_counts().to_dict()
    return ShownTable(runs, counts, len(differing), rows=differing[:SHOWN_NUMBERS])


def differing_numbers(numbers: pd.DataFrame) -> pd.DataFrame:
    """Return the numbers that differ, sorted by their difference, the largest first.

    The difference is divided by the allowed difference. It counts as infinite if only one of the
    two numbers is known. Numbers without an uncertainty come last.
    """
    # Numbers with the outcome AGREES may be unequal, too, but only within their uncertainties.
    may_differ = numbers["outcome"].isin([DIFFERS, UNKNOWN, ALTERED])
    differing = numbers[may_differ & (numbers["new"] != numbers["old"])]
    # One of the two uncertainties is enough.
    has_uncertainty = differing[["old_uncertainty", "new_uncertainty"]].notna().any(axis=1)
    difference = (differing["new"] - differing["old"]).abs()
    # The tiny lower bound avoids a division by 0.
    relative = difference / differing["allowed"].clip(lower=1e-300)
    sort_keys = pd.DataFrame(
        {"has_uncertainty": has_uncertainty, "relative": relative.fillna(float("inf"))}
    )
    in_order = sort_keys.sort_values([*sort_keys.columns], ascending=False, kind="stable")
    return differing.loc[in_order.index]


def figure_names(new: Path, old: Path) -> list[str]:
    """Return the names of the figures in either folder, in order."""
    paths = [*new.glob("figures/*.png"), *old.glob("figures/*.png")]
    return sorted({path.stem for path in paths})


def figure_pair(name: str, new: Path, old: Path) -> FigurePair:
    """Return both pictures of a figure, and whether both show the same numbers."""
    # The numbers are None if the figure is not in the folder.
    new_numbers, old_numbers = _drawn_numbers(name, new), _drawn_numbers(name, old)
    return FigurePair(
        name,
        is_equal=new_numbers is not None and new_numbers == old_numbers,
        old=embedded_picture(old / f"figures/{name}.png"),
        new=embedded_picture(new / f"figures/{name}.png"),
    )


def embedded_picture(path: Path) -> Picture | None:
    """Return a reduced picture, or None if there is no such file.

    Raises ValueError with the path if the file is not a picture.
    """
    if not path.exists():
        return None
    try:
        with Image.open(path) as picture:
            picture.load()
            # A picture with a palette must be converted to full colour before it is made smaller.
            reduced = picture if picture.width <= MAX_PICTURE_WIDTH else picture.convert("RGB")
            # The thumbnail keeps the proportions, and only its width is limited.
            reduced.thumbnail((MAX_PICTURE_WIDTH, 10 * MAX_PICTURE_WIDTH))
            with_palette = reduced.convert("RGB").quantize(
                PICTURE_COLOURS, dither=Image.Dither.NONE
            )
            content = io.BytesIO()
            with_palette.save(content, "PNG", optimize=True)
    except OSError as error:
        raise UnreadableFile(path, error) from None
    encoded = base64.b64encode(content.getvalue()).decode()
    return Picture(f"data:image/png;base64,{encoded}", reduced.width, reduced.height)


def _drawn_numbers(name: str, results: Path) -> list[str] | None:
    """Return the lines of a figure's CSV file, or None if there is no such file."""
    path = results / f"figures/{name}.csv"
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else None
