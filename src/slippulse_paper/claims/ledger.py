"""Turn the claims of claims.json into the texts that pages and reports show.

`Ledger` has all claims and findings by id. An `Entry` is one claim. It returns the texts on the
prediction, the measured value, the deviation with its tolerance, and the reason for the verdict.
"""

from collections.abc import Iterable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from ..records.provenance import changes
from ..text.numerals import MISSING, number, percent, rounded, setting, with_uncertainty
from .rules import FAILED, NOT_TESTABLE, VERDICTS, WITHOUT_RESERVATION

# A claim reports the tolerances at which its verdict changes if they are within this factor of its
# own tolerance.
TOLERANCE_BAND = 1.5


class Entry(SimpleNamespace):
    """A claim of claims.json with its fields as attributes.

    This class formats claims that are decided by a measured number, and subclasses format the other
    kinds. A method with a name in _text returns the content of one column in the table of claims.
    """

    # Fields that only some kinds have, with the values for all others.
    runs = left_out = 0
    remark = False
    largest: Any = None
    exact_largest: Any = None
    # Only estimates have a deviation that is a median, with an uncertainty of its own.
    deviation_uncertainty: Any = None

    def predicted_text(self) -> str:
        """Return the prediction of the paper."""
        return number(self.predicted, 5)

    def measured_text(self) -> str:
        """Return the measured value with its uncertainty."""
        return with_uncertainty(self.measured, self.uncertainty)

    def compared_text(self) -> str:
        """Return the deviation and the tolerance in words."""
        return MISSING if self.deviation is None else self._deviation_or_requirement()

    def why_text(self) -> str:
        """Return the reason for the verdict; empty if the claim holds without reservation."""
        if self.verdict in WITHOUT_RESERVATION or self.why:
            return self.why
        if self.verdict == NOT_TESTABLE:
            return "This run has no number that could be judged."
        return self._sentence_on_deviation()

    def evidence_text(self) -> str:
        """Return the additional evidence for the verdict, as Markdown."""
        parts = [self.note, *self._numbers_of_runs()]
        parts += [f"{name}: {rounded(value)}" for name, value in self.further.items()]
        if self.exact_largest is not None:
            median, largest = percent(self.exact_median), percent(self.exact_largest)
            parts.append(
                f"runs deviate from exact theory by {median} (median) and by at most {largest}"
            )
        parts += [*self._other_tolerances(), *self._not_counted()]
        return "; ".join(part for part in parts if part)

    def _other_tolerances(self) -> list[str]:
        """Return the verdicts at other tolerances nearby (TOLERANCE_BAND), and at the earlier one.

        A text is, for example, "with a tolerance below 0.14: not reproduced".
        """
        parts = []
        # A flip has a tolerance at which the verdict changes, and the verdicts below and above it.
        for flip in self.flips_at:
            ratio = flip["tolerance"] / self.tolerance
            # The tolerance of the claim is on one side of the flip. The verdict on the other side
            # is reported.
            other_side = "above" if ratio > 1.0 else "below"
            if 1.0 / TOLERANCE_BAND <= ratio <= TOLERANCE_BAND:
                limit = number(flip["tolerance"], 3)
                parts.append(f"with a tolerance {other_side} {limit}: {flip[other_side]}")
        if self.at_earlier:
            earlier = setting(self.earlier_tolerance)
            parts.append(
                f"with the tolerance {earlier}, which was set before results were seen: "
                f"{self.at_earlier}"
            )
        return parts

    def _not_counted(self) -> list[str]:
        """Return the reasons for which the claim is not counted."""
        reasons = []
        if self.follows_from:
            names = ", ".join(f"`{id}`" for id in self.follows_from)
            reasons.append(f"the claim follows from {names} and is not counted again")
        if self.beyond:
            reasons.append("the claim goes beyond the paper and is not counted")
        if self.remark:
            reasons.append("the claim is a remark on a drawing and is not counted")
        return reasons

    def _has_relative_deviation(self) -> bool:
        """Return True except for deviations of exponents, and for those from 0."""
        return self.kind != "scaling" and bool(self.predicted)

    def _deviation_or_requirement(self) -> str:
        """Return the deviation and the tolerance, for a claim that has a deviation."""
        if not self._has_relative_deviation():
            return f"{number(self.deviation, 2)}, tolerance {setting(self.tolerance)}"
        # The deviation of an estimate is the median over all runs.
        text = "median " if self.kind == "approximate" else ""
        text += f"{percent(self.deviation)}, tolerance {setting(100.0 * self.tolerance)} %"
        # A claim may have a requirement in addition to the tolerance, in words (asked).
        return f"{text}; {self.asked}" if self.asked else text

    def _sentence_on_deviation(self) -> str:
        """Return a sentence with the deviation and its uncertainty, as the reason for the verdict.

        This function is called only for verdicts with a reservation.
        """
        if self.deviation_uncertainty is not None:
            uncertainty = percent(self.deviation_uncertainty)
        elif self._has_relative_deviation():
            # The uncertainty of the measured value is divided by the predicted value, too.
            uncertainty = percent(self.uncertainty / abs(self.predicted))
        else:
            uncertainty = number(self.uncertainty)
        deviation = "median deviation" if self.kind == "approximate" else "deviation"
        # The text is, for example, "median 12 %, tolerance 20 %".
        deviation_and_tolerance = self.compared_text().removeprefix("median ")
        return f"The {deviation} is {deviation_and_tolerance}; the uncertainty is {uncertainty}."

    def _numbers_of_runs(self) -> list[str]:
        """Return the number of runs, how much they deviate, and how many are left out."""
        parts = []
        # The measured value of a qualitative claim is a number of runs already.
        if self.runs and self.kind != "qualitative":
            parts.append(f"{self.runs} runs")
        if self.largest is not None:
            ninety, largest = percent(self.ninety), percent(self.largest)
            parts.append(
                f"90 % of the runs deviate by at most {ninety}, and the worst run by {largest}"
            )
        if self.left_out:
            parts.append(f"runs left out because they have no number: {self.left_out}")
        return parts


