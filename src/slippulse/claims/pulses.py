"""Claims about the steady pulse under a displacement boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from itertools import combinations, pairwise

import numpy as np
import pandas as pd

from ..model.prestress import Prestress
from ..model.scene import prestress_from
from ..theory.front_law import front_speed_undamped
from ..theory.pulse import paper_pulse
from ..theory.rupture import Rupture
from .evidence import Evidence
from .ledger import Claim

# What a steady pulse of given pre-stress and elasticity ratio is compared by.
SIZES = ("pulse_peak_velocity", "pulse_width", "pulse_slip")
# The nucleation reaches so many widths of its Gaussian; a derivative in time by a difference over this.
BEGINNING, SHORTLY = 6.0, 1e-4
# Quantity of each exact claim about the undamped pulse, and the paper's formula for it.
FORMULAS = {
    "pulse_profile": ("pulse_shape_deviation", lambda row: 0.0),
    "pulse_peak_velocity": (
        "pulse_peak_velocity",
        lambda row: paper_pulse(row.left, row.gamma).peak_velocity,
    ),
    "pulse_width": ("pulse_width", lambda row: paper_pulse(row.left, row.gamma).width),
    "pulse_slip": ("pulse_slip", lambda row: 2.0 * row.left / row.gamma),
    "stress_drop": ("pulse_stress_drop", lambda row: 2.0 * row.left),
    "pulse_acceleration": ("pulse_acceleration", lambda row: 1.0 / row.left),
}
NOTES = {
    "pulse_profile": "largest distance of the slip velocity from equation (9), over the peak, the peaks aligned and two"
    " blocks at either end left out",
    "pulse_width": "from the front to where blocks stick",
    "pulse_acceleration": "amplitude by projection on the sine, in which the ringing of the lattice averages out",
    "stress_drop": r"$\gamma$ times the slip",
}


def pulse_claims(evidence: Evidence) -> list[Claim]:
    """Front speed, the formulas of the undamped pulse, steadiness, uniqueness and stability."""
    return [
        limit_speed(evidence),
        moderate_speed(evidence),
        *(formula(evidence, id, *entry) for id, entry in FORMULAS.items()),
        steady_for_any_prestress(evidence),
        widen(evidence),
        unique(evidence),
        settle(evidence),
        smooth(evidence),
    ]


def limit_speed(evidence: Evidence) -> Claim:
    """The front speed without damping and leaf springs, and at the smallest gamma."""
    springs = evidence.points("speed_against_gamma", "front_speed_right")
    smallest = springs[springs["gamma"] == springs["gamma"].min()]
    points = pd.concat(
        [evidence.points("front_speed_undamped", "front_speed_right"), smallest], ignore_index=True
    )
    return evidence.exact(
        "front_speed",
        "front_speed_undamped, speed_against_gamma: front_speed_right",
        points,
        front_speed_undamped(points["right"].to_numpy(float)),
        r"without leaf springs, which is $\gamma=0$, and at the smallest $\gamma$ with them",
    )


def moderate_speed(evidence: Evidence) -> Claim:
    """The front speed without damping for gamma up to 1."""
    tables = [
        table[(table["damping_ratio"] == 0.0) & table["gamma"].between(0.1, 1.0)].assign(
            paper=lambda part: front_speed_undamped(part["right"].to_numpy(float))
        )
        for table in evidence.lattices("speed_against_gamma", "steady_displacement")
    ]
    return evidence.approximate(
        "front_speed_moderate_gamma",
        "speed_against_gamma, steady_displacement: front_speed_right",
        tables,
        "front_speed_right",
        "paper",
        note=r"$\gamma$ from $0.1$ to $1$",
    )


def formula(evidence: Evidence, id: str, quantity: str, paper) -> Claim:
    """One formula of the undamped pulse; by the exact solution of a whole rupture where the lattices are too coarse."""
    points = evidence.points("steady_displacement", quantity)
    points = points[points["damping_ratio"] == 0.0]
    predicted = [paper(row) for row in points.itertuples()]
    source, note = f"steady_displacement: {quantity}", NOTES.get(id, "")
    claim = evidence.exact(id, source, points, predicted, note)
    if claim.verdict != "inconclusive" or id not in EXACTLY:
        return claim
    found = pd.DataFrame(
        [EXACTLY[id](row) for row in points.itertuples()], columns=["extrapolated", "uncertainty"]
    )
    return replace(
        evidence.exact(
            id, f"theory.Rupture; {source}", found, predicted,
            f"{note}; by the exact solution of the whole rupture, since the lattices leave it open",
        ),
        further={"deviation on the lattices": claim.deviation, "its uncertainty": claim.uncertainty / claim.predicted},
    )  # fmt: skip


def late_pulse(row, refinement: int) -> tuple[Rupture, float]:
    """The exact rupture of a row without damping, and a time at which its pulse has forgotten the nucleation."""
    paper = paper_pulse(row.left, row.gamma)
    # The front and the Gaussian behind it, and what the steady pulse remembers.
    time = 2.0 * (BEGINNING * row.width + paper.width / (paper.speed - 1.0))
    return undamped(prestress_from(row._asdict()), row.gamma, row.release, 1.1 * time, refinement), time


@lru_cache(maxsize=32)
def undamped(prestress: Prestress, gamma: float, release: str, duration: float, refinement: int) -> Rupture:
    """The exact rupture without damping."""
    return Rupture(prestress, gamma, 0.0, release, duration, refinement)


def refined(number: Callable[[Rupture, float], float]) -> Callable[[tuple], tuple[float, float]]:
    """A number of the exact pulse of a row, and what it changes when the panels are cut in two."""

    def found(row) -> tuple[float, float]:
        values = [number(*late_pulse(row, refinement)) for refinement in (1, 2)]
        return values[0], abs(values[0] - values[1])

    return found


def amplitude(rupture: Rupture, time: float) -> float:
    """Amplitude of the sine in the slip acceleration across the exact pulse."""
    front, width = rupture.fronts_at(time)[1], rupture.pulse_width(time)
    x = front - width * np.linspace(0.1, 0.9, 9)
    late, early = (rupture.slip_velocity(x, time + shift) for shift in (SHORTLY, -SHORTLY))
    sine = np.cos(np.pi * (front - x) / width)
    return float(np.sum((late - early) / (2.0 * SHORTLY) * sine) / np.sum(sine**2))


# What decides where the lattices cannot, by claim.
EXACTLY = {
    "pulse_width": refined(lambda rupture, time: rupture.pulse_width(time)),
    "pulse_acceleration": refined(amplitude),
}


def steady_for_any_prestress(evidence: Evidence) -> Claim:
    """Two pulses whose slip does not vary, at every level."""
    allowed = evidence.tolerance("steady_for_any_prestress")
    decided = evidence.agreed(
        "any_prestress",
        lambda table: table["left"].between(0.0, 1.0, inclusive="neither"),
        lambda table: (table["slip_variation"] < allowed) & (table["regime"] == "pulses, two-way"),
    )
    return evidence.qualitative(
        "steady_for_any_prestress",
        "any_prestress: slip_variation, regime",
        decided,
        "levels at which a pulse on each side leaves a slip that varies less than the tolerance over the last third of"
        " its path",
    )


def widen(evidence: Evidence) -> Claim:
    """Each step up in the pre-stress makes the pulse wider."""
    points = evidence.points("any_prestress", "pulse_width").sort_values("left")
    decided = [larger(*pair) for pair in pairwise(points.itertuples())]
    return evidence.qualitative(
        "pulses_widen_with_prestress", "any_prestress: pulse_width", decided, r"steps in $\tau_0$"
    )


def larger(one, other) -> bool | None:
    """Whether the value of the second row is above that of the first; None within their uncertainties."""
    change, blur = other.value - one.value, one.uncertainty + other.uncertainty
    return bool(change > 0.0) if abs(change) > blur else None


def unique(evidence: Evidence) -> Claim:
    """Pulses of one pre-stress from different beginnings are the same pulse."""
    allowed = evidence.tolerance("displacement_pulse_unique")
    sweeps = ("nucleation_widths", "any_prestress", "pulses_across_a_step")
    studies = {
        size: pd.concat([evidence.points(name, size) for name in sweeps], ignore_index=True) for size in SIZES
    }
    where = studies["pulse_slip"]
    decided = []
    for _, rows in where.groupby([where["beyond"], "gamma", "damping_ratio"]).groups.items():
        for i, j in combinations(rows, 2):
            decided.append(alike([(studies[size].loc[i], studies[size].loc[j]) for size in SIZES], allowed))
    return evidence.qualitative(
        "displacement_pulse_unique",
        "nucleation_widths, any_prestress, pulses_across_a_step: pulse_peak_velocity, pulse_width, pulse_slip",
        decided,
        r"pairs of pulses at one $\tau_0$, $\gamma$, $\beta/\Delta x$ that began in Gaussians of different width or in"
        " another pre-stress; equal in peak, width and slip",
    )


def alike(pairs, allowed: float) -> bool | None:
    """Whether pairs of values are equal within a tolerance; None where only their uncertainty sets them apart."""
    apart = [abs(one["value"] / other["value"] - 1.0) for one, other in pairs]
    blur = [(one["uncertainty"] + other["uncertainty"]) / abs(other["value"]) for one, other in pairs]
    if all(difference <= allowed for difference in apart):
        return True
    return False if any(d - b > allowed for d, b in zip(apart, blur, strict=True)) else None


def settle(evidence: Evidence) -> Claim:
    """A pulse sent into another pre-stress leaves the slip of that pre-stress's own steady pulse."""
    allowed = evidence.tolerance("perturbed_pulses_settle")
    keys = ["left", "gamma", "damping_ratio"]
    steady = [
        table.drop_duplicates(keys).set_index(keys)["pulse_slip"]
        for table in evidence.lattices("any_prestress", "steady_displacement")
    ]

    def off(table: pd.DataFrame, own: pd.Series) -> np.ndarray:
        rows = zip(table["beyond"], table["gamma"], table["damping_ratio"], strict=True)
        new = np.array([own.get(row, np.nan) for row in rows])
        return np.abs(table["pulse_slip"].to_numpy(float) / new - 1.0)

    tables = evidence.lattices("pulses_across_a_step", "pulses_across_wide_steps")
    first, second = (off(table, own) for table, own in zip(tables[:2], steady[:2], strict=True))
    claim = evidence.qualitative(
        "perturbed_pulses_settle",
        "pulses_across_a_step, pulses_across_wide_steps, any_prestress, steady_displacement: pulse_slip",
        [
            bool(one) if one == other else None
            for one, other in zip(first <= allowed, second <= allowed, strict=True)
        ],
        "slip long after a step of the pre-stress, against that of the steady pulse that began at the new level",
    )
    return replace(claim, further={"slip off by at most": float(np.nanmax(first, initial=0.0))})


def smooth(evidence: Evidence) -> Claim:
    """Damping takes power from the waves of the lattice."""
    finest, middle, *_ = evidence.lattices("steady_displacement")

    def falls(table: pd.DataFrame) -> list[bool]:
        by_level = [
            rows.sort_values("damping_ratio")["lattice_noise"] for _, rows in table.groupby(["left", "gamma"])
        ]
        return [bool(after < before) for noise in by_level for before, after in combinations(noise, 2)]

    pairs = zip(falls(finest), falls(middle), strict=True)
    claim = evidence.qualitative(
        "damping_reduces_oscillations",
        "steady_displacement: lattice_noise; a run with the printed sign grows without bound (tests/verification)",
        [one if one == other else None for one, other in pairs],
        r"pairs of $\beta/\Delta x$ of which the larger has less power of slip velocity in waves of a few blocks;"
        " condition: the sign opposite to the printed one",
        condition=True,
    )
    open_runs = claim.failed or claim.undecided
    return replace(claim, why="" if open_runs else "It needs the sign opposite to the printed one.")
