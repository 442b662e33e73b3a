"""One verdict over every admissible combination of what the paper leaves open (manuscript/open_choices.yaml)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations
from typing import Any

from ..data.numerals import percent, setting
from . import rules
from .evidence import Claim

# A combination of choices, by name.
Chosen = dict[str, float | str]
# The fraction of the path where a lattice has no criterion of arrest.
LAST = "last release"
# What a combination has beside its choices.
FOUND = ("deviation", "exponent", "verdict", "holds")


def over_choices(claims: Sequence[tuple[Chosen, Claim]], shown: Claim | None = None) -> Claim:
    """One claim with the verdict over all combinations of choices.

    Parameters
    ----------
    claims : combinations of choices by name, each with the claim judged at it
    shown : whose numbers stand with it; without, those of the first combination
    """
    rows: list[dict[str, Any]] = [
        {**choice, "deviation": claim.get("deviation"), "exponent": claim.get("exponent")}
        | {"verdict": claim["verdict"], "holds": rules.HOLDS.get(claim["verdict"])}
        for choice, claim in claims
    ]
    verdict, pairs = rules.over_choices([row["verdict"] for row in rows]), decisive(rows)
    found = (claims[0][1] if shown is None else shown) | {
        "choices": rows, "choice": next(iter(pairs), ""), "verdict": verdict,
        "combinations": len(rows), "holds_at": sum(row["holds"] is True for row in rows),
    }  # fmt: skip
    if all("at" in claim for _, claim in claims):
        ats = [claim["at"] for _, claim in claims]
        found["at"] = lambda tolerance: rules.over_choices([at(tolerance) for at in ats])
    if verdict == rules.DEPENDS:
        sides = "; on ".join(
            f"{NAMES[name]}: {sides_of(name, pair, 'held' in found)}" for name, pair in pairs.items()
        )
        found["why"] = f"It holds at {found['holds_at']} of {len(rows)} combinations. It depends on {sides}."
    elif verdict == "reproduced with caveat":
        unsure = next(row for row in rows if row["verdict"] == verdict)
        where = " and ".join(f"{NAMES[name]} {named(unsure[name])}" for name in NAMES if name in unsure)
        found["why"] = f"With {where} it is within the tolerance, but not together with its uncertainty."
    return found


def sides_of(name: str, pair: Iterable[Mapping], counted: bool) -> str:
    """What combinations say of a claim, by their value of one choice; ``counted``: by runs, not by a deviation."""

    def side(row: Mapping) -> str:
        size = percent(row["deviation"], 3) + (" of the runs against" if counted else "")
        size += ", at the last release" if name != "fraction" and row.get("fraction") == LAST else ""
        return f"it {'holds' if row['holds'] else 'fails'} at {named(row[name])} ({size})"

    return " and ".join(map(side, pair))


# What each choice is called in a sentence.
NAMES = {
    "fraction": "the fraction of the path that counts as arrest",
    "release": "the release rule",
    "damping_ratio": r"the damping ratio $\beta/\Delta x$",
    "nucleation": "the nucleation",
}


def named(value: float | str) -> str:
    """A value of a choice."""
    return value if isinstance(value, str) else setting(value)


def decisive(choices: Sequence[Mapping]) -> dict[str, tuple[Mapping, Mapping]]:
    """Choices that, changed alone, decide whether a claim holds, first the one that moves the deviation most.

    Returns
    -------
    of each the combination that holds and the one that fails, of those that differ in nothing else the closest; where
    none decides, the choice that moves the deviation most, without a pair that does
    """
    moves: dict[str, list[tuple[float, Mapping, Mapping]]] = {}
    quiet: dict[str, tuple[bool, float]] = {}
    for one, other in permutations(choices, 2):
        apart = [name for name in {*one, *other} - {*FOUND} if one.get(name) != other.get(name)]
        if len(apart) != 1 or apart[0] not in NAMES or None in (one["deviation"], other["deviation"]):
            continue
        move = abs(one["deviation"] - other["deviation"])
        # A lattice is a corner; the exact solution has every combination.
        rank = one.get("solution") == "exact", move
        quiet[apart[0]] = max(rank, quiet.get(apart[0], rank))
        if one["holds"] and other["holds"] is False:
            moves.setdefault(apart[0], []).append((move, one, other))
    order = sorted(moves, key=quiet.__getitem__, reverse=True)
    closest = {name: min(moves[name], key=lambda each: each[0])[1:] for name in order}
    return closest or dict.fromkeys(sorted(quiet, key=quiet.__getitem__)[-1:], ({}, {}))
