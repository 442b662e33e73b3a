"""Write results/claims.html: every claim with its deviation, its tolerance and its tables.

Claims are grouped by verdict, and those that failed come first.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path

from ..claims.ledger import Entry, Ledger
from ..claims.rules import VERDICTS, WORST_FIRST
from ..text.numerals import rounded
from .html import markup_of, page

# Each verdict has a sign, so that the page can be read without colours.
MARKS = "\N{CHECK MARK}~\N{UP DOWN ARROW}\N{NOT EQUAL TO}\N{MULTIPLICATION SIGN}→?\N{EN DASH}"
SIGNS = dict(zip(VERDICTS, MARKS, strict=True))
# The full length of a bar, as a deviation divided by its tolerance.
FULL_BAR = 2.0
# What the page calls the tables of a folder, if not by the name of the folder.
TABLE_NAMES = {"measurements": "measured", "predictions": "predicted", "studies": "study"}
Rows = Sequence[Mapping]
# A claim that rests on more simulations than this is regenerated with everything else.
MAX_NAMED_SIMULATIONS = 6


def claims_page(claims: Rows, altered: Rows, findings: Rows, tables: Iterable[str]) -> str:
    """Return the page of claims and findings, given as in their JSON files.

    ``tables`` are the paths of all tables relative to the page, which links to them.
    """
    ledger, texts = Ledger(claims), [finding["text"] for finding in findings]
    groups: dict[str, list[Entry]] = {}
    for claim in sorted(ledger, key=lambda claim: WORST_FIRST.index(claim.verdict)):
        texts += [claim.statement, claim.why, claim.evidence_text()]
        groups.setdefault(claim.verdict, []).append(claim)
    return page(
        "claims.html",
        html=markup_of(texts),
        summary=ledger.summary(),
        following=len(ledger.claims) - ledger.count(),
        groups=groups,
        findings=findings,
        altered=altered,
        rules_altered=any(change["key"].startswith("claims.") for change in altered),
        signs=SIGNS,
        tables_behind=partial(tables_behind, tables=sorted(tables)),
        command=command,
        bar=bar,
        figure_title=figure_title,
    )


def tables_behind(source: str, tables: Sequence[str]) -> dict[str, dict[str, str]]:
    """Return the files of the simulations and studies in a source, by name and by kind of table."""
    files: dict[str, dict[str, str]] = {}
    for path in map(Path, tables):
        folder = path.parts[0]
        files.setdefault(path.stem, {})[TABLE_NAMES.get(folder, folder)] = path.as_posix()
    if source.startswith("every simulation"):
        return files
    names = dict.fromkeys(re.findall(r"\w+", source))
    return {name: files[name] for name in names if name in files}


def command(files: Mapping[str, Mapping[str, str]]) -> str:
    """Return the command that regenerates tables."""
    if len(files) > MAX_NAMED_SIMULATIONS:
        return "make replicate"
    paths = chain.from_iterable(kinds.values() for kinds in files.values())
    targets = " ".join(f"results/{path}" for path in paths)
    return f'make replicate TARGET="{targets}"' if targets else "make test"


def bar(claim: Entry) -> tuple[str, float] | None:
    """Return deviation divided by tolerance in words, and the length of its bar in per cent.

    None for a kind of claim that has no bar.
    """
    if claim.kind not in ("exact", "approximate") or claim.deviation is None or not claim.tolerance:
        return None
    ratio = claim.deviation / claim.tolerance
    return f"{rounded(ratio, 2)} × tolerance", round(100.0 * min(ratio, FULL_BAR) / FULL_BAR, 1)


def figure_title(name: str) -> str:
    """Return the text of a link to a figure, as in "figure 5, scaling"."""
    kind, _, words = name.replace("_", " ").partition(" ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}"
