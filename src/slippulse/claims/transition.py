"""Claims about the transition from crack to pulse, and about where a front ends.

Each is judged at every choice that the paper leaves open.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple, TypeVar

import numpy as np
import pandas as pd

from ..measurement.fronts import straight_line
from . import rules
from .choices import LAST, Chosen, Combination, OverChoices, named, over_choices
from .evidence import Evidence, agreeing, ratios, studied
from .kinds import NAN, Approximate, Claim, Qualitative

# At or below -1 the printed threshold, which has two sides, lets the pre-stress itself slide back.
INSIDE = "left > -1"
# The smallest length of the model, in H: a front that ends so near to x_minus ends there.
GAP = 1.0
# Fraction of the way whose numbers stand with a claim.
SHOWN = 0.95
# Columns of the exact solution and of lattices, by their names in `arrests`.
SOLVED = {
    "paper_transition_time": "distance",
    "transition_time": "time",
    "transition_length": "length",
}
SIMULATED = {
    "balance_distance": "distance",
    "last_release_distance": "covered",
    "last_release_time": "time",
    "last_release_length": "length",
}


class Estimate(NamedTuple):
    """A quantity of the transition, and the expression for it under held stress."""

    symbol: str
    quantity: str
    predicted: str


DURATION = Estimate("T", "time", "distance")
LENGTH = Estimate("L", "length", "2 * distance")


class Runs(NamedTuple):
    """Runs at one combination of choices: a table for each lattice, or one of exact solutions."""

    choice: Chosen
    tables: list[pd.DataFrame]


AtChoice = TypeVar("AtChoice", Runs, Combination)


def shared(tables: list[pd.DataFrame]) -> Chosen:
    """The release rule and the damping ratio that runs have in common."""
    return {name: tables[0][name].iloc[0] for name in ("release", "damping_ratio")}


def on_lattices(tables: list[pd.DataFrame]) -> Runs:
    """Simulated runs with their choices."""
    return Runs(shared(tables) | {"solution": "lattice"}, tables)


def simulated(evidence: Evidence, boundary: str, where: str = "") -> list[Runs]:
    """Runs of figure 5, and the undamped ones of the figures with more damping."""
    undamped = f"{where} and damping_ratio == 0" if where else "damping_ratio == 0"
    sweeps = {f"scaling_{boundary}": where, f"damping_{boundary}": undamped}
    levels = [evidence.lattices(name, where=condition) for name, condition in sweeps.items()]
    return [on_lattices(tables) for tables in levels if len(tables[0])]


def solved(evidence: Evidence, boundary: str) -> list[Runs]:
    """The exact solution at each combination of choices; first ours, with the damping of figure 5.

    Under held stress ours is at the fraction `SHOWN` of the way.
    """
    names = ["release", "damping_ratio"]
    if boundary == "stress":
        names += ["nucleation", "fraction"]
    table = evidence.tables["open_choices"].query(f"boundary == {boundary!r} and {INSIDE}")
    # Under held stress the estimate of the time is for the whole way.
    table = table.assign(covered=table["fraction"] * table["paper_transition_time"])
    combinations = []
    for values, rows in table.groupby(names):
        choice: Chosen = dict(zip(names, values, strict=True))
        combinations.append(Runs(choice | {"solution": "exact"}, [rows]))
    ours = shared(evidence.lattices(f"scaling_{boundary}")) | {"fraction": SHOWN}

    def differs(runs: Runs) -> bool:
        return any(runs.choice.get(name, value) != value for name, value in ours.items())

    return sorted(combinations, key=differs)


def first_sticks(evidence: Evidence) -> list[Runs]:
    """Runs with the transition at the first stick, under a displacement boundary."""
    return simulated(evidence, "displacement") + solved(evidence, "displacement")


@cache
def arrests(evidence: Evidence) -> list[Runs]:
    """Runs of the left front under held stress, with the same columns for theory and lattices.

    The exact solution is at several fractions of the way to x_minus, lattices at the last release.
    Columns are distance (|x_minus|), covered, time and length (between the fronts).
    """
    last: Chosen = {"nucleation": "Gaussian", "fraction": LAST}
    out = []
    for choice, (table,) in solved(evidence, "stress"):
        out.append(Runs(choice, [table.rename(columns=SOLVED)]))
    for choice, tables in simulated(evidence, "stress", INSIDE):
        out.append(Runs(choice | last, [table.rename(columns=SIMULATED) for table in tables]))
    return out


def ours(combinations: Sequence[AtChoice]) -> list[AtChoice]:
    """The combinations with our own release rule, damping and nucleation."""
    first = combinations[0].choice
    choice = {name: first[name] for name in ("release", "damping_ratio", "nucleation")}
    return [one for one in combinations if choice.items() <= one.choice.items()]


def medians(evidence: Evidence, estimate: Estimate) -> dict[float, float]:
    """Median ratio of measured to predicted at each fraction of the way, by the exact solution."""
    out = {}
    for choice, tables in ours(arrests(evidence)):
        if choice["fraction"] != LAST:
            ratio = ratios(tables[0], estimate.quantity, estimate.predicted)
            out[float(choice["fraction"])] = float(ratio.median())
    return out


def judged(
    combinations: Iterable[Runs], judge: Callable[[list[pd.DataFrame]], Claim]
) -> list[Combination]:
    """A claim judged at each combination."""
    return [Combination(choice, judge(tables)) for choice, tables in combinations]


def held_displacement(evidence: Evidence, id: str, estimate: Estimate) -> OverChoices:
    """An estimate under a displacement boundary, at the first stick."""
    quantity = f"transition_{estimate.quantity}"

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        return evidence.approximate(id, tables, quantity, f"paper_{quantity}", ("left", "gamma"))

    exact = evidence.from_exact("scaling_displacement", quantity)
    return over_choices(judged(first_sticks(evidence), judge), from_exact=exact)


def fraction_medians(combinations: Sequence[Combination]) -> dict[str, float]:
    """The median ratio at each fraction of the way, the other choices being ours."""
    numbers = {}
    for combination in ours(combinations):
        words = f"median ratio: at {named(combination.choice['fraction'])}"
        numbers[words] = combination.claim.fields().get("measured", NAN)
    return dict(sorted(numbers.items()))


def held_stress(evidence: Evidence, id: str, estimate: Estimate) -> OverChoices:
    """An estimate under a stress boundary, at each fraction of the way and at the last release."""

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        levels = ("left", "width")
        return evidence.approximate(id, tables, estimate.quantity, estimate.predicted, levels)

    combinations = judged(arrests(evidence), judge)
    exact = evidence.from_exact("scaling_stress", f"transition_{estimate.quantity}")
    further = fraction_medians(combinations)
    fractions, ratio = zip(*sorted(medians(evidence, estimate).items()), strict=True)
    excess = np.array(ratio) - 1.0
    # NaN if the ratio is within the tolerance all the way, or never.
    leaves = np.interp(evidence.tolerance(id), excess, fractions, left=NAN, right=NAN)
    words = "fraction of the way at which the median ratio leaves the tolerance"
    return over_choices(combinations, from_exact=exact, further=further | {words: float(leaves)})


def stress_front_speeds_near_one(evidence: Evidence, id: str) -> OverChoices:
    """Mean speeds of both fronts; the front with the larger deviation counts."""

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        left = evidence.approximate(id, tables, "covered / time", "1")
        right = evidence.approximate(id, tables, "(length - covered) / time", "1")
        side, front = ("right", right) if right.median[0] > left.median[0] else ("left", left)
        return replace(front, note=f"mean speed of the {side} front, which is the farther off")

    combinations = judged(arrests(evidence), judge)
    return over_choices(combinations, further=fraction_medians(combinations))


def transition_time_underestimated(evidence: Evidence, id: str) -> OverChoices:
    """T_trans is longer than |x_minus|, in every run."""

    def judge(tables: list[pd.DataFrame]) -> Qualitative:
        longer = [table["time"] > table["distance"] for table in tables[:2]]
        return Qualitative.counted(agreeing(longer[0], longer[-1]))

    return over_choices(judged(arrests(evidence), judge))


def front_arrest_position(evidence: Evidence, id: str) -> OverChoices:
    """The last release on the left over |x_minus|, for every profile and damping.

    The distance between the two, in units of H, must be small besides.
    """
    sweeps = ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")
    covered, predicted = "last_release_distance", "balance_distance"

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        claim = evidence.approximate(id, tables, covered, predicted, ("left", "width"))
        gaps = [(table[predicted] - table[covered]).abs().median() for table in tables]
        gap = studied(tables, gaps)
        further = {"median gap in H, over all sweeps": gap[0]}
        return replace(claim, besides=rules.within(*gap, GAP), further=further)

    tables = evidence.lattices(*sweeps, where=INSIDE)
    shown, ratio = judge(tables), ratios(tables[0], covered, predicted)
    extremes = {"smallest ratio": float(ratio.min()), "largest ratio": float(ratio.max())}
    runs = []
    dampings = {*evidence.tables["open_choices"]["damping_ratio"]}
    for damping in sorted(dampings & {*tables[0]["damping_ratio"]}):
        damped = evidence.lattices(*sweeps, where=f"{INSIDE} and damping_ratio == {damping}")
        runs.append(on_lattices(damped))
    return over_choices(judged(runs, judge), shown, further={**shown.further, **extremes})


def transition_diverges(evidence: Evidence, id: str) -> Qualitative:
    """T_trans and L_trans grow at every step down in gamma.

    Their exponents at the three smallest gamma are below zero by three standard errors.
    """
    answers, exponents = [], []
    for table in evidence.lattices("scaling_displacement")[:2]:
        sequences = table.sort_values("gamma").groupby("left")
        levels = [divergence(rows) for _, rows in sequences]
        answers.append([grows for grows, _ in levels])
        exponents.append([pair for _, pair in levels])
    means = np.mean(exponents[0], axis=0)
    further = {
        rf"mean exponent of $\gamma$ in ${estimate.symbol}_\mathrm{{trans}}$": float(mean)
        for estimate, mean in zip((DURATION, LENGTH), means, strict=True)
    }
    return Qualitative.counted(agreeing(*answers), further=further)


def divergence(rows: pd.DataFrame) -> tuple[bool | None, list[float]]:
    """The answer to whether runs in order of gamma diverge, and the exponents of T and L.

    The answer is None with fewer than three runs.
    """
    quantities = [f"transition_{estimate.quantity}" for estimate in (DURATION, LENGTH)]
    smallest = np.log(rows[["gamma", *quantities]].head(3))
    lines = [straight_line(smallest["gamma"], smallest[quantity]) for quantity in quantities]
    falls = (rows[quantities].diff()[1:] < 0.0).all(axis=None)
    grows = bool(falls and all(slope + 3.0 * error < 0.0 for slope, _, error in lines))
    return grows if len(rows) >= 3 else None, [slope for slope, *_ in lines]


def rises(table: pd.DataFrame, quantity: str) -> Qualitative:
    """At each gamma every step up in the pre-stress makes a quantity larger.

    A step within the uncertainties is undecided.
    """
    unsure = f"uncertainty_{quantity}"
    table = table.assign(**{unsure: table.get(unsure, 0.0)}).sort_values("left")
    decided: list[bool | None] = []
    for _, rows in table.groupby("gamma"):
        steps = rows[quantity].diff()[1:]
        uncertainties = rows[unsure].rolling(2).sum()[1:]
        for step, uncertainty in zip(steps, uncertainties, strict=True):
            decided.append(bool(step > 0.0) if abs(step) > uncertainty else None)
    return Qualitative.counted(decided)


def shorter_transition_low_prestress(evidence: Evidence, id: str) -> OverChoices:
    """The transition gets longer with the pre-stress."""
    lengths = judged(first_sticks(evidence), lambda tables: rises(tables[0], "transition_length"))
    return over_choices(lengths)


def pulses_widen_with_prestress(evidence: Evidence, id: str) -> Qualitative:
    """The pulse gets wider with the pre-stress."""
    return rises(evidence.finest("any_prestress"), "pulse_width")
