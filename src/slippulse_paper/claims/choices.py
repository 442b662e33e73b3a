"""Judge a claim at every combination of the choices that the paper leaves open.

The paper does not state everything, for example the release rule. Such a claim is judged once for
each admissible combination of values (`Combination`), and `OverChoices` makes one verdict from all
of them. If the verdicts differ, `decisive_changes` finds the choices that the verdict depends on.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from operator import attrgetter
from typing import Any, NamedTuple

from ..text.numerals import setting
from . import rules
from .kinds import Claim

# Values of the open choices, by name.
Chosen = dict[str, float | str]
# This value stands for a fraction of the path if a lattice run is measured at its last release.
LAST_RELEASE_FRACTION = "last release"
# Names of the choices in sentences.
CHOICE_WORDS = {
    "fraction": "the fraction of the path that counts as arrest",
    "release": "the release rule",
    "damping_ratio": r"the damping ratio $\beta/\Delta x$",
    "nucleation": "the nucleation",
    "criterion": "the criterion of the transition",
}


@dataclass(frozen=True)
class Combination:
    """The result of a claim at one combination of choices."""

    choice: Chosen
    claim: Claim

    @cached_property
    def result(self) -> dict[str, Any]:
        """Deviation, verdict, and True if the claim holds; None instead of True if it is open."""
        verdict, deviation = self.claim.verdict(), self.claim.fields().get("deviation")
        return {
            "deviation": deviation,
            "verdict": verdict,
            "holds": rules.HOLDS_BY_VERDICT.get(verdict),
        }


class Change(NamedTuple):
    """Two combinations that differ in one choice only, and the difference of their deviations."""

    name: str
    before: Combination
    after: Combination
    exact: bool
    size: float


def changes(combinations: Iterable[Combination]) -> list[Change]:
    """Return all ordered pairs of combinations that differ in one choice only.

    Combinations without a deviation are left out.
    """
    # The last release is a property of the lattice and not a choice that the paper leaves open.
    choices = [one for one in combinations if one.choice.get("fraction") != LAST_RELEASE_FRACTION]
    out = []
    for before, after in permutations(choices, 2):
        names = before.choice | after.choice
        changed = [name for name in names if before.choice.get(name) != after.choice.get(name)]
        first, second = before.result["deviation"], after.result["deviation"]
        if len(changed) == 1 and changed[0] in CHOICE_WORDS and None not in (first, second):
            exact = before.choice.get("solution") == "exact"
            out.append(Change(changed[0], before, after, exact, abs(first - second)))
    return out


def decisive_changes(combinations: Iterable[Combination]) -> list[Change]:
    """Return, for each choice that decides whether the claim holds, the smallest such change.

    If no choice decides, return the change that moves the deviation most.
    """
    deciding: dict[str, Change] = {}
    changed = changes(combinations)
    for change in sorted(changed, key=attrgetter("size")):
        if change.before.result["holds"] and change.after.result["holds"] is False:
            deciding.setdefault(change.name, change)
    # Changes of the exact solution rank above changes of lattices.
    weight = attrgetter("exact", "size")
    largest = {change.name: change for change in sorted(changed, key=weight)}
    ranked = sorted(largest.values(), key=weight)[::-1]
    return [deciding[one.name] for one in ranked if one.name in deciding] or ranked[:1]


@dataclass(frozen=True, kw_only=True)
class OverChoices(Claim):
    """One claim made from its results at all combinations; its numbers are those of ``shown``."""

    combinations: Sequence[Combination]
    shown: Claim

    def own_verdict(self, tolerance: float) -> str:
        verdicts = [one.claim.verdict(tolerance) for one in self.combinations]
        return rules.verdict_over_choices(verdicts)

    @cached_property
    def decided(self) -> list[Change]:
        """Changes of choices on which the verdict depends."""
        return decisive_changes(self.combinations)

    def fields(self) -> dict[str, Any]:
        """Return the numbers shown, one row for each combination, and the most important choice."""
        rows = [one.choice | one.result for one in self.combinations]
        out: dict[str, Any] = {"verdict": self.verdict(), "choices": rows}
        out |= {"combinations": len(rows), "holds_at": sum(bool(row["holds"]) for row in rows)}
        return (
            self.shown.json_fields()
            | out
            | {"choice": self.decided[0].name if self.decided else ""}
        )

    def sentence_values(self) -> dict[str, Any]:
        """Return the values for sentences, of all combinations and of one in doubt."""
        results = [one.result for one in self.combinations]
        last = [
            one.result
            for one in self.combinations
            if one.choice.get("fraction") == LAST_RELEASE_FRACTION
        ]
        in_doubt = [one for one in self.combinations if one.result["verdict"] == rules.CAVEAT]
        unsure = (in_doubt or self.combinations)[0]
        choice = {
            CHOICE_WORDS[name]: value
            for name, value in unsure.choice.items()
            if name in CHOICE_WORDS
        }
        return self.shown.template_values | {
            "holding": [result["deviation"] for result in results if result["holds"]],
            "failing": [result["deviation"] for result in results if result["holds"] is False],
            "last": [result["deviation"] for result in last if result["deviation"] is not None],
            "changes": self.decided,
            "choice_names": CHOICE_WORDS,
            "settings": [f"{name} {named(value)}" for name, value in choice.items()],
            "unsure": unsure.claim.template_values,
        }


def over_choices(
    combinations: Sequence[Combination], shown: Claim | None = None, **fields: Any
) -> OverChoices:
    """Return one claim made from all combinations; it shows the first one, or ``shown``."""
    shown = replace(shown or combinations[0].claim, **fields)
    return OverChoices(combinations=combinations, shown=shown, tolerance=shown.tolerance)


def named(value: float | str) -> str:
    """Return the value of a choice in words."""
    return value if isinstance(value, str) else setting(value)
