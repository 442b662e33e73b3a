"""Claims about the crack-pulse transition and the collapses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from ..comparison.exact_transition import exact_transition
from ..model.scene import prestress_from
from ..theory.arrest import ArrestingCrack
from .evidence import Evidence, compared
from .ledger import Claim

TEX = {"T_trans": r"$T_\mathrm{trans}$", "L_trans": r"$L_\mathrm{trans}$"}
SHARE = r"share of $\left|x_-\right|$"
PAPER = {
    "transition_time": ("T_trans", "paper_transition_time"),
    "transition_length": ("L_trans", "paper_transition_length"),
}
BOUNDARIES = {
    "displacement": (
        "section III B",
        {"T_trans": r"$\pi/\sqrt\gamma$", "L_trans": r"$2\pi/\sqrt{\gamma(1-\tau_0^2)}$"},
    ),
    "stress": ("section III C", {"T_trans": r"$\left|x_-\right|$", "L_trans": r"$2\left|x_-\right|$"}),
}


def transition_claims(evidence: Evidence, share: float) -> list[Claim]:
    """T_trans and L_trans over both sweeps, slope and deviation of each collapse, the effect of damping."""
    claims = []
    for boundary, (place, formulas) in BOUNDARIES.items():
        simulation = f"scaling_{boundary}"
        for quantity, (name, prediction) in PAPER.items():
            points = evidence.points(simulation, quantity)
            claim = evidence.collapse(
                f"{name}_{boundary}",
                place,
                f"{TEX[name]} is {formulas[name]}, {boundary} boundary",
                points,
                points[prediction],
                f"{simulation}: {quantity}",
                note=f"{definition(boundary)}; the exact theory beside the runs extrapolated to $\\Delta x=0$",
            )
            claim = compared(claim, *extrapolated(evidence, simulation, quantity, share))
            claims.append(with_share(claim, boundary, share))
            claims.append(slope(evidence, boundary, quantity, name, prediction))
    claims.append(small_gamma(evidence))
    claims.append(underestimate(evidence, share))
    claims.append(never_arrests(evidence))
    claims += [damping_effect(evidence, boundary) for boundary in BOUNDARIES]
    claims.append(far_field_peak(evidence))
    return claims


def definition(boundary: str) -> str:
    """How the transition was measured."""
    if boundary == "displacement":
        return "measured at the first stick"
    return r"measured when the left front has covered the stated share of $\left|x_-\right|$"


def with_share(claim: Claim, boundary: str, share: float) -> Claim:
    """The claim with the share that defines it under a stress boundary."""
    return replace(claim, further=claim.further | {SHARE: share}) if boundary == "stress" else claim


def extrapolated(
    evidence: Evidence, simulation: str, quantity: str, share: float
) -> tuple[list[float], list[float]]:
    """A quantity of each run of a sweep extrapolated to dx = 0, and what the exact theory has for it."""
    study = evidence.uncertainties[simulation]
    study = study[study["quantity"] == quantity]
    exact = [exact_transition(row._asdict(), share) for row in study.itertuples()]
    values = [found.time if quantity == "transition_time" else found.length for found in exact]
    return study["extrapolated"].tolist(), values


def slope(evidence: Evidence, boundary: str, quantity: str, name: str, prediction: str) -> Claim:
    """Slope of a collapse in log-log axes, with the slope's change on the coarser lattices as uncertainty."""
    slopes = []
    simulation = f"scaling_{boundary}"
    for table in (evidence.measured[simulation], *evidence.coarser[simulation]):
        good = np.isfinite(table[quantity]) & (table["run_flags"].isna() | (table["run_flags"] == ""))
        slopes.append(float(np.polyfit(np.log(table[prediction][good]), np.log(table[quantity][good]), 1)[0]))
    return evidence.number(
        f"{name}_{boundary}_slope",
        "figure 5",
        f"{TEX[name]} grows in proportion to its prediction, {boundary} boundary",
        1.0,
        slopes[0],
        max(abs(slopes[0] - other) for other in slopes[1:]),
        f"{simulation}: {quantity}",
        "slope of a straight line through the collapse in logarithmic axes",
    )


