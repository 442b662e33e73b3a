"""The texts of claims, as manuscript/ has them in YAML, and the sentences that claims test."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from ..configuration.problems import nearest

# Whether a sentence is tested, or why it has no claim, with words for the table that counts.
REASONS = {
    "tested": "tested by a claim",
    "repeats": "repeats another sentence",
    "background": "background, or says no more than that something is shown",
    "definition": "definition or assumption",
    "other work": "is about other work",
    "no model": "no model here can tell",
    "not asked": "a model could tell; not asked here",
}


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


def claims_of(entries: Mapping[str, Mapping], sentence: Mapping) -> list[str]:
    """The claims and checks that test a sentence."""
    return [id for id, entry in entries.items() if sentence["id"] in entry["sentences"]]


def places_of(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> dict[str, str]:
    """Sections, appendices and figures of the sentences that each claim tests, in their order."""
    where = {sentence["id"]: sentence["place"].split(",")[0] for sentence in sentences}
    out = {}
    for name, entry in entries.items():
        places = [place for id, place in where.items() if id in entry["sentences"]]
        out[name] = "; ".join(dict.fromkeys(places))
    return out


def coverage(sentences: Sequence[Mapping]) -> dict[str, int]:
    """Numbers of sentences for each reason, and of all."""
    reasons = [str(sentence.get("why_none", "tested")) for sentence in sentences]
    # A repetition is "repeats ID".
    counts = Counter(re.sub("^repeats .*", "repeats", reason) for reason in reasons)
    return {key: counts[key] for key in REASONS} | {"all": len(sentences)}
