"""Judge a claim at every combination of the choices that the paper leaves open.

The paper does not state everything, for example the release rule. A claim that depends on such a
choice is judged at each combination of possible values (`Combination`). `OverChoices` makes one
verdict from all of them. If they differ, `decisive_changes` finds the choices that matter.
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

# Values of the open choices at one combination, by name of the choice.
Chosen = dict[str, float | str]
# Lattice runs are measured at their last release instead of a fraction of the path. The choice
# "fraction" then has this value.
LAST_RELEASE_FRACTION = "last release"
# Choices that the paper leaves open, with the words for them in sentences.
CHOICE_WORDS = {
    "fraction": "the fraction of the path that counts as arrest",
    "release": "the release rule",
    "damping_ratio": r"the damping ratio $\beta/\Delta x$",
    "nucleation": "the shape of the nucleation",
    "criterion": "the end of the transition",
}


@dataclass(frozen=True)
class Combination:
    """The result of a claim at one combination of choices."""

    choice: Chosen
    claim: Claim

    @cached_property
    def result(self) -> dict[str, Any]:
        """The deviation, the verdict, and whether the claim holds (None if this is open)."""
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
    """Two combinations that differ in one choice only.

    name : name of this choice
    exact : True if the results of both combinations come from exact solutions
    size : absolute difference between the deviations
    """

    name: str
    before: Combination
    after: Combination
    exact: bool
    size: float

    @property
    def decides(self) -> bool:
        """True if the claim holds before the change and fails after it."""
        return self.before.result["holds"] is True and self.after.result["holds"] is False


def changes(combinations: Iterable[Combination]) -> list[Change]:
    """Return all ordered pairs of combinations that differ in one choice only.

    This choice must be one that the paper leaves open (CHOICE_WORDS). Combinations without a
    deviation are left out. So are those at the last release, which is a property of the lattice.
    """
    compared = []
    for combination in combinations:
        at_last_release = combination.fraction == LAST_RELEASE_FRACTION
        if not at_last_release and combination.result["deviation"] is not None:
            compared.append(combination)
    single_changes = []
    for before, after in permutations(compared, 2):
        names = before.choice | after.choice
        changed = [name for name in names if before.choice.get(name) != after.choice.get(name)]
        if len(changed) == 1 and changed[0] in CHOICE_WORDS:
            single_changes.append(
                Change(
                    name=changed[0],
                    before=before,
                    after=after,
                    exact=before.choice.get("solution") == "exact",
                    size=abs(before.result["deviation"] - after.result["deviation"]),
                )
            )
    return single_changes


def decisive_changes(combinations: Iterable[Combination]) -> list[Change]:
    """Return one change for each choice that decides whether the claim holds.

    The returned change is the smallest one of this choice, from a combination at which the claim
    holds to one at which it fails. Choices with larger effects come first. If no choice decides,
    the result is the single change with the largest effect.
    """
    # Every change between exact solutions ranks above all changes between lattices.
    rank = attrgetter("exact", "size")
    ranked = sorted(changes(combinations), key=rank)
    # The dictionary keeps the last change of each choice, which ranks highest.
    largest_by_choice = {change.name: change for change in ranked}
    largest_first = sorted(largest_by_choice.values(), key=rank)[::-1]
    decisive = []
    for largest in largest_first:
        changes_to_failure = [
            change for change in ranked if change.name == largest.name and change.decides
        ]
        if changes_to_failure:
            decisive.append(min(changes_to_failure, key=attrgetter("size")))
    return decisive or largest_first[:1]


@dataclass(frozen=True, kw_only=True)
class OverChoices(Claim):
    """The result about a claim that was judged at all combinations of choices.

    shown : the result whose numbers are shown for the claim
    """

    combinations: Sequence[Combination]
    shown: Claim

    def own_verdict(self, tolerance: float) -> str:
        """Return one verdict from those at all combinations."""
        verdicts = [combination.claim.verdict(tolerance) for combination in self.combinations]
        return rules.verdict_over_choices(verdicts)

    @cached_property
    def decisive(self) -> list[Change]:
        """Changes of choices on which the verdict depends, from `decisive_changes`."""
        return decisive_changes(self.combinations)

    def fields(self) -> dict[str, Any]:
        """Return the fields of the shown result, with the verdict over all combinations.

        The field choices has one row for each combination, and choice names the choice on which the
        verdict depends most.
        """
        rows = [combination.choice | combination.result for combination in self.combinations]
        return self.shown.json_fields() | {
            "verdict": self.verdict(),
            "choices": rows,
            "combinations": len(rows),
            "holds_at": sum(bool(row["holds"]) for row in rows),
            "choice": self.decisive[0].name if self.decisive else "",
        }

    def sentence_values(self) -> dict[str, Any]:
        """Return the values that sentences may use in addition to the fields of claims.json.

        Their names are:

        holding : deviations at the combinations at which the claim holds
        failing : deviations at the combinations at which it fails
        last : deviations at the combinations at which the transition ends at the last release
        changes : the changes of choices on which the verdict depends
        choice_names : words for each choice
        settings, unsure : the choices in words, and the template values of the result, at the first
            combination with a caveat (`_combination_in_doubt`)
        """
        deviations: dict[bool | None, list] = {True: [], False: [], None: []}
        for combination in self.combinations:
            result = combination.result
            deviations[result["holds"]].append(result["deviation"])
        at_last_release = [
            combination.result["deviation"]
            for combination in self.combinations
            if combination.fraction == LAST_RELEASE_FRACTION
            and combination.result["deviation"] is not None
        ]
        in_doubt = self._combination_in_doubt()
        settings = []
        for name, value in in_doubt.choice.items():
            if name in CHOICE_WORDS:
                is_text = isinstance(value, str)
                shown_value = f"*{value}*" if is_text else f"= {text_of_value(value)}"
                settings.append(f"{CHOICE_WORDS[name]} {shown_value}")
        return self.shown.template_values | {
            "holding": deviations[True],
            "failing": deviations[False],
            "last": at_last_release,
            "changes": [change for change in self.decisive if change.decides],
            "choice_names": CHOICE_WORDS,
            "settings": settings,
            "unsure": in_doubt.claim.template_values,
        }

    def _combination_in_doubt(self) -> Combination:
        """Return the first combination whose verdict has a caveat; the first one if none has."""
        for combination in self.combinations:
            if combination.result["verdict"] == rules.CAVEAT:
                return combination
        return self.combinations[0]


def over_choices(
    combinations: Sequence[Combination], shown: Claim | None = None, **fields: Any
) -> OverChoices:
    """Make one result about a claim from its results at all combinations.

    shown : the result whose numbers are shown; that at the first combination by default
    fields : attributes that are replaced in the shown result
    """
    shown = replace(shown or combinations[0].claim, **fields)
    return OverChoices(combinations=combinations, shown=shown, tolerance=shown.tolerance)


def text_of_value(value: float | str) -> str:
    """Return the value of a choice as text: a name as it is, or a formatted number."""
    return value if isinstance(value, str) else setting(value)