def small_gamma(evidence: Evidence) -> Claim:
    """L_trans and T_trans grow without bound as gamma -> 0: the exponent of gamma at the smallest values."""
    exponents = []
    for table in (evidence.measured["scaling_displacement"], *evidence.coarser["scaling_displacement"]):
        smallest = np.sort(table["gamma"].unique())[:3]
        per_level = [
            np.polyfit(np.log(rows["gamma"]), np.log(rows["transition_time"]), 1)[0]
            for _, rows in table[table["gamma"].isin(smallest)].groupby("left")
        ]
        exponents.append(float(np.mean(per_level)))
    return evidence.number(
        "T_trans_diverges",
        "section III A",
        f"{TEX['T_trans']} and {TEX['L_trans']} tend to infinity as $\\gamma\\to0$",
        -0.5,
        exponents[0],
        max(abs(exponents[0] - other) for other in exponents[1:]),
        "scaling_displacement: transition_time",
        r"exponent of $\gamma$ in $T_\mathrm{trans}$ over the three smallest $\gamma$, mean over $\tau_0$",
    )


def underestimate(evidence: Evidence, share: float) -> Claim:
    """'A slight underestimation' of T_trans, as the median factor."""
    points = evidence.points("scaling_stress", "transition_time")
    factor = (points["value"] / points["paper_transition_time"]).to_numpy()
    error = (points["uncertainty"] / points["paper_transition_time"]).to_numpy()
    good = np.isfinite(factor) & np.isfinite(error)
    middle = np.flatnonzero(good)[np.argsort(factor[good])[good.sum() // 2]]
    claim = evidence.number(
        "T_trans_stress_underestimate",
        "section III C",
        f"taking the front speed as 1 underestimates {TEX['T_trans']} slightly",
        1.0,
        float(factor[middle]),
        float(error[middle]),
        "scaling_stress: transition_time",
        rf"median factor over $\left|x_-\right|$, {definition('stress')}",
    )
    span = {"smallest factor": float(factor[good].min()), "largest factor": float(factor[good].max())}
    return with_share(replace(claim, runs=int(good.sum()), further=span), "stress", share)


def never_arrests(evidence: Evidence) -> Claim:
    """The last release in units of |x_minus|: does it converge with dx?"""
    study = evidence.uncertainties["scaling_stress"]
    late = study[study["quantity"] == "last_release_time"]
    timed = study[study["quantity"] == "transition_time"].set_index("point")
    ratio = late.set_index("point")["uncertainty"] / late.set_index("point")["value"]
    reference = timed["uncertainty"] / timed["value"]
    return evidence.number(
        "left_front_arrests",
        "section III C",
        "under a stress boundary the left front arrests at $x_-$ after a finite time",
        0.0,
        float(np.nanmedian(ratio)),
        float(np.nanmedian(reference)),
        "scaling_stress: last_release_time; theory.ArrestingCrack",
        "median relative grid uncertainty of the time of the last release, which would vanish if it converged; beside"
        " it, as uncertainty, the same for the time to cover the configured share; exactly, the front never arrives",
    )


def damping_effect(evidence: Evidence, boundary: str) -> Claim:
    """How much damping moves a collapse: the median deviation at the largest damping against none."""
    simulation = f"damping_{boundary}"
    shifts = []
    medians = []
    for table in (evidence.measured[simulation], *evidence.coarser[simulation]):
        ratio = table["transition_length"] / table["paper_transition_length"]
        by_damping = ratio.groupby(table["damping_ratio"]).median()
        shifts.append(float(by_damping.iloc[-1] / by_damping.iloc[0]))
        medians.append(by_damping)
    claim = evidence.number(
        f"damping_effect_{boundary}",
        "appendix D",
        f"the collapse hardly depends on the damping, {boundary} boundary",
        1.0,
        shifts[0],
        max(abs(shifts[0] - other) for other in shifts[1:]),
        f"{simulation}: transition_length",
        r"median $L_\mathrm{trans}$ over its prediction at the largest $\beta/\Delta x$, relative to none",
    )
    listed = {rf"at $\beta/\Delta x={damping:g}$": float(value) for damping, value in medians[0].items()}
    return replace(claim, further=listed)


def far_field_peak(evidence: Evidence) -> Claim:
    """'The slip velocity of the pulse is entirely determined by tau at nucleation', against its exact peak."""
    points = evidence.points("steady_stress", "pulse_peak_velocity")
    predicted = [
        ArrestingCrack(prestress_from(row._asdict()), row.damping_ratio, row.release).peak_velocity
        for row in points.itertuples()
    ]
    return evidence.collapse(
        "stress_pulse_set_by_prestress",
        "section III A, figure 3",
        "under a stress boundary the pre-stress at nucleation alone determines the pulse",
        points,
        pd.Series(predicted),
        "steady_stress: pulse_peak_velocity; theory.ArrestingCrack.peak_velocity",
        note="peak slip velocity against half the integral of the pre-stress right of its zero",
    )
