"""Entries of the ledger as the text asks for them, and the tables made of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from types import SimpleNamespace

from ..claims.ledger import VERDICTS
from .markdown import table
from .notation import tex
from .numerals import number, setting, with_uncertainty


class Ledger:
    """Claims by id.

    Parameters
    ----------
    claims : the ledger, as in claims.json
    reasons : per claim, tolerance and the reason for it
    """

    def __init__(self, claims: list[dict], reasons: Mapping[str, Mapping]) -> None:
        self.claims = {claim["id"]: SimpleNamespace(**claim) for claim in claims}
        self.reasons = reasons

    def __call__(self, id: str) -> SimpleNamespace:
        """One claim: its fields as attributes.

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
        claim = self(id)
        return with_uncertainty(claim.measured, claim.uncertainty)

    def deviation(self, id: str) -> float:
        """|measured - predicted|, relative to |predicted| where that is not 0."""
        claim = self(id)
        if claim.measured is None or claim.predicted is None:
            return float("nan")
        return abs(claim.measured - claim.predicted) / (abs(claim.predicted) or 1.0)

    def verdict(self, id: str) -> str:
        """The verdict, emphasised."""
        return f"*{self(id).verdict}*"

    def remark(self, id: str, word: str, start: str = "") -> str:
        """The part of a claim's note that begins with a word, from another word on if one is given.

        Raises
        ------
        ValueError
            If no part of the note begins so.
        """
        for part in self(id).note.split("; "):
            if part.startswith(word) and start in part:
                return tex(part[part.index(start) :])
        raise ValueError(f"note of {id!r}: no part begins with {word!r}; it reads: {self(id).note}")

    def count(self, *verdicts: str) -> int:
        """How many claims have one of these verdicts; all of them if none is named."""
        return sum(not verdicts or claim.verdict in verdicts for claim in self.claims.values())

    def summary(self) -> str:
        """How many claims have each verdict, from the paper's text and from its published figure."""
        kinds = {
            "what the text and figures say": [c for i, c in self.claims.items() if not _published(i)],
            "numbers read off the published figure": [c for i, c in self.claims.items() if _published(i)],
        }
        rows = []
        for name, claims in kinds.items():
            counts = Counter(claim.verdict for claim in claims)
            rows.append([name, *(str(counts[verdict]) for verdict in VERDICTS), str(len(claims))])
        return table(["", *VERDICTS, "all"], rows, [24, 11, 14, 11, 10, 6], "lrrrrr")

    def rows(self, ids: list[str]) -> str:
        """A short table of some claims."""
        rows = [
            [tex(claim.statement), *self._numbers(claim.id), claim.verdict]
            for claim in map(self.__call__, ids)
        ]
        return table(["claim", "predicted", "measured", "verdict"], rows, [50, 12, 21, 17], "lrrl")

    def whole(self) -> str:
        """Every claim with its place, numbers, tolerance, verdict and note."""
        rows = []
        for claim in self.claims.values():
            text = f"{tex(claim.statement)} ({claim.figure_or_section}) `{claim.id}`"
            predicted, measured = self._numbers(claim.id)
            rows.append([text, predicted, measured, setting(claim.tolerance), claim.verdict, tex(claim.note)])
        head = ["claim (place) `id`", "predicted", "measured", "tolerance", "verdict", "note"]
        return table(head, rows, [33, 9, 14, 8, 10, 30], "lrrrll")

    def tolerances(self) -> str:
        """Why each tolerance is what it is: the claims that share a tolerance and a reason together."""
        groups: dict[tuple, list[str]] = {}
        for id in self.claims:
            entry = self.reasons.get(id)
            if entry is not None:
                groups.setdefault((float(entry["tolerance"]), entry["reason"]), []).append(f"`{id}`")
        rows = [
            [setting(tolerance), tex(reason), ", ".join(ids)] for (tolerance, reason), ids in groups.items()
        ]
        return table(["tolerance", "reason", "claims"], rows, [10, 32, 58], "rll")

    def published(self, readings: Mapping[str, Mapping]) -> str:
        """Numbers read off the published figure beside ours, with the reading error."""
        rows = []
        for name, reading in readings.items():
            claim = self(f"published_{name}")
            rows.append(
                [
                    tex(reading["statement"]),
                    f"{reading['value']:g} ± {reading['reading_error']:g}",
                    self.measured(claim.id),
                    claim.verdict,
                ]
            )
        return table(["quantity", "published", "this run", "verdict"], rows, [40, 18, 22, 20], "lrrl")

    def _numbers(self, id: str) -> tuple[str, str]:
        return number(self(id).predicted, 4), self.measured(id)


def _published(id: str) -> bool:
    return id.startswith("published_")
