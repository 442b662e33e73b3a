"""Claims about the transition from crack to pulse, and where a front ends, at every choice the paper leaves open."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from ..measure.fronts import straight_line
from . import rules
from .choices import LAST, Chosen, named, over_choices
from .evidence import NAN, Claim, Evidence, agreeing, ratios

# At or below -1 the printed threshold, which has two sides, lets the pre-stress itself slide back.
INSIDE = "left > -1"
# A front that ends within this of x_minus, in units of H, is within the smallest length of the model.
GAP = 1.0
# What each is called, and what the paper estimates it by under a stress boundary.
ESTIMATES = {"T": ("time", "distance"), "L": ("length", "2 * distance")}
# Fraction of the way whose numbers stand with a claim.
SHOWN = 0.95

# What is compared of the exact solution, and of lattices.
SOLVED = {"paper_transition_time": "distance", "transition_time": "time", "transition_length": "length"}
SIMULATED = {
    "balance_distance": "distance",
    "last_release_distance": "covered",
    "last_release_time": "time",
    "last_release_length": "length",
}
# One table, or one a lattice, by combination of choices.
Tables = list[tuple[Chosen, list[pd.DataFrame]]]


def transition_claims(evidence: Evidence) -> list[Claim]:
    """T_trans and L_trans under both boundary conditions, the position of arrest, and how they depend on what."""
    others = (diverges, arrest_position, speeds_near_one, underestimate, shorter_at_low, pulses_widen)
    return [
        *(displacement(evidence, name) for name in ESTIMATES),
        *(stress(evidence, name) for name in ESTIMATES),
        *(judge(evidence) for judge in others),
    ]


def chosen(tables: list[pd.DataFrame], **more: float | str) -> Chosen:
    """The release rule and the damping ratio of runs that have them in common."""
    return {name: tables[0][name].iloc[0] for name in ("release", "damping_ratio")} | more


def simulated(evidence: Evidence, boundary: str, where: str = "") -> Tables:
    """Runs of figure 5, and those of the figures with more damping that are undamped, on three lattices."""
    runs = [evidence.lattices(f"scaling_{boundary}", where=where)]
    undamped = " and ".join(filter(None, [where, "damping_ratio == 0"]))
    runs.append(evidence.lattices(f"damping_{boundary}", where=undamped))
    return [(chosen(tables, solution="lattice"), tables) for tables in runs if len(tables[0])]


def solved(evidence: Evidence, boundary: str) -> Tables:
    """The exact solution at each combination; ours first, by the damping of figure 5."""
    names = ["release", "damping_ratio", *(["nucleation", "fraction"] if boundary == "stress" else [])]
    table = evidence.tables["open_choices"].query(f"boundary == {boundary!r} and {INSIDE}")
    found: Tables = [
        (dict(zip(names, values, strict=True)) | {"solution": "exact"}, [rows])
        for values, rows in table.groupby(names)
    ]
    ours = chosen(evidence.lattices(f"scaling_{boundary}"), fraction=SHOWN)
    return sorted(found, key=lambda pair: any(pair[0].get(name, ours[name]) != ours[name] for name in ours))


def displacement(evidence: Evidence, name: str) -> Claim:
    """An estimate under a displacement boundary, at the first stick."""
    id, quantity = f"{name}_trans_displacement", f"transition_{ESTIMATES[name][0]}"
    claims = [
        (choice, evidence.approximate(id, tables, quantity, f"paper_{quantity}", "left", "gamma"))
        for choice, tables in simulated(evidence, "displacement") + solved(evidence, "displacement")
    ]
    return over_choices(claims) | evidence.compared("scaling_displacement", quantity)


def arrests(evidence: Evidence, where: str = INSIDE) -> Tables:
    """When the left front has covered fractions of |x_minus| by the exact solution, and its last release on lattices.

    Returns
    -------
    tables with distance (|x_minus|), covered, time, length (between the fronts)
    """
    found = [
        (choice, [rows.rename(columns=SOLVED).eval("covered = fraction * distance") for rows in tables])
        for choice, tables in solved(evidence, "stress")
    ]
    runs = simulated(evidence, "stress", where)
    last: Chosen = {"nucleation": "Gaussian", "fraction": LAST}
    return found + [(choice | last, [t.rename(columns=SIMULATED) for t in tables]) for choice, tables in runs]


def at_ours(tables: Tables) -> Tables:
    """Those of our own release rule and damping, by the exact solution and on lattices."""
    ours = {name: tables[0][0][name] for name in ("release", "damping_ratio", "nucleation")}
    return [pair for pair in tables if ours.items() <= pair[0].items()]


def at_fractions(evidence: Evidence, judge: Callable[[list[pd.DataFrame]], Claim]) -> Claim:
    """A claim judged at each combination; beside its numbers the medians at each fraction, the rest being ours."""
    tables = arrests(evidence)
    further = {
        f"median ratio: at {named(choice['fraction'])}": judge(found)["measured"]
        for choice, found in sorted(at_ours(tables), key=lambda pair: named(pair[0]["fraction"]))
    }
    return over_choices([(choice, judge(found)) for choice, found in tables]) | {"further": further}


def stress(evidence: Evidence, name: str) -> Claim:
    """An estimate under a stress boundary, at each fraction and at the last release."""
    id, estimate = f"{name}_trans_stress", ESTIMATES[name]

    def judge(tables: list[pd.DataFrame]) -> Claim:
        return evidence.approximate(id, tables, *estimate, "left", "width")

    claim = at_fractions(evidence, judge) | evidence.compared("scaling_stress", f"transition_{estimate[0]}")
    fractions, ratio = zip(*sorted(medians(evidence, *estimate).items()), strict=True)
    over = np.array(ratio) - 1.0
    reached = float(np.interp(evidence.tolerance(id), over, fractions, left=NAN, right=NAN))
    name = "fraction of the way at which the median ratio leaves the tolerance"
    return claim | {"further": claim["further"] | {name: reached}}


def medians(evidence: Evidence, measured: str, predicted: str) -> dict[float, float]:
    """Median ratio at each fraction of the way, by the exact solution at our release rule and damping."""
    return {
        float(choice["fraction"]): float(np.nanmedian(ratios(tables[0], measured, predicted)))
        for choice, tables in at_ours(arrests(evidence))
        if choice["fraction"] != LAST
    }


def speeds_near_one(evidence: Evidence) -> Claim:
    """Mean speeds of both fronts; the front that is farther off counts."""
    id = "stress_front_speeds_near_one"

    def judge(tables: list[pd.DataFrame]) -> Claim:
        ways = {"left": "covered", "right": "(length - covered)"}
        fronts = [
            evidence.approximate(id, tables, f"{way} / time", "1")
            | {"note": f"mean speed of the {side} front, which is the farther off"}
            for side, way in ways.items()
        ]
        return max(fronts, key=lambda claim: claim.get("deviation", NAN))

    return at_fractions(evidence, judge)


def underestimate(evidence: Evidence) -> Claim:
    """T_trans is longer than |x_minus|, in every run."""

    def judge(tables: list[pd.DataFrame]) -> Claim:
        longer = [table["time"] > table["distance"] for table in tables[:2]]
        return evidence.qualitative("T_trans_stress_underestimate", agreeing(longer[0], longer[-1]))

    return over_choices([(choice, judge(tables)) for choice, tables in arrests(evidence)])


def arrest_position(evidence: Evidence) -> Claim:
    """The last release on the left over |x_minus|, for every profile and damping; and the gap in units of H."""
    id, what = "front_arrest_position", ("last_release_distance", "balance_distance")
    sweeps = ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")

    def judge(tables: list[pd.DataFrame]) -> Claim:
        claim = evidence.approximate(id, tables, *what, "left", "width")
        gap = evidence.studied(tables, lambda t: float((t[what[1]] - t[what[0]]).abs().median()))
        far = rules.within(gap.value, gap.uncertainty, GAP)
        further = {"median gap in H, over all sweeps": gap.value}
        return claim | {"verdict": rules.worst([claim["verdict"], far]), "further": further}

    whole = evidence.lattices(*sweeps, where=INSIDE)
    claims = []
    for ratio in sorted({*evidence.tables["open_choices"]["damping_ratio"]} & {*whole[0]["damping_ratio"]}):
        tables = evidence.lattices(*sweeps, where=f"{INSIDE} and damping_ratio == {ratio}")
        claims.append((chosen(tables, solution="lattice"), judge(tables)))
    shown, ratio = judge(whole), ratios(whole[0], *what)
    extremes = {"smallest ratio": float(np.nanmin(ratio)), "largest ratio": float(np.nanmax(ratio))}
    return over_choices(claims, shown | {"further": shown["further"] | extremes})


def diverges(evidence: Evidence) -> Claim:
    """T_trans and L_trans grow at every step down in gamma, with exponents below zero."""
    quantities = {"T": "transition_time", "L": "transition_length"}

    def power(rows: pd.DataFrame, quantity: str) -> tuple[float, float, float]:
        return straight_line(np.log(rows["gamma"]), np.log(rows[quantity]))

    def grows_without_bound(rows: pd.DataFrame) -> bool | None:
        if len(rows) < 3:
            return None
        lines = [power(rows.head(3), quantity) for quantity in quantities.values()]
        falls = [(np.diff(rows[quantity]) < 0.0).all() for quantity in quantities.values()]
        return bool(all(falls) and all(slope + 3.0 * error < 0.0 for slope, _, error in lines))

    tables = [table.sort_values("gamma") for table in evidence.lattices("scaling_displacement")]
    finest, middle = ([grows_without_bound(rows) for _, rows in t.groupby("left")] for t in tables[:2])
    smallest = tables[0][tables[0]["gamma"].isin(tables[0]["gamma"].unique()[:3])]
    exponents = {
        rf"mean exponent of $\gamma$ in ${name}_\mathrm{{trans}}$": float(
            np.mean([power(rows, quantity)[0] for _, rows in smallest.groupby("left")])
        )
        for name, quantity in quantities.items()
    }
    return evidence.qualitative("transition_diverges", agreeing(finest, middle)) | {"further": exponents}


def rises(evidence: Evidence, id: str, table: pd.DataFrame, quantity: str) -> Claim:
    """Whether each step up in the pre-stress, at each gamma, makes a number larger; undecided within uncertainties."""
    decided: list[bool | None] = []
    unsure = f"uncertainty_{quantity}"
    for _, rows in table.assign(**{unsure: table.get(unsure, 0.0)}).sort_values("left").groupby("gamma"):
        change, blur = rows[quantity].diff()[1:], rows[unsure].rolling(2).sum()[1:]
        decided += [bool(c > 0.0) if abs(c) > b else None for c, b in zip(change, blur, strict=True)]
    return evidence.qualitative(id, decided)


def shorter_at_low(evidence: Evidence) -> Claim:
    """The transition gets longer with the pre-stress."""
    return over_choices(
        [
            (choice, rises(evidence, "shorter_transition_low_prestress", tables[0], "transition_length"))
            for choice, tables in simulated(evidence, "displacement") + solved(evidence, "displacement")
        ]
    )


def pulses_widen(evidence: Evidence) -> Claim:
    """The pulse gets wider with the pre-stress."""
    table = evidence.lattices("any_prestress")[0]
    return rises(evidence, "pulses_widen_with_prestress", table, "pulse_width")
