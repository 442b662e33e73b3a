"""A claim at every combination of what the paper leaves open, and the choice that decides it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import permutations
from typing import Any, NamedTuple

from ..data.numerals import number, percent, setting
from . import rules
from .kinds import ByNumber, Claim, Qualitative, Scaling

# Values of open choices, by name.
Chosen = dict[str, float | str]
# The fraction of the path where a lattice has no criterion of arrest.
LAST = "last release"
# Each choice in a sentence.
NAMES = {
    "fraction": "the fraction of the path that counts as arrest",
    "release": "the release rule",
    "damping_ratio": r"the damping ratio $\beta/\Delta x$",
    "nucleation": "the nucleation",
    "criterion": "the criterion of the transition",
}


@dataclass(frozen=True)
class Combination:
    """A claim at one combination of choices."""

    choice: Chosen
    claim: Claim

    @cached_property
    def result(self) -> dict[str, Any]:
        """Deviation and verdict, and whether the claim holds, None if that is open."""
        fields = self.claim.fields()
        numbers = {name: fields.get(name) for name in ("deviation", "verdict")}
        return numbers | {"holds": rules.HOLDS.get(fields["verdict"])}


class Change(NamedTuple):
    """Two combinations that differ in one choice alone, and how far their deviations differ."""

    name: str
    before: Combination
    after: Combination
    size: float

    def weight(self) -> tuple[bool, float]:
        """The order of changes: a lattice is a corner, the exact solution has every combination."""
        return self.before.choice.get("solution") == "exact", self.size

    def decides(self) -> bool:
        """The claim holds before the change and fails after it."""
        return bool(self.before.result["holds"]) and self.after.result["holds"] is False


def changes(combinations: Iterable[Combination]) -> list[Change]:
    """All ordered pairs of combinations with a deviation that differ in one choice alone."""
    known = [one for one in combinations if one.result["deviation"] is not None]
    out = []
    for before, after in permutations(known, 2):
        names = list(before.choice | after.choice)
        changed = [name for name in names if before.choice.get(name) != after.choice.get(name)]
        if len(changed) == 1 and changed[0] in NAMES:
            size = abs(before.result["deviation"] - after.result["deviation"])
            out.append(Change(changed[0], before, after, size))
    return out


def decisive(combinations: Iterable[Combination]) -> dict[str, Change | None]:
    """Choices that decide, changed alone, whether a claim holds, each with its smallest change.

    The choice that moves the deviation most comes first. Where no choice decides, it is the only
    one, with None.
    """
    largest: dict[str, tuple[bool, float]] = {}
    smallest: dict[str, Change] = {}
    for change in changes(combinations):
        name, weight = change.name, change.weight()
        largest[name] = max(largest.get(name, weight), weight)
        if change.decides() and (name not in smallest or change.size < smallest[name].size):
            smallest[name] = change
    names = sorted(largest, key=largest.__getitem__)[::-1]
    return {name: smallest[name] for name in names if name in smallest} or dict.fromkeys(names[:1])


@dataclass(frozen=True, kw_only=True)
class OverChoices(ByNumber):
    """One claim from those at all combinations of choices, with the numbers of ``shown``."""

    combinations: Sequence[Combination]
    shown: Claim

    def by_number(self, tolerance: float) -> str:
        claims = [one.claim for one in self.combinations if isinstance(one.claim, ByNumber)]
        return rules.over_choices([claim.verdict_at(tolerance) for claim in claims])

    def verdict(self) -> str:
        return rules.over_choices([one.result["verdict"] for one in self.combinations])

    def fields(self) -> dict[str, Any]:
        """The numbers shown, a row for each combination, and the choice that moves most."""
        rows = [one.choice | one.result for one in self.combinations]
        decided, held = decisive(self.combinations), sum(row["holds"] is True for row in rows)
        verdict, why = self.verdict(), self.shown.why
        if verdict == rules.DEPENDS:
            causes = "; on ".join(self.cause(name, change) for name, change in decided.items())
            why += f" It holds at {held} of {len(rows)} combinations{self.reach(rows)}."
            why = f"{why} It depends on {causes}.".strip()
        elif verdict == rules.CAVEAT:
            unsure = next(one for one in self.combinations if one.result["verdict"] == verdict)
            places = [
                f"{NAMES[name]} {named(unsure.choice[name])}"
                for name in NAMES
                if name in unsure.choice
            ]
            why = unsure.claim.why or "it is within the tolerance, but not with its uncertainty"
            why = f"With {' and '.join(places)}, {why}."
        out = {"choices": rows, "choice": next(iter(decided), ""), "verdict": verdict, "why": why}
        return self.shown.fields() | out | {"combinations": len(rows), "holds_at": held}

    def written(self) -> dict[str, Any]:
        return self.shown.written() | self.fields() | {"flips_at": self.flips()}

    def size(self, deviation: float) -> str:
        """A deviation in words."""
        if isinstance(self.shown, Scaling):
            return f"exponent off by {number(deviation, 2)}"
        against = " of the runs against" if isinstance(self.shown, Qualitative) else ""
        return f"{percent(deviation, 3)}{against}"

    def reach(self, rows: Iterable[Mapping]) -> str:
        """The largest deviation that holds, and the smallest that fails."""
        holding, failing = (
            [row["deviation"] for row in rows if row["holds"] is side] for side in (True, False)
        )
        least, most = min(failing), max(holding)
        words = partial(number, digits=2) if isinstance(self.shown, Scaling) else percent
        return f", with deviations up to {words(most)}, and fails with {words(least)} or more"

    def cause(self, name: str, change: Change | None) -> str:
        """A choice on which the claim depends, with what holds on either side of a change."""
        sides = []
        for one in (change.before, change.after) if change else ():
            size = self.size(one.result["deviation"])
            if name != "fraction" and one.choice.get("fraction") == LAST:
                size += ", at the last release"
            verb = "holds" if one.result["holds"] else "fails"
            sides.append(f"it {verb} at {named(one.choice[name])} ({size})")
        return f"{NAMES[name]}: {' and '.join(sides)}"


def over_choices(
    combinations: Sequence[Combination], shown: Claim | None = None, **fields: Any
) -> OverChoices:
    """One claim from all combinations, with the numbers of the first one, or of ``shown``.

    Some of its ``fields`` may be replaced.
    """
    shown = replace(shown or combinations[0].claim, **fields)
    # A claim by numbers of runs has no number that a tolerance is for.
    tolerance = shown.tolerance if isinstance(shown, ByNumber) else 0.0
    return OverChoices(combinations=combinations, shown=shown, tolerance=tolerance)


def named(value: float | str) -> str:
    """A value of a choice in words."""
    return value if isinstance(value, str) else setting(value)