class QualitativeEntry(Entry):
    """A qualitative claim, shown as numbers of runs."""

    def predicted_text(self) -> str:
        """Return the number of all runs, because the statement should hold in each of them."""
        return f"all of {self.predicted:.0f}"

    def measured_text(self) -> str:
        """Return the numbers of runs in which the statement holds, fails or is undecided."""
        total = self.held + self.failed + self.undecided
        if not total:
            return MISSING
        parts = [f"{self.held} of {total}"]
        if self.failed:
            parts.append(f"{self.failed} against")
        if self.undecided:
            parts.append(f"{self.undecided} undecided")
        return ", ".join(parts)

    def _deviation_or_requirement(self) -> str:
        """Return the requirement of the claim (asked), with its tolerance if it has one."""
        text = self.asked or "no run may contradict"
        tolerance = setting(100.0 * self.tolerance)
        return f"{text} (tolerance {tolerance} %)" if self.tolerance else text

    def _sentence_on_deviation(self) -> str:
        """Return a sentence with the reason why the verdict has a reservation.

        In some runs the claim does not hold or is undecided, or it holds only under a condition.
        This function is called only for such verdicts.
        """
        # The text is, for example, "38 of 40, 1 against, 1 undecided".
        held, _, others = self.measured_text().partition(", ")
        if others:
            return f"The claim holds in {held} cases ({others})."
        # The claim holds in all runs, so the only reason left is a condition.
        return "The claim holds only under a condition that the paper does not state."


class ReadingEntry(Entry):
    """Numbers that were read off a figure, shown as a chi-square."""

    def predicted_text(self) -> str:
        """Return the degrees of freedom, which are the expected value of chi-square."""
        degrees = "degree" if self.predicted == 1 else "degrees"
        return f"{self.predicted:.0f} {degrees} of freedom"

    def measured_text(self) -> str:
        """Return the chi-square."""
        return f"\N{GREEK SMALL LETTER CHI}² = {number(self.measured, 3)}"

    def _deviation_or_requirement(self) -> str:
        """Return the p-value and its smallest allowed value."""
        return f"p = {number(self.deviation, 2)}, required at least {setting(self.tolerance)}"

    def _sentence_on_deviation(self) -> str:
        """Return a sentence with the p-value of the best fit."""
        return f"The best fit has {self.compared_text()}."


