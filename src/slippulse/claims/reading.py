"""Claims as texts ask for them: from manuscript/claims.yaml and from claims.json."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import yaml

from ..configuration.problems import nearest
from ..data.numerals import number, percent, rounded, setting, with_uncertainty
from .rules import VERDICTS

# Reasons for a sentence to have no claim; a repetition names the sentence that it repeats.
WHY_NONE = ("background", "definition", "other work", "no model", "not asked")
# What tests check beside the claims: algebra, and what the model imposes.
CHECKS = ("algebra", "imposed")
# A tolerance below this is for rounding alone.
SLIGHT = 1e-6
# A claim says at which tolerances its verdict changes, up to this factor from its own.
BAND = 1.5


def read_text(path: str | Path):
    """A YAML file, by the parser in C: ten times as fast."""
    return yaml.load(Path(path).read_text(encoding="utf-8"), yaml.CSafeLoader)


def read_entries(path: str | Path, tolerances: Mapping[str, Mapping]) -> dict[str, dict]:
    """Claims, checks and findings, with tolerances of the configuration; or ValueError."""
    texts = read_text(path)
    claims = texts["claims"]
    for id, other in tolerances.items():
        if id not in claims:
            raise ValueError(
                f"claims.{id}: unknown claim{nearest(id, claims)}; allowed: those in {path}"
            )
        claims[id] |= other
    return texts


def every_test(texts: Mapping[str, Mapping]) -> dict[str, Mapping]:
    """Everything that tests sentences: claims and checks, by id."""
    return {id: entry for part in ("claims", *CHECKS) for id, entry in texts[part].items()}


def claims_of(entries: Mapping[str, Mapping], sentence: Mapping) -> list[str]:
    """The claims and checks that test a sentence."""
    return [id for id, entry in entries.items() if sentence["id"] in entry["sentences"]]


def coverage(sentences: Sequence[Mapping]) -> dict[str, int]:
    """Numbers of sentences: all, tested, and not tested for each reason."""
    reasons = [str(sentence.get("why_none", "tested")) for sentence in sentences]
    # A repetition is "repeats ID".
    counts = Counter(re.sub("^repeats .*", "repeats", reason) for reason in reasons)
    return {"all": len(sentences), **{key: counts[key] for key in ("tested", "repeats", *WHY_NONE)}}


def places_of(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> dict[str, str]:
    """Sections, appendices and figures of the sentences that each claim tests, in their order."""
    where = {sentence["id"]: sentence["place"].split(",")[0] for sentence in sentences}
    out = {}
    for name, entry in entries.items():
        places = [place for id, place in where.items() if id in entry["sentences"]]
        out[name] = "; ".join(dict.fromkeys(places))
    return out


class Ledger:
    """Claims of claims.json by id, with fields as attributes, and findings of findings.json."""

    def __init__(self, claims: Iterable[Mapping], findings: Iterable[Mapping] = ()) -> None:
        self.claims = {claim["id"]: SimpleNamespace(**claim) for claim in claims}
        self.findings = {finding["id"]: finding for finding in findings}

    def __iter__(self):
        return iter(self.claims.values())

    def __call__(self, id: str) -> SimpleNamespace:
        """One claim; a ValueError for an unknown name lists those that there are."""
        return _known("claim", id, self.claims)

    def found(self, id: str) -> SimpleNamespace | None:
        """The numbers of one finding by name; None without runs for them."""
        numbers = _known("finding", id, self.findings)["numbers"]
        return SimpleNamespace(**numbers) if numbers else None

    def measured(self, id: str) -> str:
        """Measured value, as `measured_text`."""
        return measured_text(self(id))

    def deviation_at(self, id: str, **chosen: float | str) -> float | None:
        """The deviation of a claim at a combination of choices; None without such a combination."""
        rows = (row["deviation"] for row in self(id).choices if chosen.items() <= row.items())
        return next(rows, None)

    def further(self, id: str, words: str) -> float | None:
        """The first further number of a claim whose name has these words; None without one."""
        return next((value for name, value in self(id).further.items() if words in name), None)

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


def _known(what: str, id: str, entries: Mapping[str, Any]) -> Any:
    if id not in entries:
        raise ValueError(f"{what}: {id!r}; allowed: {', '.join(entries)}")
    return entries[id]


def predicted_text(claim: SimpleNamespace) -> str:
    """The prediction of the paper, in the form of its kind."""
    if claim.predicted is None:
        return number(None)
    if claim.kind == "qualitative":
        return f"all of {claim.predicted:.0f}"
    if claim.kind == "reading":
        degrees = "degree" if claim.predicted == 1 else "degrees"
        return f"{claim.predicted:.0f} {degrees} of freedom"
    return number(claim.predicted, 5)


def measured_text(claim: SimpleNamespace) -> str:
    """The measured value with its uncertainty; for a qualitative claim numbers of runs."""
    if claim.kind == "qualitative":
        counts = {"against": claim.failed, "undecided": claim.undecided}
        rest = [f"{count} {name}" for name, count in counts.items() if count]
        return ", ".join([f"{claim.held} of {claim.held + claim.failed + claim.undecided}", *rest])
    if claim.kind == "reading":
        return f"\N{GREEK SMALL LETTER CHI}² = {number(claim.measured, 3)}"
    return with_uncertainty(claim.measured, claim.uncertainty)


def compared_text(claim: SimpleNamespace) -> str:
    """The deviation and the tolerance, in words."""
    if claim.deviation is None:
        return number(None)
    if claim.kind == "qualitative":
        text = claim.asked or "no run may contradict"
        if claim.tolerance > SLIGHT:
            text += f" (tolerance {setting(100.0 * claim.tolerance)} %)"
        return text
    if claim.kind == "reading":
        return f"p = {number(claim.deviation, 2)}, at least {setting(claim.tolerance)}"
    if claim.kind == "scaling" or claim.predicted == 0.0:
        return f"{number(claim.deviation, 2)}, tolerance {setting(claim.tolerance)}"
    text = "" if claim.kind == "exact" else "median "
    text += f"{percent(claim.deviation)}, tolerance {setting(100.0 * claim.tolerance)} %"
    return f"{text}; {claim.asked}" if claim.asked else text


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
        return "It needs a condition that the paper does not state."
    if claim.kind == "reading":
        return f"At the best fit {compared_text(claim)} is asked."
    return f"It is off by {compared_text(claim)}; its uncertainty is {uncertainty_text(claim)}."


def uncertainty_text(claim: SimpleNamespace) -> str:
    """The uncertainty in the unit of the deviation: relative, or absolute where 0 is predicted."""
    if not claim.predicted:
        return number(claim.uncertainty)
    scale = abs(claim.predicted) if claim.kind == "exact" else 1.0
    return percent(claim.uncertainty / scale)


def evidence_text(claim: SimpleNamespace) -> str:
    """The evidence for the verdict besides the numbers shown, as Markdown."""
    parts = [claim.note]
    if claim.kind in ("exact", "approximate", "scaling"):
        parts += spread_texts(claim)
    parts += [f"{name}: {rounded(value)}" for name, value in claim.further.items()]
    if claim.kind == "approximate" and claim.exact_largest is not None:
        median, largest = percent(claim.exact_median), percent(claim.exact_largest)
        parts.append(f"runs off the exact theory by {median} (median) to {largest}")
    for flip in claim.flips_at:
        side = "above" if flip["tolerance"] > claim.tolerance else "below"
        if 1.0 / BAND <= flip["tolerance"] / claim.tolerance <= BAND:
            parts.append(f"with a tolerance {side} {number(flip['tolerance'], 3)}: {flip[side]}")
    if claim.at_earlier:
        earlier = setting(claim.earlier_tolerance)
        parts.append(f"at {earlier}, set before results were seen: {claim.at_earlier}")
    if claim.follows_from:
        names = ", ".join(f"`{id}`" for id in claim.follows_from)
        parts.append(f"follows from {names} and is not counted again")
    if claim.beyond:
        parts.append("beyond the paper, and not counted")
    return "; ".join(filter(None, parts))


def spread_texts(claim: SimpleNamespace) -> list[str]:
    """The runs behind a number: how many, their spread, and how many are left out."""
    parts = [f"{claim.runs} runs"] if claim.runs else []
    if claim.kind == "approximate" and claim.largest is not None:
        ninety, largest = percent(claim.ninety), percent(claim.largest)
        parts.append(f"90 % of them within {ninety}, the largest deviation {largest}")
    if claim.left_out:
        parts.append(f"left out, without numbers: {claim.left_out}")
    return parts
