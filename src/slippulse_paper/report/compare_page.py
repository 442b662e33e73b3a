"""results/compare.html: old beside new, with every figure inside; its numbers are in a CSV."""

import base64
import io
from collections.abc import Iterable
from pathlib import Path

import pandas as pd
from PIL import Image

from slippulse.data.files import UnreadableFile, write_text
from slippulse.data.tables import save_table

from ..claims.claim_texts import read_text
from .claims_page import SIGNS, figure_title
from .compare import ALTERED, DIFFERS, UNKNOWN, Comparison
from .html import markup_of, page

# Numbers of one table that the page shows; all are in the CSV.
SHOWN_NUMBERS = 40
# Each figure is on the page twice, so that it is drawn with this many pixels at most.
PICTURE_WIDTH = 1000


def write_comparison(result: Comparison, new: Path, old: Path, path: Path) -> None:
    """Write the page, and the numbers of both folders beside it as CSV."""
    if not path.parent.is_dir():
        raise ValueError(f"{path.parent}: no such folder; allowed: a folder of results")
    numbers = path.with_suffix(".csv")
    save_table(result.numbers, numbers)
    write_text(comparison_page(result, new, old, numbers.name), path)


def comparison_page(result: Comparison, new: Path, old: Path, numbers: str) -> str:
    """Return the page, whose link to all numbers leads to the file of that name."""
    verdicts = changed_verdicts(result, new, old)
    tables = []
    for runs in result.runs:
        rows = result.numbers[result.numbers["table"] == runs["table"]]
        counts = rows["outcome"].value_counts()
        differing = differing_numbers(rows)
        shown = {"rows": differing[:SHOWN_NUMBERS], "differing": len(differing)}
        tables.append(runs | {"counts": counts} | shown)
    figures = [figure_pair(name, new, old) for name in figure_names(new, old)]
    return page(
        "compare.html",
        old=old,
        new=new,
        result=result,
        settings=result.changes.get("provenance.json", []),
        verdicts=verdicts,
        html=markup_of(verdict["statement"] for verdict in verdicts),
        tables=tables,
        # What changed comes first.
        figures=sorted(figures, key=lambda figure: figure["equal"]),
        numbers=numbers,
        signs=SIGNS,
        figure_title=figure_title,
    )


def changed_verdicts(result: Comparison, new: Path, old: Path) -> list[dict]:
    """Return the claims whose verdicts differ, with both verdicts and measured numbers."""
    changed = result.changes.get("claims.json", [])
    claims = [
        {claim["id"]: claim for claim in read_text(tree / "claims.json")} if changed else {}
        for tree in (new, old)
    ]
    found = []
    for change in changed:
        ours, theirs = (tree.get(change["key"], {}) for tree in claims)
        statement = (ours or theirs).get("statement", change["key"])
        found.append(change | {"statement": statement, "new": ours, "old": theirs})
    return found


def differing_numbers(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the numbers that differ, first those with an uncertainty that differ most."""
    rows = rows[rows["outcome"].isin([DIFFERS, UNKNOWN, ALTERED]) & (rows["new"] != rows["old"])]
    studied = rows[["old_uncertainty", "new_uncertainty"]].notna().any(axis=1)
    excess = (rows["new"] - rows["old"]).abs() / rows["allowed"].clip(lower=1e-300)
    # An undefined difference, of a number and a missing one, is the largest.
    ranks = pd.DataFrame({"studied": studied, "excess": excess.fillna(float("inf"))})
    order = ranks.sort_values(["studied", "excess"], ascending=False, kind="stable").index
    return rows.loc[order]


def figure_names(*trees: Path) -> list[str]:
    """Return the names of the figures of all folders, in order."""
    return sorted({path.stem for tree in trees for path in (tree / "figures").glob("*.png")})


def figure_pair(name: str, new: Path, old: Path) -> dict:
    """Return both pictures of a figure, and whether the numbers drawn are equal."""
    pictures = {}
    for side, tree in (("old", old), ("new", new)):
        path = tree / f"figures/{name}.png"
        pictures[side] = embedded_picture(path) if path.exists() else None
    drawn = [_drawn_numbers(tree / f"figures/{name}.csv") for tree in (new, old)]
    return {"name": name, "equal": drawn[0] is not None and drawn[0] == drawn[1], **pictures}


def embedded_picture(path: Path) -> dict:
    """Return a picture as a data URI with its size; ValueError names a file that is no picture."""
    try:
        with Image.open(path) as picture:
            picture.load()
            # Few colours stay few, so that a diagram does not grow.
            reduced = picture if picture.width <= PICTURE_WIDTH else picture.convert("RGB")
            reduced.thumbnail((PICTURE_WIDTH, 10 * PICTURE_WIDTH))
            colours = reduced.convert("RGB").quantize(128, dither=Image.Dither.NONE)
            content = io.BytesIO()
            colours.save(content, "PNG", optimize=True)
    except OSError as error:
        raise UnreadableFile(path, error) from None
    uri = f"data:image/png;base64,{base64.b64encode(content.getvalue()).decode()}"
    return {"uri": uri, "width": reduced.width, "height": reduced.height}


def _drawn_numbers(path: Path) -> Iterable[str] | None:
    """Return the lines of a figure's CSV; None if there is no such file."""
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else None
