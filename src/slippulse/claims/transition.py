"""Claims about the transition from crack to pulse, and where a front ends."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd

from . import rules
from .evidence import NAN, Claim, Evidence, agreeing

# Fractions of |x_minus| at which a time that has no end is judged.
FRACTIONS = (0.9, 0.95, 0.99)
# A front that ends within this of x_minus, in units of H, is within the smallest length of the model.
GAP = 1.0
SWEEPS = {
    "displacement": ("scaling_displacement", ("left", "gamma")),
    "stress": ("scaling_stress", ("left", "width")),
}
ESTIMATES = {"T_trans": "time", "L_trans": "length"}
RISING = (
    ("shorter_transition_low_prestress", "scaling_displacement", "transition_length"),
    ("pulses_widen_with_prestress", "any_prestress", "pulse_width"),
)


def transition_claims(evidence: Evidence) -> list[Claim]:
    """T_trans and L_trans under both boundary conditions, the position of arrest, and how they depend on what."""
    return [
        *(displacement(evidence, name) for name in ESTIMATES), *(stress(evidence, name) for name in ESTIMATES),
        diverges(evidence), arrest_position(evidence), *(rises_with_prestress(evidence, *row) for row in RISING),
        speeds_near_one(evidence), underestimate(evidence),
    ]  # fmt: skip


def displacement(evidence: Evidence, name: str) -> Claim:
    """An estimate under a displacement boundary, at the first stick."""
    what, (sweep, levels) = ESTIMATES[name], SWEEPS["displacement"]
    quantity = f"transition_{what}"
    claim = evidence.approximate(
        f"{name}_displacement", evidence.lattices(sweep), quantity, f"paper_{quantity}", levels
    )
    return evidence.compared(claim, sweep, f"transition_{what}")


def arrests(evidence: Evidence) -> dict[str, list[pd.DataFrame]]:
    """When the left front has covered fractions of |x_minus| by the exact solution, and its last release on lattices.

    Returns
    -------
    by where that is: one table, or one a lattice, with distance (|x_minus|), time, length (between the fronts then),
    twice (the distance), one, and left_speed and right_speed (in the mean)
    """
    lattices = evidence.lattices("scaling_stress")
    table, found = lattices[0], {}
    for fraction in FRACTIONS:
        time, length = (table[f"exact_arrest_{what}_{100.0 * fraction:g}"] for what in ("time", "length"))
        covered = fraction * table["exact_balance_distance"]
        rows = _arrest(table, table["exact_balance_distance"], covered, time, length)
        found[f"at {100.0 * fraction:g} %"] = [rows]
    found["at the last release"] = [
        _arrest(
            t, t["balance_distance"], *(t[f"last_release_{name}"] for name in ("distance", "time", "length"))
        )
        for t in lattices
    ]
    return found


def _arrest(table: pd.DataFrame, distance, covered, time, length) -> pd.DataFrame:
    columns = table[table.columns.intersection(["left", "width", "factor"])]
    return columns.assign(
        distance=distance, time=time, length=length, twice=2.0 * distance, one=1.0, left_speed=covered / time,
        right_speed=(length - covered) / time,
    )  # fmt: skip


def at_fractions(evidence: Evidence, judge: Callable[[list[pd.DataFrame]], Claim]) -> Claim:
    """A claim judged at each fraction by the exact solution and at the last release, as `rules.at_fractions`.

    Its numbers are those of the middle fraction; the verdict at each says why.
    """
    claims = {where: judge(tables) for where, tables in arrests(evidence).items()}
    *verdicts, last = (claim.verdict for claim in claims.values())
    verdict = rules.at_fractions(verdicts, last)
    said = ", ".join(f"{where} {claim.verdict}" for where, claim in claims.items())
    why = "" if verdict == "reproduced" else f"It depends on where the transition is taken to end: {said}."
    further = {f"median ratio {where}": claim.measured for where, claim in claims.items()}
    return replace([*claims.values()][1], verdict=verdict, further=further, why=why)


def stress(evidence: Evidence, name: str) -> Claim:
    """An estimate under a stress boundary, at each fraction and at the last release."""
    what, (sweep, levels) = ESTIMATES[name], SWEEPS["stress"]
    predicted = {"time": "distance", "length": "twice"}[what]
    claim = at_fractions(
        evidence, lambda tables: evidence.approximate(f"{name}_stress", tables, what, predicted, levels)
    )
    return evidence.compared(claim, sweep, f"transition_{what}")


def speeds_near_one(evidence: Evidence) -> Claim:
    """Mean speeds of both fronts; the front that is farther off counts."""

    def judge(tables: list[pd.DataFrame]) -> Claim:
        fronts = [
            replace(
                evidence.approximate("stress_front_speeds_near_one", tables, f"{side}_speed", "one"),
                note=f"mean speed of the {side} front, which is the farther off",
            )
            for side in ("left", "right")
        ]
        return max(fronts, key=lambda claim: claim.deviation)

    return at_fractions(evidence, judge)


def underestimate(evidence: Evidence) -> Claim:
    """T_trans is longer than |x_minus|, in every run."""

    def judge(tables: list[pd.DataFrame]) -> Claim:
        longer = [table["time"] > table["distance"] for table in tables[:2]]
        return evidence.qualitative("T_trans_stress_underestimate", agreeing(longer[0], longer[-1]))

    medians = {
        f"median factor {where}": float((tables[0]["time"] / tables[0]["distance"]).median())
        for where, tables in arrests(evidence).items()
    }
    return replace(at_fractions(evidence, judge), further=medians)


def arrest_position(evidence: Evidence) -> Claim:
    """The last release on the left over |x_minus|, for every profile and damping; and the gap in units of H."""
    id = "front_arrest_position"
    tables = evidence.lattices("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")
    claim = evidence.approximate(id, tables, "last_release_distance", "balance_distance", ("left", "width"))
    gap = evidence.studied(
        tables, lambda t: float((t["balance_distance"] - t["last_release_distance"]).abs().median())
    )
    ratio = tables[0]["last_release_distance"] / tables[0]["balance_distance"]
    return replace(
        claim,
        further={
            "median gap in H": gap.value,
            "smallest ratio": float(ratio.min()),
            "largest ratio": float(ratio.max()),
        },
        verdict=rules.worst([claim.verdict, rules.within(gap.value, gap.uncertainty, GAP)]),
    )


def diverges(evidence: Evidence) -> Claim:
    """T_trans and L_trans grow at every step down in gamma, with exponents below zero."""
    quantities = {"T": "transition_time", "L": "transition_length"}

    def grows_without_bound(rows: pd.DataFrame) -> bool | None:
        rows = rows.sort_values("gamma")
        if len(rows) < 3:
            return None
        lines = [line_with_error(rows.head(3), quantity) for quantity in quantities.values()]
        falls = [(np.diff(rows[quantity]) < 0.0).all() for quantity in quantities.values()]
        return bool(all(falls) and all(slope + 3.0 * error < 0.0 for slope, error in lines))

    tables = evidence.lattices("scaling_displacement")
    finest, middle = ([grows_without_bound(rows) for _, rows in t.groupby("left")] for t in tables[:2])
    claim = evidence.qualitative("transition_diverges", agreeing(finest, middle))
    smallest = tables[0][tables[0]["gamma"].isin(np.sort(tables[0]["gamma"].unique())[:3])]
    exponents = {
        rf"mean exponent of $\gamma$ in ${name}_\mathrm{{trans}}$": float(
            np.mean([line_with_error(rows, quantity)[0] for _, rows in smallest.groupby("left")])
        )
        for name, quantity in quantities.items()
    }
    return replace(claim, further=exponents)


def line_with_error(rows: pd.DataFrame, quantity: str) -> tuple[float, float]:
    """Exponent of gamma in a quantity, and its standard error."""
    x, y = np.log(rows["gamma"]), np.log(rows[quantity])
    centred = x - x.mean()
    scatter = float((centred**2).sum())
    if scatter == 0.0:
        return NAN, NAN
    slope = float((centred * (y - y.mean())).sum()) / scatter
    rest = y - y.mean() - slope * centred
    return slope, float(np.sqrt((rest**2).sum() / max(len(x) - 2, 1) / scatter))


def rises_with_prestress(evidence: Evidence, id: str, sweep: str, quantity: str) -> Claim:
    """Each step up in the pre-stress, at each gamma, makes a number larger; undecided within the uncertainties."""
    decided: list[bool | None] = []
    for _, rows in evidence.points(sweep, quantity).groupby("gamma"):
        rows = rows.sort_values("left")
        change, blur = rows["value"].diff()[1:], rows["uncertainty"].rolling(2).sum()[1:]
        decided += [bool(c > 0.0) if abs(c) > b else None for c, b in zip(change, blur, strict=True)]
    return evidence.qualitative(id, decided)
