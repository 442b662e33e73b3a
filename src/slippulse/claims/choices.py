"""One verdict over every admissible combination of what the paper leaves open (manuscript/open_choices.yaml)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations

from ..data.numerals import percent, setting
from . import rules
from .evidence import Claim

# What a combination has beside its choices.
FOUND = ("deviation", "exponent", "verdict", "holds")


def over_choices(claims: Sequence[tuple[Mapping, Claim]]) -> Claim:
    """The first claim, with the verdict over all of them.

    Parameters
    ----------
    claims : combinations of choices by name, each with the claim judged at it; ours first
    """
    choices = [
        {**chosen, "deviation": claim.get("deviation"), "exponent": claim.get("exponent")}
        | {"verdict": claim["verdict"], "holds": rules.HOLDS.get(claim["verdict"])}
        for chosen, claim in claims
    ]
    ats = [claim["at"] for _, claim in claims if "at" in claim]
    verdict, (choice, pair) = rules.over_choices([row["verdict"] for row in choices]), decisive(choices)
    told = {
        "choices": choices, "choice": choice, "combinations": len(choices),
        "holds_at": sum(row["holds"] is True for row in choices), "verdict": verdict,
        "at": lambda tolerance: rules.over_choices([at(tolerance) for at in ats]),
    }  # fmt: skip
    why = {}
    if verdict == rules.DEPENDS:
        sides = " and ".join(
            f"{'holds' if row['holds'] else 'fails'} at {named(row[choice])} ({percent(row['deviation'])})"
            for row in sorted(pair, key=lambda row: not row["holds"])
        )
        why["why"] = (
            f"It depends on {NAMES[choice]}: it {sides}; it holds at {told['holds_at']} of {len(choices)}."
        )
    return claims[0][1] | told | why


# What each choice is called in a sentence.
NAMES = {
    "fraction": "the fraction of the path that counts as arrest",
    "release": "the release rule",
    "damping_ratio": r"the damping ratio $b$",
    "nucleation": "the shape of the nucleation",
    "spacing": "the spacing",
}


def named(value: float | str) -> str:
    """A value of a choice."""
    return value if isinstance(value, str) else setting(value)


def decisive(choices: Sequence[Mapping]) -> tuple[str, tuple[Mapping, Mapping]]:
    """The choice that, changed alone, moves the deviation most, from holding to failing if any does; and the pair."""
    best = (False, -1.0)
    found: tuple[str, tuple[Mapping, Mapping]] = ("", ({}, {}))
    for one, other in combinations(choices, 2):
        apart = [name for name in {*one, *other} - {*FOUND} if one.get(name) != other.get(name)]
        if len(apart) == 1 and apart[0] in NAMES and None not in (one["deviation"], other["deviation"]):
            flips = {one["holds"], other["holds"]} == {True, False}
            rank = (flips, abs(one["deviation"] - other["deviation"]))
            if rank > best:
                best, found = rank, (apart[0], (one, other))
    return found
