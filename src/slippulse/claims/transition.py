"""Claims about the transition from crack to pulse, and where a front ends."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd

from ..measure.fronts import straight_line
from . import rules
from .choices import over_choices
from .evidence import NAN, Claim, Evidence, agreeing, ratios

# Percent of |x_minus| at which a time that has no end is judged.
PERCENT = (90, 95, 99)
# A front that ends within this of x_minus, in units of H, is within the smallest length of the model.
GAP = 1.0
# What each is called, and what the paper estimates it by under a stress boundary.
ESTIMATES = {"T": ("time", "distance"), "L": ("length", "2 * distance")}
# Whether each step up in the pre-stress, at each gamma, makes a number larger.
RISING = {
    "shorter_transition_low_prestress": ("scaling_displacement", "transition_length"),
    "pulses_widen_with_prestress": ("any_prestress", "pulse_width"),
}


def transition_claims(evidence: Evidence) -> list[Claim]:
    """T_trans and L_trans under both boundary conditions, the position of arrest, and how they depend on what."""
    others = (diverges, arrest_position, speeds_near_one, underestimate)
    return [
        *(displacement(evidence, name) for name in ESTIMATES),
        *(stress(evidence, name) for name in ESTIMATES),
        *(judge(evidence) for judge in others),
        *(rises(evidence, id, *row) for id, row in RISING.items()),
    ]


def displacement(evidence: Evidence, name: str) -> Claim:
    """An estimate under a displacement boundary, at the first stick."""
    id, sweep, quantity = (
        f"{name}_trans_displacement",
        "scaling_displacement",
        f"transition_{ESTIMATES[name][0]}",
    )
    tables = evidence.lattices(sweep)
    claim = evidence.approximate(id, tables, quantity, f"paper_{quantity}", "left", "gamma")
    return claim | evidence.compared(sweep, quantity)


def stress(evidence: Evidence, name: str) -> Claim:
    """An estimate under a stress boundary, at each fraction and at the last release."""
    id, estimate = f"{name}_trans_stress", ESTIMATES[name]
    claim = at_fractions(
        evidence, lambda tables: evidence.approximate(id, tables, *estimate, "left", "width")
    )
    return claim | evidence.compared("scaling_stress", f"transition_{estimate[0]}")


def arrests(evidence: Evidence) -> dict[str, list[pd.DataFrame]]:
    """When the left front has covered fractions of |x_minus| by the exact solution, and its last release on lattices.

    Returns
    -------
    by where that is: one table, or one a lattice, with distance (|x_minus|), covered, time, length (between the fronts)
    """
    lattices = evidence.lattices("scaling_stress")
    exact = lattices[0].assign(distance=lattices[0]["exact_balance_distance"])
    found = {
        f"at {percent} %": [
            exact.assign(
                covered=0.01 * percent * exact["distance"],
                time=exact[f"exact_arrest_time_{percent}"],
                length=exact[f"exact_arrest_length_{percent}"],
            )
        ]
        for percent in PERCENT
    }
    names = {f"last_release_{name}": name for name in ("time", "length")}
    names |= {"balance_distance": "distance", "last_release_distance": "covered"}
    return found | {"at the last release": [table.rename(columns=names) for table in lattices]}


def at_fractions(evidence: Evidence, judge: Callable[[list[pd.DataFrame]], Claim]) -> Claim:
    """A claim judged at each fraction (exact) and at the last release; its numbers are the middle one's."""
    judged = {where: judge(tables) for where, tables in arrests(evidence).items()}
    further = {f"median ratio {where}": claim.get("measured") for where, claim in judged.items()}
    rows = [({"fraction": where.removeprefix("at ")}, claim) for where, claim in judged.items()]
    rows.insert(0, rows.pop(1))
    return over_choices(rows) | {"further": further}


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

    medians = {
        f"median factor {where}": float(np.nanmedian(ratios(tables[0], "time", "distance")))
        for where, tables in arrests(evidence).items()
    }
    return at_fractions(evidence, judge) | {"further": medians}


def arrest_position(evidence: Evidence) -> Claim:
    """The last release on the left over |x_minus|, for every profile and damping; and the gap in units of H."""
    tables = evidence.lattices("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")
    what = "last_release_distance", "balance_distance"
    claim = evidence.approximate("front_arrest_position", tables, *what, "left", "width")
    gap = evidence.studied(tables, lambda t: float((t[what[1]] - t[what[0]]).abs().median()))
    ratio = ratios(tables[0], *what)
    further = {"smallest ratio": float(np.nanmin(ratio)), "largest ratio": float(np.nanmax(ratio))}
    verdict = rules.worst([claim["verdict"], rules.within(gap.value, gap.uncertainty, GAP)])
    return claim | {"verdict": verdict, "further": {"median gap in H": gap.value} | further}


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


def rises(evidence: Evidence, id: str, sweep: str, quantity: str) -> Claim:
    """A claim of `RISING`; a step is undecided within the uncertainties."""
    decided: list[bool | None] = []
    for _, rows in evidence.lattices(sweep)[0].sort_values("left").groupby("gamma"):
        change, blur = rows[quantity].diff()[1:], rows[f"uncertainty_{quantity}"].rolling(2).sum()[1:]
        decided += [bool(c > 0.0) if abs(c) > b else None for c, b in zip(change, blur, strict=True)]
    return evidence.qualitative(id, decided)
