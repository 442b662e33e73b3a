"""Turn the claims of claims.json into the texts that pages and reports show.

`Ledger` holds all claims and findings by id. `Entry` and its subclasses format one claim by its
kind: prediction, measured value, deviation with tolerance, and the reason for the verdict.
"""

from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import Any

from ..records.provenance import changes
from ..text.numerals import MISSING, number, percent, rounded, setting, with_uncertainty
from .rules import FAILED, NOT_TESTABLE, VERDICTS, WITHOUT_RESERVATION

# A claim reports the tolerances at which its verdict changes if they are within this factor of its
# own tolerance.
TOLERANCE_BAND = 1.5


class Entry(SimpleNamespace):
    """A claim of claims.json with its fields as attributes; this class formats a number.

    A subclass formats claims of other kinds. A method with a name in _text returns the content of
    one column in the table of claims.
    """

    # Fields that only some kinds have, with the values for all others.
    runs = left_out = 0
    remark = False
    largest: Any = None
    exact_largest: Any = None

    def predicted_text(self) -> str:
        """Return the prediction of the paper."""
        return number(self.predicted, 5)

    def measured_text(self) -> str:
        """Return the measured value with its uncertainty; numbers of runs if qualitative."""
        return with_uncertainty(self.measured, self.uncertainty)

    def compared_text(self) -> str:
        """Return the deviation and the tolerance in words."""
        return MISSING if self.deviation is None else self._compared()

    def why_text(self) -> str:
        """Return why a claim is not simply reproduced; empty if it is."""
        if self.verdict in WITHOUT_RESERVATION or self.why:
            return self.why
        if self.verdict == NOT_TESTABLE:
            return "This run has no number that could be judged."
        return self._off()

    def evidence_text(self) -> str:
        """Return the additional evidence for the verdict, as Markdown."""
        parts = [self.note, *self._spread()]
        parts += [f"{name}: {rounded(value)}" for name, value in self.further.items()]
        if self.exact_largest is not None:
            median, largest = percent(self.exact_median), percent(self.exact_largest)
            parts.append(
                f"runs deviate from exact theory by {median} (median), or {largest} at most"
            )
        parts += [*self._other_tolerances(), *self._not_counted()]
        return "; ".join(part for part in parts if part)

    def _other_tolerances(self) -> list[str]:
        """Return the verdicts at other tolerances that are near, and at the earlier tolerance."""
        parts = []
        for flip in self.flips_at:
            # The verdict changes at this tolerance. The other verdict lies beyond it.
            ratio = flip["tolerance"] / self.tolerance
            side = "above" if ratio > 1.0 else "below"
            if 1.0 / TOLERANCE_BAND <= ratio <= TOLERANCE_BAND:
                limit = number(flip["tolerance"], 3)
                parts.append(f"with a tolerance {side} {limit}: {flip[side]}")
        if self.at_earlier:
            earlier = setting(self.earlier_tolerance)
            parts.append(
                f"at {earlier}, the tolerance set before results were seen: {self.at_earlier}"
            )
        return parts

    def _not_counted(self) -> list[str]:
        """Return the reasons for which the claim is not counted."""
        reasons = []
        if self.follows_from:
            names = ", ".join(f"`{id}`" for id in self.follows_from)
            reasons.append(f"the claim follows from {names} and is not counted again")
        if self.beyond:
            reasons.append("the claim is beyond the paper and is not counted")
        if self.remark:
            reasons.append("the claim is a remark on a drawing and is not counted")
        return reasons

    def _compared(self) -> str:
        """Return the deviation and the tolerance, for a claim that has a deviation."""
        # A scaling deviates in its exponent; an estimate deviates in its median run.
        if self.kind == "scaling" or self.predicted == 0.0:
            return f"{number(self.deviation, 2)}, tolerance {setting(self.tolerance)}"
        text = "median " if self.kind == "approximate" else ""
        text += f"{percent(self.deviation)}, tolerance {setting(100.0 * self.tolerance)} %"
        return f"{text}; {self.asked}" if self.asked else text

    def _off(self) -> str:
        """Return how far the claim is off; the uncertainty is relative, like the deviation."""
        uncertainty = number(self.uncertainty)
        if self.predicted:
            uncertainty = percent(self.uncertainty / abs(self.predicted))
        deviation = "median deviation" if self.kind == "approximate" else "deviation"
        compared = self.compared_text().removeprefix("median ")
        return f"The {deviation} is {compared}; the uncertainty is {uncertainty}."

    def _spread(self) -> list[str]:
        """Return how many runs a number has, their spread, and how many are left out."""
        parts = []
        # The measured value of a qualitative claim is a number of runs already.
        if self.runs and self.kind != "qualitative":
            parts.append(f"{self.runs} runs")
        if self.largest is not None:
            ninety, largest = percent(self.ninety), percent(self.largest)
            parts.append(f"90 % of them deviate by at most {ninety}, and the worst by {largest}")
        if self.left_out:
            parts.append(f"runs left out because they have no number: {self.left_out}")
        return parts


