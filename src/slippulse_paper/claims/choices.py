"""A claim at every combination of what the paper leaves open, and the choice that decides it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from operator import attrgetter
from typing import Any, NamedTuple

from ..text.numerals import setting
from . import rules
from .kinds import Claim

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
        verdict, deviation = self.claim.verdict(), self.claim.fields().get("deviation")
        return {"deviation": deviation, "verdict": verdict, "holds": rules.HOLDS.get(verdict)}


class Change(NamedTuple):
    """Two combinations that differ in one choice alone, and how far their deviations differ."""

    name: str
    before: Combination
    after: Combination
    exact: bool
    size: float


def changes(combinations: Iterable[Combination]) -> list[Change]:
    """All ordered pairs of combinations with a deviation that differ in one choice alone."""
    # The last release is that of a lattice, so that what it changes with is no choice of the paper.
    choices = [one for one in combinations if one.choice.get("fraction") != LAST]
    out = []
    for before, after in permutations(choices, 2):
        names = before.choice | after.choice
        changed = [name for name in names if before.choice.get(name) != after.choice.get(name)]
        first, second = before.result["deviation"], after.result["deviation"]
        if len(changed) == 1 and changed[0] in NAMES and None not in (first, second):
            exact = before.choice.get("solution") == "exact"
            out.append(Change(changed[0], before, after, exact, abs(first - second)))
    return out


def decisive(combinations: Iterable[Combination]) -> list[Change]:
    """The smallest change of each choice that decides, changed alone, whether a claim holds."""
    deciding: dict[str, Change] = {}
    changed = changes(combinations)
    for change in sorted(changed, key=attrgetter("size")):
        if change.before.result["holds"] and change.after.result["holds"] is False:
            deciding.setdefault(change.name, change)
    # Changes of the exact solution are above those of lattices.
    weight = attrgetter("exact", "size")
    largest = {change.name: change for change in sorted(changed, key=weight)}
    ranked = sorted(largest.values(), key=weight)[::-1]
    # If none decides, the choice that moves the deviation most stands alone.
    return [deciding[one.name] for one in ranked if one.name in deciding] or ranked[:1]


@dataclass(frozen=True, kw_only=True)
class OverChoices(Claim):
    """One claim from those at all combinations of choices, with the numbers of ``shown``."""

    combinations: Sequence[Combination]
    shown: Claim

    def alone(self, tolerance: float) -> str:
        verdicts = [one.claim.verdict(tolerance) for one in self.combinations]
        return rules.verdict_over_choices(verdicts)

    @cached_property
    def decided(self) -> list[Change]:
        """The changes of choices on which the claim depends."""
        return decisive(self.combinations)

    def fields(self) -> dict[str, Any]:
        """The numbers shown, a row for each combination, and the choice that moves most."""
        rows = [one.choice | one.result for one in self.combinations]
        out: dict[str, Any] = {"verdict": self.verdict(), "choices": rows}
        out |= {"combinations": len(rows), "holds_at": sum(bool(row["holds"]) for row in rows)}
        return self.shown.written() | out | {"choice": self.decided[0].name if self.decided else ""}

    def names(self) -> dict[str, Any]:
        """What sentences tell of the numbers shown, of all combinations and of one in doubt."""
        results = [one.result for one in self.combinations]
        last = [one.result for one in self.combinations if one.choice.get("fraction") == LAST]
        in_doubt = [one for one in self.combinations if one.result["verdict"] == rules.CAVEAT]
        unsure = (in_doubt or self.combinations)[0]
        choice = {NAMES[name]: value for name, value in unsure.choice.items() if name in NAMES}
        return self.shown.told | {
            "holding": [result["deviation"] for result in results if result["holds"]],
            "failing": [result["deviation"] for result in results if result["holds"] is False],
            "last": [result["deviation"] for result in last if result["deviation"] is not None],
            "changes": self.decided,
            "choice_names": NAMES,
            "settings": [f"{name} {named(value)}" for name, value in choice.items()],
            "unsure": unsure.claim.told,
        }


def over_choices(
    combinations: Sequence[Combination], shown: Claim | None = None, **fields: Any
) -> OverChoices:
    """One claim from all combinations, with the numbers of the first or of ``shown``."""
    shown = replace(shown or combinations[0].claim, **fields)
    return OverChoices(combinations=combinations, shown=shown, tolerance=shown.tolerance)


def named(value: float | str) -> str:
    """A value of a choice in words."""
    return value if isinstance(value, str) else setting(value)
