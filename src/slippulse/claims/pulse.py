"""Claims about the steady pulse under a displacement boundary."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from ..theory.front_law import front_speed, front_speed_undamped, lattice_front_speed
from ..theory.pulse import paper_pulse, steady_pulse
from .evidence import Evidence, compared
from .ledger import Claim

PLACE = "section III A, appendix C"


def undamped(table: pd.DataFrame) -> pd.Series:
    """Runs without damping."""
    return table["damping_ratio"] == 0.0


def at_paper_damping(table: pd.DataFrame) -> pd.Series:
    """Runs at the damping ratio nearest to that of the paper's space-time figure, beta = 1e-3 at dx = 0.01."""
    ratios = table["damping_ratio"]
    return ratios == ratios.iloc[np.argmin(np.abs(ratios - 0.1))]


CASES = {"undamped": r"$\beta=0$", "paper_damping": "at the damping of the figures"}
DAMPING_RATIO = r"$\beta/\Delta x$"
# Quantity of the measured table, what the paper calls it, its formula, and the damped theory beside it.
FORMULAS = {
    "front_speed": (
        "front_speed_right",
        r"the front runs at $1/\sqrt{1-\tau_0^2}$",
        lambda row: float(front_speed_undamped(row.left)),
        lambda row: row_speed(row),
    ),
    "pulse_peak_velocity": (
        "pulse_peak_velocity",
        r"the largest slip velocity of the pulse is $1/\sqrt\gamma$",
        lambda row: paper_pulse(row.left, row.gamma).peak_velocity,
        lambda row: damped(row).peak_velocity,
    ),
    "pulse_width": (
        "pulse_width",
        r"the pulse is $\pi\tau_0/\sqrt{\gamma(1-\tau_0^2)}$ wide",
        lambda row: paper_pulse(row.left, row.gamma).width,
        lambda row: damped(row).width,
    ),
    "pulse_slip": (
        "pulse_slip",
        r"the pulse leaves a slip of $2\tau_0/\gamma$",
        lambda row: 2.0 * row.left / row.gamma,
        lambda row: damped(row).slip,
    ),
    "stress_drop": (
        "pulse_stress_drop",
        r"the stress drop is $2\tau_0$",
        lambda row: 2.0 * row.left,
        lambda row: damped(row).stress_drop,
    ),
    "acceleration": (
        "pulse_acceleration",
        r"the slip acceleration is a sine of amplitude $1/\tau_0$",
        lambda row: 1.0 / row.left,
        None,
    ),
}


def row_speed(row) -> float:
    """Exact front speed for one row of a measured table."""
    return float(front_speed(row.left, row.damping_ratio, row.release))


def damped(row):
    """Exact damped pulse for one row of a measured table."""
    return steady_pulse(row.left, row.gamma, row.beta, row_speed(row))


def pulse_claims(evidence: Evidence) -> list[Claim]:
    """Each formula of the pulse without damping, and at the damping that the published figures used."""
    claims = []
    for name, (quantity, statement, formula, exact) in FORMULAS.items():
        for suffix, where in (("undamped", undamped), ("paper_damping", at_paper_damping)):
            points = evidence.points("steady_displacement", quantity, where)
            predicted = np.array([formula(row) for row in points.itertuples()])
            claim = evidence.collapse(
                f"{name}_{suffix}",
                PLACE,
                f"{statement} ({CASES[suffix]})",
                points,
                predicted,
                f"steady_displacement: {quantity}",
            )
            if suffix == "paper_damping":
                claim = replace(claim, further={DAMPING_RATIO: float(points["damping_ratio"].iloc[0])})
                if exact is not None:
                    claim = compared(claim, points["value"], [exact(row) for row in points.itertuples()])
            claims.append(claim)
    claims.append(
        evidence.share(
            "steady_for_any_prestress",
            "section IV C 1",
            "steady pulses exist for any pre-stress between 0 and 1",
            "any_prestress",
            lambda table: (table["left"] > 0.0) & (table["left"] < 1.0),
            lambda table: (table["slip_variation"] < 1e-3) & (table["regime"] == "pulses, two-way"),
            "any_prestress: slip_variation, regime",
            "a pulse on each side whose final slip varies by less than a thousandth over the last third of its path",
        )
    )
    points = evidence.points("any_prestress", "pulse_width").sort_values("left")
    growth = np.diff(points["value"].to_numpy())
    claims.append(
        replace(
            evidence.number(
                "pulses_widen_with_prestress",
                "section IV A",
                "the higher the pre-stress, the wider the pulse",
                1.0,
                float(np.mean(growth > 0.0)),
                float(np.mean(np.abs(growth) <= points["uncertainty"].to_numpy()[1:])),
                "any_prestress: pulse_width",
                r"share of the steps in $\tau_0$ that widen the pulse; uncertainty: share within grid error",
            ),
            further={r"steps in $\tau_0$": float(growth.size)},
        )
    )
    claims.append(speed_at_small_gamma(evidence))
    claims.append(speed_at_unit_gamma(evidence))
    claims.append(burridge_knopoff_speed(evidence))
    claims.append(settles_beyond_step(evidence))
    return claims