class Counts(Entry):
    """A qualitative claim, shown as numbers of runs."""

    def predicted_text(self) -> str:
        """Return the number of runs, in all of which the statement should hold."""
        return f"all of {self.predicted:.0f}"

    def measured_text(self) -> str:
        """Return the numbers of runs in which it holds, fails or is undecided."""
        total = self.held + self.failed + self.undecided
        parts = [f"{self.held} of {total}"]
        if self.failed:
            parts.append(f"{self.failed} against")
        if self.undecided:
            parts.append(f"{self.undecided} undecided")
        return ", ".join(parts)

    def _compared(self) -> str:
        text = self.asked or "no run may contradict"
        tolerance = setting(100.0 * self.tolerance)
        return f"{text} (tolerance {tolerance} %)" if self.tolerance else text

    def _off(self) -> str:
        """Return in how many runs the claim holds and what the others do."""
        # The text is "HELD of ALL", followed by what did not hold.
        held, _, rest = self.measured_text().partition(", ")
        if rest:
            return f"It holds in {held} cases ({rest})."
        return "It holds only under a condition that the paper does not state."


class ReadOff(Entry):
    """Readings from a figure, shown as a chi-square."""

    def predicted_text(self) -> str:
        """Return the degrees of freedom, which are the expectation of chi-square."""
        degrees = "degree" if self.predicted == 1 else "degrees"
        return f"{self.predicted:.0f} {degrees} of freedom"

    def measured_text(self) -> str:
        return f"\N{GREEK SMALL LETTER CHI}² = {number(self.measured, 3)}"

    def _compared(self) -> str:
        return f"p = {number(self.deviation, 2)}, required at least {setting(self.tolerance)}"

    def _off(self) -> str:
        """Return the p-value of the best fit."""
        return f"The best fit has {self.compared_text()}."


KINDS: dict[str, type[Entry]] = dict.fromkeys(("exact", "approximate", "scaling"), Entry)
KINDS |= {"qualitative": Counts, "reading": ReadOff}


def with_texts(claim: Mapping[str, Any]) -> Entry:
    """Return a claim of claims.json as the class that formats its kind."""
    return KINDS[claim["kind"]](**claim)


class Ledger:
    """All claims of claims.json by id, and all findings of findings.json.

    Iteration goes over the claims.
    """

    def __init__(self, claims: Iterable[Mapping], findings: Iterable[Mapping] = ()) -> None:
        self.claims = {claim["id"]: with_texts(claim) for claim in claims}
        self.findings = {finding["id"]: finding for finding in findings}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> Entry:
        """Return one claim; an unknown id raises a ValueError that lists the known ones."""
        return _known("claim", id, self.claims)

    def found(self, id: str) -> SimpleNamespace | None:
        """Return the numbers of one finding by name; None if it has no numbers."""
        numbers = _known("finding", id, self.findings)["numbers"]
        return SimpleNamespace(**numbers) if numbers else None

    def deviation_at(self, id: str, **chosen: float | str) -> float | None:
        """Return the deviation at a combination of choices; None if it does not exist."""
        for row in self(id).choices:
            if chosen.items() <= row.items():
                return row["deviation"]
        return None

    def listed(self, id: str, words: str) -> str:
        """List the further numbers of a claim with keys "WORDS: NAME", with NAME in italics."""
        parts = []
        for key, value in self(id).further.items():
            start, colon, name = key.partition(": ")
            if colon and words in start:
                parts.append(f"{number(value)} *{name}*")
        return "; ".join(parts)

    def count(self, *verdicts: str) -> int:
        """Return the number of counted claims, or of those with one of the given verdicts."""
        counted = [claim.verdict for claim in self if claim.counted]
        return sum(not verdicts or verdict in verdicts for verdict in counted)

    def relaxed(self, *verdicts: str) -> int:
        """Return the number of claims with a stricter earlier tolerance.

        If verdicts are given, count only claims with one of them at the earlier tolerance.
        """
        earlier = [claim.at_earlier for claim in self if claim.at_earlier]
        return sum(not verdicts or verdict in verdicts for verdict in earlier)

    def summary(self) -> str:
        """Return the numbers of claims of each verdict in words: counted claims, then the others.

        Of the claims that are not counted, only those that fail are named.
        """
        listed = []
        for verdict in VERDICTS:
            count = self.count(verdict)
            words = verdict.replace("depends", "depend") if count > 1 else verdict
            if count:
                listed.append(f"{count} {words}")
        text = f"{self.count()} counted claims: {', '.join(listed)}"
        failed = sum(not claim.counted and claim.verdict == FAILED for claim in self)
        if failed:
            words = "claim, not counted, is" if failed == 1 else "claims, not counted, are"
            text += f"; {failed} more {words} not reproduced"
        return f"{text}."

    def differences(self, shipped: Mapping[str, str]) -> list[dict]:
        """Return the verdicts that differ from the shipped ones, as `changes` lists them."""
        return changes(shipped, {claim.id: claim.verdict for claim in self})


def _known(what: str, id: str, entries: Mapping[str, Any]) -> Any:
    """Return the entry with an id; an unknown id raises a ValueError that lists the known ones."""
    if id not in entries:
        raise ValueError(f"{what}: {id!r}; allowed: {', '.join(entries)}")
    return entries[id]
