"""The ledger as pages and texts ask for it: claims of claims.json, with texts by their kind."""

from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import Any

from ..records.provenance import changes
from ..text.numerals import MISSING, number, percent, rounded, setting, with_uncertainty
from .rules import NOT_TESTABLE, REPRODUCED, VERDICTS

# A claim says at which tolerances its verdict changes, up to this factor from its own.
BAND = 1.5


class Entry(SimpleNamespace):
    """A claim of claims.json, with its fields as attributes; its texts are those of a number."""

    # Fields that only some kinds have.
    runs = left_out = 0
    remark = False
    largest: Any = None
    exact_largest: Any = None

    def predicted_text(self) -> str:
        """The prediction of the paper."""
        return number(self.predicted, 5)

    def measured_text(self) -> str:
        """The measured value with its uncertainty; for a qualitative claim numbers of runs."""
        return with_uncertainty(self.measured, self.uncertainty)

    def compared_text(self) -> str:
        """The deviation and the tolerance, in words."""
        return MISSING if self.deviation is None else self._compared()

    def why_text(self) -> str:
        """One sentence on why a claim is not simply reproduced; empty if it is."""
        if self.verdict == REPRODUCED or self.why:
            return self.why
        if self.verdict == NOT_TESTABLE:
            return "This run leaves no number to judge by."
        return self._off()

    def evidence_text(self) -> str:
        """The evidence for the verdict besides the numbers shown, as Markdown."""
        parts = [self.note, *self._spread()]
        parts += [f"{name}: {rounded(value)}" for name, value in self.further.items()]
        if self.exact_largest is not None:
            median, largest = percent(self.exact_median), percent(self.exact_largest)
            parts.append(f"runs off the exact theory by {median} (median) to {largest}")
        for flip in self.flips_at:
            side = "above" if flip["tolerance"] > self.tolerance else "below"
            if 1.0 / BAND <= flip["tolerance"] / self.tolerance <= BAND:
                parts.append(
                    f"with a tolerance {side} {number(flip['tolerance'], 3)}: {flip[side]}"
                )
        if self.at_earlier:
            earlier = setting(self.earlier_tolerance)
            parts.append(f"at {earlier}, set before results were seen: {self.at_earlier}")
        if self.follows_from:
            names = ", ".join(f"`{id}`" for id in self.follows_from)
            parts.append(f"follows from {names} and is not counted again")
        if self.beyond:
            parts.append("beyond the paper, and not counted")
        if self.remark:
            parts.append("a remark on a drawing, and not counted")
        return "; ".join(filter(None, parts))

    def _compared(self) -> str:
        # The deviation of a scaling is of an exponent, that of an estimate a median.
        if self.kind == "scaling" or self.predicted == 0.0:
            return f"{number(self.deviation, 2)}, tolerance {setting(self.tolerance)}"
        text = "median " if self.kind == "approximate" else ""
        text += f"{percent(self.deviation)}, tolerance {setting(100.0 * self.tolerance)} %"
        return f"{text}; {self.asked}" if self.asked else text

    def _off(self) -> str:
        """How far it is off; the uncertainty is relative as the deviation is."""
        uncertainty = number(self.uncertainty)
        if self.predicted:
            uncertainty = percent(self.uncertainty / abs(self.predicted))
        return f"It is off by {self.compared_text()}; its uncertainty is {uncertainty}."

    def _spread(self) -> list[str]:
        """The runs behind a number: how many, their spread, and how many are left out."""
        parts = [f"{self.runs} runs"] if self.runs and self.kind != "qualitative" else []
        if self.largest is not None:
            ninety, largest = percent(self.ninety), percent(self.largest)
            parts.append(f"90 % of them within {ninety}, the largest deviation {largest}")
        return parts + ([f"left out, without numbers: {self.left_out}"] if self.left_out else [])


