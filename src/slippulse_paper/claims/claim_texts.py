"""Read the texts of claims, and the sentences of the paper that they test, from manuscript/."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from ..configuration.problems import spelling_hint

# Reasons why a sentence of the paper is or is not tested by a claim, with the words for a table.
REASONS = {
    "tested": "tested by a claim",
    "repeats": "repeats another sentence",
    "background": "gives background, or only says that something is shown",
    "definition": "definition or assumption",
    "other work": "is about other work",
    "no model": "cannot be decided by any model of this project",
    "not asked": "could be decided by a model, but is not examined here",
}


def read_text(path: str | Path):
    """Return the content of a YAML file."""
    # This loader is written in C and ten times as fast as the default one.
    return yaml.load(Path(path).read_text(encoding="utf-8"), yaml.CSafeLoader)


def read_entries(path: str | Path, tolerances: Mapping[str, Mapping]) -> dict[str, dict]:
    """Return the content of manuscript/claims.yaml, with the tolerances of the configuration.

    path : path of this file
    tolerances : tolerances that replace those of the file, by claim id and key. Raises ValueError
        if a claim is unknown.
    """
    texts = read_text(path)
    claims = texts["claims"]
    for id, changed_tolerances in tolerances.items():
        if id not in claims:
            raise ValueError(
                f"claims.{id}: unknown claim{spelling_hint(id, claims)}; allowed: those in {path}"
            )
        claims[id] |= changed_tolerances
    return texts


def claims_of(entries: Mapping[str, Mapping], sentence: Mapping) -> list[str]:
    """Return the ids of the claims that test a sentence of the paper.

    entries : entries of the claims, each with the ids of the sentences that it tests
    """
    return [id for id, entry in entries.items() if sentence["id"] in entry["sentences"]]


def places_of(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> dict[str, str]:
    """Return the sections and figures of the sentences that each claim tests, by claim id."""
    # A place such as "abstract, paragraph 1, sentence 2" is shortened to "abstract".
    place_of_sentence = {sentence["id"]: sentence["place"].split(",")[0] for sentence in sentences}
    places_of_claim = {}
    for claim_id, entry in entries.items():
        places = [place for id, place in place_of_sentence.items() if id in entry["sentences"]]
        # A dictionary keeps each place once, in the order of the paper.
        without_repetitions = dict.fromkeys(places)
        places_of_claim[claim_id] = "; ".join(without_repetitions)
    return places_of_claim


def coverage(sentences: Sequence[Mapping]) -> dict[str, int]:
    """Count the sentences of the paper that claims test, and those that none tests, by reason.

    The keys are those of REASONS, and "all" for the total.
    """
    counts: Counter[str] = Counter()
    for sentence in sentences:
        reason = str(sentence.get("why_none", "tested"))
        # In "repeats ID", ID is the id of the repeated sentence.
        counts["repeats" if reason.startswith("repeats ") else reason] += 1
    return {reason: counts[reason] for reason in REASONS} | {"all": len(sentences)}