# The class that formats a claim, by its kind.
KINDS: dict[str, type[Entry]] = {
    "exact": Entry,
    "approximate": Entry,
    "scaling": Entry,
    "qualitative": QualitativeEntry,
    "reading": ReadingEntry,
}


def with_texts(claim: Mapping[str, Any]) -> Entry:
    """Return a claim of claims.json as an object that formats it."""
    return KINDS[claim["kind"]](**claim)


class Ledger:
    """All claims of claims.json and all findings of findings.json, by id.

    Iterating over a ledger yields its claims.
    """

    def __init__(self, claims: Iterable[Mapping], findings: Iterable[Mapping] = ()) -> None:
        self.claims = {claim["id"]: with_texts(claim) for claim in claims}
        self.findings = {finding["id"]: finding for finding in findings}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> Entry:
        """Return the claim with an id; raises ValueError if there is none."""
        return _entry_with_id("claim", id, self.claims)

    def found(self, id: str) -> SimpleNamespace | None:
        """Return the numbers of one finding by name; None if it has no numbers."""
        numbers = _entry_with_id("finding", id, self.findings)["numbers"]
        return SimpleNamespace(**numbers) if numbers else None

    def deviation_at(self, id: str, **choices: float | str) -> float | None:
        """Return the deviation of a claim for given values of the open choices of the paper.

        The claim was judged at many combinations of values. The first combination with the given
        values counts. None if there is no such combination.

        choices : values by name of the choice, such as ``release="total"``
        """
        for combination in self(id).choices:
            if choices.items() <= combination.items():
                return combination["deviation"]
        return None

    def listed(self, id: str, words: str) -> str:
        """Return some further numbers of a claim as Markdown, such as "12 *cracks*; 3 *pulses*".

        The keys of further numbers have the form "TEXT: NAME". The numbers whose TEXT contains the
        given words are listed. If there is none, the result is "none". A page may break the words
        at the end of a line.
        """
        words, parts = " ".join(words.split()), []
        for key, value in self(id).further.items():
            text, colon, name = key.partition(": ")
            if colon and words in text:
                parts.append(f"{number(value)} *{name}*")
        return "; ".join(parts) or "none"

    def count(self, *verdicts: str) -> int:
        """Return the number of counted claims, or of those that have one of the given verdicts."""
        verdicts_of_claims = [claim.verdict for claim in self if claim.counted]
        return _count_of(verdicts_of_claims, verdicts)

    def relaxed(self, *verdicts: str) -> int:
        """Return the number of claims that had a stricter tolerance earlier.

        If verdicts are given, count only claims with one of them at the earlier tolerance.
        """
        earlier_verdicts = [claim.at_earlier for claim in self if claim.at_earlier]
        return _count_of(earlier_verdicts, verdicts)

    def summary(self) -> str:
        """Return the number of counted claims with each verdict, in words.

        If claims that are not counted fail, their number follows.
        """
        listed = []
        for verdict in VERDICTS:
            count = self.count(verdict)
            # Plural of "depends on an open choice".
            words = verdict.replace("depends", "depend") if count > 1 else verdict
            if count:
                listed.append(f"{count} {words}")
        text = f"{self.count()} counted claims: {', '.join(listed)}"
        failed = sum(not claim.counted and claim.verdict == FAILED for claim in self)
        if failed:
            words = (
                "claim, which is not counted, is"
                if failed == 1
                else "claims, which are not counted, are"
            )
            text += f"; {failed} further {words} not reproduced"
        return f"{text}."

    def differences(self, shipped: Mapping[str, str]) -> list[dict]:
        """Return the verdicts that differ from the shipped ones, in the form of `changes`.

        shipped : verdicts that come with the project, by claim id
        """
        return changes(shipped, {claim.id: claim.verdict for claim in self})


def _count_of(values: Iterable[str], wanted: Sequence[str]) -> int:
    """Return how many values are among the wanted ones; all count if none is wanted."""
    return sum(not wanted or value in wanted for value in values)


def _entry_with_id(kind: str, id: str, entries: Mapping[str, Any]) -> Any:
    """Return the entry with an id; raises ValueError, with all ids, if there is none.

    kind : word for an entry in the message, "claim" or "finding"
    """
    if id not in entries:
        raise ValueError(f"{kind}: {id!r}; allowed: {', '.join(entries)}")
    return entries[id]
