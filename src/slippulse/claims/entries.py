"""Claims as manuscript/claims.yaml has them, and the sentences of the paper that they test."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from ..model.checks import nearest

# Why a sentence has no claim of its own; a repetition names the sentence that it repeats.
WHY_NONE = ("background", "definition", "other work", "no model")

# Whether a sentence that is tested holds itself, whatever the claim that it led to.
AS_PRINTED = ("holds", "holds corrected", "depends on an open choice", "does not hold")


def read_entries(path: str | Path, tolerances: Mapping[str, Mapping]) -> dict[str, dict]:
    """Claims, algebra and findings, the claims with other tolerances where the configuration has them.

    Raises
    ------
    ValueError
        Naming a claim of the configuration that there is not.
    """
    texts = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    claims = texts["claims"]
    for id, other in tolerances.items():
        if id not in claims:
            raise ValueError(f"claims.{id}: unknown claim{nearest(id, claims)}; allowed: those in {path}")
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
    found: dict[str, dict[str, None]] = {id: {} for id in entries}
    for sentence in sentences:
        for id in claims_of(entries, sentence):
            found[id][sentence["place"].split(",")[0]] = None
    return {id: "; ".join(places) for id, places in found.items()}
