"""Entries of manuscript/claims.yaml with the sentences that they test; those of claims.json as texts ask for them."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import yaml

from ..configuration.problems import nearest
from ..data.numerals import number, percent, rounded, setting, with_uncertainty
from .rules import VERDICTS

# Why a sentence has no claim of its own; a repetition names the sentence that it repeats.
WHY_NONE = ("background", "definition", "other work", "no model")
# Whether a sentence that is tested holds itself, whatever the claim that it led to.
AS_PRINTED = ("holds", "holds corrected", "depends on an open choice", "does not hold")
# A tolerance below this is for rounding alone.
SLIGHT = 1e-6
# Whether a tolerance that is this much larger or smaller would change a verdict is said with the claim.
BAND = 1.5


def read_text(path: str | Path):
    """A YAML file, by the parser in C: ten times as fast."""
    return yaml.load(Path(path).read_text(encoding="utf-8"), yaml.CSafeLoader)


def read_entries(path: str | Path, tolerances: Mapping[str, Mapping]) -> dict[str, dict]:
    """Claims, algebra and findings, the claims with tolerances of the configuration; ValueError for an unknown one."""
    texts = read_text(path)
    claims = texts["claims"]
    for id, other in tolerances.items():
        if id not in claims:
            raise ValueError(
                f"claims.{id}: unknown claim{nearest(id, claims)}; allowed: those in {path}"
            )
        claims[id] |= other
    return texts


def claims_of(entries: Mapping[str, Mapping], sentence: Mapping) -> list[str]:
    """The claims, and the algebra, that test a sentence."""
    return [id for id, entry in entries.items() if sentence["id"] in entry["sentences"]]


def coverage(sentences: Sequence[Mapping]) -> dict[str, int]:
    """How many sentences there are, how many are tested, and how many are not for each reason."""
    why = [str(sentence.get("why_none", "tested")) for sentence in sentences]
    counts = Counter("repeats" if reason.startswith("repeats") else reason for reason in why)
    return {"all": len(sentences), **{key: counts[key] for key in ("tested", "repeats", *WHY_NONE)}}


def positions(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> dict[str, str]:
    """Per claim the sections, appendices and figures whose sentences it tests."""
    where = [(sentence["id"], sentence["place"].split(",")[0]) for sentence in sentences]
    return {
        name: "; ".join(dict.fromkeys(place for id, place in where if id in entry["sentences"]))
        for name, entry in entries.items()
    }


class Ledger:
    """The claims of claims.json by id, each with its fields as attributes, and the findings of findings.json."""

    def __init__(self, claims: Iterable[Mapping], findings: Iterable[Mapping] = ()) -> None:
        self.claims = {claim["id"]: SimpleNamespace(**claim) for claim in claims}
        self.findings = {finding["id"]: finding for finding in findings}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> SimpleNamespace:
        """One claim; of an unknown name a ValueError says which there are, here and in `found`."""
        return _known("claim", id, self.claims)

    def found(self, id: str) -> SimpleNamespace | None:
        """The numbers of one finding by name; None if this run has no runs for them."""
        numbers = _known("finding", id, self.findings)["numbers"]
        return SimpleNamespace(**numbers) if numbers else None

    def measured(self, id: str) -> str:
        """Measured value, as `measured_text`."""
        return measured_text(self(id))

    def deviation_at(self, id: str, **chosen: float | str) -> float | None:
        """The deviation of a claim at a combination of choices; None where it was not judged at it."""
        rows = (row["deviation"] for row in self(id).choices if chosen.items() <= row.items())
        return next(rows, None)

    def listed(self, id: str, words: str) -> str:
        """The further numbers of a claim whose name has these words before its colon, each with what is behind it."""
        found = [
            (*name.split(": ", 1), value)
            for name, value in self(id).further.items()
            if ": " in name
        ]
        return "; ".join(
            f"{number(value)} {name}" for before, name, value in found if words in before
        )

    def count(self, *verdicts: str) -> int:
        """How many counted claims have one of these verdicts; all of them if none is named."""
        return sum(claim.counted and (not verdicts or claim.verdict in verdicts) for claim in self)

    def following(self) -> int:
        """How many claims follow from others."""
        return len(self.claims) - self.count()

    def summary(self) -> str:
        """How many claims there are of each verdict, in words."""
        counts = {name: count for name in VERDICTS if (count := self.count(name))}
        listed = [
            f"{n} {name.replace('depends', 'depend') if n > 1 else name}"
            for name, n in counts.items()
        ]
        rest = f" {self.following()} more follow from these." if self.following() else ""
        return f"{self.count()} claims: {', '.join(listed)}.{rest}"


def _known(what: str, id: str, entries: Mapping[str, Any]) -> Any:
    if id not in entries:
        raise ValueError(f"{what}: {id!r}; allowed: {', '.join(entries)}")
    return entries[id]


def predicted_text(claim: SimpleNamespace) -> str:
    """What the paper has, as its kind says it."""
    if claim.predicted is None:
        return number(None)
    if claim.kind == "qualitative":
        return f"all of {claim.predicted:.0f}"
    if claim.kind == "reading":
        return f"{claim.predicted:.0f} degree{'s' * (claim.predicted != 1)} of freedom"
    return number(claim.predicted, 5)


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
        equal = (
            f" (equal within {setting(100.0 * claim.tolerance)} %)"
            if claim.tolerance > SLIGHT
            else ""
        )
        return f"no run may contradict{equal}"
    if claim.kind == "reading":
        return f"p = {number(claim.deviation, 2)}, at least {setting(claim.tolerance)}"
    if claim.kind == "arithmetic" or claim.predicted == 0.0:
        return f"{number(claim.deviation, 2)}, tolerance {setting(claim.tolerance)}"
    text = f"{percent(claim.deviation)}, tolerance {setting(100.0 * claim.tolerance)} %"
    if claim.kind == "exact":
        return text
    if claim.exponent is not None:
        exponent = with_uncertainty(claim.exponent, claim.exponent_uncertainty)
        text += f"; exponent {exponent}, tolerance {setting(claim.tolerance_exponent)}"
    return f"median {text}"


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
        condition = claim.note.partition("condition: ")[2]
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
        ninety, largest = percent(claim.ninety), percent(claim.largest)
        parts.append(f"90 % of them within {ninety}, the largest deviation {largest}")
    if counted and claim.left_out:
        parts.append(f"left out, without numbers: {claim.left_out}")
    parts += [f"{name}: {rounded(value)}" for name, value in claim.further.items()]
    if estimate and claim.exact_largest is not None:
        median, largest = percent(claim.exact_median), percent(claim.exact_largest)
        parts.append(f"runs off the exact theory by {median} (median) to {largest}")
    for flip in claim.flips_at:
        side = "above" if flip["tolerance"] > claim.tolerance else "below"
        if 1.0 / BAND <= flip["tolerance"] / claim.tolerance <= BAND:
            parts.append(f"with a tolerance {side} {number(flip['tolerance'], 3)}: {flip[side]}")
    if claim.follows_from:
        names = ", ".join(f"`{id}`" for id in claim.follows_from)
        parts.append(f"follows from {names} and is not counted again")
    return "; ".join(filter(None, parts))
