"""Tables of the ledger, as Markdown."""

from __future__ import annotations

from collections.abc import Mapping

from ..claims.reading import (
    FAILURES_FIRST,
    Ledger,
    compared_text,
    evidence_text,
    measured_text,
    predicted_text,
)
from ..data.numerals import setting, with_uncertainty
from .markdown import plain, table


class LedgerTables(Ledger):
    """The ledger with its tables.

    Parameters
    ----------
    claims : the ledger, as in claims.json
    reasons : per claim, kind, tolerance and the reason for it
    findings : as in findings.json
    """

    def __init__(self, claims: list[dict], reasons: Mapping[str, Mapping], findings: list[dict]) -> None:
        super().__init__(claims, findings)
        self.reasons = reasons

    def counts(self) -> str:
        """How many claims of each kind have each verdict; behind a plus those that follow from others."""
        rows = [[kind, *counts] for kind, counts in self.by_kind()]
        rows.append(["counted", *(str(self.count(verdict)) for verdict in FAILURES_FIRST)])
        return table(["kind", *FAILURES_FIRST], rows, [14, 14, 13, 11, 14, 12], "lrrrrr")

    def failures(self) -> str:
        """Every claim that is not simply reproduced, worst first, each with one sentence of why."""
        rows = [
            [f"{claim.statement} `{claim.id}`", claim.verdict, claim.why]
            for verdict in FAILURES_FIRST[:-1]
            for claim in self
            if claim.verdict == verdict
        ]
        return table(["claim", "verdict", "why"], rows, [46, 14, 40], "lll")

    def judged(self, id: str) -> str:
        """In how many runs a qualitative claim holds, and its verdict, for a pair of brackets."""
        return f"{self.measured(id)}, {self.verdict(id)}"

    def whole(self) -> str:
        """Every claim with its place, numbers, tolerance, verdict and note."""
        rows = [
            [
                f"{claim.statement} ({claim.figure_or_section}) `{claim.id}`",
                predicted_text(claim),
                measured_text(claim),
                compared_text(claim),
                claim.verdict,
                evidence_text(claim),
            ]
            for claim in self
        ]
        head = ["claim (place) `id`", "predicted", "measured", "deviation, tolerance", "verdict", "rests on"]
        return table(head, rows, [32, 8, 12, 14, 9, 29], "lrrlll")

    def tolerances(self) -> str:
        """Why each tolerance is what it is: the claims that share kind, tolerance and reason together."""
        groups: dict[tuple, list[str]] = {}
        for claim in self:
            entry = self.reasons.get(claim.id)
            if entry is not None:
                key = (
                    entry["kind"],
                    float(entry["tolerance"]),
                    entry.get("tolerance_exponent"),
                    entry["reason"],
                )
                groups.setdefault(key, []).append(f"`{claim.id}`")
        rows = [
            [
                kind,
                setting(tolerance) + (f"; exponent {setting(exponent)}" if exponent else ""),
                plain(reason),
                ", ".join(ids),
            ]
            for (kind, tolerance, exponent, reason), ids in groups.items()
        ]
        return table(["kind", "tolerance", "reason", "claims"], rows, [11, 11, 42, 36], "lrll")

    def published(self, readings: Mapping[str, Mapping]) -> str:
        """Numbers read off the published figure beside ours, with the reading error."""
        ours = self("published_space_time_figure").further
        rows = [
            [
                reading["statement"],
                with_uncertainty(reading["value"], reading["reading_error"]),
                with_uncertainty(ours.get(reading["statement"]), None),
            ]
            for reading in readings.values()
        ]
        return table(["quantity", "published", "this run"], rows, [50, 20, 20], "lrr")

    def found_beside(self) -> str:
        """Every finding, as a list."""
        return "\n".join(f"- {' '.join(finding['text'].split())}" for finding in self.findings.values())
