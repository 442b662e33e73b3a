"""Read the texts of claims from the YAML files in manuscript/.

Also list which sentences of the paper each claim tests, and count sentences that none tests.
"""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from ..configuration.problems import nearest

# Each sentence is tested or has a reason why it has no claim; the words appear in a table.
REASONS = {
    "tested": "tested by a claim",
    "repeats": "repeats another sentence",
    "background": "background, or says no more than that something is shown",
    "definition": "definition or assumption",
    "other work": "is about other work",
    "no model": "no model of this project can decide it",
    "not asked": "a model could decide it; not examined here",
}


def read_text(path: str | Path):
    """Return the content of a YAML file, read by the C parser, which is ten times as fast."""
    return yaml.load(Path(path).read_text(encoding="utf-8"), yaml.CSafeLoader)


def read_entries(path: str | Path, tolerances: Mapping[str, Mapping]) -> dict[str, dict]:
    """Return claims, checks and findings, with the tolerances that the configuration sets.

    A tolerance for an unknown claim raises a ValueError.
    """
    texts = read_text(path)
    claims = texts["claims"]
    for id, changed_tolerances in tolerances.items():
        if id not in claims:
            raise ValueError(
                f"claims.{id}: unknown claim{nearest(id, claims)}; allowed: those in {path}"
            )
        claims[id] |= changed_tolerances
    return texts


def claims_of(entries: Mapping[str, Mapping], sentence: Mapping) -> list[str]:
    """Return the ids of the claims and checks that test a sentence of the paper.

    Each entry lists the ids of the sentences that it tests.
    """
    return [id for id, entry in entries.items() if sentence["id"] in entry["sentences"]]


def places_of(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> dict[str, str]:
    """Return, for each claim, the sections and figures of the sentences that it tests, in order."""
    # A place such as "abstract, paragraph 1, sentence 2" is shortened to "abstract".
    place_of_sentence = {sentence["id"]: sentence["place"].split(",")[0] for sentence in sentences}
    places_of_claim = {}
    for claim, entry in entries.items():
        places = [place for id, place in place_of_sentence.items() if id in entry["sentences"]]
        without_repetitions = dict.fromkeys(places)
        places_of_claim[claim] = "; ".join(without_repetitions)
    return places_of_claim


def coverage(sentences: Sequence[Mapping]) -> dict[str, int]:
    """Return the number of sentences for each reason, and the total as "all"."""
    reasons = [str(sentence.get("why_none", "tested")) for sentence in sentences]
    # A repetition is "repeats ID".
    counts = Counter(re.sub("^repeats .*", "repeats", reason) for reason in reasons)
    return {key: counts[key] for key in REASONS} | {"all": len(sentences)}
