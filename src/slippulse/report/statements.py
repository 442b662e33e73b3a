"""The sentences of the paper and the claims that test them, as Markdown."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from ..claims.coverage import claims_of, coverage
from .markdown import table

# What a reason reads like in a table of how many sentences have it.
REASONS = {
    "tested": "tested by a claim",
    "repeats": "repeats another sentence",
    "background": "background, or says no more than that something is shown",
    "definition": "definition or assumption",
    "other work": "is about other work",
    "no model": "no model here can tell",
}


class Statements:
    """The sentences of the paper that assert something.

    Parameters
    ----------
    entries : as in manuscript/statements.yaml, in the order of the paper
    """

    def __init__(self, entries: Sequence[Mapping]) -> None:
        self.entries = entries
        self.counts = coverage(entries)

    def counted(self) -> str:
        """How many sentences are tested, and how many are not for each reason."""
        rows = [[words, str(self.counts[key])] for key, words in REASONS.items()]
        return table(["sentences", "how many"], [*rows, ["all", str(self.counts["all"])]], [60, 15], "lr")

    def whole(self) -> str:
        """Every sentence that is tested, with its place and its claims."""
        rows = [
            [
                _short(entry["place"]),
                entry["paraphrase"],
                ", ".join(f"`{claim}`" for claim in claims_of(entry)),
            ]
            for entry in self.entries
            if claims_of(entry)
        ]
        return table(["place", "what it says", "claims"], rows, [22, 45, 33], "lll")


def _short(place: str) -> str:
    """A place that fits a narrow column: paragraph and sentence as numbers."""
    return re.sub(r", paragraph (\d+), sentence (\d+)", r", ¶ \1, \2", place)
