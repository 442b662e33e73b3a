"""results/claims.html: the ledger by kind and failures first, each deviation beside its tolerance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

from markupsafe import Markup

from ..claims.reading import (
    FAILURES_FIRST,
    Ledger,
    compared_text,
    evidence_text,
    measured_text,
    predicted_text,
)
from ..claims.rules import VERDICTS
from ..data.numerals import rounded
from .html import markup_of, page

# Each verdict has a sign, so that colour is not needed.
SIGNS = dict(zip(VERDICTS, "\N{CHECK MARK}~\N{MULTIPLICATION SIGN}?\N{EN DASH}", strict=True))
# The bar of a deviation ends at so many tolerances.
LONGEST = 2.0


@dataclass(frozen=True)
class Row:
    """One claim as it is shown.

    Attributes
    ----------
    id, kind, place, verdict, source : of the claim
    statement, why, remark : HTML; why it is not simply reproduced, and what the verdict rests on
    predicted, measured, compared : written numbers; deviation beside tolerance
    share : deviation over tolerance in words
    length : of its bar, percent of the whole; None where it has no bar
    figure, title : name of the figure that shows it, and what the link to it says; empty without one
    """

    id: str
    kind: str
    place: str
    verdict: str
    source: str
    statement: Markup
    why: Markup
    remark: Markup
    predicted: str
    measured: str
    compared: str
    share: str
    length: float | None
    figure: str
    title: str


@dataclass(frozen=True)
class Group:
    """The claims of one verdict: what it is, its sign, an anchor, the rows."""

    verdict: str
    sign: str
    anchor: str
    rows: list[Row]


def claims_page(
    claims: Iterable[Mapping], altered: Sequence[Mapping] = (), findings: Iterable[Mapping] = ()
) -> str:
    """The ledger as a page of its own.

    Parameters
    ----------
    claims : as in claims.json
    altered : what differs from the shipped configuration (`slippulse.data.alterations.changes`)
    findings : as in findings.json
    """
    ledger = Ledger(claims, findings)
    texts = {id: finding["text"] for id, finding in ledger.findings.items()}
    html = markup_of(texts.values())
    rules = any(change["key"].startswith("claims.") for change in altered)
    return page(
        "claims.html",
        summary=ledger.summary(),
        kinds=ledger.by_kind(),
        verdicts=FAILURES_FIRST,
        findings={id: html[text] for id, text in texts.items()},
        groups=claim_groups(ledger),
        altered=altered,
        rules_altered=rules,
    )


def claim_groups(ledger: Ledger) -> list[Group]:
    """The claims by verdict, failures first."""
    html = markup_of(text for claim in ledger for text in (claim.statement, claim.why, evidence_text(claim)))
    return [
        Group(
            verdict,
            SIGNS[verdict],
            verdict.replace(" ", "-"),
            [_row(claim, html) for claim in ledger if claim.verdict == verdict],
        )
        for verdict in FAILURES_FIRST
        if any(claim.verdict == verdict for claim in ledger)
    ]


def _row(claim: SimpleNamespace, html: Mapping[str, Markup]) -> Row:
    ratio = _ratio(claim)
    return Row(
        id=claim.id,
        kind=claim.kind,
        place=claim.figure_or_section,
        verdict=claim.verdict,
        source=claim.source,
        statement=html[claim.statement],
        why=html[claim.why],
        remark=html[evidence_text(claim)],
        predicted=predicted_text(claim),
        measured=measured_text(claim),
        compared=compared_text(claim),
        share="" if ratio is None else f"{rounded(ratio, 2)} × tolerance",
        length=None if ratio is None else round(100.0 * min(ratio, LONGEST) / LONGEST, 1),
        figure=claim.figure,
        title=_figure_title(claim.figure),
    )


def _ratio(claim: SimpleNamespace) -> float | None:
    """Deviation over tolerance; None where the kind of claim has no such bar."""
    if claim.kind not in ("exact", "approximate") or claim.deviation is None or not claim.tolerance:
        return None
    return claim.deviation / claim.tolerance


def _figure_title(name: str) -> str:
    """What a link to a figure says: figure 5, scaling."""
    kind, _, words = name.partition("_")
    words = words.replace("_", " ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}" if kind else ""