def speed_at_small_gamma(evidence: Evidence) -> Claim:
    """The front speed at the smallest gamma of a sweep without damping."""
    points = evidence.points(
        "speed_against_gamma", "front_speed_right", lambda t: t["gamma"] == t["gamma"].min()
    )
    return evidence.collapse(
        "front_speed_gamma_to_zero",
        "appendix C",
        r"$v=1/\sqrt{1-\tau_0^2}$ is exact in the limit $\gamma\to0$",
        points,
        front_speed_undamped(points["left"].to_numpy()),
        "speed_against_gamma: front_speed_right",
        note=r"in the continuum limit without damping it is exact for every $\gamma$ (`theory.lattice_front_speed`)",
    )


def speed_at_unit_gamma(evidence: Evidence) -> Claim:
    """The front speed at the largest gamma up to 1 without damping."""
    points = evidence.points(
        "speed_against_gamma",
        "front_speed_right",
        lambda t: t["gamma"] == t["gamma"][t["gamma"] <= 1.0].max(),
    )
    claim = evidence.collapse(
        "front_speed_gamma_to_one",
        "appendix C",
        r"$v=1/\sqrt{1-\tau_0^2}$ is a good approximation up to $\gamma$ of about 1",
        points,
        front_speed_undamped(points["left"].to_numpy()),
        "speed_against_gamma: front_speed_right",
    )
    return replace(
        claim,
        further={r"$\gamma$": float(points["gamma"].iloc[0]), r"$\Delta x$": float(points["dx"].iloc[0])},
    )


def burridge_knopoff_speed(evidence: Evidence) -> Claim:
    """dx = 1 against the exact speed of the Burridge-Knopoff lattice with leaf springs."""
    points = evidence.points("burridge_knopoff_speed", "front_speed_right")
    predicted = [lattice_front_speed(row.left, row.gamma, row.dx) for row in points.itertuples()]
    return evidence.collapse(
        "burridge_knopoff_identity",
        "section II A, appendix B",
        r"at $\Delta x=1$ the discretised equation is the Burridge-Knopoff model",
        points,
        predicted,
        "burridge_knopoff_speed: front_speed_right; tests/verification: a separately written model",
        note=r"front speed at $\Delta x=1$ against the exact speed of a chain of blocks with leaf springs",
    )


def settles_beyond_step(evidence: Evidence) -> Claim:
    """A pulse sent into another pre-stress leaves the slip of that pre-stress's own steady pulse."""
    points = evidence.points("pulses_across_a_step", "pulse_slip")
    predicted = [
        steady_pulse(
            row.beyond, row.gamma, row.beta, float(front_speed(row.beyond, row.damping_ratio, row.release))
        ).slip
        for row in points.itertuples()
    ]
    return evidence.collapse(
        "perturbed_pulses_settle",
        "section IV C 1",
        "under a displacement boundary a perturbed pulse passes to another steady pulse",
        points,
        predicted,
        "pulses_across_a_step: pulse_slip",
        note="final slip long after a step of the pre-stress, against the exact pulse of the new level",
    )
