"""One verdict over every admissible combination of what the paper leaves open (manuscript/open_choices.yaml)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import permutations
from typing import Any, TypeVar

from ..data.numerals import percent, setting
from . import rules
from .evidence import Claim

# A combination of choices, by name.
Chosen = dict[str, float | str]
# The fraction of the path where a lattice has no criterion of arrest.
LAST = "last release"
# What a combination has beside its choices.
FOUND = ("deviation", "exponent", "verdict", "holds")
# What each choice is called in a sentence.
NAMES = {
    "fraction": "the fraction of the path that counts as arrest",
    "release": "the release rule",
    "damping_ratio": r"the damping ratio $\beta/\Delta x$",
    "nucleation": "the nucleation",
}
Runs = TypeVar("Runs")


def over_choices(
    runs: Iterable[tuple[Chosen, Runs]], judge: Callable[[Runs], Claim], shown: Claim | None = None
) -> Claim:
    """One claim with the verdict over all combinations of choices.

    Parameters
    ----------
    runs : combinations of choices by name, each with what ``judge`` judges the claim by
    shown : whose numbers stand with it; without, those of the first combination
    """
    pairs = [(choice, judge(tables)) for choice, tables in runs]
    claims = [claim for _, claim in pairs]
    rows: list[dict[str, Any]] = [
        choice
        | {name: claim.get(name) for name in ("deviation", "exponent", "verdict")}
        | {"holds": rules.HOLDS.get(claim["verdict"])}
        for choice, claim in pairs
    ]
    verdict, decided = rules.over_choices([row["verdict"] for row in rows]), decisive(rows)
    found = (shown or claims[0]) | {
        "choices": rows, "choice": next(iter(decided), ""), "verdict": verdict,
        "combinations": len(rows), "holds_at": sum(row["holds"] is True for row in rows),
    }  # fmt: skip
    if all("at" in claim for claim in claims):
        found["at"] = lambda tolerance: rules.over_choices([claim["at"](tolerance) for claim in claims])
    if verdict == rules.DEPENDS:
        sides = [f"{NAMES[name]}: {sides_of(name, pair, 'held' in found)}" for name, pair in decided.items()]
        found["why"] = f"It holds at {found['holds_at']} of {len(rows)} combinations."
        found["why"] += f" It depends on {'; on '.join(sides)}."
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


def named(value: float | str) -> str:
    """A value of a choice."""
    return value if isinstance(value, str) else setting(value)


def decisive(choices: Sequence[Mapping]) -> dict[str, Sequence[Mapping]]:
    """Choices that, changed alone, decide whether a claim holds, first the one that moves the deviation most.

    Returns
    -------
    of each the combination that holds and the one that fails, of those that differ in nothing else the closest; where
    none decides, the choice that moves the deviation most, without a pair that does
    """
    moves: dict[str, list[tuple[float, Mapping, Mapping]]] = {}
    largest: dict[str, tuple[bool, float]] = {}
    for one, other in permutations(choices, 2):
        apart = [name for name in {*one, *other} - {*FOUND} if one.get(name) != other.get(name)]
        if len(apart) != 1 or apart[0] not in NAMES or None in (one["deviation"], other["deviation"]):
            continue
        move = abs(one["deviation"] - other["deviation"])
        # A lattice is a corner; the exact solution has every combination.
        rank = one.get("solution") == "exact", move
        largest[apart[0]] = max(rank, largest.get(apart[0], rank))
        if one["holds"] and other["holds"] is False:
            moves.setdefault(apart[0], []).append((move, one, other))
    order = sorted(largest, key=largest.__getitem__)
    closest: dict[str, Sequence[Mapping]] = {
        name: min(moves[name], key=lambda each: each[0])[1:] for name in order[::-1] if name in moves
    }
    return closest or dict.fromkeys(order[-1:], ())
