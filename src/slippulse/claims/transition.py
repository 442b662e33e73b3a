"""Claims about the transition from crack to pulse, and where a front ends, at every choice the paper leaves open."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from itertools import permutations
from typing import Any

import numpy as np
import pandas as pd

from ..data.numerals import percent, setting
from ..measure.fronts import straight_line
from . import rules
from .evidence import NAN, Claim, Evidence, agreeing, ratios

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
# At or below -1 the printed threshold, which has two sides, lets the pre-stress itself slide back.
INSIDE = "left > -1"
# A front that ends within this of x_minus, in units of H, is within the smallest length of the model.
GAP = 1.0
# What each is called, and what the paper estimates it by under a stress boundary.
ESTIMATES = {"T": ("time", "distance"), "L": ("length", "2 * distance")}
# Fraction of the way whose numbers stand with a claim.
SHOWN = 0.95

# What is compared of the exact solution, and of lattices.
SOLVED = {
    "paper_transition_time": "distance",
    "transition_time": "time",
    "transition_length": "length",
}
SIMULATED = {"balance_distance": "distance", "last_release_distance": "covered"}
SIMULATED |= {f"last_release_{name}": name for name in ("time", "length")}
# One table, or one a lattice, by combination of choices.
Tables = list[tuple[Chosen, list[pd.DataFrame]]]


def over_choices(pairs: Sequence[tuple[Chosen, Claim]], shown: Claim | None = None) -> Claim:
    """One claim from those at all combinations of choices, with the numbers of the first one, or of ``shown``."""
    claims = [claim for _, claim in pairs]
    rows: list[dict[str, Any]] = [
        choice
        | {name: claim.get(name) for name in FOUND}
        | {"holds": rules.HOLDS.get(claim["verdict"])}
        for choice, claim in pairs
    ]
    verdict, decided = rules.over_choices([row["verdict"] for row in rows]), decisive(rows)
    found = (shown or claims[0]) | {
        "choices": rows, "choice": next(iter(decided), ""), "verdict": verdict,
        "combinations": len(rows), "holds_at": sum(row["holds"] is True for row in rows),
    }  # fmt: skip
    if all("at" in claim for claim in claims):
        found["at"] = lambda tolerance: rules.over_choices(
            [claim["at"](tolerance) for claim in claims]
        )
    if verdict == rules.DEPENDS:
        pairs_of = [sides(name, pair, "held" in found) for name, pair in decided.items()]
        found["why"] = f"It holds at {found['holds_at']} of {len(rows)} combinations."
        found["why"] += f" It depends on {'; on '.join(pairs_of)}."
    elif verdict == "reproduced with caveat":
        unsure = next(row for row in rows if row["verdict"] == verdict)
        at = [f"{words} {named(unsure[name])}" for name, words in NAMES.items() if name in unsure]
        found["why"] = (
            f"With {' and '.join(at)} it is within the tolerance, but not together with its uncertainty."
        )
    return found


def sides(name: str, pair: Iterable[Mapping], counted: bool) -> str:
    """What combinations say of a claim, by their value of one choice; ``counted``: by runs, not by a deviation."""
    parts = []
    for row in pair:
        size = percent(row["deviation"], 3) + (" of the runs against" if counted else "")
        size += (
            ", at the last release" if name != "fraction" and row.get("fraction") == LAST else ""
        )
        parts.append(f"it {'holds' if row['holds'] else 'fails'} at {named(row[name])} ({size})")
    return f"{NAMES[name]}: {' and '.join(parts)}"


def named(value: float | str) -> str:
    """A value of a choice."""
    return value if isinstance(value, str) else setting(value)


def decisive(choices: Sequence[Mapping]) -> dict[str, Sequence[Mapping]]:
    """Choices that, changed alone, decide whether a claim holds, first the one that moves the deviation most.

    Each with the closest combinations of which one holds and one fails; where none decides, that one choice.
    """
    moves: dict[str, list[tuple[tuple[bool, float], Mapping, Mapping]]] = {}
    for one, other in permutations(choices, 2):
        apart = [name for name in {*one, *other} - {*FOUND} if one.get(name) != other.get(name)]
        if (
            len(apart) == 1
            and apart[0] in NAMES
            and None not in (one["deviation"], other["deviation"])
        ):
            # A lattice is a corner; the exact solution has every combination.
            move = one.get("solution") == "exact", abs(one["deviation"] - other["deviation"])
            moves.setdefault(apart[0], []).append((move, one, other))
    order = sorted(moves, key=lambda name: max(move for move, *_ in moves[name]))
    closest: dict[str, Sequence[Mapping]] = {}
    for name in reversed(order):
        if pairs := [
            each for each in moves[name] if each[1]["holds"] and each[2]["holds"] is False
        ]:
            closest[name] = min(pairs, key=lambda each: each[0][1])[1:]
    return closest or dict.fromkeys(order[-1:], ())


# What claims are judged by


def chosen(tables: list[pd.DataFrame], **more: float | str) -> Chosen:
    """The release rule and the damping ratio of runs that have them in common."""
    return {name: tables[0][name].iloc[0] for name in ("release", "damping_ratio")} | more


def simulated(evidence: Evidence, boundary: str, where: str = "") -> Tables:
    """Runs of figure 5, and those of the figures with more damping that are undamped, on three lattices."""
    undamped = " and ".join(filter(None, [where, "damping_ratio == 0"]))
    sweeps = {f"scaling_{boundary}": where, f"damping_{boundary}": undamped}
    runs = [evidence.lattices(name, where=where) for name, where in sweeps.items()]
    return [(chosen(tables, solution="lattice"), tables) for tables in runs if len(tables[0])]


def solved(evidence: Evidence, boundary: str) -> Tables:
    """The exact solution at each combination; ours first, by the damping of figure 5."""
    names = [
        "release",
        "damping_ratio",
        *(["nucleation", "fraction"] if boundary == "stress" else []),
    ]
    table = evidence.tables["open_choices"].query(f"boundary == {boundary!r} and {INSIDE}")
    # Under a stress boundary the estimate of the time is the whole way.
    table = table.assign(covered=table["fraction"] * table["paper_transition_time"])
    found: Tables = []
    for values, rows in table.groupby(names):
        found.append((dict(zip(names, values, strict=True)) | {"solution": "exact"}, [rows]))
    ours = chosen(evidence.lattices(f"scaling_{boundary}"), fraction=SHOWN)
    return sorted(
        found, key=lambda pair: any(pair[0].get(name, ours[name]) != ours[name] for name in ours)
    )


@cache
def arrests(evidence: Evidence) -> Tables:
    """When the left front has covered fractions of |x_minus| by the exact solution, and its last release on lattices.

    Columns are distance (|x_minus|), covered, time, length (between the fronts).
    """
    last: Chosen = {"nucleation": "Gaussian", "fraction": LAST}
    exact, lattices = solved(evidence, "stress"), simulated(evidence, "stress", INSIDE)
    return [
        (choice, [rows.rename(columns=SOLVED) for rows in tables]) for choice, tables in exact
    ] + [
        (choice | last, [rows.rename(columns=SIMULATED) for rows in tables])
        for choice, tables in lattices
    ]


def at_ours(tables: Sequence[tuple[Chosen, Any]]) -> list[tuple[Chosen, Any]]:
    """Those of our own release rule and damping, by the exact solution and on lattices."""
    ours = {name: tables[0][0][name] for name in ("release", "damping_ratio", "nucleation")}
    return [pair for pair in tables if ours.items() <= pair[0].items()]


def medians(evidence: Evidence, measured: str, predicted: str) -> dict[float, float]:
    """Median ratio at each fraction of the way, by the exact solution at our release rule and damping."""
    return {
        float(choice["fraction"]): float(ratios(tables[0], measured, predicted).median())
        for choice, tables in at_ours(arrests(evidence))
        if choice["fraction"] != LAST
    }


def T_trans_displacement(evidence: Evidence, id: str) -> Claim:
    """An estimate under a displacement boundary, at the first stick."""
    quantity = f"transition_{ESTIMATES[id[0]][0]}"
    pairs = [
        (choice, evidence.approximate(id, found, quantity, f"paper_{quantity}", "left", "gamma"))
        for choice, found in simulated(evidence, "displacement") + solved(evidence, "displacement")
    ]
    return over_choices(pairs) | evidence.compared("scaling_displacement", quantity)


def at_fractions(evidence: Evidence, judge: Callable[[list[pd.DataFrame]], Claim]) -> Claim:
    """A claim judged at each combination; beside its numbers the medians at each fraction, the rest being ours."""
    pairs = [(choice, judge(found)) for choice, found in arrests(evidence)]
    ours = {
        f"median ratio: at {named(choice['fraction'])}": found["measured"]
        for choice, found in at_ours(pairs)
    }
    return over_choices(pairs) | {"further": dict(sorted(ours.items()))}


def T_trans_stress(evidence: Evidence, id: str) -> Claim:
    """An estimate under a stress boundary, at each fraction and at the last release."""
    estimate = ESTIMATES[id[0]]
    claim = at_fractions(
        evidence, lambda found: evidence.approximate(id, found, *estimate, "left", "width")
    )
    claim |= evidence.compared("scaling_stress", f"transition_{estimate[0]}")
    fractions, ratio = zip(*sorted(medians(evidence, *estimate).items()), strict=True)
    over = np.array(ratio) - 1.0
    left = np.interp(evidence.tolerance(id), over, fractions, left=NAN, right=NAN)
    claim["further"]["fraction of the way at which the median ratio leaves the tolerance"] = float(
        left
    )
    return claim


def stress_front_speeds_near_one(evidence: Evidence, id: str) -> Claim:
    """Mean speeds of both fronts; the front that is farther off counts."""
    ways = {"left": "covered", "right": "(length - covered)"}

    def judge(tables: list[pd.DataFrame]) -> Claim:
        fronts = {
            side: evidence.approximate(id, tables, f"{way} / time", "1")
            for side, way in ways.items()
        }
        side = max(fronts, key=lambda name: fronts[name].get("deviation", NAN))
        return fronts[side] | {"note": f"mean speed of the {side} front, which is the farther off"}

    return at_fractions(evidence, judge)


def T_trans_stress_underestimate(evidence: Evidence, id: str) -> Claim:
    """T_trans is longer than |x_minus|, in every run."""
    pairs = []
    for choice, tables in arrests(evidence):
        longer = [table["time"] > table["distance"] for table in tables[:2]]
        pairs.append((choice, evidence.qualitative(agreeing(longer[0], longer[-1]))))
    return over_choices(pairs)


def front_arrest_position(evidence: Evidence, id: str) -> Claim:
    """The last release on the left over |x_minus|, for every profile and damping; and the gap in units of H."""
    what = "last_release_distance", "balance_distance"
    sweeps = ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")

    def judge(tables: list[pd.DataFrame]) -> Claim:
        claim = evidence.approximate(id, tables, *what, "left", "width")
        gap = evidence.studied(tables, [(t[what[1]] - t[what[0]]).abs().median() for t in tables])
        far = rules.within(gap.value, gap.uncertainty, GAP)
        further = {"median gap in H, over all sweeps": gap.value}
        return claim | {"verdict": rules.worst([claim["verdict"], far]), "further": further}

    whole = evidence.lattices(*sweeps, where=INSIDE)
    shown, ratio = judge(whole), ratios(whole[0], *what)
    shown["further"] |= {"smallest ratio": float(ratio.min()), "largest ratio": float(ratio.max())}
    pairs = []
    for damping in sorted(
        {*evidence.tables["open_choices"]["damping_ratio"]} & {*whole[0]["damping_ratio"]}
    ):
        tables = evidence.lattices(*sweeps, where=f"{INSIDE} and damping_ratio == {damping}")
        pairs.append((chosen(tables, solution="lattice"), judge(tables)))
    return over_choices(pairs, shown)


def transition_diverges(evidence: Evidence, id: str) -> Claim:
    """T_trans and L_trans grow at every step down in gamma, with exponents below zero at the smallest three."""
    quantities, decided, slopes = ["transition_time", "transition_length"], [], []
    for table in evidence.lattices("scaling_displacement")[:2]:
        found: list[bool | None] = []
        for _, rows in table.sort_values("gamma").groupby("left"):
            smallest = np.log(rows[["gamma", *quantities]].head(3))
            lines = [
                straight_line(smallest["gamma"], smallest[quantity]) for quantity in quantities
            ]
            falls = (rows[quantities].diff()[1:] < 0.0).all(axis=None)
            grows = bool(falls and all(slope + 3.0 * error < 0.0 for slope, _, error in lines))
            found.append(grows if len(rows) >= 3 else None)
            slopes.append([slope for slope, *_ in lines])
        decided.append(found)
    means = np.mean(slopes[: len(decided[0])], axis=0)
    further = {
        rf"mean exponent of $\gamma$ in ${name}_\mathrm{{trans}}$": float(mean)
        for name, mean in zip(ESTIMATES, means, strict=True)
    }
    return evidence.qualitative(agreeing(*decided)) | {"further": further}


def rises(evidence: Evidence, table: pd.DataFrame, quantity: str) -> Claim:
    """Whether each step up in the pre-stress, at each gamma, makes a number larger; undecided within uncertainties."""
    decided: list[bool | None] = []
    unsure = f"uncertainty_{quantity}"
    for _, rows in (
        table.assign(**{unsure: table.get(unsure, 0.0)}).sort_values("left").groupby("gamma")
    ):
        change, blur = rows[quantity].diff()[1:], rows[unsure].rolling(2).sum()[1:]
        decided += [
            bool(c > 0.0) if abs(c) > b else None for c, b in zip(change, blur, strict=True)
        ]
    return evidence.qualitative(decided)


def shorter_transition_low_prestress(evidence: Evidence, id: str) -> Claim:
    """The transition gets longer with the pre-stress."""
    both = simulated(evidence, "displacement") + solved(evidence, "displacement")
    return over_choices(
        [(each, rises(evidence, found[0], "transition_length")) for each, found in both]
    )


def pulses_widen_with_prestress(evidence: Evidence, id: str) -> Claim:
    """The pulse gets wider with the pre-stress."""
    return rises(evidence, evidence.lattices("any_prestress")[0], "pulse_width")


# Times and lengths are judged alike.
L_trans_displacement, L_trans_stress = T_trans_displacement, T_trans_stress