class Counts(Entry):
    """A qualitative claim, by numbers of runs."""

    def predicted_text(self) -> str:
        return f"all of {self.predicted:.0f}"

    def measured_text(self) -> str:
        counts = {"against": self.failed, "undecided": self.undecided}
        rest = [f"{count} {name}" for name, count in counts.items() if count]
        return ", ".join([f"{self.held} of {self.held + self.failed + self.undecided}", *rest])

    def _compared(self) -> str:
        text = self.asked or "no run may contradict"
        tolerance = setting(100.0 * self.tolerance)
        return f"{text} (tolerance {tolerance} %)" if self.tolerance else text

    def _off(self) -> str:
        held, _, rest = self.measured_text().partition(", ")
        if rest:
            return f"It holds in {held} cases, with {rest}."
        return "It needs a condition that the paper does not state."


class ReadOff(Entry):
    """A figure that was read off, by chi-square."""

    def predicted_text(self) -> str:
        degrees = "degree" if self.predicted == 1 else "degrees"
        return f"{self.predicted:.0f} {degrees} of freedom"

    def measured_text(self) -> str:
        return f"\N{GREEK SMALL LETTER CHI}² = {number(self.measured, 3)}"

    def _compared(self) -> str:
        return f"p = {number(self.deviation, 2)}, at least {setting(self.tolerance)}"

    def _off(self) -> str:
        return f"At the best fit {self.compared_text()} is asked."


KINDS: dict[str, type[Entry]] = dict.fromkeys(("exact", "approximate", "scaling"), Entry)
KINDS |= {"qualitative": Counts, "reading": ReadOff}


def with_texts(claim: Mapping[str, Any]) -> Entry:
    """A claim of claims.json with the texts of its kind."""
    return KINDS[claim["kind"]](**claim)


class Ledger:
    """Claims of claims.json by id, and findings of findings.json."""

    def __init__(self, claims: Iterable[Mapping], findings: Iterable[Mapping] = ()) -> None:
        self.claims = {claim["id"]: with_texts(claim) for claim in claims}
        self.findings = {finding["id"]: finding for finding in findings}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> Entry:
        """One claim; a ValueError for an unknown name lists those that there are."""
        return _known("claim", id, self.claims)

    def found(self, id: str) -> SimpleNamespace | None:
        """The numbers of one finding by name; None without runs for them."""
        numbers = _known("finding", id, self.findings)["numbers"]
        return SimpleNamespace(**numbers) if numbers else None

    def deviation_at(self, id: str, **chosen: float | str) -> float | None:
        """The deviation of a claim at a combination of choices; None without such a combination."""
        rows = (row["deviation"] for row in self(id).choices if chosen.items() <= row.items())
        return next(rows, None)

    def listed(self, id: str, words: str) -> str:
        """The further numbers of a claim that are named "WORDS: NAME", each with its name."""
        parts = []
        for key, value in self(id).further.items():
            start, colon, name = key.partition(": ")
            if colon and words in start:
                parts.append(f"{number(value)} {name}")
        return "; ".join(parts)

    def count(self, *verdicts: str) -> int:
        """The number of counted claims with one of these verdicts, or of all of them."""
        return sum(claim.counted and (not verdicts or claim.verdict in verdicts) for claim in self)

    def relaxed(self, *verdicts: str) -> int:
        """The number of claims whose tolerance was stricter, or of these verdicts at that one."""
        earlier = [claim.at_earlier for claim in self if claim.at_earlier]
        return sum(not verdicts or verdict in verdicts for verdict in earlier)

    def summary(self) -> str:
        """The number of claims of each verdict, in words."""
        listed = []
        for verdict in VERDICTS:
            count = self.count(verdict)
            words = verdict.replace("depends", "depend") if count > 1 else verdict
            if count:
                listed.append(f"{count} {words}")
        return f"{self.count()} claims: {', '.join(listed)}."

    def differences(self, shipped: Mapping[str, str]) -> list[dict]:
        """Verdicts that differ from shipped ones by id, as `changes` lists them."""
        return changes(shipped, {claim.id: claim.verdict for claim in self})


def _known(what: str, id: str, entries: Mapping[str, Any]) -> Any:
    if id not in entries:
        raise ValueError(f"{what}: {id!r}; allowed: {', '.join(entries)}")
    return entries[id]
