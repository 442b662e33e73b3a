"""The entries of claims.json as texts ask for them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import Any

from ..data.numerals import number, percent, rounded, setting, with_uncertainty
from .rules import VERDICTS, WORST_FIRST

# What a reader looks for first.
FAILURES_FIRST = WORST_FIRST
# A tolerance below this is for rounding alone.
SLIGHT = 1e-6
# Whether a tolerance that is this much larger or smaller would change a verdict is said with the claim.
BAND = 1.5


class Numbers(SimpleNamespace):
    """Numbers by name; None for every name of a finding that this run has no runs for."""

    def __init__(self, numbers: Mapping[str, float | None]) -> None:
        super().__init__(**numbers)

    def __getattr__(self, name: str) -> None:
        if self.__dict__:
            raise AttributeError(name)


class Ledger:
    """Claims by id, each with its fields as attributes, and findings.

    Parameters
    ----------
    claims : the ledger, as in claims.json
    findings : numbers of ours, as in findings.json
    """

    def __init__(self, claims: Iterable[Mapping], findings: Iterable[Mapping] = ()) -> None:
        self.claims = {claim["id"]: SimpleNamespace(**claim) for claim in claims}
        self.findings = {finding["id"]: finding for finding in findings}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> SimpleNamespace:
        """One claim; of an unknown name a ValueError says which there are, here and in `found`."""
        return _known("claim", id, self.claims)

    def found(self, id: str) -> Numbers:
        """The numbers of one finding."""
        return Numbers(_known("finding", id, self.findings)["numbers"])

    def measured(self, id: str) -> str:
        """Measured value, as `measured_text`."""
        return measured_text(self(id))

    def deviation(self, id: str) -> float:
        """What stands beside the tolerance; NaN where nothing was measured."""
        deviation = self(id).deviation
        return float("nan") if deviation is None else deviation

    def deviation_at(self, id: str, **chosen: float | str) -> float:
        """The deviation of a claim at a combination of choices; NaN where it was not judged at it."""
        rows = [row["deviation"] for row in getattr(self(id), "choices", []) if chosen.items() <= row.items()]
        return rows[0] if rows else float("nan")

    def verdict(self, id: str) -> str:
        """The verdict, emphasised."""
        return f"*{self(id).verdict}*"

    def listed(self, id: str, words: str) -> str:
        """The further numbers of a claim whose name has these words before its colon, each with what is behind it."""
        found = [(name.partition(": "), value) for name, value in self(id).further.items()]
        return "; ".join(f"{number(value)} {name}" for (before, _, name), value in found if words in before)

    def count(self, *verdicts: str) -> int:
        """How many counted claims have one of these verdicts; all of them if none is named."""
        return sum(claim.counted and (not verdicts or claim.verdict in verdicts) for claim in self)

    def following(self) -> int:
        """How many claims follow from others."""
        return sum(not claim.counted for claim in self)

    def summary(self) -> str:
        """How many claims there are of each verdict, in words."""
        counts = {name: self.count(name) for name in VERDICTS}
        several = {name: name.replace("depends", "depend") if counts[name] > 1 else name for name in VERDICTS}
        listed = ", ".join(f"{counts[name]} {several[name]}" for name in VERDICTS if counts[name])
        rest = f" {self.following()} more follow from these." if self.following() else ""
        return f"{self.count()} claims: {listed}.{rest}"


def _known(what: str, id: str, entries: Mapping[str, Any]) -> Any:
    if id not in entries:
        raise ValueError(f"{what}: {id!r}; allowed: {', '.join(entries)}")
    return entries[id]


# By kind, what the paper has and what was measured; others have numbers.
PREDICTED = {"qualitative": "all of {:.0f}", "reading": "{:.0f} degrees of freedom"}


def predicted_text(claim: SimpleNamespace) -> str:
    """What the paper has, as its kind says it."""
    if claim.predicted is None:
        return number(None)
    text = PREDICTED.get(claim.kind, number(claim.predicted, 5)).format(claim.predicted)
    return text.replace("degrees", "degree") if claim.predicted == 1 else text


def measured_text(claim: SimpleNamespace) -> str:
    """What was measured, with its uncertainty; of a qualitative claim whole numbers of runs."""
    if claim.kind == "qualitative":
        counts = {"against": claim.failed, "undecided": claim.undecided}
        rest = [f"{count} {name}" for name, count in counts.items() if count]
        return ", ".join([f"{claim.held} of {claim.held + claim.failed + claim.undecided}", *rest])
    if claim.kind == "reading":
        return f"\N{GREEK SMALL LETTER CHI}² = {number(claim.measured, 3)}"
    if claim.kind == "arithmetic":
        return number(claim.measured, 4)
    return with_uncertainty(claim.measured, claim.uncertainty)


def compared_text(claim: SimpleNamespace) -> str:
    """What stands beside the tolerance, and the tolerance, in words."""
    if claim.deviation is None:
        return number(None)
    if claim.kind == "qualitative":
        equal = f" (equal within {setting(100.0 * claim.tolerance)} %)" if claim.tolerance > SLIGHT else ""
        return f"no run may contradict{equal}"
    if claim.kind == "reading":
        return f"p = {number(claim.deviation, 2)}, at least {setting(claim.tolerance)}"
    if claim.kind == "arithmetic" or claim.predicted == 0.0:
        return f"{number(claim.deviation, 2)}, tolerance {setting(claim.tolerance)}"
    middle = "median " if claim.kind == "approximate" else ""
    text = f"{middle}{percent(claim.deviation)}, tolerance {setting(100.0 * claim.tolerance)} %"
    if claim.kind == "exact" or claim.exponent is None:
        return text
    exponent = with_uncertainty(claim.exponent, claim.exponent_uncertainty)
    return f"{text}; exponent {exponent}, tolerance {setting(claim.tolerance_exponent)}"


def why_text(claim: SimpleNamespace) -> str:
    """One sentence on why a claim is not simply reproduced; empty if it is."""
    if claim.verdict == "reproduced" or claim.why:
        return claim.why
    if claim.verdict == "not testable":
        return "This run leaves no number to judge by."
    if claim.kind == "qualitative":
        held, _, rest = measured_text(claim).partition(", ")
        if rest:
            return f"It holds in {held} cases, with {rest}."
        condition = getattr(claim, "note", "").partition("condition: ")[2]
        return f"It needs a condition that the paper does not state{condition and ': '}{condition}."
    if claim.kind == "arithmetic":
        return f"The printed formula gives {measured_text(claim)} of the derived value."
    if claim.kind == "reading":
        return f"At the best fit {compared_text(claim)} is asked."
    write, scale = (percent, abs(claim.predicted)) if claim.predicted else (number, 1.0)
    blur = write(claim.uncertainty / (1.0 if claim.kind == "approximate" else scale))
    return f"It is off by {compared_text(claim)}; its uncertainty is {blur}."


def evidence_text(claim: SimpleNamespace) -> str:
    """What the verdict rests on besides the numbers shown, as Markdown."""
    counted, estimate = claim.kind in ("exact", "approximate"), claim.kind == "approximate"
    parts = [claim.note]
    if counted and claim.runs:
        parts.append(f"{claim.runs} runs")
    if estimate and claim.largest is not None:
        parts.append(
            f"90 % of them within {percent(claim.ninety)}, the largest deviation {percent(claim.largest)}"
        )
    if counted and claim.left_out:
        parts.append(f"left out, without numbers: {claim.left_out}")
    parts += [f"{name}: {rounded(value)}" for name, value in claim.further.items()]
    if estimate and claim.exact_largest is not None:
        median, largest = percent(claim.exact_median), percent(claim.exact_largest)
        parts.append(f"runs off the exact theory by {median} (median) to {largest}")
    for flip in getattr(claim, "flips_at", []):
        larger = flip["tolerance"] > claim.tolerance
        if 1.0 / BAND <= flip["tolerance"] / claim.tolerance <= BAND:
            other = flip["above" if larger else "below"]
            parts.append(
                f"with a tolerance {'above' if larger else 'below'} {number(flip['tolerance'], 3)}: {other}"
            )
    if claim.follows_from:
        names = ", ".join(f"`{id}`" for id in claim.follows_from)
        parts.append(f"follows from {names} and is not counted again")
    return "; ".join(filter(None, parts))
