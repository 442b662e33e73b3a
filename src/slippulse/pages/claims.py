"""results/claims.html: the ledger, failures first, each deviation beside its tolerance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

from markupsafe import Markup

from ..claims.ledger import VERDICTS
from ..claims.reading import FAILURES_FIRST, Ledger, deviation_of, evidence_text, measured_text
from ..texts.numerals import number, percent, rounded, setting
from .render import markup_of, page

# Each verdict has a sign, so that colour is not needed.
SIGNS = dict(zip(VERDICTS, "\N{CHECK MARK}~\N{MULTIPLICATION SIGN}?", strict=True))
# The bar of a deviation ends at so many tolerances.
LONGEST = 2.0


@dataclass(frozen=True)
class Row:
    """One claim as it is shown.

    Attributes
    ----------
    id, place, verdict, source : of the claim
    statement, remark : HTML
    predicted, measured, deviation, tolerance : written numbers
    share : deviation over tolerance in words
    length : of its bar, percent of the whole
    figure, title : name of the figure that shows it, and what the link to it says; empty without one
    """

    id: str
    place: str
    verdict: str
    source: str
    statement: Markup
    remark: Markup
    predicted: str
    measured: str
    deviation: str
    tolerance: str
    share: str
    length: float
    figure: str
    title: str


@dataclass(frozen=True)
class Group:
    """The claims of one verdict: what it is, its sign, an anchor, the rows."""

    verdict: str
    sign: str
    anchor: str
    rows: list[Row]


def claims_page(claims: Iterable[Mapping], altered: Sequence[Mapping] = ()) -> str:
    """The ledger as a page of its own.

    Parameters
    ----------
    claims : as in claims.json
    altered : what differs from the shipped configuration (`slippulse.data.alterations.changes`)
    """
    ledger = Ledger(claims)
    rules = any(change["key"].startswith("claims.") for change in altered)
    return page(
        "claims.html",
        summary=ledger.summary(),
        groups=claim_groups(ledger),
        altered=altered,
        rules_altered=rules,
    )


def claim_groups(ledger: Ledger) -> list[Group]:
    """The claims by verdict, failures first."""
    html = markup_of(text for claim in ledger for text in (claim.statement, evidence_text(claim)))
    return [
        Group(
            verdict,
            SIGNS[verdict],
            verdict.replace(" ", "-"),
            [_row(claim, html) for claim in ledger if claim.verdict == verdict],
        )
        for verdict in FAILURES_FIRST
        if ledger.count(verdict)
    ]


def _row(claim: SimpleNamespace, html: Mapping[str, Markup]) -> Row:
    deviation = deviation_of(claim)
    relative = claim.predicted != 0.0
    ratio = _ratio(deviation, claim.tolerance)
    return Row(
        id=claim.id,
        place=claim.figure_or_section,
        verdict=claim.verdict,
        source=claim.source,
        statement=html[claim.statement],
        remark=html[evidence_text(claim)],
        predicted=number(claim.predicted, 5),
        measured=measured_text(claim),
        deviation=percent(deviation) if relative else number(deviation, 2),
        tolerance=f"{setting(100.0 * claim.tolerance)} %" if relative else setting(claim.tolerance),
        share=_share(ratio),
        length=0.0 if math.isnan(ratio) else round(100.0 * min(ratio, LONGEST) / LONGEST, 1),
        figure=claim.figure,
        title=_figure_title(claim.figure),
    )


def _ratio(deviation: float, tolerance: float) -> float:
    if deviation == 0.0:
        return 0.0
    return deviation / tolerance if tolerance else math.copysign(math.inf, deviation)


def _share(ratio: float) -> str:
    if math.isnan(ratio):
        return "not measured"
    return "no deviation is tolerated" if math.isinf(ratio) else f"{rounded(ratio, 2)} × tolerance"


def _figure_title(name: str) -> str:
    """What a link to a figure says: figure 5, scaling."""
    kind, _, words = name.partition("_")
    words = words.replace("_", " ")
    return f"figure {int(kind[3:])}, {words}" if kind.startswith("fig") else f"study, {words}" if kind else ""
