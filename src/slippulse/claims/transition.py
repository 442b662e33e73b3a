"""Claims about the crack-pulse transition and the collapses."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd

from ..prestress import Prestress
from ..theory import ArrestingCrack, exact_transition_displacement
from .evidence import Evidence
from .ledger import Claim

PAPER = {
    "transition_time": ("T_trans", "paper_transition_time"),
    "transition_length": ("L_trans", "paper_transition_length"),
}
BOUNDARIES = {
    "displacement": (
        "section III B",
        {"T_trans": "pi/sqrt(gamma)", "L_trans": "2 pi/sqrt(gamma (1 - tau_0^2))"},
    ),
    "stress": ("section III C", {"T_trans": "|x_minus|", "L_trans": "2 |x_minus|"}),
}


def transition_claims(evidence: Evidence, share: float) -> list[Claim]:
    """T_trans and L_trans over both sweeps, slope and deviation of each collapse, the effect of damping."""
    claims = []
    for boundary, (place, formulas) in BOUNDARIES.items():
        simulation = f"scaling_{boundary}"
        exact_note = exact_deviation(evidence, boundary, share)
        for quantity, (name, prediction) in PAPER.items():
            points = evidence.points(simulation, quantity)
            claims.append(
                evidence.collapse(
                    f"{name}_{boundary}",
                    place,
                    f"{name} is {formulas[name]}, {boundary} boundary",
                    points,
                    points[prediction],
                    f"{simulation}: {quantity}",
                    note=definition(boundary, share) + "; " + exact_note[quantity],
                )
            )
            claims.append(slope(evidence, boundary, quantity, name, prediction))
    claims.append(small_gamma(evidence))
    claims.append(underestimate(evidence, share))
    claims.append(never_arrests(evidence))
    claims += [damping_effect(evidence, boundary) for boundary in BOUNDARIES]
    claims.append(far_field_peak(evidence))
    return claims


def definition(boundary: str, share: float) -> str:
    """How the transition was measured."""
    if boundary == "displacement":
        return "measured at the first stick"
    return f"measured when the left front has covered {share:g} of |x_minus|"


def exact_deviation(evidence: Evidence, boundary: str, share: float) -> dict[str, str]:
    """Deviation of the extrapolated sweep from the exact theory, in words."""
    out = {}
    theory: dict[tuple, tuple[float, float]] = {}
    for quantity in PAPER:
        study = evidence.uncertainties[f"scaling_{boundary}"]
        study = study[study["quantity"] == quantity]
        deviations = []
        for row in study.itertuples():
            key = (row.left, row.width, row.gamma, row.damping_ratio, row.release)
            if key not in theory:
                theory[key] = exact(boundary, row, share)
            value = theory[key][0 if quantity == "transition_time" else 1]
            deviations.append(abs(row.extrapolated / value - 1.0))
        deviations = np.array(deviations)
        deviations = deviations[np.isfinite(deviations)]
        out[quantity] = (
            f"extrapolated to dx = 0 it deviates from the exact theory by {np.median(deviations):.2g} (median),"
            f" {np.max(deviations):.2g} (largest)"
        )
    return out


def exact(boundary: str, row, share: float) -> tuple[float, float]:
    """Exact T_trans and L_trans for one row of a measured table."""
    if boundary == "displacement":
        found = exact_transition_displacement(
            Prestress(row.left, row.right, row.width), row.gamma, row.damping_ratio, row.release
        )
        return found.time, found.length
    crack = ArrestingCrack(Prestress(row.left, row.right, row.width), row.damping_ratio, row.release)
    return crack.share_time(share), crack.share_length(share)


def slope(evidence: Evidence, boundary: str, quantity: str, name: str, prediction: str) -> Claim:
    """Slope of a collapse in log-log axes, with the slope's change on the coarser lattices as uncertainty."""
    slopes = []
    simulation = f"scaling_{boundary}"
    for table in (evidence.measured[simulation], *evidence.coarser[simulation]):
        good = np.isfinite(table[quantity]) & (table["flags"].isna() | (table["flags"] == ""))
        slopes.append(float(np.polyfit(np.log(table[prediction][good]), np.log(table[quantity][good]), 1)[0]))
    return evidence.number(
        f"{name}_{boundary}_slope",
        "figure 5",
        f"{name} grows in proportion to its prediction, {boundary} boundary",
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
        "T_trans and L_trans tend to infinity as gamma -> 0",
        -0.5,
        exponents[0],
        max(abs(exponents[0] - other) for other in exponents[1:]),
        "scaling_displacement: transition_time",
        "exponent of gamma in T_trans over the three smallest gamma, mean over tau_0",
    )


def underestimate(evidence: Evidence, share: float) -> Claim:
    """'A slight underestimation' of T_trans, as the median factor."""
    points = evidence.points("scaling_stress", "transition_time")
    factor = (points["value"] / points["paper_transition_time"]).to_numpy()
    error = (points["uncertainty"] / points["paper_transition_time"]).to_numpy()
    good = np.isfinite(factor) & np.isfinite(error)
    middle = np.flatnonzero(good)[np.argsort(factor[good])[good.sum() // 2]]
    return evidence.number(
        "T_trans_stress_underestimate",
        "section III C",
        "taking the front speed as 1 underestimates T_trans slightly",
        1.0,
        float(factor[middle]),
        float(error[middle]),
        "scaling_stress: transition_time",
        f"median factor over |x_minus|, {definition('stress', share)}; from {factor[good].min():.3g} to"
        f" {factor[good].max():.3g}",
    )


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
        "under a stress boundary the left front arrests at x_minus after a finite time",
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
    notes = []
    for table in (evidence.measured[simulation], *evidence.coarser[simulation]):
        ratio = table["transition_length"] / table["paper_transition_length"]
        by_damping = ratio.groupby(table["damping_ratio"]).median()
        shifts.append(float(by_damping.iloc[-1] / by_damping.iloc[0]))
        notes.append(by_damping)
    listed = ", ".join(f"{damping:g}: {value:.3f}" for damping, value in notes[0].items())
    return evidence.number(
        f"damping_effect_{boundary}",
        "appendix D",
        f"the collapse hardly depends on the damping, {boundary} boundary",
        1.0,
        shifts[0],
        max(abs(shifts[0] - other) for other in shifts[1:]),
        f"{simulation}: transition_length",
        f"median L_trans over its prediction at the largest beta/dx, relative to none; by beta/dx: {listed}",
    )


def far_field_peak(evidence: Evidence) -> Claim:
    """'The slip velocity of the pulse is entirely determined by tau at nucleation', against its exact peak."""
    points = evidence.points("steady_stress", "pulse_peak_velocity")
    predicted = []
    for row in points.itertuples():
        more = json.loads(row.steps_and_bumps) if hasattr(row, "steps_and_bumps") else {}
        profile = Prestress(
            row.left, row.right, row.width, **{key: value for key, value in more.items() if value}
        )
        predicted.append(ArrestingCrack(profile, row.damping_ratio, row.release).peak_velocity)
    return evidence.collapse(
        "stress_pulse_set_by_prestress",
        "section III A, figure 3",
        "under a stress boundary the pre-stress at nucleation alone determines the pulse",
        points,
        pd.Series(predicted),
        "steady_stress: pulse_peak_velocity; theory.ArrestingCrack.peak_velocity",
        note="peak slip velocity against half the integral of the pre-stress right of its zero",
    )
