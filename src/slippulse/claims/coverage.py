"""The sentences of the paper that can be tested, and the claims that test them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

# Why a sentence has no claim of its own; a repetition names the sentence that it repeats.
WHY_NONE = ("background", "definition", "other work", "no model")


def claims_of(sentence: Mapping) -> list[str]:
    """The claims that test a sentence."""
    named = sentence.get("claim", [])
    return [named] if isinstance(named, str) else list(named)


def problems(statements: Sequence[Mapping], claims: Sequence[str]) -> list[str]:
    """One line for each sentence that is neither tested nor excused, each claim without a sentence, each wrong name."""
    ids = Counter(sentence["id"] for sentence in statements)
    lines = [f"{id}: twice" for id, count in ids.items() if count > 1]
    for sentence in statements:
        named, why = claims_of(sentence), str(sentence.get("why_none", ""))
        if bool(named) == bool(why):
            lines.append(f"{sentence['id']}: allowed: a claim, or why there is none")
        lines += [f"{sentence['id']}: {claim}: no such claim" for claim in named if claim not in claims]
        repeated = why.removeprefix("repeats ")
        if why and why not in WHY_NONE and repeated not in ids:
            lines.append(f"{sentence['id']}: {why!r}; allowed: {', '.join(WHY_NONE)}, repeats ID")
        if len(sentence["paraphrase"].split()) > 25:
            lines.append(f"{sentence['id']}: paraphrase of more than 25 words")
    tested = {claim for sentence in statements for claim in claims_of(sentence)}
    return lines + [f"{claim}: tests no sentence" for claim in claims if claim not in tested]


def coverage(statements: Sequence[Mapping]) -> dict[str, int]:
    """How many sentences there are, how many are tested, and how many are not for each reason."""
    counts: Counter[str] = Counter()
    for sentence in statements:
        why = str(sentence.get("why_none", "tested"))
        counts["repeats" if why.startswith("repeats") else why] += 1
    return {"all": len(statements), **{key: counts[key] for key in ("tested", "repeats", *WHY_NONE)}}


def places(statements: Sequence[Mapping]) -> dict[str, str]:
    """Per claim the sections, appendices and figures whose sentences it tests."""
    found: dict[str, dict[str, None]] = {}
    for sentence in statements:
        for claim in claims_of(sentence):
            found.setdefault(claim, {})[sentence["place"].split(",")[0]] = None
    return {claim: "; ".join(where) for claim, where in found.items()}
