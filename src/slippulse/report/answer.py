"""The answer to the paper's question: manuscript/summary.yaml, judged by the ledger."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import SimpleNamespace
from typing import NamedTuple

from ..claims.reading import Ledger
from ..claims.rules import WORST_FIRST

# What the answer says of one thing with each verdict, and of several.
EXCEPTIONS = {
    "not reproduced": ("is not reproduced", "are not reproduced"),
    "depends on an open choice": (
        "depends on a choice that the paper leaves open",
        "depend on choices that the paper leaves open",
    ),
    "inconclusive": ("stays open", "stay open"),
    "not testable": ("is not tested in this run", "are not tested in this run"),
}


class Line(NamedTuple):
    """One thing that the paper says.

    Attributes
    ----------
    topic, text : what it is and what was found, Markdown
    named : the same in a sentence: of the first line a clause, of the others a noun in the singular
    claim : the claim that has the worst verdict of those that it rests on
    """

    topic: str
    named: str
    text: str
    claim: SimpleNamespace


def judged_lines(summary: Mapping, ledger: Ledger, fill: Callable[[str], str]) -> list[Line]:
    """The lines of the summary in their order, their expressions evaluated by ``fill``."""

    def worst(claims: Iterable[str]) -> SimpleNamespace:
        return min(map(ledger, claims), key=lambda claim: WORST_FIRST.index(claim.verdict))

    return [
        Line(line["topic"], line["named"], fill(line["text"]), worst(line["claims"]))
        for line in summary["verdict"]
    ]


def answer(lines: Sequence[Line]) -> str:
    """One sentence: whether what the first line says is reproduced, and which of the others are not, as Markdown."""
    first, *rest = lines
    parts = []
    for verdict, (one, several) in EXCEPTIONS.items():
        if named := [line.named for line in rest if line.claim.verdict == verdict]:
            *others, last = named
            listed = f"{', '.join(others)} and {last}" if others else last
            parts.append(f"{listed} {several if others else one}")
    start = "Yes" if first.claim.verdict.startswith("reproduced") else "Not in this run"
    return f"**{start}**, {first.named}{', except that ' if parts else ''}{', and '.join(parts)}."
