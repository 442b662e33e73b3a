"""Tables of the ledger, as Markdown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from ..claims.ledger import VERDICTS
from ..claims.reading import Ledger, evidence_text, measured_text
from ..texts.numerals import number, setting, with_uncertainty
from .markdown import plain, table


class LedgerTables(Ledger):
    """The ledger with its tables.

    Parameters
    ----------
    claims : the ledger, as in claims.json
    reasons : per claim, tolerance and the reason for it
    """

    def __init__(self, claims: list[dict], reasons: Mapping[str, Mapping]) -> None:
        super().__init__(claims)
        self.reasons = reasons

    def counts(self) -> str:
        """How many claims have each verdict, from the paper's text and from its published figure."""
        kinds = {
            "what the text and figures say": [claim for claim in self if not _published(claim)],
            "numbers read off the published figure": [claim for claim in self if _published(claim)],
        }
        rows = []
        for name, claims in kinds.items():
            found = Counter(claim.verdict for claim in claims)
            rows.append([name, *(str(found[verdict]) for verdict in VERDICTS), str(len(claims))])
        return table(["", *VERDICTS, "all"], rows, [24, 11, 14, 11, 10, 6], "lrrrrr")

    def rows(self, ids: list[str]) -> str:
        """A short table of some claims."""
        rows = [
            [claim.statement, number(claim.predicted, 4), measured_text(claim), claim.verdict]
            for claim in map(self, ids)
        ]
        return table(["claim", "predicted", "measured", "verdict"], rows, [50, 12, 21, 17], "lrrl")

    def whole(self) -> str:
        """Every claim with its place, numbers, tolerance, verdict and note."""
        rows = [
            [
                f"{claim.statement} ({claim.figure_or_section}) `{claim.id}`",
                number(claim.predicted, 4),
                measured_text(claim),
                setting(claim.tolerance),
                claim.verdict,
                evidence_text(claim),
            ]
            for claim in self
        ]
        head = ["claim (place) `id`", "predicted", "measured", "tolerance", "verdict", "note"]
        return table(head, rows, [33, 9, 14, 8, 10, 30], "lrrrll")

    def tolerances(self) -> str:
        """Why each tolerance is what it is: the claims that share a tolerance and a reason together."""
        groups: dict[tuple, list[str]] = {}
        for claim in self:
            entry = self.reasons.get(claim.id)
            if entry is not None:
                groups.setdefault((float(entry["tolerance"]), entry["reason"]), []).append(f"`{claim.id}`")
        rows = [
            [setting(tolerance), plain(reason), ", ".join(ids)] for (tolerance, reason), ids in groups.items()
        ]
        return table(["tolerance", "reason", "claims"], rows, [10, 32, 58], "rll")

    def published(self, readings: Mapping[str, Mapping]) -> str:
        """Numbers read off the published figure beside ours, with the reading error."""
        rows = []
        for name, reading in readings.items():
            claim = self(f"published_{name}")
            published = with_uncertainty(reading["value"], reading["reading_error"])
            rows.append([claim.statement, published, measured_text(claim), claim.verdict])
        return table(["quantity", "published", "this run", "verdict"], rows, [40, 18, 22, 20], "lrrl")


def _published(claim) -> bool:
    return claim.id.startswith("published_")
