"""Write results/claims.html: every claim with its deviation, its tolerance and its tables.

Claims are grouped by verdict, and those that failed come first.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from ..claims.ledger import Entry, Ledger
from ..claims.rules import (
    BEYOND,
    CAVEAT,
    DEPENDS,
    FAILED,
    HOLDS_BEYOND,
    HOLDS_BEYOND_WITH_CAVEAT,
    INCONCLUSIVE,
    NOT_TESTABLE,
    REPRODUCED,
    UNMET,
    WORST_FIRST,
)
from ..text.numerals import rounded
from .html import markup_of, page

# Each verdict has a sign, so that the page can be read without colours.
SIGNS = {
    REPRODUCED: "\N{CHECK MARK}",
    CAVEAT: "~",
    DEPENDS: "\N{UP DOWN ARROW}",
    UNMET: "\N{NOT EQUAL TO}",
    FAILED: "\N{MULTIPLICATION SIGN}",
    BEYOND: "→",
    HOLDS_BEYOND: "\N{CHECK MARK}",
    HOLDS_BEYOND_WITH_CAVEAT: "~",
    INCONCLUSIVE: "?",
    NOT_TESTABLE: "\N{EN DASH}",
}
# A bar has its full length if the deviation is this many times the tolerance, or more.
FULL_BAR_RATIO = 2.0
# Names of tables on the page, by their folder. For other folders, the name of the folder is used.
TABLE_KINDS = {"measurements": "measured", "predictions": "predicted", "studies": "study"}
Rows = Sequence[Mapping]
# The command that regenerates the tables of a claim names at most this number of simulations and
# studies. For a claim with more of them it regenerates everything.
MAX_NAMED_SIMULATIONS = 6


def claims_page(claims: Rows, altered: Rows, findings: Rows, tables: Iterable[str]) -> str:
    """Return the page of claims and findings as HTML.

    claims, findings : contents of claims.json and findings.json
    altered : values of the configuration that differ from the shipped ones
    tables : paths of all tables relative to the page, which links to them
    """
    ledger = Ledger(claims)
    # All texts of the page that are written in Markdown. They are converted to HTML together.
    markdown_texts = [finding["text"] for finding in findings]
    groups: dict[str, list[Entry]] = {}
    for claim in sorted(ledger, key=lambda claim: WORST_FIRST.index(claim.verdict)):
        markdown_texts += [claim.statement, claim.why, claim.evidence_text()]
        groups.setdefault(claim.verdict, []).append(claim)
    return page(
        "claims.html",
        # The template looks up the HTML of a text in this mapping.
        html=markup_of(markdown_texts),
        summary=ledger.summary(),
        # Claims that follow from others, or that are not in the paper, are not counted.
        uncounted=len(ledger.claims) - ledger.count(),
        groups=groups,
        findings=findings,
        altered=altered,
        rules_altered=any(change["key"].startswith("claims.") for change in altered),
        signs=SIGNS,
        tables_behind=partial(tables_of_claim, tables=sorted(tables)),
        command=command,
        bar_of=bar_of,
        figure_title=figure_title,
    )


def tables_of_claim(source: str, tables: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return the paths of the tables by which a claim is judged.

    The keys are the names of simulations and studies, and then kinds of tables, as in
    {"front_speed": {"measured": "measurements/front_speed.csv"}}.

    source : the text in which the claim names its simulations and studies
    tables : paths of all tables
    """
    paths: dict[str, dict[str, str]] = {}
    for path in map(Path, tables):
        # The name of a folder is the kind of its tables, unless TABLE_KINDS has another word.
        folder = path.parts[0]
        table_kind = TABLE_KINDS.get(folder, folder)
        paths.setdefault(path.stem, {})[table_kind] = path.as_posix()
    if source.startswith("every simulation"):
        return paths
    # A word of the source that is not a name has no tables.
    words = dict.fromkeys(re.findall(r"\w+", source))
    return {word: paths[word] for word in words if word in paths}


def command(tables: Mapping[str, Mapping[str, str]]) -> str:
    """Return the command that regenerates some tables, or all of them if these are many.

    tables : the result of `tables_of_claim`; empty for a claim that only tests check
    """
    if not tables:
        return "make test"
    if len(tables) > MAX_NAMED_SIMULATIONS:
        return "make replicate"
    paths = chain.from_iterable(paths_by_kind.values() for paths_by_kind in tables.values())
    targets = " ".join(f"results/{path}" for path in paths)
    return f'make replicate TARGET="{targets}"'


class Bar(NamedTuple):
    """A bar that shows a deviation: the text beside it, and its length in per cent."""

    text: str
    length: float


def bar_of(claim: Entry) -> Bar | None:
    """Return the bar that shows the deviation of a claim divided by its tolerance.

    Returns None if the claim has no deviation, no tolerance, or a kind without a bar.
    """
    if claim.kind not in ("exact", "approximate") or claim.deviation is None or not claim.tolerance:
        return None
    ratio = claim.deviation / claim.tolerance
    length = 100.0 * min(ratio / FULL_BAR_RATIO, 1.0)
    return Bar(f"{rounded(ratio, 2)} × tolerance", round(length, 1))


def figure_title(name: str) -> str:
    """Return the text of a link to a figure, as in "figure 5, scaling"."""
    kind, _, words = name.replace("_", " ").partition(" ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}"
