"""The entries of claims.json as texts ask for them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from types import SimpleNamespace

from ..texts.numerals import percent, rounded, with_uncertainty
from .ledger import VERDICTS

# What a reader looks for first.
FAILURES_FIRST = ("not reproduced", "reproduced with caveat", "not testable", "reproduced")


class Ledger:
    """Claims by id, each with its fields as attributes.

    Parameters
    ----------
    claims : the ledger, as in claims.json
    """

    def __init__(self, claims: Iterable[Mapping]) -> None:
        self.claims = {claim["id"]: SimpleNamespace(**claim) for claim in claims}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> SimpleNamespace:
        """One claim.

        Raises
        ------
        ValueError
            Naming the id and those that there are.
        """
        if id not in self.claims:
            raise ValueError(f"claim: {id!r}; allowed: {', '.join(self.claims)}")
        return self.claims[id]

    def measured(self, id: str) -> str:
        """Measured value with its uncertainty."""
        return measured_text(self(id))

    def deviation(self, id: str) -> float:
        """Deviation from the prediction, as `deviation_of`."""
        return deviation_of(self(id))

    def verdict(self, id: str) -> str:
        """The verdict, emphasised."""
        return f"*{self(id).verdict}*"

    def count(self, *verdicts: str) -> int:
        """How many claims have one of these verdicts; all of them if none is named."""
        return sum(not verdicts or claim.verdict in verdicts for claim in self)

    def summary(self) -> str:
        """How many claims there are of each verdict, in words."""
        counts = Counter(claim.verdict for claim in self)
        listed = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
        return f"{self.count()} claims: {listed}."


def deviation_of(claim: SimpleNamespace) -> float:
    """|measured - predicted|, relative to |predicted| where that is not 0; NaN where one is missing."""
    if claim.measured is None or claim.predicted is None:
        return float("nan")
    return abs(claim.measured - claim.predicted) / (abs(claim.predicted) or 1.0)


def measured_text(claim: SimpleNamespace) -> str:
    """Measured value with its uncertainty."""
    return with_uncertainty(claim.measured, claim.uncertainty)


def evidence_text(claim: SimpleNamespace) -> str:
    """What the verdict rests on besides the numbers shown, as Markdown."""
    parts = []
    if claim.runs is not None:
        parts.append(f"{claim.runs} runs")
    if claim.largest is not None:
        parts.append(f"deviation: median {percent(claim.median)}, largest {percent(claim.largest)} (shown)")
    if claim.left_out:
        parts.append(f"{claim.left_out} runs without a grid study left out")
    parts += [f"{name}: {rounded(value)}" for name, value in claim.further.items()]
    if claim.note:
        parts.append(claim.note)
    if claim.exact_largest is not None:
        parts.append(
            f"from the exact theory: median {percent(claim.exact_median)}, largest {percent(claim.exact_largest)}"
        )
    return "; ".join(parts)
