"""Claims as manuscript/claims.yaml has them, and the sentences of the paper that they test."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import yaml

from ..model.checks import nearest

# Why a sentence has no claim of its own; a repetition names the sentence that it repeats.
WHY_NONE = ("background", "definition", "other work", "no model")


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


def problems(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> list[str]:
    """One line for each sentence that is neither tested nor excused, each claim without a sentence, each wrong name."""
    ids = Counter(sentence["id"] for sentence in sentences)
    lines = [f"{id}: twice" for id, count in ids.items() if count > 1]
    for sentence in sentences:
        why = str(sentence.get("why_none", ""))
        if bool(claims_of(entries, sentence)) == bool(why):
            lines.append(f"{sentence['id']}: allowed: a claim, or why there is none")
        repeated = why.removeprefix("repeats ")
        if why and why not in WHY_NONE and repeated not in ids:
            lines.append(f"{sentence['id']}: {why!r}; allowed: {', '.join(WHY_NONE)}, repeats ID")
        if len(sentence["paraphrase"].split()) > 25:
            lines.append(f"{sentence['id']}: paraphrase of more than 25 words")
    for id, entry in entries.items():
        lines += [f"{id}: {name}: no such sentence" for name in entry["sentences"] if name not in ids]
        lines += [] if entry["sentences"] else [f"{id}: tests no sentence"]
    return lines


def coverage(sentences: Sequence[Mapping]) -> dict[str, int]:
    """How many sentences there are, how many are tested, and how many are not for each reason."""
    why = [str(sentence.get("why_none", "tested")) for sentence in sentences]
    counts = Counter("repeats" if reason.startswith("repeats") else reason for reason in why)
    return {"all": len(sentences), **{key: counts[key] for key in ("tested", "repeats", *WHY_NONE)}}


def positions(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> dict[str, str]:
    """Per claim the sections, appendices and figures whose sentences it tests."""
    found = {}
    for id, entry in entries.items():
        tested = [
            sentence["place"].split(",")[0] for sentence in sentences if sentence["id"] in entry["sentences"]
        ]
        found[id] = "; ".join(dict.fromkeys(tested))
    return found
