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
        """The deviation, the verdict, and whether the claim holds (None if that is open)."""
        verdict = self.claim.verdict()
        return {
            "deviation": self.claim.fields().get("deviation"),
            "verdict": verdict,
            "holds": rules.HOLDS_BY_VERDICT.get(verdict),
        }

    @property
    def fraction(self) -> float | str | None:
        """The fraction of the path that counts as arrest; None if the claim has no such choice."""
        return self.choice.get("fraction")


class Change(NamedTuple):
    """A change of one choice, which leads from one combination to another.

    name : the choice that changes
    exact : True if both combinations are exact solutions
    size : absolute difference of the deviations
    """

    name: str
    before: Combination
    after: Combination
    exact: bool
    size: float


def changes(combinations: Iterable[Combination]) -> list[Change]:
    """Return all ordered pairs of combinations that differ in one choice only.

    Combinations without a deviation are left out.
    """
    compared = []
    for combination in combinations:
        # The last release is a property of the lattice and not a choice that the paper leaves open.
        is_open_choice = combination.fraction != LAST_RELEASE_FRACTION
        if is_open_choice and combination.result["deviation"] is not None:
            compared.append(combination)
    single_changes = []
    for before, after in permutations(compared, 2):
        names = before.choice | after.choice
        changed = [name for name in names if before.choice.get(name) != after.choice.get(name)]
        if len(changed) == 1 and changed[0] in CHOICE_WORDS:
            exact = before.choice.get("solution") == "exact"
            size = abs(before.result["deviation"] - after.result["deviation"])
            single_changes.append(Change(changed[0], before, after, exact, size))
    return single_changes


def decisive_changes(combinations: Iterable[Combination]) -> list[Change]:
    """Return, for each choice that decides whether the claim holds, the smallest such change.

    If no choice decides, return the change that moves the deviation most.
    """
    all_changes = changes(combinations)
    smallest_deciding: dict[str, Change] = {}
    for change in sorted(all_changes, key=attrgetter("size")):
        holds_before, holds_after = change.before.result["holds"], change.after.result["holds"]
        if holds_before is True and holds_after is False:
            smallest_deciding.setdefault(change.name, change)
    # The choices are sorted by their largest change, in descending order. Changes of the exact
    # solution come before changes of lattices.
    rank = attrgetter("exact", "size")
    # A dictionary keeps the last change of each choice, which is the largest one.
    largest = {change.name: change for change in sorted(all_changes, key=rank)}
    largest_first = sorted(largest.values(), key=rank)[::-1]
    deciding = [
        smallest_deciding[change.name]
        for change in largest_first
        if change.name in smallest_deciding
    ]
    return deciding or largest_first[:1]


@dataclass(frozen=True, kw_only=True)
class OverChoices(Claim):
    """One claim made from its results at all combinations; its numbers are those of ``shown``."""

    combinations: Sequence[Combination]
    shown: Claim

    def own_verdict(self, tolerance: float) -> str:
        """Return one verdict from those at all combinations."""
        verdicts = [one.claim.verdict(tolerance) for one in self.combinations]
        return rules.verdict_over_choices(verdicts)

    @cached_property
    def decisive(self) -> list[Change]:
        """Changes of choices on which the verdict depends."""
        return decisive_changes(self.combinations)

    def fields(self) -> dict[str, Any]:
        """Return the numbers shown, one row for each combination, and the most important choice."""
        rows = [one.choice | one.result for one in self.combinations]
        return self.shown.json_fields() | {
            "verdict": self.verdict(),
            "choices": rows,
            "combinations": len(rows),
            "holds_at": sum(bool(row["holds"]) for row in rows),
            "choice": self.decisive[0].name if self.decisive else "",
        }

    def sentence_values(self) -> dict[str, Any]:
        """Return the values that sentences may use in addition to the fields of claims.json.

        holding : deviations at the combinations at which the claim holds
        failing : deviations at the combinations at which it fails
        last : deviations of lattice runs that are measured at their last release
        changes : the changes of choices on which the verdict depends
        choice_names : names of the choices in sentences
        settings : choices of the combination in doubt, in words. This is the first combination
            whose verdict has a caveat, or the first of all if none has.
        unsure : the template values of the claim at this combination
        """
        holding: list[float | None] = []
        failing: list[float | None] = []
        last: list[float] = []
        for combination in self.combinations:
            deviation, holds = combination.result["deviation"], combination.result["holds"]
            if holds is True:
                holding.append(deviation)
            if holds is False:
                failing.append(deviation)
            if combination.fraction == LAST_RELEASE_FRACTION and deviation is not None:
                last.append(deviation)
        with_caveat = [one for one in self.combinations if one.result["verdict"] == rules.CAVEAT]
        in_doubt = with_caveat[0] if with_caveat else self.combinations[0]
        settings = [
            f"{CHOICE_WORDS[name]} {named(value)}"
            for name, value in in_doubt.choice.items()
            if name in CHOICE_WORDS
        ]
        return self.shown.template_values | {
            "holding": holding,
            "failing": failing,
            "last": last,
            "changes": self.decisive,
            "choice_names": CHOICE_WORDS,
            "settings": settings,
            "unsure": in_doubt.claim.template_values,
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
