"""results/claims.html: the ledger by kind and failures first, each deviation next to its tolerance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from types import SimpleNamespace

from ..claims import reading
from ..claims.reading import FAILURES_FIRST, Ledger
from ..claims.rules import VERDICTS
from ..data.numerals import rounded
from .html import markup_of, page

# Each verdict has a sign, so that colour is not needed.
SIGNS = dict(
    zip(VERDICTS, "\N{CHECK MARK}~\N{UP DOWN ARROW}\N{MULTIPLICATION SIGN}?\N{EN DASH}", strict=True)
)
# The bar of a deviation ends at this many tolerances.
LONGEST = 2.0


def claims_page(
    claims: Iterable[Mapping], altered: Sequence[Mapping] = (), findings: Sequence[Mapping] = ()
) -> str:
    """The ledger and the findings, as in their JSON, with what differs from the shipped configuration."""
    return page(
        "claims.html",
        findings=findings,
        altered=altered,
        rules_altered=any(change["key"].startswith("claims.") for change in altered),
        **shown(Ledger(claims), [finding["text"] for finding in findings]),
    )


def shown(ledger: Ledger, texts: Iterable[str]) -> dict[str, object]:
    """What templates that show claims ask for; `html` has the HTML of each of their texts, and of others."""
    asked = [(claim.statement, claim.why, reading.evidence_text(claim)) for claim in ledger]
    by_verdict = {name: [claim for claim in ledger if claim.verdict == name] for name in FAILURES_FIRST}
    return {
        "html": markup_of([*texts, *chain.from_iterable(asked)]),
        "summary": ledger.summary(),
        "kinds": ledger.by_kind(),
        "groups": {verdict: claims for verdict, claims in by_verdict.items() if claims},
        "verdicts": FAILURES_FIRST,
        "signs": SIGNS,
        "reading": reading,
        "bar": bar,
        "figure_title": figure_title,
    }


def bar(claim: SimpleNamespace) -> tuple[str, float] | None:
    """Deviation over tolerance in words, and the length of its bar in percent; None where the kind has no such bar."""
    if claim.kind not in ("exact", "approximate") or claim.deviation is None or not claim.tolerance:
        return None
    ratio = claim.deviation / claim.tolerance
    return f"{rounded(ratio, 2)} × tolerance", round(100.0 * min(ratio, LONGEST) / LONGEST, 1)


def figure_title(name: str) -> str:
    """What a link to a figure says: figure 5, scaling."""
    kind, _, words = name.partition("_")
    words = words.replace("_", " ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}"
