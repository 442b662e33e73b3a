"""results/claims.html: the ledger, failures first, each deviation next to its tolerance."""

import re
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import chain
from pathlib import Path

from ..claims.ledger import Entry, Ledger
from ..claims.rules import VERDICTS, WORST_FIRST
from ..text.numerals import rounded
from .html import markup_of, page

# Each verdict has a sign, so that colour is not needed.
MARKS = "\N{CHECK MARK}~\N{UP DOWN ARROW}\N{NOT EQUAL TO}\N{MULTIPLICATION SIGN}→?\N{EN DASH}"
SIGNS = dict(zip(VERDICTS, MARKS, strict=True))
# The bar of a deviation ends at this many tolerances.
LONGEST = 2.0
# Folders of tables whose kind has another name.
KINDS = {"measurements": "measured", "predictions": "predicted", "studies": "study"}
Rows = Sequence[Mapping]
# A claim on more simulations than these has the command that makes everything.
FEW = 6


def claims_page(claims: Rows, altered: Rows, findings: Rows, tables: Iterable[str]) -> str:
    """The page of claims and findings (as in their JSON), with links to tables next to the page."""
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
    """Files of the simulations and studies that a source names, by name and kind of table."""
    files: dict[str, dict[str, str]] = {}
    for path in map(Path, tables):
        folder = path.parts[0]
        files.setdefault(path.stem, {})[KINDS.get(folder, folder)] = path.as_posix()
    if source.startswith("every simulation"):
        return files
    names = dict.fromkeys(re.findall(r"\w+", source))
    return {name: files[name] for name in names if name in files}


def command(files: Mapping[str, Mapping[str, str]]) -> str:
    """The command that makes tables anew."""
    if len(files) > FEW:
        return "make replicate"
    paths = chain.from_iterable(kinds.values() for kinds in files.values())
    targets = " ".join(f"results/{path}" for path in paths)
    return f'make replicate TARGET="{targets}"' if targets else "make test"


def bar(claim: Entry) -> tuple[str, float] | None:
    """Deviation over tolerance in words and as a bar in percent; None where a kind has no bar."""
    if claim.kind not in ("exact", "approximate") or claim.deviation is None or not claim.tolerance:
        return None
    ratio = claim.deviation / claim.tolerance
    return f"{rounded(ratio, 2)} × tolerance", round(100.0 * min(ratio, LONGEST) / LONGEST, 1)


def figure_title(name: str) -> str:
    """Text of a link to a figure: figure 5, scaling."""
    kind, _, words = name.replace("_", " ").partition(" ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}"
